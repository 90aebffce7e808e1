"""Proven deviations contain those of dense samples that share nothing with verisq, and the comparison can fail."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["VERISQ_SOURCE"]) / "bench"))
import sampled_deviation  # noqa: E402


def stem(body: float, taper: float, bow: float) -> dict:
    """A body and a head of radius 14, in mm."""
    return {"format": "verisq-model/1", "units": "mm", "primitives": [
        {"name": "body", "superquadric": {"semi_axes": [body, 8, 40], "exponents": [0.4, 0.6], "taper": taper},
         "bend": {"curvature": bow, "angle_deg": 30}},
        {"name": "head", "superquadric": {"semi_axes": [14, 14, 14], "exponents": [1, 1]},
         "pose": {"translation": [8, 0, 50], "quaternion": [0.9, 0.1, 0.3, 0.2]}}]}


class SampledDeviation(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def write(self, name: str, model: dict) -> str:
        path = pathlib.Path(self.folder.name) / name
        path.write_text(json.dumps(model))
        return str(path)

    def meshed(self, model: str) -> str:
        mesh = model.replace(".json", ".stl")
        subprocess.run([os.environ["VERISQ"], "mesh", "--model", model, "--deviation", "0.2", "--no-proof", "-o", mesh,
                        "--no-progress"], check=True, stdout=subprocess.DEVNULL)
        return mesh

    def test_is_contained(self) -> None:
        mesh = self.meshed(self.write("other.json", stem(11, 1.8, 0.004)))
        for name, model in (("tapered.json", stem(9, 1.5, 0)), ("bent.json", stem(9, 1, 0.001))):
            sys.argv = ["sampled_deviation.py", self.write(name, model), mesh, "--step", "1"]
            self.assertEqual(sampled_deviation.main(), 0, name)

    def test_what_escapes_or_is_wide_is_told(self) -> None:
        sampled = {"Hausdorff": 2.0, "mean": 1.0}
        agree = lambda proven: sampled_deviation.agree(sampled, proven, step=0.1, error=1e-4, tolerance=0.05)
        self.assertTrue(agree({"Hausdorff": (2.05, 2.1), "mean": (0.99, 1.01)}))
        for escaped in ((1.9, 1.99), (2.2, 2.25)):
            self.assertFalse(agree({"Hausdorff": escaped, "mean": (0.99, 1.01)}), escaped)
        for escaped in ((0.96, 0.99), (1.01, 1.04), (0.9, 1.1)):
            self.assertFalse(agree({"Hausdorff": (2.0, 2.1), "mean": escaped}), escaped)


if __name__ == "__main__":
    unittest.main()
