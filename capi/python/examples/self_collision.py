"""Finds configurations at which an arm does not touch itself: 10,000 random ones, and how near each comes.

    python self_collision.py

Signed distances are exact, so the least of a configuration is how much room it leaves. The fingers are to meet: that pair is
left out.
"""

import sys
import time
from pathlib import Path

import numpy as np

import libdyn as dyn

PANDA = Path(__file__).resolve().parents[3] / "models" / "robots" / "panda.urdf"
SAMPLES, MARGIN = 10_000, 0.01  # -, m


def main() -> int:
    model = dyn.load(PANDA, base="fixed")
    links = [tuple(model.frame_name(model.shape(shape).frame) for shape in pair[:2]) for pair in model.pairs]
    counted = [k for k, (a, b) in enumerate(links) if not ("finger" in a and "finger" in b)]
    data, q = model.data(), np.array([model.random(seed=k) for k in range(SAMPLES)])
    nearest, which = np.empty(SAMPLES), np.empty(SAMPLES, int)
    begin = time.perf_counter()
    for k in range(SAMPLES):
        distances = data.compute_distances(q[k])[counted]
        which[k] = np.argmin(distances)
        nearest[k] = distances[which[k]]
    seconds = time.perf_counter() - begin
    free = nearest > MARGIN
    a, b = links[counted[np.bincount(which[~free]).argmax()]]
    print(f"{SAMPLES} configurations, {len(counted)} pairs of shapes each: {1e6 * seconds / SAMPLES:.0f} us a configuration")
    print(f"{free.mean():.1%} keep {1e3 * MARGIN:.0f} mm away; of the others most have {a} near {b}")
    print(f"most room: {1e3 * nearest.max():.0f} mm, at q = {[round(float(x), 2) for x in q[np.argmax(nearest)]]}")
    return 0 if 0.5 < free.mean() < 1 else 1


if __name__ == "__main__":
    sys.exit(main())
