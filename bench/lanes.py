#!/usr/bin/env python3
"""How many times as fast a batch is with its states in lanes as one by one (exact=True), on one thread.

    [DYN_LEVEL=plain] PYTHONPATH=capi/python python3 bench/lanes.py [--states 1000] [--runs 20] [--json]

The least of interleaved runs counts.
"""

import argparse
import json
from pathlib import Path

import numpy as np
from python_overhead import ROBOTS, least

import libdyn as dyn

MODELS = Path(__file__).resolve().parents[1] / "models" / "robots"
ROWS = {"frame_placements": "q", "rnea": "q v a", "aba": "q v tau", "crba": "q", "rnea_derivatives": "q v a",
        "aba_derivatives": "q v tau"}


def measure(robot, base, options):
    m = dyn.load(MODELS / f"{robot}.urdf", base=base)
    batch, random = m.batch(1), np.random.default_rng(1)
    states = {name: random.standard_normal((options.states, m.nv)) for name in ("v", "a", "tau")}
    states["q"] = np.array([m.random(k) for k in range(options.states)])
    rows = {}
    for algorithm, inputs in ROWS.items():
        call, given = getattr(batch, algorithm), [states[name] for name in inputs.split()]
        into = {} if algorithm == "frame_placements" else {"out": call(*given)}  # which makes objects of its results
        t = least({"lanes": (lambda: call(*given, **into), 1), "exact": (lambda: call(*given, exact=True, **into), 1)},
                  options.runs)
        rows[algorithm] = t["exact"] / t["lanes"]
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--states", type=int, default=1000)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if options.states < 1 or options.runs < 1:
        parser.error("--states and --runs must be at least 1")
    gains = {robot: measure(robot, base, options) for robot, base in ROBOTS.items()}
    if options.json:
        print(json.dumps({"build": dyn.build_info, "gains": gains}))
        return
    print(dyn.build_info)
    for robot, rows in gains.items():
        print(f"{robot:10}", *(f"{algorithm} {gain:.2f}" for algorithm, gain in rows.items()))


if __name__ == "__main__":
    main()
