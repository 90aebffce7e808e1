"""Objects of other packages: meshes, matrices, rotations; enclosures as numbers; maps as tables and pictures."""

import math
import pickle
import random
import types
import unittest
from decimal import Decimal
from fractions import Fraction

import meshio
import numpy as np
import verisq
from scipy.spatial.transform import Rotation

from command_line import EXAMPLES

CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
                  [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])


def trimesh_like(vertices=CORNERS, faces=FACES):
    return types.SimpleNamespace(vertices=vertices, faces=faces)


def open3d_like():
    return types.SimpleNamespace(vertices=[list(corner) for corner in CORNERS], triangles=FACES.astype(np.int32))


class MeshesOfOtherPackages(unittest.TestCase):
    MESHES = {"trimesh": trimesh_like(), "Open3D": open3d_like(),
              "meshio": meshio.Mesh(CORNERS, [("line", [[0, 1]]), ("triangle", FACES[:5]), ("triangle", FACES[5:])]),
              "verisq": verisq.Mesh(CORNERS, FACES)}

    def test_are_a_mesh(self):
        for name, thing in self.MESHES.items():
            with self.subTest(name):
                mesh = verisq.Mesh(thing)
                np.testing.assert_array_equal(mesh.vertices, CORNERS)
                np.testing.assert_array_equal(mesh.triangles, FACES)

    def test_are_a_model(self):
        points = np.random.default_rng(1).uniform(-3, 3, (50, 3))
        of_mesh = verisq.map(verisq.Model.from_mesh(verisq.Mesh(CORNERS, FACES)), points)
        for name, thing in self.MESHES.items():
            with self.subTest(name):
                np.testing.assert_array_equal(verisq.map(verisq.Model.from_mesh(thing), points).lo, of_mesh.lo)

    def test_are_what_is_mapped(self):
        model = verisq.Model.load(EXAMPLES / "capsule.json")
        points = verisq.map(model, CORNERS)
        triangles = verisq.map_triangles(model, CORNERS[FACES])
        for name, thing in self.MESHES.items():
            with self.subTest(name):
                np.testing.assert_array_equal(verisq.map(model, thing).lo, points.lo)
                np.testing.assert_array_equal(verisq.map_triangles(model, thing).hi, triangles.hi)
                np.testing.assert_array_equal(verisq.closest_points(model, thing).lo,
                                              verisq.closest_points(model, CORNERS).lo)

    def test_are_taken_by_every_function_of_meshes(self):
        model = verisq.Model.load(EXAMPLES / "capsule.json")
        cube = verisq.Mesh(CORNERS, FACES)
        self.assertEqual(verisq.deviation(model, trimesh_like()).from_mesh.largest,
                         verisq.deviation(model, cube).from_mesh.largest)
        self.assertEqual(verisq.mesh_clearance(model, trimesh_like()).smallest_distance,
                         verisq.mesh_clearance(model, cube).smallest_distance)

    def test_binary32_is_widened_exactly(self):
        narrow = (CORNERS / 3).astype(np.float32)
        np.testing.assert_array_equal(verisq.Mesh(trimesh_like(vertices=narrow)).vertices, narrow.astype(np.float64))

    def test_a_cloud_has_no_triangles(self):
        cloud = types.SimpleNamespace(points=CORNERS)
        self.assertEqual(len(verisq.Mesh(cloud).triangles), 0)
        with self.assertRaisesRegex(ValueError, "has no triangles"):
            verisq.map_triangles(verisq.Model.load(EXAMPLES / "capsule.json"), cloud)

    def test_other_polygons_are_refused(self):
        quads = meshio.Mesh(CORNERS, [("quad", [[0, 1, 3, 2]])])
        with self.assertRaisesRegex(ValueError, "meshio's Mesh has cells of type quad"):
            verisq.Mesh(quads)
        with self.assertRaisesRegex(ValueError, "triangles must be an array of shape"):
            verisq.Mesh(trimesh_like(faces=[[0, 1, 3, 2]]))
        with self.assertRaisesRegex(ValueError, "triangles name vertex 8 of 8"):
            verisq.Mesh(trimesh_like(faces=[[0, 1, 8]]))

    def test_a_grid_is_no_cloud(self):
        grid = types.SimpleNamespace(points=CORNERS, GetCells=lambda: None)
        with self.assertRaisesRegex(ValueError, "is no surface: extract it"):
            verisq.Mesh(grid)

    def test_what_is_no_mesh_is_refused(self):
        for thing in ("bone.stl", 3, {"vertices": CORNERS}, None):
            with self.assertRaises((TypeError, ValueError)):
                verisq.Mesh(thing)


