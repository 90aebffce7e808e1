"""Answers: each kind of certificate file, made here or by the command line, is proved again by both, and by nothing else."""

import json
import pickle
import tempfile
import unittest
from pathlib import Path

import numpy as np
import verisq

from command_line import EXAMPLES, message, run

STEM = EXAMPLES / "stem_mm.json"
CAVITY = EXAMPLES / "cavity.off"
LEFT = [60.0, 0, 0, 1, 0, 0, 0]


def example(name):
    return verisq.Model.load(EXAMPLES / name)


class Answers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)

    def program_checks(self, answer, *arguments):
        """Its exit status: 0 where all is proved."""
        file = self.folder / "answer.json"
        answer.save(file)
        return run("check", "--certificate", file, *arguments).returncode

    def same_after_saving(self, answer):
        file = self.folder / "saved.json"
        answer.save(file)
        again = verisq.Answer.load(file)
        self.assertEqual((again.kind, again.units, again.files), (answer.kind, answer.units, answer.files))
        again.save(self.folder / "again.json")
        self.assertEqual(file.read_bytes(), (self.folder / "again.json").read_bytes())
        self.assertEqual(pickle.loads(pickle.dumps(answer)).files, answer.files)
        return again

    def test_a_distance_of_two_models(self):
        stem = example("stem_mm.json")
        answer = self.same_after_saving(verisq.certified_distance(stem, stem, LEFT).answer(STEM, STEM, LEFT))
        self.assertEqual(answer.kind, "pair")
        self.assertEqual(answer.units, "mm")
        self.assertEqual([name for name, _ in answer.files["models"]], ["stem_mm.json", "stem_mm.json"])
        (claim,) = answer.check(models=[STEM, STEM])
        self.assertEqual((claim.what, claim.verdict, claim.is_unbounded), ("distance", "proved", False))
        self.assertLessEqual(claim.claimed.lo, claim.proven.lo)
        self.assertTrue(answer.is_proved(models=[STEM, STEM]))
        self.assertEqual(self.program_checks(answer, "--model", STEM, "--model", STEM), 0)

    def test_other_files_are_refused(self):
        stem = example("stem_mm.json")
        answer = verisq.certified_distance(stem, stem, LEFT).answer(STEM, STEM, LEFT)
        with self.assertRaisesRegex(verisq.Error, "gem.json.*about another model"):
            answer.check(models=[STEM, EXAMPLES / "gem.json"])
        with self.assertRaisesRegex(verisq.Error, "about 2 models"):
            answer.check(models=STEM)
        with self.assertRaisesRegex(verisq.Error, "about 2 models"):
            answer.is_proved()

    def test_a_forged_distance_is_refuted(self):
        stem = example("stem_mm.json")
        file = self.folder / "forged.json"
        verisq.certified_distance(stem, stem, LEFT).answer(STEM, STEM, LEFT).save(file)
        content = json.loads(file.read_text())
        content["distance"] = {"lo": content["distance"]["lo"] + 1.0, "hi": content["distance"]["hi"] + 1.0}
        file.write_text(json.dumps(content))
        forged = verisq.Answer.load(file)
        (claim,) = forged.check(models=[STEM, STEM])
        self.assertEqual(claim.verdict, "refuted")
        self.assertFalse(forged.is_proved(models=[STEM, STEM]))

    def test_a_path(self):
        capsule, gem = example("capsule.json"), example("gem.json")
        files = [EXAMPLES / "capsule.json", EXAMPLES / "gem.json"]
        path = [[200.0, 0, 0, 1, 0, 0, 0], [0, 200.0, 0, 1, 0, 0, 1]]
        found = verisq.certified_distance_along(capsule, gem, path)
        answer = self.same_after_saving(found.answer(*files, path))
        self.assertEqual(answer.kind, "path")
        self.assertEqual([claim.verdict for claim in answer.check(models=files)], ["proved"])
        self.assertEqual(self.program_checks(answer, "--model", files[0], "--model", files[1]), 0)

    def test_a_deviation(self):
        found = verisq.certified_deviation(example("stem_mm.json"), verisq.Mesh.load(CAVITY), relative_tolerance=0.5)
        answer = self.same_after_saving(found.answer(STEM, CAVITY))
        claims = answer.check(models=STEM, mesh=CAVITY)
        self.assertEqual({claim.verdict for claim in claims}, {"proved"})
        self.assertIn(("both", "largest"), [(claim.of, claim.what) for claim in claims])
        self.assertEqual(self.program_checks(answer, "--model", STEM, "--mesh", CAVITY), 0)
        with self.assertRaisesRegex(verisq.Error, "give the `mesh`"):
            answer.check(models=STEM)

    def test_a_way_in_its_surface_and_the_bone_that_it_takes(self):
        stem, cavity = example("stem_mm.json"), verisq.Mesh.load(CAVITY)
        path = verisq.straight_path([0, 0, -1], 60.0)
        found = verisq.certified_mesh_clearance(stem, cavity, path, device="host")
        answer = self.same_after_saving(found.answer(STEM, CAVITY, path))
        self.assertTrue(answer.is_proved(models=STEM, mesh=CAVITY))
        claims = answer.check(models=[STEM], mesh=CAVITY)
        self.assertEqual(len(claims), len(cavity.vertices) + 1)
        self.assertEqual(claims[-1].of, "whole surface")
        self.assertEqual(claims[-1].claimed, found.smallest_distance)
        self.assertEqual(self.program_checks(answer, "--model", STEM, "--mesh", CAVITY), 0)
        volume = verisq.certified_removed_volume(stem, path, cavity=cavity, relative_tolerance=0.5)
        removed = self.same_after_saving(volume.answer(STEM, path, cavity=CAVITY))
        (claim,) = removed.check(models=STEM, mesh=CAVITY)
        self.assertEqual((claim.what, claim.verdict), ("removed volume", "proved"))
        self.assertEqual(self.program_checks(removed, "--model", STEM, "--mesh", CAVITY), 0)

    def test_a_containment(self):
        ball = {"format": "verisq-model/1", "units": "mm", "primitives": [
            {"name": "ball", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}}]}
        file = self.folder / "ball.json"
        file.write_text(json.dumps(ball))
        around = self.folder / "around.off"
        larger = dict(ball, primitives=[{"name": "ball", "superquadric": {"semi_axes": [2, 2, 2],
                                                                          "exponents": [1, 1]}}])
        verisq.mesh_of_model(verisq.Model.from_dict(larger), 0.2).save(around)
        proof = verisq.prove_containment(verisq.Model.load(file), verisq.Mesh.load(around), "within", device="host")
        answer = self.same_after_saving(proof.answer(file, around))
        (claim,) = answer.check(models=file, mesh=around)
        self.assertEqual((claim.verdict, list(claim.proven)), ("proved", [1.0, 1.0]))
        self.assertEqual(self.program_checks(answer, "--model", file, "--mesh", around), 0)

    def test_features(self):
        landmarks = {"head_centre": [40.0, 0, 0], "neck_centre": [20.0, 0, -10.0], "shaft_proximal": [0.0, 0, -80.0],
                     "shaft_distal": [0.0, 0, -160.0]}
        found = verisq.femur_features(landmarks, "left", landmark_radius=0.5)
        answer = self.same_after_saving(found.answer(landmarks, "left", landmark_radius=0.5))
        claims = answer.check()
        self.assertEqual([claim.of for claim in claims][: len(found.features)], [each.name for each in found.features])
        self.assertEqual({claim.verdict for claim in claims}, {"proved"})
        self.assertEqual(self.program_checks(answer), 0)

    def test_where_a_body_stands(self):
        file = EXAMPLES / "standing.xml"
        found = verisq.StanceModel.load(file).certified_equilibrium(joints="held")
        answer = self.same_after_saving(found.answer(file))
        claims = answer.check(models=file)
        self.assertIn("centre of pressure, x", [claim.what for claim in claims])
        self.assertEqual({claim.verdict for claim in claims}, {"proved"})
        self.assertEqual(self.program_checks(answer, "--model", file), 0)
        with self.assertRaisesRegex(verisq.Error, "another model"):
            answer.check(models=EXAMPLES / "stance.xml")

    def test_a_fit_its_bound_and_its_contact(self):
        fitted, map_file, surface = (self.folder / name for name in ("fitted.json", "map.csv", "surface.csv"))
        files = {name: self.folder / f"{name}.json" for name in ("fit", "bound", "contact")}
        outcome = run("fit", "--implant", STEM, "--mesh", CAVITY, "--device", "host", "--samples", "16", "--gap", "0.5",
                      "--rotation-range", "1", "--translation-range", "0.5", "--map", map_file, "--certificates",
                      "--surface-map", surface, "--bound", "1e9", "--keep", "contact=0..100", "--contact-distance", "1",
                      "--certificate-file", files["fit"], "--bound-certificate-file", files["bound"],
                      "--contact-certificate-file", files["contact"], "-o", fitted)
        self.assertIn(outcome.returncode, (0, 3), outcome.stderr)
        fit = self.same_after_saving(verisq.Answer.load(files["fit"]))
        claims = fit.check(models=fitted, mesh=CAVITY, map=map_file, surface_map=surface)
        self.assertIn("objective", [claim.what for claim in claims])
        self.assertIn("surface_distance", [claim.what for claim in claims])
        self.assertTrue(fit.is_proved(models=fitted, mesh=CAVITY, map=map_file, surface_map=surface))
        with self.assertRaisesRegex(verisq.Error, "give the `map`"):
            fit.check(models=fitted, mesh=CAVITY)
        unknown = [claim for claim in fit.check(models=fitted, mesh=CAVITY, map=map_file)
                   if claim.what == "surface_distance"]
        self.assertEqual([claim.verdict for claim in unknown], ["unproved"])
        with self.assertRaisesRegex(verisq.Error, "is no map of"):
            fit.check(models=fitted, mesh=CAVITY, map=surface)
        bound = self.same_after_saving(verisq.Answer.load(files["bound"]))
        self.assertTrue(all(claim.verdict == "proved" for claim in bound.check(models=STEM, mesh=CAVITY)))
        contact = self.same_after_saving(verisq.Answer.load(files["contact"]))
        self.assertEqual(contact.kind, "contact")
        self.assertTrue(contact.is_proved(models=fitted, mesh=CAVITY))

    def test_many_poses(self):
        poses, file, found = self.folder / "poses.csv", self.folder / "poses.json", self.folder / "distances.csv"
        poses.write_text("x,y,z,qw,qx,qy,qz\n60,0,0,1,0,0,0\n0,70,0,1,0,0,0\n")
        outcome = run("distance", STEM, STEM, "--poses", poses, "-o", found, "--certificate-file", file)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        answer = self.same_after_saving(verisq.Answer.load(file))
        self.assertEqual([(claim.of, claim.verdict) for claim in answer.check(models=[STEM, STEM])],
                         [("pose 0", "proved"), ("pose 1", "proved")])

    def test_what_is_no_certificate_is_refused(self):
        with self.assertRaisesRegex(verisq.Error, "format"):
            verisq.Answer.load(STEM)


if __name__ == "__main__":
    unittest.main()
