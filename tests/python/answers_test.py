"""Answers: each kind of certificate file, made here or by the command line, is proved again by both, and by nothing else."""

import json
import pickle
import tempfile
import unittest
from pathlib import Path

import verisq

from command_line import EXAMPLES, run

STEM = EXAMPLES / "stem_mm.json"
CAVITY = EXAMPLES / "cavity.off"
LEFT = [60.0, 0, 0, 1, 0, 0, 0]


def example(name):
    return verisq.Model.load(EXAMPLES / name)


def ellipsoid(semi_axes):
    return {"format": "verisq-model/1", "units": "mm", "primitives": [
        {"name": "ellipsoid", "superquadric": {"semi_axes": semi_axes, "exponents": [1, 1]}}]}


class Answers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.implant_file, cls.cavity_file = cls.folder / "implant.json", cls.folder / "cavity.off"
        verisq.Model.from_dict(ellipsoid([3, 4, 8])).save(cls.implant_file)
        around = verisq.Model.from_dict(ellipsoid([3.5, 4.5, 8.5])).posed([1, -0.5, 2, 1, 0, 0, 0])
        verisq.mesh_of_model(around, 0.2).save(cls.cavity_file)

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
        for needless in ("mesh", "within", "map", "surface_map"):
            with self.assertRaisesRegex(verisq.Error, f"needs no `{needless}`"):
                answer.check(models=[STEM, STEM], **{needless: CAVITY})

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
        implant, cavity = verisq.Model.load(self.implant_file), verisq.Mesh.load(self.cavity_file)
        path = verisq.straight_path([0, 0.1, -1], 20.0)
        found = verisq.certified_mesh_clearance(implant, cavity, path, tolerance=1.0, device="host")
        answer = self.same_after_saving(found.answer(self.implant_file, self.cavity_file, path))
        self.assertTrue(answer.is_proved(models=self.implant_file, mesh=self.cavity_file))
        claims = answer.check(models=[self.implant_file], mesh=self.cavity_file)
        self.assertEqual(len(claims), len(cavity.vertices) + 1)
        self.assertEqual(claims[-1].of, "whole surface")
        self.assertEqual(list(claims[-1].claimed), list(found.smallest_distance))
        self.assertEqual(self.program_checks(answer, "--model", self.implant_file, "--mesh", self.cavity_file), 0)
        volume = verisq.certified_removed_volume(implant, path, bone=cavity, relative_tolerance=0.5)
        removed = self.same_after_saving(volume.answer(self.implant_file, path, bone=self.cavity_file))
        (claim,) = removed.check(models=self.implant_file, mesh=self.cavity_file)
        self.assertEqual((claim.what, claim.verdict), ("removed volume", "proved"))
        self.assertEqual(self.program_checks(removed, "--model", self.implant_file, "--mesh", self.cavity_file), 0)

    def test_a_containment(self):
        file, around = self.folder / "ball.json", self.folder / "around.off"
        ball = verisq.Model.from_dict(ellipsoid([1, 1, 1]))
        ball.save(file)
        verisq.mesh_of_model(verisq.Model.from_dict(ellipsoid([2, 2, 2])), 0.2).save(around)
        proof = verisq.prove_containment(ball, verisq.Mesh.load(around), "within", device="host")
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
        with self.assertRaisesRegex(verisq.Error, "about no model"):
            answer.check(models=STEM)
        with self.assertRaisesRegex(verisq.Error, "about no mesh"):
            answer.check(mesh=CAVITY)

    def test_where_a_body_stands(self):
        file = EXAMPLES / "standing.xml"
        model = verisq.StanceModel.load(file).within(1.0, ["mp", "px"])
        answer = self.same_after_saving(model.certified_equilibrium(uncertain=["mp", "px"]).answer(file))
        claims = answer.check(models=file)
        self.assertIn("centre of pressure, x", [claim.what for claim in claims])
        self.assertEqual({claim.verdict for claim in claims}, {"proved"})
        self.assertEqual(self.program_checks(answer, "--model", file), 0)
        with self.assertRaisesRegex(verisq.Error, "another model"):
            answer.check(models=EXAMPLES / "stance.xml")

    def test_a_fit_its_bound_and_its_contact(self):
        fitted, map_file, surface = (self.folder / name for name in ("fitted.json", "map.csv", "surface.csv"))
        files = {name: self.folder / f"{name}.json" for name in ("fit", "bound", "contact")}
        outcome = run("fit", "--implant", self.implant_file, "--mesh", self.cavity_file, "--cavity", "--device", "host",
                      "--samples", "16", "--gap", "0.5", "--completion", "cemented", "--rotation-range", "1",
                      "--translation-range", "0.5", "--pose-start", "1,-0.5,2,1,0,0,0", "--bound", "50",
                      "--keep", "contact=0,100", "--map", map_file, "--surface-map", surface,
                      "--certificate-file", files["fit"], "--bound-certificate-file", files["bound"],
                      "--contact-certificate-file", files["contact"], "-o", fitted)
        self.assertIn(outcome.returncode, (0, 3), outcome.stderr)
        about = {"models": fitted, "mesh": self.cavity_file}
        fit = self.same_after_saving(verisq.Answer.load(files["fit"]))
        claims = fit.check(**about, map=map_file, surface_map=surface)
        self.assertLessEqual({"objective", "surface_distance"}, {claim.what for claim in claims})
        self.assertEqual({claim.verdict for claim in claims}, {"proved"})
        with self.assertRaisesRegex(verisq.Error, "give the `map`"):
            fit.check(**about)
        without = {claim.what: claim.verdict for claim in fit.check(**about, map=map_file)}
        self.assertEqual(without["surface_distance"], "unproved")
        with self.assertRaisesRegex(verisq.Error, "is no map of"):
            fit.check(**about, map=surface)
        bound = self.same_after_saving(verisq.Answer.load(files["bound"]))
        (claim,) = bound.check(models=self.implant_file, mesh=self.cavity_file)
        self.assertEqual(claim.verdict, "proved")
        contact = self.same_after_saving(verisq.Answer.load(files["contact"]))
        self.assertEqual(contact.kind, "contact")
        self.assertTrue(contact.is_proved(**about))

    def test_many_poses(self):
        poses, file, found = self.folder / "poses.csv", self.folder / "poses.json", self.folder / "distances.csv"
        poses.write_text("60,0,0,1,0,0,0\n0,70,0,1,0,0,0\n")
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
