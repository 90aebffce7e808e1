"""Is a robot's way free? Where that is proven, at the poses along it and between them.

    python3 robot_clearance.py [STEPS]

An arm of three links turns in its plane, beside a table and a cloud of points that a sensor has seen, each known to
2 mm. A bound of how far the links move between two poses makes the answer one about the whole way: no sampling.
"""

import sys

import numpy as np
import verisq

STEPS = int(sys.argv[1]) if len(sys.argv) > 1 else 200
LENGTHS = np.array([400.0, 350.0, 250.0])  # mm
OVERHANG = 60.0  # no point of a link is farther beyond its joints, and none beside its axis: see the semi-axes
SENSOR = 2.0
ROUNDING = 1e-6  # more than NumPy's sines and sums of numbers below 2000 are off


def superquadric(name, semi_axes, exponents, centre):
    return verisq.Model.from_dict({
        "format": "verisq-model/1", "units": "mm",
        "primitives": [{"name": name, "superquadric": {"semi_axes": semi_axes, "exponents": exponents},
                        "pose": {"translation": centre}}],
    })


links = [superquadric(f"link {k}", [length / 2 + 25, 30, 30], [0.8, 0.3], [length / 2, 0, 0])
         for k, length in enumerate(LENGTHS)]
table = superquadric("table", [600, 20, 300], [0.1, 0.1], [300, -320, 0])
cloud = np.random.default_rng(7).normal([350, 480, 0], [60, 25, 60], (3000, 3))  # a thing above the elbow

# Joint angles along the way, from rest towards the cloud; the frame of link k: where it begins, how far it is turned.
angles = np.linspace(np.radians([-20, 10, 20]), np.radians([75, -50, -40]), STEPS + 1)
turned = np.cumsum(angles, axis=1)
along = LENGTHS[:, None] * np.stack([np.cos(turned), np.sin(turned)], axis=-1)
starts = np.concatenate([np.zeros((STEPS + 1, 1, 2)), np.cumsum(along, axis=1)[:, :-1]], axis=1)

# Nothing of link k is farther from joint j than the links between them, and its overhang. From a pose half the way to
# the next one a joint turns by half its step; each pose stands for the half steps on both sides.
half_step = np.abs(np.diff(angles, axis=0)).max(axis=0) / 2
moves = [sum(half_step[j] * (LENGTHS[j : k + 1].sum() + OVERHANG) for j in range(k + 1)) for k in range(3)]

free = np.ones(STEPS + 1, dtype=bool)
for k, link in enumerate(links):
    angle, start = turned[:, k], starts[:, k]
    # The table: distances of two solids for every pose.
    zeros = np.zeros(STEPS + 1)
    poses = np.stack([start[:, 0], start[:, 1], zeros, np.cos(angle / 2), zeros, zeros, np.sin(angle / 2)], axis=1)
    to_table = verisq.map_poses(table, link, poses, tolerance=0.01)
    free &= to_table.lo > moves[k] + ROUNDING
    # The cloud, seen from the link: each point is any within this radius, so a lower end above 0 is a proof.
    away = cloud[None, :, :2] - start[:, None]
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    seen = np.stack([c * away[..., 0] + s * away[..., 1], c * away[..., 1] - s * away[..., 0],
                     np.broadcast_to(cloud[:, 2], away.shape[:2])], axis=-1)
    to_cloud = verisq.map(link, seen.reshape(-1, 3), tolerance=0.01, point_radius=SENSOR + moves[k] + ROUNDING)
    free &= (to_cloud.lo > 0.0).reshape(seen.shape[:2]).all(axis=1)
    print(f"link {k}: moves at most {moves[k]:.2f} mm from a pose to the middle between it and the next; "
          f"some {to_table.lo.min():.0f} mm from the table, {to_cloud.lo.min() + moves[k]:.0f} mm from the cloud")

first = np.argmin(free) if not free.all() else STEPS + 1
print(f"{free.sum()} of {len(free)} poses are proven free, with all between them")
print("the whole way is proven free" if free.all() else f"from the start the way is proven free up to pose {first - 1}")
