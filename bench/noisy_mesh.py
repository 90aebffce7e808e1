#!/usr/bin/env python3
"""Moves every vertex of an .off mesh by independent Gaussian noise along each axis: what recoveries are tried on.

noisy_mesh.py IN.off OUT.off DEVIATION [SEED]: the standard deviation of each coordinate, in the mesh's units.
"""
import random
import sys


def main() -> None:
    source, target, deviation = sys.argv[1], sys.argv[2], float(sys.argv[3])
    numbers = random.Random(int(sys.argv[4]) if len(sys.argv) > 4 else 1)
    with open(source, encoding="ascii") as file:
        lines = [line for line in file if not line.startswith("#")]
    vertices = int(lines[1].split()[0])
    with open(target, "w", encoding="ascii") as file:
        file.writelines(lines[:2])
        for line in lines[2 : 2 + vertices]:
            moved = (float(x) + numbers.gauss(0.0, deviation) for x in line.split()[:3])
            file.write(" ".join(repr(x) for x in moved) + "\n")
        file.writelines(lines[2 + vertices :])


if __name__ == "__main__":
    main()
