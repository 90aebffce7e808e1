"""The programs and files that tests compare the package with."""

import os
import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np

PROGRAM = os.environ["VERISQ_PROGRAM"]
SOURCE = Path(os.environ["VERISQ_SOURCE"])
EXAMPLES = SOURCE / "examples"


def run(*arguments):
    """What `verisq` says to these arguments: status, standard output, standard error."""
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)


def map_of_points(model, points, *options):
    """lo, hi, status as `verisq map` writes them into a .npy."""
    with tempfile.TemporaryDirectory() as folder:
        given = Path(folder, "points.npy")
        rows = Path(folder, "map.npy")
        np.save(given, points)
        outcome = run("map", "--model", model, "--points", given, "-o", rows, *options)
        assert outcome.returncode in (0, 3), outcome.stderr
        return np.load(rows)


def message(*arguments):
    """The line with which `verisq` refuses, with options called as the library calls them: `any_side`."""
    outcome = run(*arguments)
    assert outcome.returncode in (1, 2), outcome
    line = outcome.stderr.splitlines()[0].removeprefix("verisq: ")
    return re.sub("--([a-z]+(?:-[a-z]+)*)", lambda option: "`" + option[1].replace("-", "_") + "`", line)
