"""Maps of arrays: the rows of the command line bit for bit, whatever the array; threads; Ctrl-C; what is refused."""

import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tracemalloc
import unittest
from pathlib import Path

import numpy as np
import verisq

from command_line import EXAMPLES, map_of_points, message


def random_points(count, extent, seed):
    return np.random.default_rng(seed).uniform(-extent, extent, (count, 3))


class MeshAsTheSolid(unittest.TestCase):
    """A closed mesh as the model: an implant as it comes."""

    CUBE = ([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)],
            [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
             [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = Path(folder.name, "cube.off")
        verisq.Mesh(*self.CUBE).save(self.file)
        self.cube = verisq.Model.from_mesh(verisq.Mesh(*self.CUBE))

    def test_distances_to_a_cube_are_those_of_its_formula(self):
        points = random_points(5000, 3.0, 7)
        beyond = np.abs(points) - 1.0
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
        exact = np.where(outside > 0.0, outside, beyond.max(axis=1))
        found = verisq.map(self.cube, points)
        self.assertTrue((found.lo <= exact + 1e-15).all())
        self.assertTrue((exact - 1e-15 <= found.hi).all())
        self.assertLess((found.hi - found.lo).max(), 1e-13)
        self.assertEqual(found.host_verified, 5000)

    def test_a_mesh_that_is_turned_inward_is_the_same_solid(self):
        points = random_points(500, 3.0, 8)
        inward = verisq.Model.from_mesh(verisq.Mesh(self.CUBE[0], np.array(self.CUBE[1])[:, ::-1]))
        np.testing.assert_array_equal(verisq.map(inward, points).lo < 0, verisq.map(self.cube, points).lo < 0)

    def test_rows_are_those_of_the_command_line(self):
        points = random_points(3000, 3.0, 9)
        rows = map_of_points(self.file, points)
        for model in (self.cube, verisq.Model.load(self.file)):
            found = verisq.map(model, points)
            self.assertEqual(found.lo.tobytes(), np.ascontiguousarray(rows["lo"]).tobytes())
            self.assertEqual(found.hi.tobytes(), np.ascontiguousarray(rows["hi"]).tobytes())

    def test_a_checker_proves_its_rows(self):
        points = random_points(300, 3.0, 10)
        found = verisq.map(self.cube, points, certificates=True)
        checker = verisq.Checker(self.cube)
        self.assertTrue(checker.points(points, found.lo, found.hi, found.certificates).all_proved)
        shifted = checker.points(points, found.lo + 1e-6, found.hi + 1e-6, found.certificates)
        self.assertFalse((shifted.verdict == verisq.Verdict.PROVED).any())

    def test_a_checker_proves_its_triangles(self):
        triangles = random_points(900, 3.0, 11).reshape(-1, 3, 3)
        found = verisq.map_triangles(self.cube, triangles, certificates=True)
        checker = verisq.Checker(self.cube)
        self.assertTrue(checker.triangles(triangles, found.lo, found.hi, found.certificates).all_proved)
        self.assertGreater(np.count_nonzero(found.lo > 0), 30)
        self.assertGreater(np.count_nonzero(found.hi == 0), 30)
        shifted = checker.triangles(triangles, found.lo + 1e-6, found.hi + 1e-6, found.certificates)
        self.assertFalse((shifted.verdict == verisq.Verdict.PROVED).any())

    def test_closest_points_and_normals_are_proven(self):
        found = verisq.closest_points(self.cube, [[3.0, 0.25, 0.5], [0.0, 0.0, 0.0]])
        np.testing.assert_array_equal(found.unique, [True, False])
        np.testing.assert_allclose(found.point[0].T[0], [1.0, 0.25, 0.5], atol=1e-15)
        np.testing.assert_allclose(found.normal[0].T[1], [1.0, 0.0, 0.0], atol=1e-15)

    def test_a_model_of_a_mesh_is_kept_bit_for_bit(self):
        model = verisq.Model.from_mesh(verisq.Mesh(*self.CUBE), name="implant", units="mm",
                                       pose=[1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.5])
        self.assertEqual(model.names, ["implant"])
        self.assertFalse(model.is_union_of_convex)
        again = verisq.Model.from_dict(model.to_dict())
        self.assertEqual(again.to_dict(), model.to_dict())
        saved = self.file.parent / "implant.json"
        model.save(saved)
        self.assertEqual(verisq.Model.load(saved).to_dict(), model.to_dict())

    def test_two_meshes_have_a_deviation_and_a_distance(self):
        other = verisq.Mesh(np.array(self.CUBE[0]) * 1.25, self.CUBE[1])
        found = verisq.deviation(self.cube, other, tolerance=1e-3)
        corner = np.sqrt(3.0) * 0.25
        self.assertLessEqual(found.hausdorff.lo, corner + 1e-12)
        self.assertGreaterEqual(found.hausdorff.hi, corner - 1e-12)
        self.assertLess(found.hausdorff.hi - found.hausdorff.lo, 1e-3)
        distances = verisq.map_poses(self.cube, self.cube, [[3.0, 0, 0, 1, 0, 0, 0], [1.0, 0, 0, 1, 0, 0, 0]])
        self.assertAlmostEqual(distances.lo[0], 1.0, delta=1e-12)
        self.assertEqual(distances.hi[1], 0.0)

    def test_what_is_no_solid_is_refused(self):
        with self.assertRaisesRegex(verisq.Error, "3 of its edges are open"):
            verisq.Model.from_mesh(verisq.Mesh(self.CUBE[0], self.CUBE[1][1:]))
        with self.assertRaisesRegex(verisq.Error, "no triangles"):
            verisq.Model.from_mesh(verisq.Mesh(self.CUBE[0]))
        with self.assertRaisesRegex(verisq.Error, "not finite"):
            verisq.map(self.cube, [[np.nan, 0, 0]])

    def test_what_a_mesh_lacks_so_far_is_refused(self):
        given = ["map", "--model", self.file, "--mesh", EXAMPLES / "cavity.off", "-o", self.file.parent / "map.csv"]
        self.assertIn("mesh", message(*given, "--method", "published", "--device", "host"))
        self.assertIn("mesh", message("insert", "--implant", self.file, "--mesh", EXAMPLES / "cavity.off", "--along",
                                      "0,0,1", "--length", "1", "-o", self.file.parent / "way.csv", "--certificate-file",
                                      self.file.parent / "way.json"))


class SameAsCommandLine(unittest.TestCase):
    def check(self, name, points, device, tolerance):
        path = EXAMPLES / name
        rows = map_of_points(path, points, "--device", device, "--tol", tolerance)
        found = verisq.map(verisq.Model.load(path), points, device=device, tolerance=tolerance)
        self.assertEqual(found.lo.tobytes(), np.ascontiguousarray(rows["lo"]).tobytes())
        self.assertEqual(found.hi.tobytes(), np.ascontiguousarray(rows["hi"]).tobytes())
        np.testing.assert_array_equal(found.status, rows["status"])
        return found

    def test_on_a_device(self):
        found = self.check("capsule.json", random_points(5000, 200.0, 1), "auto", 1e-9)
        if found.device != "host":  # there is one
            self.assertGreater(found.device_verified, 4000)
        self.assertEqual(found.device_verified + found.host_verified + found.wide, 5000)

    def test_on_the_host(self):
        for name, extent in [("soap.json", 6.0), ("stem.json", 1.0), ("tapered_stem.json", 80.0)]:
            with self.subTest(name):
                found = self.check(name, random_points(60, extent, 2), "host", 1e-6)
                self.assertEqual(found.device, "host")
                self.assertGreater(found.hi.min(), found.lo.min() - 1.0)

    def test_bent_and_uncertain(self):
        self.check("bent_stem.json", random_points(12, 40.0, 3), "host", 1e-3)
        self.check("uncertain_stem.json", random_points(40, 40.0, 4), "host", 1e-3)

    def test_default_tolerance_and_summary(self):
        model = verisq.Model.load(EXAMPLES / "soap.json")
        points = random_points(50, 9.0, 5)
        rows = map_of_points(EXAMPLES / "soap.json", points)
        found = verisq.map(model, points)
        np.testing.assert_array_equal(found.lo, rows["lo"])
        self.assertEqual(found.tolerance, 1e-6 * model.bounding_radius)
        self.assertEqual(found.smallest.lo, found.lo.min())
        self.assertEqual(found.smallest.hi, found.hi.min())
        self.assertEqual(found.largest_width, (found.hi - found.lo).max())
        np.testing.assert_array_equal(found.verified, found.status != verisq.Status.WIDE)


class Arrays(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mapper = verisq.Mapper(verisq.Model.load(EXAMPLES / "soap.json"), device="host", tolerance=1e-6)
        cls.points = random_points(40, 8.0, 6).astype(np.float32).astype(np.float64)
        cls.expected = cls.mapper(cls.points).lo

    def same(self, points):
        before = points.tobytes()
        np.testing.assert_array_equal(self.mapper(points).lo, self.expected)
        self.assertEqual(points.tobytes(), before)

    def test_strides(self):
        wide = np.full((80, 7), np.nan)
        wide[::2, 1::2] = self.points
        self.same(wide[::2, 1::2])
        self.same(np.asfortranarray(self.points))
        self.same(np.ascontiguousarray(self.points[::-1])[::-1])
        self.same(np.ascontiguousarray(self.points[:, ::-1])[:, ::-1])
        record = np.zeros(40, dtype=[("flag", "u1"), ("at", "f8", 3)])  # packed: nothing is aligned
        record["at"] = self.points
        self.same(record["at"])

    def test_one_point_many_times(self):
        found = self.mapper(np.broadcast_to(self.points[3], (5, 3)))
        np.testing.assert_array_equal(found.lo, np.repeat(self.expected[3], 5))

    def test_types(self):
        for kind in ("<f4", ">f4", ">f8"):
            with self.subTest(kind):
                self.same(self.points.astype(kind))
        whole = np.round(self.points)
        expected = self.mapper(whole).lo
        for kind in ("i1", "i4", ">i8", "f2"):
            with self.subTest(kind):
                np.testing.assert_array_equal(self.mapper(whole.astype(kind)).lo, expected)
        np.testing.assert_array_equal(self.mapper(whole.astype(int).tolist()).lo, expected)

    def test_read_only(self):
        points = self.points.copy()
        points.flags.writeable = False
        self.same(points)

    def test_empty(self):
        found = self.mapper(np.empty((0, 3)))
        self.assertEqual((len(found), found.lo.shape, found.smallest), (0, (0,), None))
        lo, hi, status = found
        self.assertEqual((lo.dtype, hi.dtype, status.dtype), (np.float64, np.float64, np.uint8))

    def test_chunks(self):
        model = verisq.Model.load(EXAMPLES / "soap.json")
        chunks = (self.points[k : k + 15] for k in range(0, 40, 15))
        found = list(verisq.map_chunks(model, chunks, device="host", tolerance=1e-6))
        self.assertEqual([len(each) for each in found], [15, 15, 10])
        np.testing.assert_array_equal(np.concatenate([each.lo for each in found]), self.expected)


class Memory(unittest.TestCase):
    def test_points_are_read_where_they_lie(self):
        count = 20000
        mapper = verisq.Mapper(verisq.Model.load(EXAMPLES / "capsule.json"))
        points = random_points(count, 200.0, 9)
        tracemalloc.start()
        try:
            found = mapper(points)
            with_view = tracemalloc.get_traced_memory()[1]
            tracemalloc.reset_peak()
            del found
            mapper(points.astype(np.float32))
            with_copy = tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()
        rows, coordinates = 17 * count, 24 * count
        self.assertLess(with_view, rows + coordinates // 2)
        self.assertGreater(with_copy, rows + coordinates)  # what a copy would look like


class Refused(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = verisq.Model.load(EXAMPLES / "soap.json")

    def refuses(self, error, text, points, **options):
        with self.assertRaises(error) as caught:
            verisq.map(self.model, points, **options)
        self.assertEqual(str(caught.exception), text)
        return caught.exception

    def test_shapes(self):
        for shape in [(4, 2), (3,), (2, 3, 3), ()]:
            text = f"points must be an array of shape (N, 3), not {shape}"
            self.refuses(ValueError, text, np.zeros(shape))

    def test_types(self):
        for kind in ["c16", "O", "U3", "?", "g", "M8[s]"]:
            with self.subTest(kind), self.assertRaises(TypeError) as caught:
                verisq.map(self.model, np.zeros((2, 3)).astype(kind))
            self.assertIn("points must be real numbers that binary64 holds exactly", str(caught.exception))
        masked = np.ma.masked_array(np.zeros((1, 3)), mask=[[True, False, False]])
        self.refuses(TypeError, "points must not be a masked array: leave out what is masked", masked)

    def test_integers_that_binary64_does_not_hold(self):
        text = "points must be within 2^53 where they are integers: binary64 holds no others"
        self.refuses(ValueError, text, [[2**53 + 1, 0, 0]])
        verisq.map(self.model, [[2**53, 0, 0]], tolerance=1e9)

    def test_not_finite(self):
        error = self.refuses(verisq.Error, "point (1, nan, 0) is not finite", [[0.0, 0, 0], [1, np.nan, 0]])
        self.assertEqual(error.kind, "input")
        self.refuses(verisq.Error, "point (inf, 0, 0) is not finite", [[np.inf, 0, 0]])

    def test_options(self):
        points = np.zeros((1, 3))
        self.refuses(ValueError, "tolerance must be finite and at least 0, not -1", points, tolerance=-1.0)
        self.refuses(ValueError, "point_radius must be finite and at least 0, not nan", points, point_radius=np.nan)
        self.refuses(ValueError, "time_limit must be above 0 and at most 1e9 seconds, not 0", points, time_limit=0)
        expected = message("map", "--model", EXAMPLES / "soap.json", "--mesh", EXAMPLES / "cavity.off", "-o",
                           os.devnull, "--format", "csv", "--device", "no such device")
        self.refuses(verisq.Error, expected, points, device="no such device")


class Threads(unittest.TestCase):
    def test_models_and_mappers_are_shared(self):
        names = ["soap.json", "gem.json"]
        models = [verisq.Model.load(EXAMPLES / name) for name in names]
        points = random_points(30, 9.0, 7)
        mappers = [verisq.Mapper(model, device="host", tolerance=1e-6) for model in models]
        expected = [mapper(points).lo for mapper in mappers]
        wrong = []

        def work(number):
            for which in (number % 2, 1 - number % 2):
                if not np.array_equal(mappers[which](points).lo, expected[which]):
                    wrong.append(number)

        threads = [threading.Thread(target=work, args=(number,)) for number in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])

    def test_others_run_during_a_map(self):
        # No thread is told to give Python's lock away: others run only where the map has released it.
        model = verisq.Model.load(EXAMPLES / "bent_tapered_stem.json")
        begun, ended = threading.Event(), threading.Event()
        ticks = []

        def count():
            begun.wait()
            while not ended.is_set():
                ticks.append(len(ticks))
                time.sleep(0.001)

        other = threading.Thread(target=count)
        other.start()
        interval = sys.getswitchinterval()
        sys.setswitchinterval(1000.0)
        try:
            begun.set()
            found = verisq.map(model, random_points(500, 30.0, 8), device="host", tolerance=0.0, time_limit=0.3)
        finally:
            ended.set()
            sys.setswitchinterval(interval)
            other.join()
        self.assertGreater(len(ticks), 3)
        self.assertTrue(np.all(found.lo <= found.hi))


class OneAfterAnother(unittest.TestCase):
    def test_each_is_of_its_own_model_and_options(self):
        # map() keeps the last one ready for the device.
        points = random_points(200, 9.0, 10)
        soap = verisq.Model.load(EXAMPLES / "soap.json")
        moved = soap.posed([1, 0, 0, 1, 0, 0, 0])
        of_soap, of_moved = (verisq.Mapper(model, tolerance=1e-6)(points).lo.tobytes() for model in (soap, moved))
        for model, expected in [(soap, of_soap), (soap, of_soap), (moved, of_moved), (soap, of_soap)]:
            self.assertEqual(verisq.map(model, points, tolerance=1e-6).lo.tobytes(), expected)
        self.assertIsNotNone(verisq.map(soap, points, tolerance=1e-6, certificates=True).certificates)
        with self.assertRaises(verisq.Error):
            verisq.map(soap, points * np.nan, tolerance=1e-6)
        self.assertEqual(verisq.map(soap, points, tolerance=1e-6).lo.tobytes(), of_soap)


class Interrupted(unittest.TestCase):
    PROGRAM = """
import numpy, sys, verisq
model = verisq.Model.load(sys.argv[1])
points = numpy.random.default_rng(1).uniform(-1000, 1000, (2000000, 3))
print("ready", flush=True)
try:
    verisq.map(model, points, device="host", tolerance=0.0)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""

    def test_ends_the_map(self):
        # It would take the host minutes.
        child = subprocess.Popen([sys.executable, "-c", self.PROGRAM, EXAMPLES / "tapered_stem.json"],
                                 stdout=subprocess.PIPE, text=True)
        self.assertEqual(child.stdout.readline(), "ready\n")
        time.sleep(0.2)
        child.send_signal(signal.SIGINT)
        self.assertEqual(child.stdout.readline(), "interrupted\n")
        self.assertEqual(child.wait(), 0)
        child.stdout.close()


if __name__ == "__main__":
    unittest.main()
