#!/usr/bin/env python3
"""How far a mesh and a model's surface lie apart by dense samples both ways: what `verisq deviation` must contain.

sampled_deviation.py MODEL.json MESH.stl [--step LENGTH] [--tol SHARE]: a floating-point estimate by NumPy and SciPy
that shares nothing with verisq, beside the proven enclosures of `verisq deviation --json` (the program that VERISQ
names, default build/release/verisq). Exit status 1 where one does not contain its estimate, or is wider than --tol of
its upper end (default 0.05).

The model is a union of primitives with tapers and bends; the mesh .stl (binary) or .off.
"""
import argparse
import json
import os
import subprocess
import sys

import numpy as np
from scipy.spatial import cKDTree

at_one_point = ("largest, mesh to model", "largest, model to mesh", "Hausdorff")
error_of_shares = 2e-3  # of means and percentiles by finitely many samples, about


def read_triangles(name: str) -> np.ndarray:
    """(N, 3, 3)."""
    if name.endswith(".stl"):
        record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
        return np.fromfile(name, dtype=record, offset=84)["corners"].astype(float)
    with open(name, encoding="ascii") as file:
        words = [line for line in file if line.strip() and not line.startswith("#")]
    vertices, faces = (int(word) for word in words[1].split()[:2])
    points = np.array([line.split()[:3] for line in words[2 : 2 + vertices]], dtype=float)
    return points[np.array([line.split()[1:4] for line in words[2 + vertices : 2 + vertices + faces]], dtype=int)]


class Primitive:
    """One posed superquadric, in and out of its own frame."""

    def __init__(self, description: dict) -> None:
        shape = description["superquadric"]
        self.axes = np.array(shape["semi_axes"], dtype=float)
        self.exponents = shape["exponents"]
        ends = shape.get("taper", 1.0)
        self.slope = (ends - 1) / (ends + 1)
        bend = description.get("bend", {})
        self.curvature = bend.get("curvature", 0.0)
        self.angle = np.radians(bend.get("angle_deg", 0.0))
        pose = description.get("pose", {})
        self.translation = np.array(pose.get("translation", [0, 0, 0]), dtype=float)
        w, x, y, z = np.array(pose.get("quaternion", [1, 0, 0, 0]), dtype=float)
        n = w * w + x * x + y * y + z * z
        self.rotation = np.eye(3) + 2 / n * np.array(
            [[-y * y - z * z, x * y - w * z, x * z + w * y],
             [x * y + w * z, -x * x - z * z, y * z - w * x],
             [x * z - w * y, y * z + w * x, -x * x - y * y]])

    def placed(self, unit: np.ndarray) -> np.ndarray:
        """Where taper, bend and pose take points given in semi-axes."""
        height = (unit[:, 2] - self.slope) / (1 - self.slope * unit[:, 2])
        scale = 1 + self.slope * height
        x, y, z = (np.column_stack([scale * unit[:, 0], scale * unit[:, 1], height]) * self.axes).T
        if self.curvature:
            c, s, k = np.cos(self.angle), np.sin(self.angle), self.curvature
            towards, across = x * c + y * s, y * c - x * s
            along, z = 1 / k - (1 / k - towards) * np.cos(k * z), (1 / k - towards) * np.sin(k * z)
            x, y = along * c - across * s, along * s + across * c
        return np.column_stack([x, y, z]) @ self.rotation.T + self.translation

    def contains(self, points: np.ndarray) -> np.ndarray:
        x, y, z = ((points - self.translation) @ self.rotation).T
        if self.curvature:
            c, s, k = np.cos(self.angle), np.sin(self.angle), self.curvature
            along, across = x * c + y * s, y * c - x * s
            towards = 1 / k - np.sign(k) * np.hypot(z, 1 / k - along)
            z = np.arctan2(z * np.sign(k), (1 / k - along) * np.sign(k)) / k
            x, y = towards * c - across * s, towards * s + across * c
        x, y, z = np.array([x, y, z]) / self.axes[:, None]
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            section = 1 + self.slope * z
            x, y, z = np.abs([x / section, y / section, (z + self.slope) / section])
            first, second = self.exponents
            around = (x ** (2 / second) + y ** (2 / second)) ** (second / first)
            return (section > 0) & (around + z ** (2 / first) < 1)

    def surface(self, step: float) -> np.ndarray:
        """Triangles (N, 3, 3) with sides of about `step`, closed but for slivers at the poles."""
        rows = int(np.pi * max(self.axes) / step) + 8
        columns = int(2 * np.pi * max(self.axes[:2]) / step) + 16
        along = on_curve(*evenly(rows, half=True), self.exponents[0])
        around = on_curve(*evenly(columns, half=False), self.exponents[1])
        unit = np.stack([np.outer(along[0], around[0]), np.outer(along[0], around[1]),
                         np.outer(along[1], np.ones(columns))], axis=-1)
        grid = self.placed(unit.reshape(-1, 3)).reshape(rows, columns, 3)
        grid = np.concatenate([grid, grid[:, :1]], axis=1)
        a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
        return np.concatenate([np.stack([a, b, c], axis=2).reshape(-1, 3, 3),
                               np.stack([a, c, d], axis=2).reshape(-1, 3, 3)])


