#!/usr/bin/env python3
"""What Ray adds to rollouts, by the size of a task: the constants of the model in capi/pages/measured_cluster.md.

    python bench/cluster.py [--workers 2] [--passes 5]

Needs the packages ray and dyn. A local cluster simulates a quadruped in the air in tasks of several sizes; the least wall time of
the passes counts. From least squares of relative errors over the sizes:
  c   seconds of a worker for a step
  o   seconds of a worker for a task beside its steps
  d   seconds of the calling process for a task (its processor time): what limits how many workers it can feed
  b   the same for each megabyte that comes back
"""

import argparse
import os
import secrets
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
if (ROOT / "build/release/lib").is_dir():
    os.environ.setdefault("DYN_LIBRARY", str(ROOT / "build/release/lib"))
sys.path.append(str(ROOT / "capi/python"))
os.environ.setdefault("RAY_worker_niceness", "0")  # 15 as it comes: a machine with other work would be measured
os.environ.setdefault("RAY_AUTH_TOKEN", secrets.token_hex(32))  # or Ray writes one to the home folder
import libdyn as dyn  # noqa: E402
import ray  # noqa: E402
from libdyn.batch import rollout  # noqa: E402


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--passes", type=int, default=5)
    o = parser.parse_args()
    m = dyn.load(ROOT / "models/robots/go2.urdf", base="floating")
    q0 = m.neutral()
    begin = time.perf_counter()
    ray.init(num_cpus=o.workers, include_dashboard=False, log_to_driver=False,
             runtime_env={"env_vars": {"PYTHONPATH": str(ROOT / "capi/python")}})
    started = time.perf_counter() - begin
    begin = time.perf_counter()
    rollout(m, q0, steps=1, n=o.workers, chunk=1, engine="ray")
    print(f"Start of the cluster {started:.1f} s; first call (processes start, import dyn, load the model) {time.perf_counter() - begin:.1f} s; "
          f"image of the model {len(m.image()) / 1e6:.2f} MB.\n")  # fmt: skip
    rows = []  # tasks, steps, megabytes, wall, processor time here
    for steps, every, n in ((1, 1, 100), (50, 50, 100), (200, 200, 50), (1000, 1000, 20), (3000, 3000, 10), (1000, 1, 20),
                            (200, 1, 50)):
        wall, here = np.inf, np.inf
        for _ in range(o.passes):
            times = time.perf_counter(), time.process_time()
            r = rollout(m, q0, steps=steps, every=every, n=n, chunk=1, engine="ray")
            wall, here = min(wall, time.perf_counter() - times[0]), min(here, time.process_time() - times[1])
        rows.append((n, n * steps, (r.q.nbytes + r.v.nbytes) / 1e6, wall, here))
    tasks, steps, megabytes, wall, here = np.array(rows).T
    relative = lambda A, y: np.linalg.lstsq(A / y[:, None], np.ones(len(y)), rcond=None)[0]
    overhead, c = relative(np.stack([tasks, steps], 1) / o.workers, wall)
    d, b = relative(np.stack([tasks, megabytes], 1), here)
    print(f"c {c * 1e6:.1f} us a step, o {overhead * 1e3:.2f} ms a task, d {d * 1e3:.2f} ms a task, b {b * 1e3:.2f} ms a "
          "megabyte\n")
    print("| steps of a task | its work, ms | share of a worker's time that is steps | workers that one caller feeds "
          "|\n|---:|---:|---:|---:|")
    for size in (1, 50, 200, 1000, 5000, dyn.cluster.STEPS_OF_A_TASK):
        print(f"| {size:,} | {1e3 * size * c:.1f} | {size * c / (size * c + overhead):.1%} | {(size * c + overhead) / d:,.0f} |")
    errors = (tasks * overhead + steps * c) / o.workers / wall - 1
    print(f"\nThe model's errors in the sizes that were measured: {', '.join(f'{e:+.0%}' for e in errors)}")
    ray.shutdown()


if __name__ == "__main__":
    main()
