#!/usr/bin/env python3
"""Hashes of what the programs write: has a change of the source changed a byte of an answer?

golden.py BUILD [--write]: BUILD is the folder of `verisq` and `verisq-check`. Runs

  * every answer of `./run certify`, its check, and both as JSON;
  * the commands of docs/commands.md as printed;
  * `--help` of every command;
  * requests that are refused, for their messages and exit statuses;

and compares the hash of each output with tests/golden/hashes.txt, which --write writes instead. The outputs stay in
build/golden, those of the run before in build/golden.before: `diff -r` shows what changed. Times, rates and names of
devices are left out. The host makes maps and octrees. A device makes fits, ways in and meshes: the host takes minutes.
"""
import argparse
import hashlib
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import time

root = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(root / "bench"))
import certified_answers  # noqa: E402

hashes_file = root / "tests/golden/hashes.txt"
left_out = ("device", "notice")  # and all keys that end like these:
times = ("seconds", "per_second")
on_devices = ("fit", "insert", "mesh")

refused_requests = [
    "", "mapp", "map", "map --model", "map --model none.json --mesh examples/cavity.off",
    "map --model examples/stem.json --mesh none.stl", "map --model examples/stem.json --mesh examples/stem.json",
    "map --model examples/cavity.off --mesh examples/cavity.off",
    "map --model examples/stem.json --mesh examples/cavity.off --tol -1",
    "map --model examples/stem.json --mesh examples/cavity.off --tol nan",
    "map --model examples/stem.json --mesh examples/cavity.off -o map.txt",
    "map --model examples/stem.json --mesh examples/cavity.off --device nowhere",
    "map --model examples/stem.json --mesh examples/cavity.off --part 3/2",
    "map --model examples/stem.json --mesh examples/cavity.off --certificates -o map.npy",
    "check", "check --model examples/stem.json --map examples/path.csv --mesh examples/cavity.off",
    "check --certificate examples/stem.json", "distance examples/stem.json",
    "distance examples/stem.json examples/stem.json --pose 1,2,3",
    "distance examples/stem.json examples/stem.json --pose 0,0,0,0,0,0,0",
    "path examples/capsule.json examples/soap.json", "octree --model examples/stem.json --depth 99 -o tree.vtu",
    "mesh --model examples/stem_mm.json --deviation 0 -o stem.stl", "fit --implant examples/stem_mm.json -o f.json",
    "fit --implant examples/stem_mm.json --mesh examples/cavity.off -o f.json --bound -5",
    "insert --implant examples/stem_mm.json --mesh examples/cavity.off --along 0,0,0 --length 60",
    "features", "features --landmarks examples/stem.json", "stance examples/stem.json",
    "stance examples/standing.xml --uncertain nothing", "recover --mesh examples/cavity.off --primitives 0 -o m.json",
    "deviation --model examples/stem_mm.json", "merge examples/path.csv examples/path.csv -o whole.csv",
    "batch examples/stem.json -o folder", "surface", "help nothing",
]


def without_times(value: object) -> object:
    if isinstance(value, dict):
        return {key: without_times(inner) for key, inner in value.items()
                if key not in left_out and not key.endswith(times)}
    if isinstance(value, list):
        return [without_times(inner) for inner in value]
    return value


def comparable(text: str) -> str:
    """What a program printed, without what differs from run to run."""
    if text.startswith("{"):
        try:
            return json.dumps(without_times(json.loads(text)), indent=1)
        except json.JSONDecodeError:
            pass
    text = re.sub(r"[0-9.]+(e[-+][0-9]+)?[kMG]? (s|ms|us|min|[a-z]+/s)\b", r"# \2", text)
    return re.sub(r"(?m)^(device  +).*$", r"\1#", text)


