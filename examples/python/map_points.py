import numpy as np, verisq

stem = verisq.Model.load("examples/tapered_stem.json")
lo, hi, status = verisq.map(stem, np.random.default_rng(1).uniform(-100, 100, (1_000_000, 3)))
print(f"{np.sum(lo > 2.0)} of {len(lo)} points are proven to be farther than 2 mm")
