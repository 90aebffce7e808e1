"""A cohort on a dask cluster: how near each stem lies to the bone in each pose, whichever worker finds it out.

    python3 cohort_with_dask.py BONE.off STEM.json... [--scheduler tcp://HOST:8786]

Needs dask's scheduler (Debian: python3-distributed) and a bone in the stems' units. Without --scheduler two processes on
this machine do the work. A case that fails is listed, and the others go on.
"""

import argparse

import verisq
from distributed import Client, LocalCluster, as_completed

SHIFTS = [[x, y, 0.0] for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0)]


def smallest_distance(stem, bone, shift):
    """What is proven of the vertices' smallest distance: the least of all lower ends, and of all upper ends."""
    # A device's kernels would be compiled by every worker: the host needs none, and a worker has a core of its own.
    rows = verisq.map(stem.posed([*shift, 1, 0, 0, 0]), bone.vertices, device="host")
    return float(rows.lo.min()), float(rows.hi.min())


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bone")
    parser.add_argument("stems", nargs="+")
    parser.add_argument("--scheduler")
    asked = parser.parse_args()
    bone = verisq.Mesh.load(asked.bone)
    # Processes, not threads of one; begun afresh, as OpenCL does not survive a fork.
    cluster = None if asked.scheduler else LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with Client(asked.scheduler or cluster) as client:
        everywhere = client.scatter(bone, broadcast=True)  # once to each worker, not with every case
        cases = {}
        for name in asked.stems:
            stem = client.scatter(verisq.Model.load(name))
            for shift in SHIFTS:
                cases[client.submit(smallest_distance, stem, everywhere, shift, pure=False)] = (name, shift)
        for done in as_completed(cases):
            name, shift = cases[done]
            if done.status == "error":
                print(f"{name} at {shift}: failed: {done.exception()}")
                continue
            lo, hi = done.result()
            print(f"{name} at {shift}: the nearest vertex is between {lo} and {hi} away")
        answers = [done.result() for done in cases if done.status == "finished"]
    if cluster:
        cluster.close()
    least = f"nothing is nearer than {min(lo for lo, _ in answers)}" if answers else "nothing is proven"
    print(f"{len(answers)} of {len(cases)} cases; {least}")


if __name__ == "__main__":
    main()