class PosesOfOtherPackages(unittest.TestCase):
    def test_a_matrix_is_its_quaternion(self):
        generator = np.random.default_rng(2)
        for rotation in [*Rotation.random(200, random_state=3), *Rotation.create_group("O")]:
            matrix = np.eye(4)
            matrix[:3, :3] = rotation.as_matrix()
            matrix[:3, 3] = generator.uniform(-9, 9, 3)
            for thing in (matrix, matrix.tolist(), (rotation, matrix[:3, 3]), (matrix[:3, :3], matrix[:3, 3])):
                found = verisq.pose(thing)
                np.testing.assert_array_equal(found[:3], matrix[:3, 3])
                turned = Rotation.from_quat(found[[4, 5, 6, 3]]).as_matrix()
                np.testing.assert_allclose(turned, matrix[:3, :3], rtol=0, atol=1e-15)

    def test_many_at_once(self):
        rotations = Rotation.random(30, random_state=4)
        matrices = np.tile(np.eye(4), (30, 1, 1))
        matrices[:, :3, :3] = rotations.as_matrix()
        matrices[:, :3, 3] = [200, 0, 0]
        a, b = (verisq.Model.load(EXAMPLES / name) for name in ("capsule.json", "gem.json"))
        seven = np.array([verisq.pose(matrix) for matrix in matrices])
        np.testing.assert_array_equal(verisq.map_poses(a, b, matrices).lo, verisq.map_poses(a, b, seven).lo)
        self.assertEqual(len(verisq.map_poses(a, b, rotations)), 30)

    def test_a_pose_moves_the_model_of_a_map(self):
        model = verisq.Model.load(EXAMPLES / "stem_mm.json")
        pose = [10, 20, 30, 0.5, 0.5, -0.5, 0.5]
        points = np.random.default_rng(5).uniform(-100, 100, (300, 3))
        moved = verisq.map(model.posed(pose), points)
        np.testing.assert_array_equal(verisq.map(model, points, pose=pose).lo, moved.lo)
        self.assertFalse((moved.lo == verisq.map(model, points).lo).all())
        corners = points.reshape(-1, 3, 3)
        np.testing.assert_array_equal(verisq.map_triangles(model, corners, pose=pose).hi,
                                      verisq.map_triangles(model.posed(pose), corners).hi)

    def test_what_is_not_rigid_is_refused(self):
        for change in (np.diag([2, 2, 2, 1.0]), np.diag([-1, 1, 1, 1.0]), np.diag([1, 1, 1, 2.0]),
                       np.full((4, 4), np.nan), np.eye(4) + np.eye(4, k=1) * 1e-3):
            with self.assertRaisesRegex(ValueError, "pose 0: a matrix must turn and move"):
                verisq.pose(change)
        for several in (np.tile(np.eye(4), (3, 1, 1)), Rotation.random(3), np.zeros((3, 7)), np.zeros(6), np.eye(3)):
            with self.assertRaisesRegex(ValueError, "a pose must be"):
                verisq.pose(several)
        stack = np.tile(np.eye(4), (3, 1, 1))
        stack[2] *= 2
        with self.assertRaisesRegex(ValueError, "pose 2: a matrix must"):
            verisq.map_poses(*[verisq.Model.load(EXAMPLES / "capsule.json")] * 2, stack)


