"""Random models and queries: the rows of the command line bit for bit, or the same refusal.

VERISQ_PYTHON_CASES=100000 asks for more cases than the few hundred of every test run; a case is a row. VERISQ_PYTHON_SEED
draws others than those of every run, the same for the same number.
"""

import json
import os
import tempfile
import unittest
from pathlib import Path

import numpy as np
import verisq
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

from command_line import run

CASES = int(os.environ.get("VERISQ_PYTHON_CASES", "200"))
SEED = os.environ.get("VERISQ_PYTHON_SEED")
# Of an example, which is a call of the command; of more than 50 triangles Hypothesis has no room to draw the numbers.
ROWS = 10 if CASES < 10000 else 50


def examples_of(share):
    """Settings for so large a part of the cases. The same cases in every run of one seed."""
    chosen = settings(max_examples=max(1, round(share * CASES / ROWS)), deadline=None, database=None,
                      derandomize=SEED is None, suppress_health_check=list(HealthCheck))
    return chosen if SEED is None else lambda test: chosen(seed(int(SEED))(test))


lengths = st.floats(0.05, 40.0)
exponents = st.one_of(st.sampled_from([0.1, 0.5, 1.0, 1.5, 2.0]), st.floats(0.05, 2.0))
places = st.one_of(st.sampled_from([0.0, 1.0]), st.floats(-30.0, 30.0))
turns = st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4).filter(lambda q: max(map(abs, q)) > 0.1)
# On axes and planes, far away, tiny, and anywhere.
coordinates = st.one_of(st.floats(-60.0, 60.0), st.sampled_from([0.0, -0.0, 1.0, -20.0, 5e-324, 1e-9, 1e5]),
                        st.floats(-1e9, 1e9))


@st.composite
def primitives(draw, index, shape):
    """Of these shapes: "plain", "tapered", "bent"."""
    superquadric = {
        "semi_axes": draw(st.lists(lengths, min_size=3, max_size=3)),
        "exponents": draw(st.lists(exponents, min_size=2, max_size=2)),
    }
    if shape == "tapered":
        superquadric["taper"] = draw(st.floats(0.4, 2.5))
    result = {
        "name": f"p{index}",
        "superquadric": superquadric,
        "pose": {"translation": draw(st.lists(places, min_size=3, max_size=3)), "quaternion": draw(turns)},
    }
    if shape == "bent":
        # A bend must not fold the solid: the curvature stays below that of its wider side.
        widest = max(superquadric["semi_axes"][:2])
        result["bend"] = {"curvature": draw(st.floats(0.01, 0.4)) / (2.0 * widest), "angle_deg": draw(places)}
    return result


def model_of(parts, csg=None):
    description = {"format": "verisq-model/1", "units": "mm", "primitives": parts}
    if csg:
        description["csg"] = csg
    return description


@st.composite
def unions(draw):
    """Unions of convex primitives, mostly of one."""
    shapes = draw(st.lists(st.sampled_from(["plain", "tapered"]), min_size=1, max_size=3))
    return model_of([draw(primitives(k, shape)) for k, shape in enumerate(shapes)])


@st.composite
def solids(draw):
    """A bend, or set operations."""
    if draw(st.booleans()):
        return model_of([draw(primitives(0, "bent"))])
    parts = [draw(primitives(k, "plain")) for k in range(2)]
    return model_of(parts, {draw(st.sampled_from(["union", "intersection", "difference"])): ["p0", "p1"]})


def rows_of(width):
    return st.lists(st.lists(coordinates, min_size=width, max_size=width), min_size=ROWS, max_size=ROWS).map(np.array)


