"""Fits, ways in, octrees, clearances, stance: the numbers of the command line, and its refusals."""

import json
import pickle
import tempfile
import unittest
from pathlib import Path

import numpy as np
import verisq

from command_line import EXAMPLES, message, run

BALL = {"semi_axes": [2, 2, 2], "exponents": [1, 1]}


def model_of(*superquadrics, **others):
    parts = [{"name": f"p{k}", "superquadric": each} for k, each in enumerate(superquadrics)]
    return {"format": "verisq-model/1", "units": "mm", "primitives": parts, **others}


def printed(*arguments):
    """The JSON object that `verisq` prints."""
    outcome = run(*arguments, "--json")
    assert outcome.returncode in (0, 3), outcome.stderr
    return json.loads(outcome.stdout)


def ends(value):
    return [value["lo"], value["hi"]]


class Files(unittest.TestCase):
    """A folder with an implant of three sizes of freedom, and a cavity around it, moved."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.implant_file = cls.file("implant.json")
        cls.implant_file.write_text(json.dumps(model_of(
            {"semi_axes": [3, 4, 8], "exponents": [1, 1]},
            areas=[{"name": "upper", "weight": 3, "box": [[-9, -9, 0], [9, 9, 12]]}],
            landmarks={"head_centre": [0, 0, 8]})))
        around = verisq.Model.from_dict(model_of({"semi_axes": [3.5, 4.5, 8.5], "exponents": [1, 1]}))
        cls.cavity = verisq.mesh_of_model(around.posed([1, -0.5, 2, 1, 0, 0, 0]), 0.2)
        cls.cavity_file = cls.file("cavity.off")
        cls.cavity.save(cls.cavity_file)
        cls.implant = verisq.Model.load(cls.implant_file)

    @classmethod
    def file(cls, name):
        return Path(cls.folder.name, name)


class Fits(Files):
    # From where it belongs: a search from far away takes a processor minutes.
    OPTIONS = ["--device", "host", "--samples", 16, "--gap", 0.5, "--completion", "cemented", "--rotation-range", 1,
               "--translation-range", 0.5, "--pose-start", "1,-0.5,2,1,0,0,0"]
    ARGUMENTS = {"device": "host", "samples": 16, "gap": 0.5, "completion": "cemented", "rotation_range": 1.0,
                 "translation_range": 0.5, "pose_start": [1, -0.5, 2, 1, 0, 0, 0]}

    def test_are_those_of_the_command(self):
        said = printed("fit", "--implant", self.implant_file, "--mesh", self.cavity_file, "--cavity", "--resection",
                       "0,0,10.3,0,0,3", "--weight", "upper=2", *self.OPTIONS, "-o", self.file("fitted.json"))
        found = verisq.fit(self.implant, self.cavity, surface="cavity", resection=[0, 0, 10.3, 0, 0, 3],
                           weights={"upper": 2.0}, **self.ARGUMENTS)
        self.assertEqual(found.pose.tolist(), said["pose"]["translation"] + said["pose"]["quaternion"])
        self.assertEqual(found.model.to_dict(), verisq.Model.load(self.file("fitted.json")).to_dict())
        self.assertEqual(found.model.landmarks["head_centre"], found.model.to_dict()["landmarks"]["head_centre"])
        for name in ("objective", "smallest_distance", "deepest_penetration"):
            self.assertEqual(list(getattr(found, name)), ends(said[name]), name)
        self.assertEqual(list(found.surface.smallest_distance), ends(said["surface"]["smallest_distance"]))
        self.assertEqual(found.sides, {each["primitive"]: each["found"] for each in said["sides"]["primitives"]})
        self.assertEqual([(area.name, area.weight, area.points, list(area.mean_distance)) for area in found.areas],
                         [(area["name"], area["weight"], area["points"], ends(area["mean_distance"]))
                          for area in said["areas"]])
        self.assertEqual(len(found.map), said["points"])
        self.assertEqual((found.proven_within_limit, found.as_asked), (said["points"], True))
        self.assertGreater(len(found.map), len(self.cavity.vertices))  # new ones, where it is cut
        self.assertIsNone(found.bound)

    def test_a_rasp_is_cleared_where_the_implant_lies(self):
        rasp = self.file("rasp.json")
        rasp.write_text(json.dumps(model_of({"semi_axes": [3.6, 4.2, 8.2], "exponents": [1, 1]})))
        said = printed("fit", "--implant", self.implant_file, "--instrument", rasp, "--mesh", self.cavity_file,
                       "--cavity", *self.OPTIONS, "-o", self.file("fitted.json"))
        found = verisq.fit(self.implant, self.cavity, surface="cavity", **self.ARGUMENTS)
        # Coarse, because the host takes long to decide what lies hardly inside.
        cut = verisq.mesh_clearance(verisq.Model.load(rasp).posed(found.pose), self.cavity, device="host", tolerance=0.1)
        lo, hi = ends(said["instrument"]["surface"]["smallest_distance"])
        self.assertLess(cut.smallest_distance.hi, 0)
        # Of tolerances of their own, but of one truth.
        self.assertLessEqual(max(lo, cut.smallest_distance.lo), min(hi, cut.smallest_distance.hi))

    def test_certificates_prove_the_fit(self):
        labels = np.where(self.cavity.vertices[:, 0] > 0, 7, -1)
        found = verisq.fit(self.implant, self.cavity, surface="any", on="vertices", labels=labels, certificates=True,
                           **self.ARGUMENTS)
        self.assertEqual(len(found.map.certificates), len(self.cavity.vertices))
        self.assertTrue(found.is_proved(self.cavity))
        self.assertTrue(pickle.loads(pickle.dumps(found)).is_proved(self.cavity))
        moved = verisq.Mesh(self.cavity.vertices + [0.5, 0, 0], self.cavity.triangles)
        self.assertFalse(found.is_proved(moved))
        with self.assertRaisesRegex(ValueError, "has 3 vertices"):
            found.is_proved(verisq.Mesh(np.eye(3), [[0, 1, 2]]))
        alone = verisq.fit(self.implant, self.cavity, surface="any", on="vertices", **self.ARGUMENTS)
        with self.assertRaisesRegex(ValueError, "certificates=True"):
            alone.is_proved(self.cavity)

    def test_certificates_prove_the_bound(self):
        found = verisq.fit(self.implant, self.cavity, surface="any", on="vertices", bound=30.0, certificates=True,
                           **self.ARGUMENTS)
        bound = found.certified_bound
        self.assertGreaterEqual(bound.upper, found.objective.lo)
        self.assertGreaterEqual(bound.boxes, 1)
        self.assertTrue(bound.is_proved(self.implant, self.cavity))
        self.assertTrue(pickle.loads(pickle.dumps(bound)).is_proved([self.implant], self.cavity))
        twice = verisq.Mesh(self.cavity.vertices * 0.5, self.cavity.triangles)
        self.assertEqual(bound.is_proved(self.implant, twice), bound.upper >= len(self.cavity.vertices))
        with self.assertRaisesRegex(verisq.Error, "centres: 1 of 2 implants"):
            bound.is_proved([self.implant, self.implant], self.cavity)
        self.assertIsNone(verisq.fit(self.implant, self.cavity, surface="any", on="vertices", certificates=True,
                                     **self.ARGUMENTS).certified_bound)

    def test_certificates_prove_contact(self):
        labels = np.where(self.cavity.vertices[:, 0] > 0, 7, -1)
        found = verisq.fit(self.implant, self.cavity, surface="any", on="vertices", labels=labels, certificates=True,
                           **self.ARGUMENTS)
        contact = found.certified_contact
        self.assertEqual(contact.distance, 0.75)  # the gap and half of it
        self.assertEqual(list(contact.claims), ["contact", "contact:-1", "contact:7"])
        for name, within in found.contact.items():
            self.assertLessEqual(contact.claims[name]["percent"].lo, 100 * within.share.lo)
            self.assertGreaterEqual(contact.claims[name]["percent"].hi, 100 * within.share.hi)
            self.assertGreater(contact.claims[name]["area"].lo, 0)
        self.assertTrue(contact.is_proved(found.model, self.cavity))
        self.assertTrue(pickle.loads(pickle.dumps(contact)).is_proved(found.model, self.cavity))
        moved = verisq.Mesh(self.cavity.vertices + [0.5, 0, 0], self.cavity.triangles)
        self.assertFalse(contact.is_proved(found.model, moved))
        self.assertFalse(contact.is_proved(found.model, verisq.Mesh(np.eye(3), [[0, 1, 2]])))
        self.assertIsNone(verisq.fit(self.implant, self.cavity, surface="any", on="vertices",
                                     **self.ARGUMENTS).certified_contact)
        self.assertEqual(contact.counted, [])

    def test_certificates_prove_the_implants_contact(self):
        found = verisq.fit(self.implant, self.cavity, surface="any", on="vertices", implant_contact=True,
                           certificates=True, **self.ARGUMENTS)
        contact = found.certified_contact
        self.assertEqual(contact.counted, [True])
        claim, within = contact.claims["implant_contact"], found.contact["implant_contact"]
        self.assertLessEqual(claim["percent"].lo, 100 * within.share.lo)
        self.assertGreaterEqual(claim["percent"].hi, 100 * within.share.hi)
        self.assertGreater(claim["area"].lo, 0)
        self.assertTrue(contact.is_proved(found.model, self.cavity))
        self.assertTrue(pickle.loads(pickle.dumps(contact)).is_proved(found.model, self.cavity))
        self.assertFalse(contact.is_proved(verisq.Model.load(EXAMPLES / "stem.json"), self.cavity))

    def test_labels_bounds_and_features(self):
        labels = np.where(self.cavity.vertices[:, 0] > 0, 7, -1)
        landmarks = {"head_centre": [0, 0, 8], "shaft_proximal": [0, 0, 0], "shaft_distal": [0, 0, -100]}
        found = verisq.fit(self.implant, self.cavity, surface="any", on="vertices", labels=labels,
                           weights={"7": 2.0}, landmarks=landmarks, keep={"head_distance": (0.0, 9.0)},
                           bound=99.0, bound_time=0.3, **self.ARGUMENTS)
        self.assertEqual([(area.name, area.weight) for area in found.areas], [("-1", 1.0), ("7", 2.0)])
        self.assertIsNone(found.sides)
        self.assertIsNone(found.surface)
        self.assertGreaterEqual(found.bound.upper, found.objective.lo)
        distance = next(change for change in found.changes if change.name == "head_distance")
        self.assertLess(distance.value.hi, 9.0)

    def refuses(self, text, *arguments, **others):
        with self.assertRaises(verisq.Error) as caught:
            verisq.fit(*arguments, **others)
        self.assertEqual(str(caught.exception), text)
        return caught.exception

    def test_refuses_as_the_command(self):
        expected = message("fit", "--implant", self.implant_file, "--mesh", self.cavity_file, "-o",
                           self.file("none.json"))
        self.refuses(expected.replace(str(self.cavity_file), "mesh"), self.implant, self.cavity)
        inch = verisq.Model.from_dict({**self.implant.to_dict(), "units": "inch"})
        self.refuses('implants[1]: units "inch" differ from "mm" of implants[0]', [self.implant, inch], self.cavity)
        self.refuses('`gap`: give one, because the implants\' units are "inch", not mm', inch, self.cavity)
        self.refuses("`crossing` neck: no primitive is named neck".replace(" neck:", ":"), self.implant, self.cavity,
                     surface="cavity", crossing=["neck"])
        self.refuses("`keep`: needs `landmarks`, the bone's", self.implant, self.cavity, keep={"ccd_change": (0, 1)})
        self.refuses("labels: no vertex has the value '9', which has a weight", self.implant, self.cavity,
                     surface="cavity", labels=np.zeros(len(self.cavity.vertices), int), weights={"9": 1.0})
        for others in ({"surface": "bones"}, {"completion": "glue"}, {"bound": 100.0}, {"gap": -1.0}, {"samples": 0},
                       {"keep": {"ccd_change": (2, 1)}}, {"labels": [1, 2]}, {"rotation_range": 181.0}):
            with self.assertRaises(ValueError):
                verisq.fit(self.implant, self.cavity, **others)


class WaysIn(Files):
    def test_are_those_of_the_command(self):
        bone = verisq.Mesh(self.cavity.vertices * 0.9, self.cavity.triangles)
        file = self.file("bone.off")
        bone.save(file)
        said = printed("insert", "--implant", self.implant_file, "--mesh", file, "--bone", "--on", "triangles",
                       "--along", "0,0,-1", "--length", 1, "--device", "host", "--tol", 0.5, "--volume-tol", 0.5,
                       "-o", self.file("way.npy"))
        rows = np.load(self.file("way.npy"))
        path = verisq.straight_path([0, 0, -1], 1.0)
        self.assertEqual(path.shape, (2, 7))
        found = verisq.map_along(self.implant, bone.vertices, path, tolerance=0.5, device="host")
        np.testing.assert_array_equal(found.lo, rows["lo"])
        np.testing.assert_array_equal(found.hi, rows["hi"])
        surface = verisq.mesh_clearance(self.implant, bone, path=path, tolerance=0.5, device="host")
        self.assertEqual(list(surface.smallest_distance), ends(said["whole_surface"]["smallest_distance"]))
        self.assertEqual(surface.proven_too_deep, said["whole_surface"]["proven_cut"])
        self.assertEqual(len(surface.points_too_deep), surface.proven_too_deep)
        removed = verisq.removed_volume(self.implant, path, bone=bone, relative_tolerance=0.5)
        self.assertEqual(list(removed.volume), ends(said["removed_volume"]))
        self.assertTrue(removed.within_tolerance)
        certified = verisq.certified_removed_volume(self.implant, path, bone=bone, relative_tolerance=0.5)
        self.assertLess(certified.volume[0], removed.volume[1])
        self.assertGreater(certified.volume[1], removed.volume[0])
        self.assertTrue(certified.is_proved(self.implant, path, bone=bone))
        farther = path + [[0, 0, -1.0, 0, 0, 0, 0]]
        self.assertFalse(certified.is_proved(self.implant, farther, bone=bone))

    def test_are_proved_again(self):
        points = self.cavity.vertices[::16] * 0.95
        path = verisq.straight_path([0, 0.1, -1], 20.0)
        found = verisq.map_along(self.implant, points, path, tolerance=0.2, device="host")
        way = verisq.certified_map_along(self.implant, points, path, tolerance=0.2, device="host")
        self.assertEqual(len(way), len(points))
        self.assertEqual(way.map.wide, 0)
        self.assertTrue(np.all(way.map.lo <= found.hi) and np.all(found.lo <= way.map.hi))
        self.assertTrue(way.is_proved(self.implant, points, path))
        self.assertFalse(way.is_proved(self.implant, points + 1.0, path))
        self.assertFalse(way.is_proved(self.implant, points, path + [[0, 0, 0.5, 0, 0, 0, 0]]))
        self.assertFalse(way.is_proved(self.implant.posed([0, 0, 1, 1, 0, 0, 0]), points, path))
        with self.assertRaises(ValueError):
            way.is_proved(self.implant, points[1:], path)

    def test_the_whole_surface_is_proved_again(self):
        path = verisq.straight_path([0, 0.1, -1], 20.0)
        way = verisq.certified_mesh_clearance(self.implant, self.cavity, path, tolerance=1.0, device="host")
        self.assertLessEqual(way.smallest_distance.lo, way.vertices.map.hi.min())
        self.assertLess(way.smallest_distance.hi - way.smallest_distance.lo, 1.5)
        self.assertTrue(way.is_proved(self.implant, self.cavity, path))
        moved = verisq.Mesh(self.cavity.vertices + 1.0, self.cavity.triangles)
        self.assertFalse(way.is_proved(self.implant, moved, path))
        with self.assertRaises(ValueError):
            way.is_proved(self.implant, verisq.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), path)

    def test_what_is_refused(self):
        path = verisq.straight_path([0, 0, -1], 1.0)
        with self.assertRaisesRegex(verisq.Error, "^`cavity`: nothing says where the bone around it ends"):
            verisq.removed_volume(self.implant, path, cavity=self.cavity)
        inward = verisq.Mesh(self.cavity.vertices, self.cavity.triangles[:, ::-1])
        with self.assertRaisesRegex(verisq.Error, "^`bone`: bone: its normals point inward, as a cavity's$"):
            verisq.removed_volume(self.implant, path, bone=inward)
        with self.assertRaises(ValueError):
            verisq.removed_volume(self.implant, path)
        with self.assertRaises(verisq.Error):
            verisq.map_along(self.implant, [[0, 0, 0]], np.empty((0, 7)))
        for direction, length in (([0, 0, 0], 1.0), ([0, 0, 1], 0.0), ([0, np.inf, 1], 1.0)):
            with self.assertRaises(ValueError):
                verisq.straight_path(direction, length)


class Solids(Files):
    def test_octrees(self):
        ball = verisq.Model.from_dict(model_of(BALL))
        file = self.file("ball.json")
        ball.save(file)
        said = printed("octree", "--model", file, "--depth", 5, "--device", "host", "-o", self.file("ball.vtu"))
        found = verisq.octree(ball, depth=5, device="host")
        self.assertEqual(list(found.volume), ends(said["volume"]))
        self.assertIn(4.0 / 3.0 * np.pi * 8.0, found.volume)
        limited = verisq.octree(ball, depth=5, device="host", time_limit=1e-9)
        self.assertTrue(limited.out_of_time and not limited.complete)
        self.assertIn(4.0 / 3.0 * np.pi * 8.0, limited.volume)
        volumes = found.edge**3
        inside = found.colour == verisq.CubeColour.INSIDE
        self.assertEqual(volumes[inside].sum(), found.volume.lo)  # exact sums
        self.assertEqual(volumes.sum(), (2.0 * found.root_half_width) ** 3)
        self.assertEqual(found.levels[:, ::-1].tolist(),
                         [[level["inside"], level["undecided"], level["outside"]] for level in said["levels"]])
        centres = found.lower[inside] + found.edge[inside, None] / 2.0
        self.assertLess(np.linalg.norm(centres, axis=1).max(), 2.0)
        found.save(self.file("again.vtu"))
        self.assertEqual(self.file("again.vtu").read_bytes(), self.file("ball.vtu").read_bytes())
        self.assertTrue(found.is_proved(ball))
        larger = dict(BALL, semi_axes=[2.1, 2, 2])
        self.assertFalse(found.is_proved(verisq.Model.from_dict(model_of(larger))))
        self.assertTrue(verisq.octree(ball, tolerance=20.0, device="host").complete)
        self.assertFalse(verisq.octree(ball, depth=5, budget=8, device="host").complete)
        with self.assertRaises(ValueError):
            verisq.octree(ball, depth=5, tolerance=1.0)
        with self.assertRaises(verisq.Error):
            verisq.octree(ball, depth=21)

    def test_clearance_and_containment(self):
        still = verisq.mesh_clearance(self.implant, self.cavity, tolerance=0.01, device="host")
        self.assertLessEqual(still.smallest_distance.width, 0.01)
        self.assertLess(still.smallest_distance.hi, verisq.map(self.implant, self.cavity.vertices).hi.min() + 1e-9)
        inside = verisq.Model.from_dict(model_of(BALL))
        within = verisq.prove_containment(inside, self.cavity, "within", device="host")
        self.assertTrue(within.proven)
        self.assertTrue(within.is_proved(inside, self.cavity))
        self.assertFalse(within.is_proved(self.implant, self.cavity))
        proof = verisq.prove_containment(inside, self.cavity, "around", device="host")
        self.assertFalse(proof.proven)
        self.assertFalse(proof.is_proved(inside, self.cavity))
        self.assertGreater(proof.triangles_refuted, 0)
        with self.assertRaises(ValueError):
            verisq.prove_containment(inside, self.cavity, "beside")

    def test_models_keep_landmarks_and_areas(self):
        again = pickle.loads(pickle.dumps(self.implant))
        self.assertEqual(again.to_dict(), self.implant.to_dict())
        self.assertEqual(again.areas, [{"name": "upper", "weight": 3.0, "box": [[-9, -9, 0], [9, 9, 12]]}])
        moved = self.implant.posed([1, 0, 0, 1, 0, 0, 0])
        self.assertEqual(moved.landmarks, {"head_centre": [1, 0, 8]})
        self.assertEqual(moved.areas, self.implant.areas)  # the bone's


class Standing(unittest.TestCase):
    def test_a_person_stands_as_the_command_says(self):
        model = verisq.StanceModel.load(EXAMPLES / "standing.xml").within(1.0, ["mp", "px"])
        found = model.equilibrium(uncertain=["mp", "px"])
        self.assertEqual((found.stands, found.not_on_all, found.open), (1.0, 0.0, 0.0))
        height = model.joints.index("pelvis ty")
        self.assertLess(found.positions[height, 0], 0.97697155)
        self.assertGreater(found.positions[height, 1], 0.97697155)
        self.assertLess(found.forces["left forefoot"].lo, 102.591)
        self.assertGreater(found.forces["left forefoot"].hi, 102.591)
        self.assertGreater(found.least_penetration.lo, 0.0)
        self.assertEqual(found.cells[0]["verdict"], "stands")

    def test_what_is_found_can_be_proved_again(self):
        model = verisq.StanceModel.load(EXAMPLES / "standing.xml").within(1.0, ["mp", "px"])
        proven = model.certified_equilibrium(uncertain=["mp", "px"])
        self.assertEqual(proven.stands, 1.0)
        self.assertTrue(proven.is_proved(model))
        self.assertFalse(proven.is_proved(model.narrowed("py", 0.49, 0.5)))
        self.assertFalse(proven.is_proved(model.narrowed("mp", 49.9, 50.1)))  # not within this model's range
        found = model.equilibrium(uncertain=["mp", "px"])
        self.assertAlmostEqual(proven.forces["left forefoot"].lo, found.forces["left forefoot"].lo, places=2)
        self.assertEqual(len(proven.torques), len(model.joints))

    def test_small_disturbances_die_out(self):
        model = verisq.StanceModel.load(EXAMPLES / "standing.xml")
        found = model.stability(uncertain=[])
        self.assertEqual((found.stable, found.unstable, found.open), (1.0, 0.0, 0.0))
        self.assertLess(found.growth.hi, 0.0)
        self.assertEqual(sum(each["count"] for each in found.eigenvalues), 72)
        self.assertEqual(pickle.loads(pickle.dumps(found)).growth, found.growth)
        self.assertEqual(model.stability("proportional", uncertain=[]).cells[0]["verdict"], "stable")

    def test_moves_as_the_command_says(self):
        model = verisq.StanceModel.load(EXAMPLES / "standing.xml")
        with tempfile.TemporaryDirectory() as folder:
            table = Path(folder, "motion.csv")
            said = printed("stance", EXAMPLES / "standing.xml", "--uncertain", "none", "--simulate", 0.03, "--push",
                           "50,0.01,0.02", "--csv", table)["motion"]
            header = table.read_text().splitlines()[0].split(",")
            rows = np.array([[float(number) for number in line.split(",")]
                             for line in table.read_text().splitlines()[1:]])
        motion = model.simulate(0.03, uncertain=[], push=(50.0, 0.01, 0.02))
        parts = (motion.times, motion.positions, motion.velocities, motion.normal_forces, motion.friction)
        self.assertEqual([part.shape[1:] for part in parts], [(2,), (7, 2), (7, 2), (2, 2), (2, 2)])
        found = np.concatenate([part.reshape(len(rows), -1) for part in parts], axis=1)
        self.assertEqual(found.tolist(), rows.tolist())  # bit for bit
        self.assertEqual(header[2::2][3], motion.joints[3].replace(" ", "_") + "_position_lo")
        self.assertEqual(motion.final_positions.tolist(), [ends(said["positions"][joint]) for joint in motion.joints])
        self.assertEqual(motion.final_velocities.tolist(), [ends(said["velocities"][joint]) for joint in motion.joints])
        self.assertEqual((motion.reached, motion.proven, motion.open), (0.03, True, ""))
        self.assertIs(type(said["steps"]), int)
        self.assertEqual(said["steps"], len(motion.times))

    def test_a_motion_is_refused_as_by_the_command(self):
        model = verisq.StanceModel.load(EXAMPLES / "standing.xml")
        with self.assertRaises(verisq.Error) as caught:
            model.simulate(0.1, uncertain=["pz"])
        self.assertEqual(str(caught.exception), message("stance", EXAMPLES / "standing.xml", "--uncertain", "pz",
                                                        "--simulate", 0.1))
        for arguments in ({"duration": 0.0}, {"duration": 1.0, "lift": -1.0}, {"duration": 1.0, "push": (1.0, 0.0, 0.0)},
                          {"duration": float("inf")}):
            with self.assertRaises(ValueError):
                model.simulate(**arguments)

    def test_what_cannot_stand_is_refused(self):
        model = verisq.StanceModel.load(EXAMPLES / "stance.xml")
        with self.assertRaisesRegex(verisq.Error, "friction alone could hold"):
            model.equilibrium(uncertain=[])
        with self.assertRaisesRegex(verisq.Error, "is not within the file's range"):
            model.narrowed("mp", 10.0, 20.0)


class Stance(unittest.TestCase):
    def test_is_that_of_the_command(self):
        said = printed("stance", EXAMPLES / "stance.xml", "--uncertain", "mp,px", "--sensitivities", "--accelerations",
                       "--cells", 4, "--bounce", "right forefoot")
        stance = verisq.StanceModel.load(EXAMPLES / "stance.xml")
        names = ["mp", "px"]
        wrench = stance.wrench(names)
        self.assertEqual(wrench.tolist(), [ends(said["wrench"][f"w{k}"]) for k in range(1, 7)])
        of_mass = stance.sensitivities(names)["mp"]
        self.assertEqual(of_mass.tolist(), [ends(said["sensitivities"]["mp"][f"w{k}"]) for k in range(1, 7)])
        by_value, by_radius = stance.reference_uncertainty(names)
        self.assertEqual((by_value.shape, by_radius.shape), ((6, 2), (6,)))
        accelerations = stance.accelerations(names, cells=4)
        self.assertEqual(dict(zip(stance.joints, accelerations.tolist())),
                         {joint: ends(value) for joint, value in said["accelerations"].items()})
        for at in ("contact", "fall"):
            said_at = printed("stance", EXAMPLES / "stance.xml", "--uncertain", "mp,px", "--accelerations", at,
                              "--cells", 4, "--joint", "pelvis ty=0.99", "--joint", "right hindfoot rz=-0.01")
            there = stance.accelerations(names, cells=4, at=at,
                                         joints={"pelvis ty": 0.99, "right hindfoot rz": -0.01})
            self.assertEqual(dict(zip(stance.joints, there.tolist())),
                             {joint: ends(value) for joint, value in said_at["accelerations"].items()})
            self.assertFalse(np.array_equal(there, accelerations))
        self.assertEqual(list(stance.bounce("right forefoot", uncertain=names).rebound_speed),
                         ends(said["bounce"]["rebound_speed"]))
        self.assertTrue(np.all(stance.wrench()[:, 0] <= wrench[:, 0]))  # over all parameters
        self.assertIn(stance.parameters[0]["nominal"], stance.parameters[0]["range"])

    def test_refuses_as_the_command(self):
        stance = verisq.StanceModel.load(EXAMPLES / "stance.xml")
        for names, text in ((["mq"], "mq"), (["mp", "mp"], "mp,mp")):
            with self.assertRaises(verisq.Error) as caught:
                stance.wrench(names)
            self.assertEqual(str(caught.exception), message("stance", EXAMPLES / "stance.xml", "--uncertain", text))
        with self.assertRaisesRegex(verisq.Error, "^`bounce`: 'toe' is not one of the cylinders "):
            stance.bounce("toe")
        with self.assertRaises(ValueError):
            stance.accelerations(cells=0)
        with self.assertRaisesRegex(ValueError, "at must be \"fall\", \"contact\" or \"standing\", not \"flying\""):
            stance.accelerations(at="flying")
        with self.assertRaisesRegex(verisq.Error, "^`joint`: 'tail' is not one of pelvis tx, "):
            stance.accelerations(joints={"tail": 0.0})
        with self.assertRaisesRegex(verisq.Error, "friction alone could hold"):
            stance.accelerations([], at="standing")


if __name__ == "__main__":
    unittest.main()
