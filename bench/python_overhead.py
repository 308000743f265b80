#!/usr/bin/env python3
"""What Python adds to a call, and what a batch gains from threads.

    PYTHONPATH=capi/python python3 bench/python_overhead.py [--threads 2]

C        one state in C: a batch on one thread, of 1000 states, divided by 1000
held     what Python adds to a call on the data's own arrays: d.rnea()
given    what it adds to a call on the caller's arrays: d.rnea(q, v, a)
share    what it adds to a batch of 1000 (the time of a batch of one state, less C), in per cent of the batch's time on one
         thread, and on all of them
gain     time of that batch on one thread over its time on several
Times are the least of many short runs, interleaved: other load of the machine adds to the others.
"""

import argparse
from pathlib import Path
from time import perf_counter

import numpy as np

import dyn

MODELS = Path(__file__).resolve().parents[1] / "models" / "robots"
ROBOTS = {"panda": "fixed", "go2": "floating", "humanoid": "floating"}
ROWS = {"rnea": "q v a", "aba": "q v tau", "crba": "q", "center_of_mass_jacobian": "q"}
STATES = 1000


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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--runs", type=int, default=300)
    options = parser.parse_args()
    print(dyn.build_info)
    print(f"{'robot':10} {'algorithm':24} {'C us':>7} {'held us':>8} {'given us':>9} {'share 1 thread %':>17} {'share %':>8} {'gain':>6}")
    for robot, base in ROBOTS.items():
        m = dyn.load(MODELS / f"{robot}.urdf", base=base)
        d, one, several = m.data(), m.batch(1), m.batch(options.threads)
        random = np.random.default_rng(1)
        states = {name: random.standard_normal((STATES, m.nv)) for name in ("v", "a", "tau")}
        states["q"] = np.array([m.random(k) for k in range(STATES)])
        d.set_state(**{name: x[0].copy() for name, x in states.items()})
        for algorithm, inputs in ROWS.items():
            all_states = [states[name] for name in inputs.split()]
            state, single = [x[0].copy() for x in all_states], [x[:1] for x in all_states]
            held, on_one, on_several = getattr(d, algorithm), getattr(one, algorithm), getattr(several, algorithm)
            out = on_one(*all_states)
            t = least(
                {
                    "C": (lambda: on_one(*all_states, out=out), 1),
                    "several": (lambda: on_several(*all_states, out=out), 1),
                    "held": (held, 100),
                    "given": (lambda: held(*state), 100),
                    "batch of one": (lambda: on_one(*single), 100),
                },
                options.runs,
            )
            c = t["C"] / STATES
            overhead = t["batch of one"] - c
            print(
                f"{robot:10} {algorithm:24} {1e6 * c:7.2f} {1e6 * (t['held'] - c):8.2f} {1e6 * (t['given'] - c):9.2f} "
                f"{100 * overhead / t['C']:17.2f} {100 * overhead / t['several']:8.2f} {t['C'] / t['several']:6.2f}"
            )


if __name__ == "__main__":
    main()
