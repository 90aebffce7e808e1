"""Proven deviations contain those of dense samples that share nothing with verisq, and the comparison can fail."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(os.environ["VERISQ_SOURCE"]) / "bench"))
import sampled_deviation  # noqa: E402


def stem(body: float, taper: float, bow: float) -> dict:
    """A body and a head of radius 14, in mm."""
    return {"format": "verisq-model/1", "units": "mm", "primitives": [
        {"name": "body", "superquadric": {"semi_axes": [body, 8, 40], "exponents": [0.4, 0.6], "taper": taper},
         "bend": {"curvature": bow, "angle_deg": 30}},
        {"name": "head", "superquadric": {"semi_axes": [14, 14, 14], "exponents": [1, 1]},
         "pose": {"translation": [8, 0, 50], "quaternion": [0.9, 0.1, 0.3, 0.2]}}]}


class Patches:
    """Of one primitive's surface, as docs/formats.md §9 describes them, read by nothing of verisq."""

    def __init__(self, primitive: sampled_deviation.Primitive, letters: str) -> None:
        self.primitive = primitive
        self.letters = iter(letters)
        self.leaves = []  # of (letter, points)
        for octant in range(8):
            self.follow(octant, ((1.0, 0.0), (0.0, 1.0)), ((1.0, 0.0), (0.0, 1.0)))
        assert next(self.letters, None) is None, "more letters than patches"

    def follow(self, octant: int, along: tuple, around: tuple) -> None:
        letter = next(self.letters)
        if letter in ".o":
            self.leaves.append((letter, self.points(octant, along, around)))
        for arc in halves(along, self.primitive.exponents[0]) if letter == "a" else ():
            self.follow(octant, arc, around)
        for arc in halves(around, self.primitive.exponents[1]) if letter == "r" else ():
            self.follow(octant, along, arc)

    def points(self, octant: int, along: tuple, around: tuple, count: int = 6) -> np.ndarray:
        first, second = on_arc(along, self.primitive.exponents[0], count), on_arc(around, self.primitive.exponents[1], count)
        signs = [-1 if octant >> i & 1 else 1 for i in range(3)]
        unit = [(c * s[0], c * s[1], z) for c, z in first.T for s in second.T]
        return self.primitive.placed(np.array(unit) * signs)


def on_arc(ends: tuple, exponent: float, count: int) -> np.ndarray:
    shares = np.linspace(0, 1, count)
    return np.array(sampled_deviation.on_curve(*(ends[0][i] * (1 - shares) + ends[1][i] * shares for i in (0, 1)), exponent))


def halves(ends: tuple, exponent: float) -> tuple:
    middle = tuple(on_arc(ends, exponent, 3)[:, 1])
    return (ends[0], middle), (middle, ends[1])


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

    def test_patches_of_a_certificate_are_what_it_says(self) -> None:
        """Of a body, and a head that it hides a part of, and points about them."""
        folder, description = pathlib.Path(self.folder.name), stem(9, 1.5, 0)
        primitives = [sampled_deviation.Primitive(primitive) for primitive in description["primitives"]]
        points_near = sampled_deviation.boundary(primitives, step=7.0)[1] * 1.05
        np.savetxt(folder / "points.csv", points_near, fmt="%.17g", delimiter=",")
        subprocess.run([os.environ["VERISQ"], "deviation", "--model", self.write("stem.json", description), "--points",
                        folder / "points.csv", "--both-ways", "--tol", "10%", "--device", "host", "--certificate-file",
                        folder / "proof.json", "--no-progress"], check=True, stdout=subprocess.DEVNULL)
        certificate = json.loads((folder / "proof.json").read_text())
        surface, largest = certificate["surface"], certificate["from_model"]["largest"]
        to_points = sampled_deviation.cKDTree(points_near).query
        farthest, hidden, off = 0.0, 0, iter(surface["off"])
        for primitive, other, letters in zip(primitives, reversed(primitives), surface["patches"]):
            for letter, points in Patches(primitive, letters).leaves:
                if letter == ".":
                    farthest = max(farthest, to_points(points)[0].max())
                    continue
                hidden += 1
                sample = next(off)
                self.assertTrue(other.contains(points).all(), sample)
                self.assertLess(np.linalg.norm(points - sample["point"], axis=1).max(), -sample["hi"])
        self.assertIsNone(next(off, None))
        self.assertGreater(hidden, 10)
        self.assertLessEqual(farthest, surface["within"])
        self.assertGreater(farthest, 0.95 * largest["lo"])
        self.assertLessEqual(largest["lo"], to_points(surface["farthest"]["point"])[0] + 1e-9)
        self.assertEqual(largest["hi"], surface["within"])

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