def evenly(count: int, half: bool) -> tuple[np.ndarray, np.ndarray]:
    """Directions by the rays through even steps along a square, which keeps edges and corners dense."""
    if half:
        t = np.linspace(-2, 2, count)
        return np.clip(2 - np.abs(t), 0, 1), np.clip(t, -1, 1)
    t = np.arange(count) * 8 / count
    wave = lambda shift: np.clip(np.abs((t + shift) % 8 - 4) - 2, -1, 1)
    return wave(0), wave(2)


def on_curve(x: np.ndarray, y: np.ndarray, exponent: float) -> tuple[np.ndarray, np.ndarray]:
    """The point of |x|^(2/e) + |y|^(2/e) = 1 towards (x, y)."""
    larger, smaller = np.maximum(abs(x), abs(y)), np.minimum(abs(x), abs(y))
    gauge = larger * (1 + (smaller / larger) ** (2 / exponent)) ** (exponent / 2)
    return x / gauge, y / gauge


def samples(triangles: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Points inside each triangle, about `step` apart, and its corners; and the area each stands for (corners: none)."""
    points, areas = [triangles.reshape(-1, 3)], [np.zeros(3 * len(triangles))]
    sides = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1)
    area = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1) / 2
    pieces = np.maximum(1, np.ceil(sides / step).astype(int))
    for n in np.unique(pieces):
        chosen = triangles[pieces == n]
        weights = [((i + third) / n, (j + third) / n) for third in (1 / 3, 2 / 3) for i in range(n) for j in range(n)
                   if i + j < n - (third > 0.5)]
        for u, v in weights:
            points.append(chosen[:, 0] * (1 - u - v) + chosen[:, 1] * u + chosen[:, 2] * v)
            areas.append(area[pieces == n] / n**2)
    return np.concatenate(points), np.concatenate(areas)


def distance_to_triangles(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Of points (N, 3) to triangles (N, K, 3, 3), the least of each row."""
    p = points[:, None]
    a, b, c = triangles[:, :, 0], triangles[:, :, 1], triangles[:, :, 2]
    dot = lambda x, y: np.einsum("nki,nki->nk", x, y)
    nearest = np.full(triangles.shape[:2], np.inf)
    inside = np.ones(triangles.shape[:2], dtype=bool)
    normal = np.cross(b - a, c - a)
    squared = dot(normal, normal)
    for start, end in ((a, b), (b, c), (c, a)):
        side = end - start
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.nan_to_num(np.clip(dot(p - start, side) / dot(side, side), 0, 1))
        nearest = np.minimum(nearest, np.linalg.norm(p - start - share[..., None] * side, axis=2))
        inside &= dot(np.cross(side, p - start), normal) >= 0
    with np.errstate(divide="ignore", invalid="ignore"):
        plane = np.abs(dot(p - a, normal)) / np.sqrt(squared)
    return np.where(inside & (squared > 0), plane, nearest).min(axis=1)


def distances(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """To the nearest of all triangles: by the nearest centroids, as many as it takes to leave none out."""
    centroids = triangles.mean(axis=1)
    reach = np.linalg.norm(triangles - centroids[:, None], axis=2).max()
    tree = cKDTree(centroids)
    result, left, count = np.empty(len(points)), np.arange(len(points)), min(16, len(triangles))
    while len(left):
        missed = []
        for part in np.array_split(left, len(left) * count // 2_000_000 + 1):
            far, which = tree.query(points[part], k=count, workers=1)
            result[part] = distance_to_triangles(points[part], triangles[which.reshape(len(part), -1)])
            missed.append(part[result[part] > far.reshape(len(part), -1)[:, -1] - reach])
        left = np.concatenate(missed) if count < len(triangles) else []
        count = min(4 * count, len(triangles))
    return result


def boundary(primitives: list[Primitive], step: float) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of the union's boundary (those that have a corner on it), and points of it."""
    triangles, points = [], []
    for primitive in primitives:
        mine = primitive.surface(step)
        covered = np.zeros(3 * len(mine), dtype=bool)
        for other in primitives:
            if other is not primitive:
                covered |= other.contains(mine.reshape(-1, 3))
        triangles.append(mine[~covered.reshape(-1, 3).all(axis=1)])
        points.append(mine.reshape(-1, 3)[~covered])
    return np.concatenate(triangles), np.unique(np.concatenate(points), axis=0)


def weighted_percentile(values: np.ndarray, weights: np.ndarray, percent: float) -> float:
    order = np.argsort(values)
    reached = np.cumsum(weights[order])
    return values[order][np.searchsorted(reached, percent / 100 * reached[-1])]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model")
    parser.add_argument("mesh")
    parser.add_argument("--step", type=float, help="of samples (default: a 200th of the mesh's longest side)")
    parser.add_argument("--tol", type=float, default=0.05, help="of its upper end, how wide an enclosure may be")
    arguments = parser.parse_args()
    with open(arguments.model, encoding="utf-8") as file:
        primitives = [Primitive(description) for description in json.load(file)["primitives"]]
    mesh = read_triangles(arguments.mesh)
    step = arguments.step or np.ptp(mesh.reshape(-1, 3), axis=0).max() / 200

    surface, on_surface = boundary(primitives, step)
    points, weights = samples(mesh, step)
    to_model, to_mesh = distances(points, surface), distances(on_surface, mesh)
    sampled = {"largest, mesh to model": to_model.max(), "mean": np.average(to_model, weights=weights),
               "50 %": weighted_percentile(to_model, weights, 50), "95 %": weighted_percentile(to_model, weights, 95),
               "largest, model to mesh": to_mesh.max(), "Hausdorff": max(to_model.max(), to_mesh.max())}

    program = os.environ.get("VERISQ", "build/release/verisq")
    summary = json.loads(subprocess.run(
        [program, "deviation", "--model", arguments.model, "--mesh", arguments.mesh, "--json", "--no-progress"],
        check=False, stdout=subprocess.PIPE).stdout)
    # Triangles with sides of a step lie within step^2/8R of a surface of radius R.
    error = step**2 / (8 * min(primitive.axes.min() for primitive in primitives))
    return 0 if agree(sampled, proven_of(summary), step, error, arguments.tol) else 1


def agree(sampled: dict, proven: dict, step: float, error: float, tolerance: float) -> bool:
    """Prints both. A largest distance at samples misses the supremum by no more than the nearest one is away."""
    result = True
    print(f"{'':24}{'sampled':>12}{'proven':>26}{'width':>9}")
    for name, (lo, hi) in proven.items():
        value, missed = sampled[name], step if name in at_one_point else error_of_shares * sampled[name]
        contained = lo <= value + missed + error and value - missed * (name not in at_one_point) - error <= hi
        narrow = hi - lo <= tolerance * hi
        result &= contained and narrow
        print(f"{name:24}{value:12.6g}{f'[{lo:.6g}, {hi:.6g}]':>26}{(hi - lo) / hi:8.2%}"
              f"{'' if contained else '  NOT CONTAINED'}{'' if narrow else '  wide'}")
    return result


def proven_of(summary: dict) -> dict[str, tuple[float, float]]:
    mesh = summary["mesh_to_model"]
    found = {"largest, mesh to model": mesh["largest"], "mean": mesh["mean"],
             "largest, model to mesh": summary["model_to_mesh"]["largest"], "Hausdorff": summary["hausdorff"]}
    found |= {f"{share['percent']:g} %": share for share in mesh["percentiles"]}
    return {name: (value["lo"], value["hi"]) for name, value in found.items()}


if __name__ == "__main__":
    sys.exit(main())
