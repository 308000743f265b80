#!/usr/bin/env python3
"""What Python adds to a call, and what a batch gains from threads.

    PYTHONPATH=capi/python python3 bench/python_overhead.py [--threads 2] [--runs N] [--json]

C        one state in C: a batch on one thread, of 1000 states, divided by 1000
held     what Python adds to a call on the data's own arrays: d.rnea()
given    what it adds to a call on the caller's arrays: d.rnea(q, v, a)
share    what it adds to a batch of 1000 (the time of a batch of one state, less C), in per cent of the batch's time on one
         thread, and on all of them
batch    the same in microseconds
gain     time of that batch on one thread over its time on several; 10 k: of a batch of 10,000
Times are the least of many short runs, interleaved: other load of the machine adds to the others.
"""

import argparse
import json
from pathlib import Path
from time import perf_counter

import numpy as np

import libdyn as dyn

MODELS = Path(__file__).resolve().parents[1] / "models" / "robots"
ROBOTS = {"panda": "fixed", "go2": "floating", "humanoid": "floating"}
ROWS = {"rnea": "q v a", "aba": "q v tau", "crba": "q", "jcom": "q"}
STATES, LARGE = 1000, 10000


def least(calls, runs):
    """Least seconds of each of {name: (function, times in a run)}."""
    best = dict.fromkeys(calls, float("inf"))
    for _ in range(runs):
        for name, (call, times) in calls.items():
            start = perf_counter()
            for _ in range(times):
                call()
            best[name] = min(best[name], (perf_counter() - start) / times)
    return best


def measure(robot, base, algorithm, inputs, options):
    m = dyn.load(MODELS / f"{robot}.urdf", base=base)
    d, one, several = m.data(), m.batch(1), m.batch(options.threads)
    random = np.random.default_rng(1)
    states = {name: random.standard_normal((LARGE, m.nv)) for name in ("v", "a", "tau")}
    states["q"] = np.array([m.random(k) for k in range(LARGE)])
    d.set_state(**{name: x[0].copy() for name, x in states.items()})
    large = [states[name] for name in inputs.split()]
    thousand, state, single = [x[:STATES] for x in large], [x[0].copy() for x in large], [x[:1] for x in large]
    held, on_one, on_several = getattr(d, algorithm), getattr(one, algorithm), getattr(several, algorithm)
    out, large_out = on_one(*thousand), on_one(*large)
    t = least(
        {
            "C": (lambda: on_one(*thousand, out=out), 1),
            "several": (lambda: on_several(*thousand, out=out), 1),
            "held": (held, 100),
            "given": (lambda: held(*state), 100),
            "batch of one": (lambda: on_one(*single), 100),
        },
        options.runs,
    )
    t |= least({"large": (lambda: on_one(*large, out=large_out), 1),
                "large, several": (lambda: on_several(*large, out=large_out), 1)}, options.runs // 10 + 3)
    c = t["C"] / STATES
    batch = t["batch of one"] - c
    return {
        "robot": robot,
        "algorithm": algorithm,
        "C": 1e6 * c,
        "held": 1e6 * (t["held"] - c),
        "given": 1e6 * (t["given"] - c),
        "batch": 1e6 * batch,
        "share": 100 * batch / t["C"],
        "share_several": 100 * batch / t["several"],
        "gain": t["C"] / t["several"],
        "gain_large": t["large"] / t["large, several"],
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--runs", type=int, default=300)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if options.threads < 1 or options.runs < 1:
        parser.error("--threads and --runs must be at least 1")
    if not options.json:
        print(dyn.build_info)
        print(f"{'robot':10} {'algorithm':24} {'C us':>7} {'held us':>8} {'given us':>9} {'batch us':>9} {'share 1 thread %':>17} {'share %':>8} {'gain':>6} {'10 k':>6}")
    rows = []
    for robot, base in ROBOTS.items():
        for algorithm, inputs in ROWS.items():
            rows.append(r := measure(robot, base, algorithm, inputs, options))
            if not options.json:
                print(
                    f"{robot:10} {algorithm:24} {r['C']:7.2f} {r['held']:8.2f} {r['given']:9.2f} {r['batch']:9.2f} "
                    f"{r['share']:17.2f} {r['share_several']:8.2f} {r['gain']:6.2f} {r['gain_large']:6.2f}",
                    flush=True,
                )
    if options.json:
        print(json.dumps({"build": dyn.build_info, "threads": options.threads, "rows": rows}))


if __name__ == "__main__":
    main()
