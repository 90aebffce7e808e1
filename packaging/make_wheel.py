#!/usr/bin/env python3
"""Makes a wheel of the installed Python package, with what it needs: make_wheel.py INSTALLED VERSION FOLDER

INSTALLED is a prefix that `cmake --install BUILD --component python` filled from a build with static libraries. What
every Python on Linux has stays outside (glibc, libstdc++, libgcc); all other libraries come along, under names of their
own, as auditwheel does it, with the licences that Debian has for them. OpenCL is none of them: it is opened at run
time where it is, and device="host" needs none. Needs patchelf and Python's `wheel` (Debian: patchelf python3-wheel).
"""

import hashlib
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile

from wheel.wheelfile import WheelFile

EVERYWHERE = re.compile(r"^(ld-linux.*|lib(c|m|dl|rt|pthread|gcc_s)|libstdc\+\+)\.so")

METADATA = """Metadata-Version: 2.1
Name: verisq
Version: {version}
Summary: Guaranteed distances for whole meshes
License: Apache-2.0
Requires-Python: {python}
Requires-Dist: numpy>=1.21
"""

WHEEL = """Wheel-Version: 1.0
Generator: verisq packaging/make_wheel.py
Root-Is-Purelib: false
Tag: {tag}
"""


def printed(*words: str | pathlib.Path) -> str:
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout


def needed_by(module: pathlib.Path) -> dict[str, pathlib.Path]:
    """All that is loaded with it and does not stay outside, by the names that are asked for."""
    found = {}
    for line in printed("ldd", module).splitlines():
        name, _, place = line.strip().partition(" => ")
        if place and not EVERYWHERE.match(name):
            if place.startswith("not found"):
                raise SystemExit(f"make_wheel.py: {module.name} needs {name}, which is not there")
            found[name] = pathlib.Path(place.split(" (")[0]).resolve()
    return found


def direct_needs(library: pathlib.Path) -> list[str]:
    return re.findall(r"NEEDED.*\[(.*)\]", printed("readelf", "--dynamic", library))


def own_name(name: str, library: pathlib.Path) -> str:
    """That no other package of the same process has, with another version of it."""
    stem, _, rest = name.partition(".so")
    return f"{stem}-{hashlib.sha256(library.read_bytes()).hexdigest()[:8]}.so{rest}"


def bring_along(module: pathlib.Path, libraries: pathlib.Path) -> dict[str, pathlib.Path]:
    needed = needed_by(module)
    names = {name: own_name(name, library) for name, library in needed.items()}
    libraries.mkdir()
    copies = {names[name]: pathlib.Path(shutil.copyfile(library, libraries / names[name]))
              for name, library in needed.items()}
    for name, copy in copies.items():
        copy.chmod(0o755)
        subprocess.run(["patchelf", "--set-soname", name, copy], check=True)
    for file in [module, *copies.values()]:
        rpath = "$ORIGIN" if file.parent == libraries else f"$ORIGIN/../{libraries.name}"
        subprocess.run(["patchelf", "--set-rpath", rpath, file], check=True)
        for name in direct_needs(file):
            if name in names:
                subprocess.run(["patchelf", "--replace-needed", name, names[name], file], check=True)
    return needed


def newest_glibc(files: list[pathlib.Path]) -> tuple[int, int]:
    versions = {(int(a), int(b)) for file in files
                for a, b in re.findall(r"\bGLIBC_(\d+)\.(\d+)", printed("readelf", "--version-info", file))}
    return max(versions)


def add_licences(needed: dict[str, pathlib.Path], folder: pathlib.Path, project: pathlib.Path) -> None:
    """Of the library itself and of what comes along: what Debian's packages say of it."""
    folder.mkdir(parents=True)
    shutil.copyfile(project / "LICENSE", folder / "LICENSE")
    shutil.copyfile(project / "packaging" / "copyright", folder / "copyright")
    for library in needed.values():
        package = printed("dpkg-query", "--search", f"*/{library.name}").split(":")[0]
        shutil.copyfile(f"/usr/share/doc/{package}/copyright", folder / f"copyright.{package}")


def main(installed: pathlib.Path, version: str, output: pathlib.Path) -> None:
    [package] = installed.glob("lib/python3*/*-packages/verisq")
    with tempfile.TemporaryDirectory() as temporary:
        root = pathlib.Path(temporary)
        shutil.copytree(package, root / "verisq", ignore=shutil.ignore_patterns("__pycache__"))
        [module] = (root / "verisq").glob("_verisq*.so")
        needed = bring_along(module, root / "verisq.libs")
        major, minor = newest_glibc([module, *(root / "verisq.libs").iterdir()])
        python = f"cp{sys.version_info[0]}{sys.version_info[1]}"
        machine = sysconfig.get_platform().removeprefix("linux-").replace("-", "_")
        tag = f"{python}-{python}-manylinux_{major}_{minor}_{machine}"
        information = root / f"verisq-{version}.dist-info"
        add_licences(needed, information / "licenses", pathlib.Path(__file__).resolve().parent.parent)
        python_versions = f"=={sys.version_info[0]}.{sys.version_info[1]}.*"
        (information / "METADATA").write_text(METADATA.format(version=version, python=python_versions))
        (information / "WHEEL").write_text(WHEEL.format(tag=tag))
        output.mkdir(parents=True, exist_ok=True)
        path = output / f"verisq-{version}-{tag}.whl"
        with WheelFile(path, "w") as archive:
            archive.write_files(root)
    print(f"{path}: {path.stat().st_size / 1e6:.1f} MB, with {', '.join(sorted(needed)) or 'no library'}")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3]))
