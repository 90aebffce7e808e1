"""The examples and the tutorial do what they say, and README shows one of them as it is."""

import importlib.util
import inspect
import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import verisq

from command_line import EXAMPLES, SOURCE


def output(name, *arguments):
    command = [sys.executable, "-B", EXAMPLES / "python" / name, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True, cwd=SOURCE).stdout


class Examples(unittest.TestCase):
    def test_clearance(self):
        # Every vertex is 2 mm away, to the rounding of its decimals.
        lines = output("clearance.py", EXAMPLES / "stem_mm.json", EXAMPLES / "cavity.off", "2.001").splitlines()
        self.assertEqual(lines[0], "786 vertices, of which 0 have a wide enclosure")
        self.assertEqual(lines[1], "within 2.001 mm: 786 proven, 0 undecided")
        self.assertEqual(lines[2], "beyond: 0 proven")
        self.assertRegex(lines[3],
                         r"^no vertex is nearer than 1\.99999\d+ mm; vertex \d+ is at most (2\.00000|1\.99999)")

    @unittest.skipUnless(importlib.util.find_spec("scipy"), "SciPy is not installed: optimise_pose.py is NOT tested")
    def test_optimise_pose(self):
        first, last = output("optimise_pose.py", EXAMPLES / "stem_mm.json", EXAMPLES / "cavity.off", "2",
                             "8,-5,10,0.99,0.08,-0.06,0.1").splitlines()
        self.assertEqual(first, "at the start distances are off 2 by 44.9 (root mean square)")
        self.assertLess(float(re.search(r"off by (\S+) at most", last)[1]), 1e-7)

    def test_readme_shows_the_first(self):
        lines = (EXAMPLES / "python" / "first_map.py").read_text()
        self.assertIn(f"```python\n{lines}```\n\n```text\n{output('first_map.py')}```\n", (SOURCE / "README.md").read_text())

    def test_tutorial_prints_what_it_says(self):
        text = (SOURCE / "docs" / "tutorial.md").read_text()
        lines, printed = re.search(r"```python\n(.*?)```\n\n```text\n(.*?)```\n", text, re.DOTALL).groups()
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "examples").symlink_to(EXAMPLES)
            stem = verisq.Model.load(EXAMPLES / "stem_mm.json")
            verisq.mesh_of_model(stem, deviation=0.2).save(Path(folder, "implant.stl"))
            run = subprocess.run([sys.executable, "-B", "-c", lines], capture_output=True, text=True, check=True, cwd=folder)
        self.assertEqual(run.stdout, printed)

    @unittest.skipUnless(importlib.util.find_spec("meshio"), "meshio is not there")
    def test_bone_for_paraview(self):
        import meshio

        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder, "bone.vtu")
            lines = output("bone_for_paraview.py", EXAMPLES / "stem_mm.json", EXAMPLES / "cavity.off", out,
                           "2.0001").splitlines()
            written = meshio.read(out)
            self.assertEqual((Path(folder, "bone_within.vtp").exists(), len(lines)),
                             (True, 2) if importlib.util.find_spec("vtkmodules") else (False, 1))
        self.assertEqual(lines[0], "bone.vtu: 786 vertices within 2.0001 mm, 0 undecided")
        self.assertEqual(lines[1:], [f"bone_within.vtp: {len(written.cells[0].data)} triangles"][: len(lines) - 1])
        found = verisq.map(verisq.Model.load(EXAMPLES / "stem_mm.json"), written.points)
        np.testing.assert_array_equal(written.point_data["lo"], found.lo)

    @unittest.skipUnless(importlib.util.find_spec("distributed"), "dask is not installed: its example is NOT tested")
    def test_cohort_with_dask(self):
        names = [EXAMPLES / "stem_mm.json", EXAMPLES / "tapered_stem.json"]
        lines = output("cohort_with_dask.py", EXAMPLES / "cavity.off", *names).splitlines()
        bone = verisq.Mesh.load(EXAMPLES / "cavity.off").vertices
        least = []
        for name in names:
            for x, y in [(x, y) for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0)]:
                rows = verisq.map(verisq.Model.load(name).posed([x, y, 0, 1, 0, 0, 0]), bone, device="host")
                least.append(float(rows.lo.min()))
                answer = f"{name} at {[x, y, 0.0]}: the nearest vertex is between {least[-1]} and {float(rows.hi.min())} away"
                self.assertIn(answer, lines)
        self.assertEqual(lines[-1], f"18 of 18 cases; nothing is nearer than {min(least)}")

    def test_robot_clearance(self):
        lines = output("robot_clearance.py", "60").splitlines()
        self.assertRegex(lines[-2], r"^\d+ of 61 poses are proven free, with all between them$")
        self.assertRegex(lines[-1], r"^from the start the way is proven free up to pose [1-5]\d$")

    def test_notebook(self):
        cells = json.loads((EXAMPLES / "python" / "tour.ipynb").read_text())["cells"]
        self.assertTrue(all(cell.get("outputs", []) == [] for cell in cells))
        code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        code.append("print(float(near.lo.min()), cubes.volume.hi > 1000)")
        program = subprocess.run([sys.executable, "-B", "-c", "\n".join(code)], capture_output=True, text=True,
                                 check=True, cwd=SOURCE)
        self.assertRegex(program.stdout.splitlines()[-1], r"^-\d+\.\d+ True$")


class Documentation(unittest.TestCase):
    def test_commands_have_names_in_python(self):
        # A fit, an octree and a deviation: the tests of the commands beside them take that time already.
        lines = re.findall(r"```python\n(.*?)```", (SOURCE / "docs" / "commands.md").read_text(), re.DOTALL)[0]
        compile(lines, "commands.md", "exec")
        called = re.findall(r"verisq\.(\w+(?:\.\w+)?)\(", lines)
        self.assertGreater(len(called), 8)
        for name in called:
            thing = verisq
            for part in name.split("."):
                thing = getattr(thing, part)
            for argument in re.findall(rf"verisq\.{name}\([^()]*?(\w+)=", lines):
                self.assertRegex(inspect.getdoc(thing), rf"\b{argument}\b")

    def test_everything_public_explains_itself(self):
        for name in verisq.__all__:
            if name == "__version__":
                continue
            thing = getattr(verisq, name)
            self.assertTrue(inspect.getdoc(thing), name)
            self.assertIn(f"`{name}", (SOURCE / "docs" / "python.md").read_text())

    def test_stubs_declare_what_there_is(self):
        stubs = (SOURCE / "python" / "verisq" / "_verisq.pyi").read_text()
        for name in verisq.__all__:
            thing = getattr(verisq, name)
            if name in ("CubeColour", "Status", "Verdict", "map_chunks"):
                continue
            declared = "class " if inspect.isclass(thing) else "def "
            self.assertIn(f"{name}:" if name == "__version__" else declared + name, stubs)
            if not inspect.isclass(thing):
                continue
            body = re.split(rf"class {name}\b", stubs)[1].split("\n\nclass ")[0]
            for member in vars(thing):
                if not member.startswith("_"):
                    self.assertRegex(body, rf"\b{member}\b", f"{name}.{member}")


if __name__ == "__main__":
    unittest.main()
