#!/usr/bin/env python3
"""Counts what the demo's program costs to build: build_cost.py BUILD_FOLDER [--write], where it is built

The counts do not depend on noise. They are compared with .ci/build_cost.csv:

  lines           preprocessed lines that the compiler reads: of each source beyond its precompiled header, and of each
                  precompiled header once
  instantiations  functions that more than one object may hold (templates and inline functions), as compiled

Fails where a count is more than 1.2 times its bar. Seconds, by ninja's log of the last compilation of each object, are
printed and not judged. With --write the counts become the bars.
"""

import argparse
import csv
import json
import os
import pathlib
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

PROGRAM = "demo/verisq"
BARS = pathlib.Path(__file__).with_name("build_cost.csv")
MOST = 1.2


def output_of(command: list[str], folder: pathlib.Path) -> str:
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout


def lines_read(command: list[str], folder: pathlib.Path) -> int:
    """Counts the lines of one preprocessed source, without those that only say where others come from."""
    words = [word for word in command if word != "ccache"]
    words[words.index("-o"):words.index("-o") + 2] = []
    text = output_of([*words, "-E", "-P"], folder)
    return text.count("\n")


def header_of(command: list[str]) -> str | None:
    """The precompiled header that a source begins with."""
    return next((after for word, after in zip(command, command[1:])
                 if word == "-include" and after.endswith("cmake_pch.hxx")), None)


def lines_of(commands: list[list[str]], folder: pathlib.Path) -> int:
    headers = {header: command for command in commands if (header := header_of(command))}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        # The command of a source that begins with the header, with an empty file in place of the source.
        of_headers = dict(zip(headers, pool.map(
            lambda command: lines_read([*command[:-1], "/dev/null"], folder), headers.values())))
        of_sources = pool.map(lambda command: lines_read(command, folder), commands)
        return sum(of_headers.values()) + sum(
            lines - of_headers.get(header_of(command), 0) for command, lines in zip(commands, of_sources))


def instantiations(objects: list[str], folder: pathlib.Path) -> int:
    symbols = output_of(["nm", "--defined-only", "--no-sort", *objects], folder)
    return sum(1 for line in symbols.splitlines() if " W " in line)


def seconds(objects: set[str], folder: pathlib.Path) -> float:
    last = {}
    for line in (folder / ".ninja_log").read_text().splitlines()[1:]:
        begin, end, _, output, _ = line.split("\t")
        last[output] = int(end) - int(begin)
    return sum(last.get(name, 0) for name in objects) / 1000


def counts(folder: pathlib.Path) -> dict[str, int]:
    inputs = set(output_of(["ninja", "-t", "inputs", PROGRAM], folder).splitlines())
    objects = sorted(name for name in inputs if name.endswith(".o"))
    commands = [shlex.split(entry["command"]) for entry in json.loads((folder / "compile_commands.json").read_text())]
    commands = [command for command in commands if command[command.index("-o") + 1] in inputs]
    print(f"{len(objects)} objects, compiled in {seconds(set(objects), folder):.0f} s, one after the other")
    return {"lines": lines_of(commands, folder), "instantiations": instantiations(objects, folder)}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    found = counts(arguments.folder)
    if arguments.write:
        with BARS.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([("count", "bar"), *found.items()])
    with BARS.open(newline="") as file:
        bars = {row["count"]: int(row["bar"]) for row in csv.DictReader(file)}
    for name, count in found.items():
        print(f"{name:<16} {count:>9}   bar {bars[name]:>9}   {count / bars[name]:.2f} of at most {MOST}")
    return 1 if any(count > MOST * bars[name] for name, count in found.items()) else 0


if __name__ == "__main__":
    sys.exit(main())
