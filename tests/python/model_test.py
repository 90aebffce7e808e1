"""Models, and what the command line says of bad ones."""

import copy
import json
import pickle
import tempfile
import unittest
from pathlib import Path

import numpy as np
import verisq

from command_line import EXAMPLES, message

SOAP = json.loads((EXAMPLES / "soap.json").read_text())


class Models(unittest.TestCase):
    def test_of_files_texts_and_dictionaries_are_the_same(self):
        for path in sorted(EXAMPLES.glob("*.json")):
            if path.name == "femur_landmarks.json":
                continue
            with self.subTest(path.name):
                model = verisq.Model.load(path)
                again = verisq.Model.from_dict(model.to_dict())
                self.assertEqual(again.to_dict(), model.to_dict())
                self.assertEqual(verisq.Model.loads(path.read_text()).to_dict(), model.to_dict())
                self.assertEqual(pickle.loads(pickle.dumps(model)).to_dict(), model.to_dict())
                self.assertEqual(again.bounding_radius, model.bounding_radius)
                self.assertEqual(len(model.names), len(model.to_dict()["primitives"]))

    def test_are_saved_bit_for_bit(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ["bent_tapered_stem.json", "tapered_stem.json", "stem.json"]:
                model = verisq.Model.load(EXAMPLES / name)
                model.save(Path(folder, name))
                self.assertEqual(verisq.Model.load(Path(folder, name)).to_dict(), model.to_dict())
            with self.assertRaisesRegex(verisq.Error, "^saving a model: not for models with intervals$"):
                verisq.Model.load(EXAMPLES / "uncertain_stem.json").save(Path(folder, "uncertain.json"))

    def test_know_what_they_are(self):
        uncertain = verisq.Model.load(EXAMPLES / "uncertain_stem.json")
        bent = verisq.Model.load(EXAMPLES / "bent_stem.json")
        self.assertEqual((uncertain.is_exact, uncertain.is_union_of_convex), (False, True))
        self.assertEqual((bent.is_exact, bent.is_union_of_convex), (True, False))
        self.assertEqual(verisq.Model.load(EXAMPLES / "tapered_stem.json").units, "mm")
        self.assertIn("with intervals", repr(uncertain))

    def test_set_operations_stay(self):
        ball = {"semi_axes": [1, 1, 1], "exponents": [1, 1]}
        description = {
            "format": "verisq-model/1",
            "primitives": [{"name": "a", "superquadric": ball}, {"name": "b", "superquadric": ball}],
            "csg": {"difference": ["a", {"intersection": ["b", "a"]}]},
        }
        self.assertEqual(verisq.Model.from_dict(description).to_dict()["csg"], description["csg"])

    def test_are_moved(self):
        soap = verisq.Model.load(EXAMPLES / "soap.json")
        moved = soap.posed([0, 0, 5, 0, 0, 0, 2])  # half a turn about z, then up
        self.assertEqual(moved.to_dict()["primitives"][0]["pose"]["translation"], [0, 0, 5])
        here, there = verisq.SignedDistance(soap)([4, 1, 2]), verisq.SignedDistance(moved)([-4, -1, 7])
        self.assertEqual(there, here)
        with self.assertRaisesRegex(verisq.Error, "^a pose must be finite, and its quaternion not zero$"):
            soap.posed([0, 0, 5, 0, 0, 0, 0])

    def test_take_arrays(self):
        description = copy.deepcopy(SOAP)
        superquadric = description["primitives"][0]["superquadric"]
        superquadric["semi_axes"] = np.array(superquadric["semi_axes"], dtype=np.float32)
        axes = verisq.Model.from_dict(description).to_dict()["primitives"][0]["superquadric"]["semi_axes"]
        self.assertEqual(axes, superquadric["semi_axes"].tolist())
        superquadric["semi_axes"] = object()
        with self.assertRaisesRegex(TypeError, "not object$"):
            verisq.Model.from_dict(description)


class Errors(unittest.TestCase):
    def test_say_what_the_command_line_says(self):
        changes = {
            "exponent": lambda model: model["primitives"][0]["superquadric"].update(exponents=[3.0, 1.0]),
            "key": lambda model: model.update(colour="red"),
            "name": lambda model: model.update(csg={"union": ["nobody"]}),
            "interval": lambda model: model["primitives"][0]["superquadric"].update(exponents=[[1.0, 0.5], 1.0]),
            "format": lambda model: model.update(format="verisq-model/2"),
        }
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "bad.json")
            for name, change in changes.items():
                with self.subTest(name):
                    description = copy.deepcopy(SOAP)
                    change(description)
                    path.write_text(json.dumps(description))
                    with self.assertRaises(verisq.Error) as caught:
                        verisq.Model.load(path)
                    self.assertEqual(str(caught.exception), message("distance", path, path))
                    self.assertEqual(caught.exception.kind, "input")
                    with self.assertRaises(verisq.Error) as again:
                        verisq.Model.from_dict(description)
                    self.assertEqual(str(again.exception), str(caught.exception).replace(str(path), "model"))
            path.write_text("{ ")
            missing = Path(folder, "missing.json")
            for file in (path, missing):
                with self.assertRaises(verisq.Error) as caught:
                    verisq.Model.load(file)
                self.assertEqual(str(caught.exception), message("distance", file, file))

    def test_not_finite(self):
        description = copy.deepcopy(SOAP)
        description["primitives"][0]["superquadric"]["semi_axes"] = [float("nan"), 1.0, 1.0]
        with self.assertRaises(verisq.Error):
            verisq.Model.from_dict(description)


if __name__ == "__main__":
    unittest.main()
