#!/usr/bin/env python3
"""Every kind of answer that has a certificate, of the examples: asked for, written, and proved again.

certified_answers.py BUILD [--device DEVICE] [--only TEXT]: BUILD is the folder of `verisq` and `verisq-check`. Prints a
line an answer, in Markdown: how long it took to find and to prove again, and how large the certificate is. Exit status
1 where one is not proved. The device finds; `verisq-check` knows of none.
"""
import argparse
import dataclasses
import os
import pathlib
import random
import resource
import subprocess
import sys
import tempfile

examples = pathlib.Path(__file__).resolve().parent.parent / "examples"
interrupted = (129, 130, 143)


@dataclasses.dataclass
class Answer:
    """`find` and `check` are arguments of `verisq` and `verisq-check`; `proof` are the files that prove the answer."""

    what: str
    find: list[str]
    check: list[str]
    proof: list[str]


def example(name: str) -> str:
    return str(examples / name)


def map_of(what: str, model: str, subject: list[str], file: str, more: tuple[str, ...] = ()) -> Answer:
    subject = ["--model", example(model), *subject]
    on = ["--on", "triangles"] if file.endswith(".vtp") else []
    return Answer(what, ["map", *subject, *on, *more, "--certificates", "-o", file], [*subject, "--map", file], [file])


def certified(what: str, find: list[str], check: list[str], certificate: str) -> Answer:
    return Answer(what, [*find, "--certificate-file", certificate], ["--certificate", certificate, *check],
                  [certificate])


def maps() -> list[Answer]:
    cavity = ["--mesh", example("cavity.off")]
    scattered = ["--points", "scattered.xyz"]
    about = ["--points", "about.xyz"]
    return [
        map_of("vertices about a union", "stem_mm.json", cavity, "union.csv"),
        map_of("triangles about it", "stem_mm.json", cavity, "union.vtp"),
        map_of("vertices about a tapered union", "tapered_stem.json", cavity, "tapered.csv"),
        map_of("points about a bent union", "bent_tapered_stem.json", about, "bent.csv", ("--tol", "1e-3")),
        map_of("points about a difference with a bend", "bent_stem.json", scattered, "csg.csv", ("--tol", "1e-4")),
        map_of("points in and about overlaps", "stem.json", scattered, "overlaps.csv", ("--tol", "1e-4")),
        map_of("points about a model of intervals", "uncertain_stem.json", scattered, "uncertain.csv",
               ("--tol", "0.1")),
    ]


def pairs() -> list[Answer]:
    capsule, soap = example("capsule.json"), example("soap.json")
    bent = example("bent_stem.json")
    both = ["--model", capsule, "--model", soap]
    path = ["--poses", example("path.csv")]
    return [
        certified("distance of two bent models", ["distance", bent, bent, "--pose", "0.2,0.05,0,1,0.2,0.1,0.05"],
                  ["--model", bent, "--model", bent], "distance.json"),
        certified("distances in many poses", ["distance", capsule, soap, "--poses", "poses.csv", "-o", "poses.npy"],
                  [*both, "--poses", "poses.csv"], "poses.json"),
        certified("smallest distance along a path", ["path", capsule, soap, *path], [*both, *path], "path.json"),
    ]


def octrees() -> list[Answer]:
    return [Answer(f"octree and volume of {name}",
                   ["octree", "--model", example(f"{name}.json"), "--depth", "6", "-o", f"{name}.vtu"],
                   ["--model", example(f"{name}.json"), "--octree", f"{name}.vtu"], [f"{name}.vtu"])
            for name in ("stem", "bent_stem", "bent_tapered_stem")]


def plans() -> list[Answer]:
    stem, cavity, landmarks = example("stem_mm.json"), example("cavity.off"), example("femur_landmarks.json")
    fitted = ["--model", "fitted.json", "--mesh", cavity]
    fit = ["fit", "--implant", stem, "--mesh", cavity, "--cavity", "--completion", "cemented", "--pose-start",
           "8,-5,10,0.99,0.08,-0.06,0.1", "-o", "fitted.json", "--map", "fit.csv", "--surface-map", "fit.vtp",
           "--landmarks", landmarks]
    insertion = ["insert", "--implant", stem, "--mesh", cavity, "--along", "0,0,-1", "--length", "60"]
    of_stem = ["--model", stem, "--mesh", cavity]
    walls = ["--mesh", cavity, "--within", "bone.off", "--cavity"]
    return [
        Answer("a fit: distances, F, areas, sides", [*fit, "--certificate-file", "fit.json"],
               [*fitted, "--certificate", "fit.json", "--map", "fit.csv", "--surface-map", "fit.vtp"],
               ["fit.json", "fit.csv", "fit.vtp"]),
        Answer("… how much is in contact", [*fit, "--implant-contact", "--contact-certificate-file", "contact.json"],
               [*fitted, "--certificate", "contact.json"], ["contact.json"]),
        Answer("… that no pose is better by 5 %",
               [*fit[:8], "--translation-range", "5", "--rotation-range", "5", "--samples", "64", "-o", "bound.json",
                "--bound", "5", "--bound-certificate-file", "bound_certificate.json"],
               ["--model", stem, "--mesh", cavity, "--certificate", "bound_certificate.json"],
               ["bound_certificate.json"]),
        certified("… what it changes of the femur",
                  ["features", "--landmarks", landmarks, "--landmark-radius", "1", "--implant", "fitted.json"], [],
                  "changes.json"),
        certified("a way in: distances, of the whole surface, too", [*insertion, "--on", "triangles", "-o", "way.csv"],
                  of_stem, "way.json"),
        certified("… and what is removed of the bone", [*insertion, *walls[2:], "-o", "removed.csv"],
                  ["--model", stem, *walls[:4]], "removed.json"),
        certified("mesh and model, both ways", ["deviation", *of_stem], of_stem, "deviation.json"),
        certified("… mean and percentiles of the model, too",
                  ["deviation", *of_stem, "--statistics-of-model", "--tol", "20%"], of_stem, "statistics.json"),
        certified("a femur's features", ["features", "--landmarks", landmarks, "--landmark-radius", "1"], [],
                  "features.json"),
        certified("where a body stands",
                  ["stance", example("standing.xml"), "--uncertain", "mp,px", "--within", "1", "--equilibrium", "held"],
                  ["--model", example("standing.xml")], "standing.json"),
        certified("a hull around a mesh",
                  ["recover", "--mesh", "bone.off", "--primitives", "2", "--outside", "--no-proof", "-o", "hull.json"],
                  ["--model", "hull.json", "--mesh", "bone.off"], "containment.json"),
    ]