class Run:
    """Runs the programs in a folder that looks as README's reader has it."""

    def __init__(self, build: pathlib.Path, folder: pathlib.Path):
        self.build = build
        self.folder = folder
        (folder / "build/demo").mkdir(parents=True)
        (folder / "build/release").symlink_to(build)
        (folder / "examples").symlink_to(root / "examples")
        # The demo's bone comes from the network: the cavity stands in for it.
        shutil.copy(root / "examples/cavity.off", folder / "build/demo/femur.off")
        shutil.copy(root / "examples/cavity.off", folder / "build/demo/femur_mm.off")

    def printed(self, name: str, program: str, arguments: list[str]) -> None:
        """Keeps what the program prints as NAME.out, and what it says beside that, with its exit status, as NAME.err."""
        began = time.monotonic()
        run = subprocess.run([str(self.build / program), *arguments], cwd=self.folder, capture_output=True, text=True,
                             check=False)
        print(f"golden: {time.monotonic() - began:5.1f} s  {name}  {shlex.join(arguments)[:80]}", file=sys.stderr)
        (self.folder / f"{name}.out").write_text(comparable(run.stdout), encoding="utf-8")
        said = comparable(run.stderr) + f"exit status {run.returncode}\n"
        (self.folder / f"{name}.err").write_text(said, encoding="utf-8")


def on_host(arguments: list[str]) -> list[str]:
    """The arguments of `verisq`, with the host as device unless the command takes none or is one of `on_devices`."""
    named = certified_answers.takes_device(arguments) and arguments[0] not in on_devices
    return [*arguments, "--device", "host"] if named else arguments


def certified(run: Run) -> None:
    os.chdir(run.folder)
    certified_answers.examples = pathlib.Path("examples")  # the same names wherever the checkout lies
    certified_answers.write_inputs()
    for i, answer in enumerate(certified_answers.answers_of_examples()):
        name = f"answer_{i:02}"
        run.printed(f"{name}_found", "verisq", [*on_host(answer.find), "--json"])
        run.printed(f"{name}_proved", "verisq-check", [*answer.check, "--json"])
        run.printed(f"{name}_proved_in_words", "verisq-check", answer.check)


def commands_of_document(run: Run) -> None:
    text = (root / "docs/commands.md").read_text(encoding="utf-8").replace("\\\n", "")
    commands = re.findall(r"(?m)^build/release/(.*)$", text)
    for i, command in enumerate(commands):
        program, *arguments = shlex.split(command)
        run.printed(f"command_{i:02}", program, on_host(arguments) if program == "verisq" else arguments)


def help_texts(run: Run) -> None:
    run.printed("help", "verisq", ["--help"])
    run.printed("help_of_check_program", "verisq-check", ["--help"])
    text = (run.folder / "help.out").read_text(encoding="utf-8")
    for command in re.findall(r"(?m)^  ([a-z]+) +[A-Z]", text):
        run.printed(f"help_of_{command}", "verisq", [command, "--help"])


def refusals(run: Run) -> None:
    for i, request in enumerate(refused_requests):
        run.printed(f"refused_{i:02}", "verisq", shlex.split(request))


def digest(path: pathlib.Path) -> str:
    data = path.read_bytes()
    if path.suffix in (".html", ".svg") or path.name.endswith(".part.json"):
        data = comparable(data.decode("utf-8")).encode("utf-8")
    return hashlib.sha256(data).hexdigest()[:32]


def hashes_below(folder: pathlib.Path) -> dict[str, str]:
    # A record of a batch counts its seconds.
    files = [path for path in sorted(folder.rglob("*")) if path.is_file() and "cohort" not in path.parts and
             not path.is_symlink()]
    return {str(path.relative_to(folder)): digest(path) for path in files}


def remembered_hashes() -> dict[str, str]:
    lines = hashes_file.read_text(encoding="utf-8").splitlines()
    return {name: hash_ for hash_, name in (line.split("  ", 1) for line in lines)}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--write", action="store_true", help="write the hashes instead")
    arguments = parser.parse_args()
    folder, before = root / "build/golden", root / "build/golden.before"
    if folder.exists():
        shutil.rmtree(before, ignore_errors=True)
        folder.rename(before)
    run = Run(arguments.build.resolve(), folder)
    for part in (help_texts, refusals, commands_of_document, certified):
        part(run)
    found = hashes_below(folder)
    if arguments.write:
        hashes_file.write_text("".join(f"{hash_}  {name}\n" for name, hash_ in found.items()), encoding="utf-8")
        print(f"{len(found)} hashes written to {hashes_file.relative_to(root)}")
        return 0
    known = remembered_hashes()
    differing = sorted(name for name in known.keys() | found.keys() if known.get(name) != found.get(name))
    for name in differing:
        what = "is new" if name not in known else "is missing" if name not in found else "differs"
        print(f"build/golden/{name} {what}")
    print(f"{len(known.keys() | found.keys()) - len(differing)} of {len(known)} outputs are as before")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