class EnclosuresAsNumbers(unittest.TestCase):
    def random_enclosure(self, source):
        ends = sorted(source.choice([1, -1]) * source.random() * 10.0 ** source.randint(-30, 30) for _ in range(2))
        return verisq.Enclosure(*ends)

    def test_arithmetic_contains_the_exact_result_and_is_tight(self):
        source = random.Random(6)
        operations = [lambda x, y: x + y, lambda x, y: x - y, lambda x, y: x * y, lambda x, y: x / y]
        for _ in range(2000):
            a, b = self.random_enclosure(source), self.random_enclosure(source)
            for operation in operations:
                if operation is operations[3] and 0.0 in b:
                    with self.assertRaises(ZeroDivisionError):
                        operation(a, b)
                    continue
                found = operation(a, b)
                exact = [operation(Fraction(x), Fraction(y)) for x in a for y in b]
                self.assertLessEqual(Fraction(found.lo), min(exact))
                self.assertGreaterEqual(Fraction(found.hi), max(exact))
                self.assertGreater(Fraction(math.nextafter(found.lo, math.inf)), min(exact))
                self.assertLess(Fraction(math.nextafter(found.hi, -math.inf)), max(exact))

    def test_extremes(self):
        huge = verisq.Enclosure(1e308, 1e308)
        self.assertEqual(huge + huge, verisq.Enclosure(1.7976931348623157e308, math.inf))
        self.assertEqual(-huge - huge, verisq.Enclosure(-math.inf, -1.7976931348623157e308))
        tiny = verisq.Enclosure(1e-300, 1e-300)
        self.assertEqual(tiny * tiny, verisq.Enclosure(0.0, 5e-324))
        above = verisq.Enclosure(1.0, math.inf)
        self.assertEqual(above * 0.0, verisq.Enclosure(0.0, 0.0))
        self.assertEqual(above + 0, above)
        self.assertEqual(0.0 / above, verisq.Enclosure(0.0, 0.0))
        self.assertEqual(above - above, verisq.Enclosure(-math.inf, math.inf))
        self.assertEqual(1 / above, verisq.Enclosure(0.0, 1.0))

    def test_numbers_of_all_kinds(self):
        one = verisq.Enclosure(1.0, 2.0)
        for number in (3, 3.0, np.float32(3), np.float64(3), np.int64(3), Fraction(3), Decimal(3)):
            self.assertEqual(one + number, verisq.Enclosure(4.0, 5.0))
            self.assertEqual(number - one, verisq.Enclosure(1.0, 2.0))
        beyond = verisq.Enclosure(0.0, 0.0) + (2**53 + 1)
        self.assertEqual((beyond.lo, beyond.hi), (2.0**53, 2.0**53 + 2))
        tenth = verisq.Enclosure(0.0, 0.0) + Fraction(1, 10)
        self.assertTrue(Fraction(tenth.lo) < Fraction(1, 10) < Fraction(tenth.hi))
        self.assertEqual(verisq.Enclosure(0.0, 0.0) + 10**400, verisq.Enclosure(1.7976931348623157e308, math.inf))
        for other in ("1", None, [1.0], True, np.longdouble(1)):
            with self.assertRaises(TypeError):
                one + other

    def test_comparisons_are_proven_or_refused(self):
        gap = verisq.Enclosure(1.9, 2.1)
        self.assertTrue(gap > 1.8 and gap >= 1.9 and gap < 2.2 and gap <= 2.1 and 1.8 < gap)
        self.assertFalse(gap > 2.1 or gap < 1.9 or gap >= 2.2 or gap <= 1.8)
        self.assertTrue(gap < verisq.Enclosure(3.0, 4.0))
        for undecided in (lambda: gap > 2.0, lambda: gap < 2.0, lambda: gap >= 2.0, lambda: gap <= 2.0,
                          lambda: gap < verisq.Enclosure(2.0, 3.0), lambda: gap < gap):
            with self.assertRaisesRegex(verisq.Undecided, r"undecided: \[1\.9, 2\.1\]"):
                undecided()
        self.assertEqual(abs(verisq.Enclosure(-3.0, 2.0)), verisq.Enclosure(0.0, 3.0))
        self.assertEqual(abs(verisq.Enclosure(-3.0, -2.0)), verisq.Enclosure(2.0, 3.0))

    def test_formats_contain_what_is_enclosed(self):
        self.assertEqual(f"{verisq.Enclosure(1.23456, 1.23457):.3f}", "[1.234, 1.235]")
        self.assertEqual(f"{verisq.Enclosure(-1.23456, 0.5):.2e}", "[-1.24e+0, 5.00e-1]")
        self.assertEqual(str(verisq.Enclosure(1.0, 2.0)), f"{verisq.Enclosure(1.0, 2.0)}")
        source = random.Random(7)
        for _ in range(2000):
            enclosure = self.random_enclosure(source)
            spec = f".{source.randint(0, 20)}{source.choice('efg')}"
            lo, hi = format(enclosure, spec).strip("[]").split(", ")
            self.assertTrue(Fraction(lo) <= Fraction(enclosure.lo) and Fraction(enclosure.hi) <= Fraction(hi), spec)
        self.assertEqual(f"{verisq.Enclosure(1.0, math.inf):.1f}", "[1.0, inf]")
        with self.assertRaisesRegex(ValueError, "e, f or g"):
            format(verisq.Enclosure(0.1, 0.2), "%")


