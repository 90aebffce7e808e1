#!/usr/bin/env python3
"""The shared libraries, and what they export: shared_libraries_test.py FOLDER COMPILER SCRIPT OUTPUT

Where FOLDER holds archives, they are linked here as BUILD_SHARED_LIBS links them, of the same objects: that each finds
what it needs in those before it is a part of the test.
"""

import functools
import pathlib
import re
import subprocess
import sys
import unittest

ORDER = ["proposals", "proof", "verify", "readers", "writers", "core", "map_readers", "files", "plan", "report", "stance"]
CORE = ORDER[:6]
SYSTEM = {
    "proposals": [], "proof": ["fmt"], "verify": ["fmt"], "readers": ["fmt", "z"], "writers": ["fmt"], "core": ["fmt", "dl"],
    "map_readers": ["fmt", "pugixml"], "files": ["fmt", "pugixml", "z"], "plan": ["fmt", "nlopt", "dl"],
    "report": ["fmt", "cairo"], "stance": ["fmt"],
}

folder, compiler, script, output = sys.argv[1:5]


def path_of(library: str) -> pathlib.Path:
    built = pathlib.Path(folder) / f"libverisq_{library}.so"
    return built if built.exists() else pathlib.Path(output) / f"libverisq_{library}.so"


def link(library: str) -> None:
    if path_of(library).exists() and path_of(library).parent == pathlib.Path(folder):
        return
    siblings = [f"-lverisq_{other}" for other in ORDER[: ORDER.index(library)]]
    hidden = [f"{folder}/libverisq_opencl.a"] if library in ("core", "plan") else []
    system = [f"-l{name}" for name in [*SYSTEM[library], "mpfr", "gmp"]]
    subprocess.run(
        [compiler, "-shared", "-pthread", "-o", str(path_of(library)), f"-Wl,--version-script={script}",
         "-Wl,--no-undefined,--as-needed", "-Wl,-rpath,$ORIGIN", f"-Wl,-soname,libverisq_{library}.so",
         "-Wl,--whole-archive", f"{folder}/libverisq_{library}.a", "-Wl,--no-whole-archive", f"-L{output}",
         *hidden, *siblings, *system],
        check=True)


@functools.cache
def exports(library: str) -> list[tuple[str, str]]:
    """Mangled names with the versions that they have."""
    lines = subprocess.run(["nm", "-D", "--defined-only", str(path_of(library))], capture_output=True, text=True,
                           check=True).stdout.splitlines()
    names = [line.split()[-1] for line in lines if line.split()[-2] != "A"]
    return [(name.partition("@@")[0], name.partition("@@")[2]) for name in names]


class SharedLibrariesTest(unittest.TestCase):
    def test_export_no_name_of_others(self) -> None:
        ours = re.compile(r"^(_Z(T[ISVh]?|GV|Z)?[\d_]*(T\w+_)?Z?(N[KR]*)6verisq|verisq_[a-z])")
        for library in ORDER:
            with self.subTest(library):
                found = exports(library)
                self.assertTrue(found)
                self.assertEqual([name for name, _ in found if not ours.match(name)], [])

    def test_tell_public_names_from_private_ones(self) -> None:
        namespaces = "verify|device|stance|fit_search|recovery|tessellation|report|features|kernels"
        nested = re.compile(rf"^_ZN[KR]*6verisq\d+({namespaces})\d")
        for library in ORDER:
            versions = {name: version for name, version in exports(library)}
            with self.subTest(library):
                self.assertLessEqual(set(versions.values()), {"VERISQ_0.1", "VERISQ_PRIVATE_0.1"})
                public = [name for name, version in versions.items() if version == "VERISQ_0.1"]
                self.assertEqual([name for name in public if nested.match(name)], [])
        core = dict(exports("core"))
        self.assertEqual(core["verisq_map_points"], "VERISQ_0.1")
        mapper = [name for name in core if name.startswith("_ZN6verisq6MapperI")]
        self.assertTrue(mapper)
        self.assertEqual({core[name] for name in mapper}, {"VERISQ_0.1"})
        verify = dict(exports("verify"))
        self.assertTrue(any(name.startswith("_ZN6verisq6verify") for name in verify))
        self.assertEqual({verify[name] for name in verify if nested.match(name)}, {"VERISQ_PRIVATE_0.1"})

    def test_core_needs_neither_xml_nor_nlopt_nor_cairo(self) -> None:
        for library in CORE:
            dynamic = subprocess.run(["readelf", "-d", str(path_of(library))], capture_output=True, text=True,
                                     check=True).stdout
            self.assertIn("NEEDED", dynamic)
            self.assertNotRegex(dynamic, "NEEDED.*(cairo|nlopt|pugixml|OpenCL)")


if __name__ == "__main__":
    pathlib.Path(output).mkdir(parents=True, exist_ok=True)
    for each in ORDER:
        link(each)
    unittest.main(argv=sys.argv[:1])