class SameAsCommandLine(unittest.TestCase):
    def check(self, files, command, query):
        """`command`: arguments but for -o, DIR for the files' folder; `query(folder)`: the same of the package."""
        with tempfile.TemporaryDirectory() as folder:
            for name, content in files.items():
                path = Path(folder, name)
                path.write_text(json.dumps(content)) if name.endswith(".json") else content(path)
            outcome = run(*(str(each).replace("DIR", folder) for each in command), "-o", Path(folder, "map.npy"))
            if outcome.returncode not in (0, 3):
                with self.assertRaises(verisq.Error) as caught:
                    query(folder)
                said = outcome.stderr.splitlines()[0].removeprefix("verisq: ")
                self.assertEqual(said.replace(folder + "/", ""), str(caught.exception).replace(folder + "/", ""))
                return
            rows = np.load(Path(folder, "map.npy"))
            found = query(folder)
        self.assertEqual(found.lo.tobytes(), np.ascontiguousarray(rows["lo"]).tobytes())
        self.assertEqual(found.hi.tobytes(), np.ascontiguousarray(rows["hi"]).tobytes())
        self.assertEqual(found.status.tobytes(), np.ascontiguousarray(rows["status"]).tobytes())
        self.assertTrue(np.all(found.lo <= found.hi))

    def check_map(self, model, points, tolerance, device):
        options = ["--tol", repr(tolerance)] if tolerance is not None else []
        self.check({"m.json": model, "p.npy": lambda path: np.save(path, points)},
                   ["map", "--model", "DIR/m.json", "--points", "DIR/p.npy", "--device", device, *options],
                   lambda _: verisq.map(verisq.Model.loads(json.dumps(model), "m.json"), points, tolerance=tolerance,
                                        device=device))

    @examples_of(0.5)
    @given(unions(), rows_of(3), st.sampled_from([None, 0.0, 1e-9, 0.1]))
    def test_points(self, model, points, tolerance):
        self.check_map(model, points, tolerance, "host")

    @examples_of(0.1)
    @given(solids(), rows_of(3))
    def test_points_of_bends_and_set_operations(self, model, points):
        # As wide as the solids are: the host searches each point.
        self.check_map(model, points, 5.0, "host")

    @examples_of(0.1)
    @given(st.sampled_from(["plain", "tapered"]).flatmap(lambda shape: primitives(0, shape)), rows_of(3))
    def test_points_on_a_device(self, primitive, points):
        self.check_map(model_of([primitive]), np.tile(points, (200 // ROWS, 1)) * 1.25, 1e-6, "auto")

    @examples_of(0.15)
    @given(unions(), rows_of(9))
    def test_triangles(self, model, corners):
        vertices = corners.reshape(-1, 3)
        faces = np.arange(len(vertices)).reshape(-1, 3)

        def write(path):
            lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
            lines += [" ".join(map(repr, map(float, vertex))) for vertex in vertices]
            lines += ["3 " + " ".join(map(str, face)) for face in faces]
            path.write_text("\n".join(lines) + "\n")

        def query(folder):
            mesh = verisq.Mesh.load(Path(folder, "t.off"))
            return verisq.map_triangles(verisq.Model.loads(json.dumps(model), "m.json"),
                                        mesh.vertices[mesh.triangles], device="host")

        try:
            self.check({"m.json": model, "t.off": write},
                       ["map", "--model", "DIR/m.json", "--mesh", "DIR/t.off", "--on", "triangles", "--device", "host"],
                       query)
        except verisq.Error as error:
            self.fail(f"the package alone refuses: {error}")

    @examples_of(0.15)
    @given(unions(), unions(), rows_of(7))
    def test_pairs(self, a, b, poses):
        poses[:, 3] += np.where(np.all(poses[:, 3:] == 0.0, axis=1), 1.0, 0.0)
        self.check({"a.json": a, "b.json": b, "p.csv": lambda path: np.savetxt(path, poses, "%.17g", ",")},
                   ["distance", "DIR/a.json", "DIR/b.json", "--poses", "DIR/p.csv", "--device", "host"],
                   lambda _: verisq.map_poses(verisq.Model.loads(json.dumps(a), "a.json"),
                                              verisq.Model.loads(json.dumps(b), "b.json"), poses, device="host"))


if __name__ == "__main__":
    unittest.main()