def answers_of_examples() -> list[Answer]:
    return maps() + pairs() + octrees() + plans()


def takes_device(find: list[str]) -> bool:
    """Whether these arguments of `verisq` may be followed by --device."""
    if find[0] == "distance":
        return "--poses" in find
    return find[0] not in ("batch", "merge", "path", "stance", "surface")


def write_points(name: str, count: int, low: list[float], high: list[float]) -> None:
    numbers = random.Random(1)
    with open(name, "w", encoding="ascii") as file:
        for _ in range(count):
            file.write(",".join(repr(numbers.uniform(a, b)) for a, b in zip(low, high)) + "\n")


def write_poses(name: str, count: int) -> None:
    numbers = random.Random(2)
    with open(name, "w", encoding="ascii") as file:
        file.write("tx,ty,tz,qw,qx,qy,qz\n")
        for _ in range(count):
            file.write(",".join(repr(numbers.uniform(-6, 6)) for _ in range(3)) + ",")
            file.write(",".join(repr(numbers.gauss(0, 1)) for _ in range(4)) + "\n")


def write_box(name: str, low: list[float], high: list[float]) -> None:
    """The surface of a box, its normals outward."""
    corners = [[(low, high)[i >> axis & 1][axis] for axis in range(3)] for i in range(8)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    with open(name, "w", encoding="ascii") as file:
        file.write("OFF\n8 12 0\n")
        file.writelines(" ".join(map(repr, corner)) + "\n" for corner in corners)
        file.writelines(f"3 {a} {b} {c}\n3 {a} {c} {d}\n" for a, b, c, d in faces)


def write_inputs() -> None:
    write_points("scattered.xyz", 300, [-0.2, -0.2, -0.5], [0.2, 0.2, 0.35])
    write_points("about.xyz", 2000, [-60.0, -60.0, -100.0], [60.0, 60.0, 100.0])
    write_poses("poses.csv", 1000)
    write_box("bone.off", [60.0, -40.0, -245.0], [155.0, 40.0, -45.0])


def seconds(command: list[str]) -> tuple[int, float]:
    """Of all threads' processor time. What the program says is shown where it fails."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if run.returncode < 0 or run.returncode in interrupted:
        sys.exit(f"interrupted: {' '.join(command)}")
    if run.returncode in (1, 2):
        print(" ".join(command), run.stdout, run.stderr, sep="\n", file=sys.stderr)
    return run.returncode, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def is_proved(answer: Answer, build: pathlib.Path, device: list[str]) -> bool:
    status, to_find = seconds([str(build / "verisq"), *answer.find, *(device if takes_device(answer.find) else [])])
    if status not in (0, 3):
        return False
    status, to_prove = seconds([str(build / "verisq-check"), *answer.check])
    size = sum(os.path.getsize(name) for name in answer.proof) / 1e3
    verdict = "proved" if status == 0 else f"NOT PROVED, status {status}"
    print(f"| {answer.what} | {verdict} | {to_find:.2f} s | {to_prove:.2f} s | {size:.1f} kB |", flush=True)
    return status == 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--device", help="as verisq names it (default: what it chooses)")
    parser.add_argument("--only", default="", help="answers whose name contains this text")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    device = ["--device", arguments.device] if arguments.device else []
    print("| answer | verdict | found in | proved again in | certificate |\n|---|---|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as scratch:
        os.chdir(scratch)
        write_inputs()
        answers = [each for each in answers_of_examples() if arguments.only in each.what]
        proved = [is_proved(each, build, device) for each in answers]
        os.chdir("/")
    print(f"\n{sum(proved)} of {len(proved)} answers proved again")
    return 0 if proved and all(proved) else 1


if __name__ == "__main__":
    sys.exit(main())