class MapsAsTables(unittest.TestCase):
    def setUp(self):
        self.mesh = verisq.Mesh(CORNERS * 90, FACES)
        self.map = verisq.map(verisq.Model.load(EXAMPLES / "stem_mm.json"), self.mesh)

    def test_a_structured_array_and_a_frame(self):
        rows = self.map.to_numpy()
        frame = self.map.to_frame()
        for name in ("lo", "hi", "status"):
            np.testing.assert_array_equal(rows[name], getattr(self.map, name))
            np.testing.assert_array_equal(frame[name], getattr(self.map, name))

    def test_a_notebook_shows_counts_and_a_picture(self):
        shown = self.map._repr_html_()
        self.assertIn("8 rows, 0 wider", shown)
        self.assertEqual(shown.count("<rect"), 40)
        self.assertIn("0 rows", verisq.map(verisq.Model.load(EXAMPLES / "stem_mm.json"), np.empty((0, 3)))._repr_html_())

    def test_a_plot_shows_lower_ends(self):
        import matplotlib
        matplotlib.use("Agg")
        axes = verisq.plot(trimesh_like(CORNERS * 90), self.map)
        drawn = axes.collections[0].get_array()
        np.testing.assert_array_equal(drawn, self.map.lo[FACES].min(axis=1))
        verisq.plot(self.mesh)
        with self.assertRaisesRegex(ValueError, "3 rows are not those of vertices or triangles"):
            verisq.plot(self.mesh, [1.0, 2.0, 3.0])

    def test_a_plot_asks_where_rows_fit_vertices_and_triangles(self):
        import matplotlib
        matplotlib.use("Agg")
        tetrahedron = trimesh_like(CORNERS[[0, 3, 5, 6]], np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]))
        rows = [1.0, 2.0, 3.0, 4.0]
        with self.assertRaisesRegex(ValueError, "4 vertices and as many triangles: say on="):
            verisq.plot(tetrahedron, rows)
        drawn = {on: verisq.plot(tetrahedron, rows, on=on).collections[0].get_array().tolist()
                 for on in ("vertices", "triangles")}
        self.assertEqual(drawn, {"vertices": [1.0, 1.0, 1.0, 2.0], "triangles": rows})
        with self.assertRaisesRegex(ValueError, "8 rows are not those of triangles"):
            verisq.plot(self.mesh, self.map, on="triangles")


class ModelsAndErrors(unittest.TestCase):
    def test_equal_models_are_equal(self):
        first, second = (verisq.Model.load(EXAMPLES / "tapered_stem.json") for _ in range(2))
        self.assertEqual(first, second)
        self.assertEqual(hash(first), hash(second))
        self.assertEqual(first, pickle.loads(pickle.dumps(first)))
        self.assertNotEqual(first, first.posed([0, 0, 1e-9, 1, 0, 0, 0]))
        self.assertNotEqual(first, "tapered_stem.json")
        cube = verisq.Model.from_mesh(verisq.Mesh(CORNERS, FACES))
        self.assertEqual(len({cube, verisq.Model.from_mesh(trimesh_like()), first, second}), 2)

    def test_errors_are_those_of_python_too(self):
        for kind in (verisq.Error, ValueError, OSError):
            with self.assertRaisesRegex(kind, "nowhere.json"):
                verisq.Model.load("nowhere.json")
        with self.assertRaises(verisq.Error) as caught:
            verisq.Model.loads("{}", "mine")
        self.assertEqual(str(pickle.loads(pickle.dumps(caught.exception))), str(caught.exception))
        self.assertEqual(caught.exception.kind, "input")


if __name__ == "__main__":
    unittest.main()
