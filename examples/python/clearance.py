"""How far the vertices of a bone lie from a stem, and what is proven within a limit.

    python3 clearance.py STEM.json BONE.off [LIMIT]
"""

import sys

import numpy as np
import verisq

stem = verisq.Model.load(sys.argv[1])
bone = verisq.Mesh.load(sys.argv[2])
limit = float(sys.argv[3]) if len(sys.argv) > 3 else 2.0

lo, hi, status = verisq.map(stem, bone.vertices)

proven_within = hi <= limit
proven_beyond = lo > limit
undecided = ~(proven_within | proven_beyond)
nearest = np.argmin(lo)
print(f"{len(lo)} vertices, of which {np.sum(status == verisq.Status.WIDE)} have a wide enclosure")
print(f"within {limit:g} {stem.units}: {proven_within.sum()} proven, {undecided.sum()} undecided")
print(f"beyond: {proven_beyond.sum()} proven")
# With all their digits: rounded ones would not be proven.
least, most = float(lo[nearest]), float(hi[nearest])
print(f"no vertex is nearer than {least} {stem.units}; vertex {nearest} is at most {most} away")
