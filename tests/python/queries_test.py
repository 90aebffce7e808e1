"""Everything but maps of points: single queries, meshes, triangles, poses, certificates, whole surfaces, femurs."""

import json
import pickle
import tempfile
import unittest
from pathlib import Path

import numpy as np
import verisq

from command_line import EXAMPLES, message, run


def model(name):
    return verisq.Model.load(EXAMPLES / name)


TRIANGLE = [[[9, 0, 0], [0, 9, 0], [0, 0, 9]]]
APART = [0, 0, 90, 1, 0, 0, 0]


def rotations(count, seed):
    """Poses: translations of some 20, quaternions of any length."""
    return np.random.default_rng(seed).normal(0.0, 1.0, (count, 7)) * [20, 20, 20, 2, 2, 2, 2]


def tightest(model, points):
    """The middles of enclosures of some 1e-14 of the size."""
    lo, hi, _ = verisq.map(model, points, tolerance=0.0, device="host")
    return (lo + hi) / 2


class ClosestPoints(unittest.TestCase):
    def test_a_box_a_normal_and_the_primitive(self):
        soap = model("soap.json")
        found = verisq.closest_points(soap, [[10.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
        self.assertEqual(found.point.shape, (2, 3, 2))
        np.testing.assert_array_equal(found.unique, [True, False])
        self.assertTrue(found.lo[0] <= 6.6 <= found.hi[0] and found.hi[1] < 0.0)
        lo, hi = found.point[0].T
        self.assertTrue(np.all(lo <= [3.4, 0, 0]) and np.all([3.4, 0, 0] <= hi) and np.max(hi - lo) < 1e-14)
        np.testing.assert_allclose(found.normal[0], [[1, 1], [0, 0], [0, 0]], atol=1e-15)
        np.testing.assert_array_equal(found.normal[1], [[-1, 1]] * 3)
        np.testing.assert_array_equal(found.primitive, [0, 0])
        self.assertEqual((len(found), repr(found)), (2, "<verisq.ClosestPointMap: 2 rows, 1 unique>"))

    def test_gradients_are_differences(self):
        stem = model("stem_mm.json")
        points = np.random.default_rng(3).uniform(-80.0, 80.0, (40, 3))
        centre = np.array([5.0, -3.0, 20.0])
        found = verisq.closest_points(stem, points)
        self.assertGreater(np.sum(found.unique), 30)
        gradient = found.gradient_by_motion(centre)[found.unique]
        self.assertEqual(gradient.shape[1:], (6, 2))
        self.assertLess(np.max(gradient[:, :, 1] - gradient[:, :, 0]), 1e-9)
        step = 1e-4
        for k in range(6):
            arm = points - centre
            along = np.eye(3)[k] + 0 * points if k < 3 else np.cross(np.eye(3)[k - 3], arm) / 100.0
            ends = [tightest(stem, points + sign * step * along) for sign in (1, -1)]
            difference = (ends[0] - ends[1]) / (2 * step) * (1.0 if k < 3 else 100.0)
            np.testing.assert_allclose(gradient[:, k, 0], difference[found.unique], rtol=1e-6, atol=1e-5)

    def test_of_a_model_that_is_kept_ready(self):
        points = np.random.default_rng(5).uniform(-9.0, 9.0, (20, 3))
        for name in ("soap.json", "bent_stem.json"):
            mapper = verisq.Mapper(model(name), device="host", tolerance=0.1)
            for part in (points[:7], points[7:]):
                found, once = mapper.closest_points(part), verisq.closest_points(model(name), part, tolerance=0.1)
                np.testing.assert_array_equal(found.point, once.point)
                np.testing.assert_array_equal(found.unique, once.unique)
        with self.assertRaisesRegex(verisq.Error, "^closest_points: not for models with intervals$"):
            verisq.Mapper(model("uncertain_stem.json"), device="host").closest_points(points)

    def test_of_two_models_in_many_poses(self):
        a, b = model("capsule.json"), model("soap.json")
        poses = np.array([[200.0, 0, 0, 1, 0, 0, 0], [0, 0, 0, 1, 0, 0, 0], [50, 60, -70, 1, 2, 3, 4]])
        found = verisq.closest_pairs(a, b, poses)
        np.testing.assert_array_equal(found.unique, [True, False, True])
        self.assertTrue(np.all(np.isinf(found.on_a[1])))
        for i in (0, 2):
            pair = verisq.distance(a, b, poses[i])
            for side in ("on_a", "on_b"):
                np.testing.assert_array_equal(getattr(found, side)[i], [list(c) for c in getattr(pair.closest, side)])
        self.assertEqual((len(found), repr(found)), (3, "<verisq.ClosestPairMap: 3 rows, 2 unique>"))
        with self.assertRaisesRegex(verisq.Error, "closest_pairs: not for models with intervals"):
            verisq.closest_pairs(a, model("uncertain_stem.json"), poses)

    def test_of_a_model_that_moves(self):
        a, b = model("capsule.json"), model("soap.json")
        far = verisq.distance_along(a, b, [[200.0, 0, 0, 1, 0, 0, 0], [0, 200.0, 0, 1, 0, 0, 1]])
        self.assertEqual((far.proximity, far.reached, far.meet_at, far.apart_before), ("apart", True, None, 1.0))
        for pose in ([200.0, 0, 0, 1, 0, 0, 0], [0, 200.0, 0, 1, 0, 0, 1]):
            self.assertLessEqual(far.smallest.lo, verisq.distance(a, b, pose).distance.hi)
        through = verisq.distance_along(a, b, [[200.0, 0, 0, 1, 0, 0, 0], [-200.0, 0, 0, 1, 0, 0, 0]])
        self.assertEqual((through.proximity, tuple(through.smallest)), ("meeting", (0.0, 0.0)))
        self.assertLessEqual(through.meet_at - through.apart_before, 1e-6)
        self.assertFalse(far.out_of_time)
        limited = verisq.distance_along(a, b, [[200.0, 0, 0, 1, 0, 0, 0], [0, 200.0, 0, 1, 0, 0, 1]], time_limit=1e-9)
        self.assertTrue(limited.out_of_time)
        self.assertLessEqual(limited.smallest.lo, far.smallest.lo)
        self.assertGreaterEqual(limited.smallest.hi, far.smallest.hi)
        with self.assertRaisesRegex(verisq.Error, "^distance_along: not for models with intervals$"):
            verisq.distance_along(a, model("uncertain_stem.json"), [[0, 0, 0, 1, 0, 0, 0]])
        stem = model("bent_stem.json")
        searched = verisq.distance_along(stem, stem, [[2.0, 0, 0, 1, 0, 0, 0], [0, 2.0, 0, 1, 0, 0, 1]])
        self.assertEqual((searched.proximity, searched.reached), ("apart", True))
        self.assertLessEqual(searched.smallest.width, 1e-4 * stem.bounding_radius)

    def test_proofs_of_a_model_that_moves(self):
        a, b = model("capsule.json"), model("soap.json")
        path = [[200.0, 0, 0, 1, 0, 0, 0], [0, 200.0, 0, 1, 0, 0, 1]]
        found = verisq.distance_along(a, b, path).smallest
        proven = verisq.certified_distance_along(a, b, path)
        self.assertLessEqual(proven.smallest.lo, found.hi)
        self.assertGreaterEqual(proven.smallest.hi, found.lo)
        self.assertIsNone(proven.first_contact)
        self.assertTrue(proven.is_proved(a, b, path))
        self.assertFalse(proven.is_proved(a, b, [[200.0, 0, 0, 1, 0, 0, 0], [0, 199.0, 0, 1, 0, 0, 1]]))
        self.assertFalse(proven.is_proved(a, model("gem.json"), path))
        through = [[200.0, 0, 0, 1, 0, 0, 0], [-200.0, 0, 0, 1, 0, 0, 0]]
        meeting = verisq.certified_distance_along(a, b, through)
        self.assertEqual(tuple(meeting.smallest), (0.0, 0.0))
        self.assertLessEqual(meeting.first_contact.width, 2e-6)
        self.assertTrue(meeting.is_proved(a, b, through))
        with self.assertRaisesRegex(verisq.Error, "^certified_distance_along: not for models with intervals$"):
            verisq.certified_distance_along(a, model("uncertain_stem.json"), path)

    def test_errors(self):
        with self.assertRaisesRegex(verisq.Error, r"^point 1: \(.*\) is not finite$"):
            verisq.closest_points(model("soap.json"), [[0, 0, 9], [0, 0, float("inf")]])
        with self.assertRaisesRegex(verisq.Error, "^closest_points: not for models with intervals$"):
            verisq.closest_points(model("uncertain_stem.json"), [[0, 0, 9]])


class Refusals(unittest.TestCase):
    """No number that is none, and no pose that is none, comes to an answer."""

    def test_of_tolerances(self):
        soap, mesh = model("soap.json"), EXAMPLES / "cavity.off"
        queries = {
            "map": lambda tolerance: verisq.map(soap, [[9, 0, 0]], tolerance=tolerance),
            "map_triangles": lambda tolerance: verisq.map_triangles(soap, TRIANGLE, tolerance=tolerance),
            "map_poses": lambda tolerance: verisq.map_poses(soap, soap, [APART], tolerance=tolerance),
            "SignedDistance": lambda tolerance: verisq.SignedDistance(soap)([9, 0, 0], tolerance=tolerance),
            "distance": lambda tolerance: verisq.distance(soap, soap, APART, tolerance=tolerance),
            "distance_along": lambda tolerance: verisq.distance_along(soap, soap, [APART], tolerance=tolerance),
            "octree": lambda tolerance: verisq.octree(soap, tolerance=tolerance),
            "deviation": lambda tolerance: verisq.deviation(soap, verisq.Mesh.load(mesh), tolerance=tolerance),
        }
        for name, query in queries.items():
            for tolerance in (float("nan"), -1.0):
                with self.subTest(name, tolerance=tolerance):
                    with self.assertRaisesRegex((ValueError, verisq.Error), f"tolerance.* {tolerance:g}"):
                        query(tolerance)

    def test_of_poses(self):
        soap, zero = model("soap.json"), [0, 0, 9, 0, 0, 0, 0]
        queries = {
            "distance": lambda: verisq.distance(soap, soap, zero),
            "certified_distance": lambda: verisq.certified_distance(soap, soap, zero),
            "map_poses": lambda: verisq.map_poses(soap, soap, [zero]),
            "distance_along": lambda: verisq.distance_along(soap, soap, [zero]),
            "map_along": lambda: verisq.map_along(soap, [[9, 0, 0]], [zero]),
        }
        for name, query in queries.items():
            with self.subTest(name), self.assertRaisesRegex(verisq.Error, "quaternion"):
                query()

    def test_of_points(self):
        soap, nowhere = model("soap.json"), [9, float("nan"), 0]
        queries = {
            "map": lambda: verisq.map(soap, [nowhere]),
            "map_triangles": lambda: verisq.map_triangles(soap, [[nowhere, *TRIANGLE[0][1:]]]),
            "SignedDistance": lambda: verisq.SignedDistance(soap)(nowhere),
            "closest_points": lambda: verisq.closest_points(soap, [nowhere]),
        }
        for name, query in queries.items():
            with self.subTest(name), self.assertRaisesRegex(verisq.Error, "is not finite"):
                query()


class SingleQueries(unittest.TestCase):
    def test_certified_distances(self):
        stem, pose = model("bent_stem.json"), [0.2, 0.05, 0, 1, 0.2, 0.1, 0.05]
        found = verisq.distance(stem, stem, pose).distance
        proven = verisq.certified_distance(stem, stem, pose)
        self.assertEqual(proven.distance, found)
        self.assertTrue(proven.is_proved(stem, stem, pose))
        self.assertFalse(proven.is_proved(stem, stem, [0.21, 0.05, 0, 1, 0.2, 0.1, 0.05]))
        self.assertFalse(proven.is_proved(stem, model("stem.json"), pose))
        soap, gem, apart = model("soap.json"), model("gem.json"), [12, 0, 0, 1, 0, 0, 0]
        self.assertTrue(verisq.certified_distance(soap, gem, apart).is_proved(soap, gem, apart))
        with self.assertRaisesRegex(verisq.Error, "certified_distance"):
            verisq.certified_distance(model("uncertain_stem.json"), stem)

    def test_signed_distance(self):
        distance = verisq.SignedDistance(model("soap.json"))
        lo, hi = distance([10.0, 0.0, 0.0], tolerance=1e-12)  # the soap ends at x = 3.4
        self.assertTrue(lo <= 6.6 <= hi and hi - lo < 1e-11)
        self.assertIn(6.6, distance(np.array([10, 0, 0])))
        self.assertLess(distance((0.0, 0.0, 0.0)).hi, 0.0)
        for bad, error in [([0, 0], ValueError), ([0, 0, float("inf")], verisq.Error), ("abc", ValueError)]:
            with self.assertRaises(error):
                distance(bad)
        with self.assertRaisesRegex(verisq.Error, "^SignedDistance: not for models with intervals$"):
            verisq.SignedDistance(model("uncertain_stem.json"))

    def test_enclosure(self):
        enclosure = verisq.Enclosure(1.0, 2.5)
        self.assertEqual((enclosure.width, list(enclosure), len(enclosure)), (1.5, [1.0, 2.5], 2))
        self.assertEqual(pickle.loads(pickle.dumps(enclosure)), enclosure)
        self.assertEqual(len({enclosure, verisq.Enclosure(1.0, 2.5)}), 1)
        self.assertNotIn(3.0, enclosure)
        self.assertEqual(repr(enclosure), "Enclosure(lo=1, hi=2.5)")
        for ends in [(2.0, 1.0), (float("nan"), 1.0), (1.0, float("nan"))]:
            with self.assertRaisesRegex(ValueError, "lo must be at most hi"):
                verisq.Enclosure(*ends)

    def test_pairs(self):
        pose = [200, 0, 0, 1, 0, 0, 0]
        a, b = EXAMPLES / "capsule.json", EXAMPLES / "soap.json"
        printed = json.loads(run("distance", a, b, "--pose", ",".join(map(str, pose)), "--json").stdout)
        pair = verisq.distance(verisq.Model.load(a), verisq.Model.load(b), pose)
        self.assertEqual(list(pair.distance), [printed["lo"], printed["hi"]])
        self.assertEqual((pair.proximity, pair.complete, pair.common), ("separated", True, None))
        self.assertTrue(pair.closest.unique)
        self.assertEqual([list(box) for box in pair.closest.on_b], printed["closest_points"]["on_b"])
        self.assertIsNone(pair.penetration_depth)
        self.assertEqual(verisq.distance(model("soap.json"), model("soap.json")).proximity, "overlapping")

    def test_pairs_that_overlap(self):
        capsule = model("capsule.json")
        pose = [1.4, 0, 0, 1, 0, 0, 0]  # its radius is 0.75
        pair = verisq.distance(capsule, capsule, pose)
        self.assertIn(1.5 - 1.4, pair.penetration_depth)
        self.assertLess(pair.penetration_depth.width, 1e-5)
        certified = verisq.certified_distance(capsule, capsule, pose)
        self.assertEqual(certified.penetration_depth, pair.penetration_depth)
        self.assertTrue(certified.is_proved(capsule, capsule, pose))
        self.assertFalse(certified.is_proved(capsule, capsule, [1.41, 0, 0, 1, 0, 0, 0]))
        answer = certified.answer(EXAMPLES / "capsule.json", EXAMPLES / "capsule.json", pose)
        claims = answer.check(models=[EXAMPLES / "capsule.json"] * 2)
        self.assertEqual([(claim.what, claim.verdict) for claim in claims],
                         [("distance", "proved"), ("penetration depth", "proved")])

    def test_pairs_that_are_searched(self):
        pose = [0, 0, 120, 1, 0, 0, 0]
        pair = verisq.distance(model("bent_stem.json"), model("soap.json"), pose, tolerance=0.5)
        self.assertLessEqual(pair.distance.width, 0.5)
        self.assertGreater(pair.distance.lo, 0.0)

    def test_pairs_that_are_refused(self):
        soap = model("soap.json")
        inch = verisq.Model.from_dict({**model("tapered_stem.json").to_dict(), "units": "inch"})
        with self.assertRaisesRegex(verisq.Error, "^units inch of b differ from mm of a$"):
            verisq.distance(model("tapered_stem.json"), inch)
        with self.assertRaisesRegex(verisq.Error, "quaternion not zero"):
            verisq.distance(soap, soap, [0, 0, 0, 0, 0, 0, 0])
        with self.assertRaisesRegex(ValueError, r"a pose must be an array of shape \(7,\)"):
            verisq.distance(soap, soap, [0, 0, 0])


class Meshes(unittest.TestCase):
    def test_files_and_arrays(self):
        mesh = verisq.Mesh.load(EXAMPLES / "cavity.off")
        again = verisq.Mesh(mesh.vertices, mesh.triangles)
        self.assertEqual((mesh.vertices.dtype, mesh.triangles.dtype), (np.float64, np.uint32))
        with tempfile.TemporaryDirectory() as folder:
            again.save(Path(folder, "again.ply"))
            read = verisq.Mesh.load(Path(folder, "again.ply"))
        np.testing.assert_array_equal(read.vertices, mesh.vertices)
        np.testing.assert_array_equal(read.triangles, mesh.triangles)
        sent = pickle.loads(pickle.dumps(mesh))
        np.testing.assert_array_equal(sent.vertices, mesh.vertices)
        np.testing.assert_array_equal(sent.triangles, mesh.triangles)
        self.assertEqual(len(pickle.loads(pickle.dumps(verisq.Mesh([[1, 2, 3]]))).triangles), 0)

    def test_views_outlive_their_mesh(self):
        vertices = verisq.Mesh.load(EXAMPLES / "cavity.off").vertices
        self.assertEqual(vertices.shape, (786, 3))
        self.assertTrue(np.isfinite(vertices).all())
        with self.assertRaises(ValueError):
            vertices[0, 0] = 1.0

    def test_what_is_refused(self):
        corners = np.eye(3)
        refused = [
            (ValueError, "triangles name vertex 3 of 3", corners, [[0, 1, 3]]),
            (ValueError, "triangles name vertex -1 of 3", corners, [[0, 1, -1]]),
            (TypeError, "triangles must be integers, indices of vertices, not float64", corners, [[0.0, 1.0, 2.0]]),
            (ValueError, "triangles must be an array of shape (N, 3), not (1, 4)", corners, [[0, 1, 2, 0]]),
            (verisq.Error, "vertex 1 is not finite", [[0, 0, 0], [0, np.inf, 0]], None),
        ]
        for error, text, vertices, triangles in refused:
            with self.assertRaises(error) as caught:
                verisq.Mesh(vertices, triangles)
            self.assertEqual(str(caught.exception), text)
        with self.assertRaises(verisq.Error) as caught:
            verisq.Mesh.load("nowhere.stl")
        self.assertEqual(str(caught.exception), message("map", "--model", EXAMPLES / "soap.json", "--mesh",
                                                        "nowhere.stl", "-o", "map.csv"))

    def test_of_models(self):
        mesh = verisq.mesh_of_model(model("soap.json"), 0.2)
        self.assertTrue(mesh.is_closed)
        found = verisq.map(model("soap.json"), mesh.vertices[:40])
        self.assertLess(np.abs(found.lo).max(), 0.2)


class OtherMaps(unittest.TestCase):
    def test_triangles(self):
        path, bone = EXAMPLES / "stem_mm.json", EXAMPLES / "cavity.off"
        mesh = verisq.Mesh.load(bone)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "map.npy")
            run("map", "--model", path, "--mesh", bone, "--on", "triangles", "--device", "host", "-o", file)
            rows = np.load(file)[:30]
        found = verisq.map_triangles(verisq.Model.load(path), mesh.vertices[mesh.triangles[:30]])
        np.testing.assert_array_equal(found.lo, rows["lo"])
        np.testing.assert_array_equal(found.hi, rows["hi"])
        with self.assertRaisesRegex(ValueError, r"triangles must be an array of shape \(N, 3, 3\), not \(2, 3\)"):
            verisq.map_triangles(model("soap.json"), np.zeros((2, 3)))

    def test_poses(self):
        poses = rotations(20, 1)
        a, b = EXAMPLES / "capsule.json", EXAMPLES / "soap.json"
        with tempfile.TemporaryDirectory() as folder:
            given, file = Path(folder, "poses.csv"), Path(folder, "map.npy")
            np.savetxt(given, poses, "%.17g", ",")
            outcome = run("distance", a, b, "--poses", given, "--device", "host", "-o", file)
            self.assertIn(outcome.returncode, (0, 3), outcome.stderr)
            rows = np.load(file)
        found = verisq.map_poses(verisq.Model.load(a), verisq.Model.load(b), poses, device="host")
        np.testing.assert_array_equal(found.lo, rows["lo"])
        np.testing.assert_array_equal(found.hi, rows["hi"])
        mapper = verisq.PoseMapper(verisq.Model.load(a), verisq.Model.load(b), device="host")
        np.testing.assert_array_equal(mapper(poses[:3]).lo, rows["lo"][:3])

    def test_of_places_that_are_not_known(self):
        path, points = EXAMPLES / "soap.json", np.random.default_rng(5).uniform(-9.0, 9.0, (40, 3))
        with tempfile.TemporaryDirectory() as folder:
            given, file = Path(folder, "points.npy"), Path(folder, "map.npy")
            np.save(given, points)
            outcome = run("map", "--model", path, "--points", given, "--translation-error", "0.1,0,0.2",
                          "--rotation-error", 2, "--rotation-centre", "1,0,0", "--pose-divisions", 4, "--tol", 5,
                          "--device", "host", "-o", file)
            self.assertEqual(outcome.returncode, 0, outcome.stderr)
            rows = np.load(file)
        place = verisq.PoseUncertainty((0.1, 0, 0.2), 2, (1, 0, 0), 4)
        found = verisq.map(verisq.Model.load(path), points, tolerance=5, device="host", pose_uncertainty=place)
        np.testing.assert_array_equal(found.lo, rows["lo"])
        np.testing.assert_array_equal(found.hi, rows["hi"])
        exact = verisq.map(verisq.Model.load(path), points, device="host")
        self.assertTrue((found.lo <= exact.lo).all() and (found.hi >= exact.hi).all())
        with self.assertRaisesRegex(ValueError, "more than 180 degrees"):
            verisq.PoseUncertainty(rotation=181)


class Certificates(unittest.TestCase):
    def test_prove_and_refute(self):
        stem = model("stem_mm.json")
        points = verisq.Mesh.load(EXAMPLES / "cavity.off").vertices[:25]
        found = verisq.map(stem, points, certificates=True, tolerance=1e-6)
        self.assertEqual(len(found.certificates), 25)
        self.assertEqual(len(found.certificates[-1]["normals"][0][1]), 3)
        checker = verisq.Checker(stem)
        self.assertTrue(checker.points(points, found.lo, found.hi, found.certificates).all_proved)
        wrong = checker.points(points, found.lo + 1.0, found.hi + 1.0, found.certificates)
        np.testing.assert_array_equal(wrong.verdict, verisq.Verdict.REFUTED)
        self.assertFalse(wrong.all_proved)
        with self.assertRaisesRegex(ValueError, "there are 25 certificates for 24 rows"):
            checker.points(points[1:], found.lo[1:], found.hi[1:], found.certificates)
        self.assertIsNone(verisq.map(stem, points[:1]).certificates)

    def test_of_triangles(self):
        stem = model("stem_mm.json")
        mesh = verisq.Mesh.load(EXAMPLES / "cavity.off")
        corners = mesh.vertices[mesh.triangles[:10]]
        found = verisq.map_triangles(stem, corners, certificates=True)
        self.assertTrue(verisq.Checker(stem).triangles(corners, found.lo, found.hi, found.certificates).all_proved)

    def test_of_set_operations_and_bends(self):
        stem = model("bent_stem.json")
        points = [[0.0, 0.1, 0.0], [0.08, -0.05, -0.38], [0.3, 0.2, -0.1]]
        found = verisq.map(stem, points, certificates=True)
        self.assertTrue(verisq.Checker(stem).points(points, found.lo, found.hi, found.certificates).all_proved)


class Surfaces(unittest.TestCase):
    def test_recovery_and_deviation(self):
        ball = verisq.Model.from_dict({
            "format": "verisq-model/1",
            "primitives": [{"name": "ball", "superquadric": {"semi_axes": [3, 3, 3], "exponents": [1, 1]}}],
        })
        mesh = verisq.mesh_of_model(ball, 0.2)
        deviation = verisq.deviation(ball, mesh, relative_tolerance=0.3, device="host", from_model=False)
        self.assertLess(deviation.from_mesh.largest.hi, 0.3)
        self.assertEqual(len(deviation.from_mesh.percentiles), 2)
        self.assertIsNone(deviation.hausdorff)
        proven = verisq.certified_deviation(ball, mesh, relative_tolerance=0.3, device="host")
        self.assertLess(proven.from_mesh.largest.hi, 0.4)
        self.assertLess(proven.from_model.hi, 0.4)
        self.assertEqual(proven.hausdorff.hi, max(proven.from_model.hi, proven.from_mesh.largest.hi))
        self.assertTrue(proven.is_proved(ball, mesh))
        self.assertIsNone(proven.statistics_from_model)
        with_means = verisq.certified_deviation(ball, mesh, relative_tolerance=0.3, statistics_of_model=True,
                                                device="host")
        means = with_means.statistics_from_model
        self.assertLessEqual(means.mean.lo, means.mean.hi)
        self.assertLess(means.mean.hi, with_means.from_model.hi)
        self.assertEqual(len(means.percentiles), 2)
        self.assertTrue(with_means.is_proved(ball, mesh))
        twice = verisq.Mesh(2.0 * mesh.vertices, mesh.triangles)
        self.assertFalse(with_means.is_proved(ball, twice))
        self.assertFalse(proven.is_proved(model("soap.json"), mesh))
        self.assertFalse(proven.is_proved(ball, mesh.vertices))
        found = verisq.recover(mesh.vertices, units="mm")
        self.assertFalse(found.out_of_time)
        self.assertTrue(verisq.recover(mesh.vertices, time_limit=1e-9).out_of_time)
        self.assertEqual(found.model.units, "mm")
        self.assertLess(abs(found.model.bounding_radius - ball.bounding_radius), 0.05)
        self.assertEqual([stage.primitives for stage in found.stages], [1])
        with self.assertRaisesRegex(verisq.Error, "12"):
            verisq.recover(np.zeros((3, 3)))

    def test_features(self):
        landmarks = json.loads((EXAMPLES / "femur_landmarks.json").read_text())
        printed = json.loads(run("features", "--landmarks", EXAMPLES / "femur_landmarks.json", "--landmark-radius", 1,
                                 "--json").stdout)
        points = {**landmarks["landmarks"], "head_radius": landmarks["head_radius"]}
        found = verisq.femur_features(points, landmarks["side"], landmark_radius=1.0)
        self.assertTrue(found.is_proved(points, landmarks["side"], landmark_radius=1.0))
        self.assertFalse(found.is_proved(points, landmarks["side"], landmark_radius=1.5))
        expected = [(each["name"], each["value"]["lo"], each["value"]["hi"]) for each in printed["features"]]
        self.assertEqual([(each.name, *each.value) for each in found.features], expected)
        self.assertEqual(found.features[1].unit, "degrees")
        with self.assertRaisesRegex(verisq.Error, "no landmark is called knee"):
            verisq.femur_features({"knee": [0, 0, 0]}, landmark_radius=1.0)


if __name__ == "__main__":
    unittest.main()
