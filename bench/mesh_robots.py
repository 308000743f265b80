#!/usr/bin/env python3
"""Time of a step of robots whose shapes are hulls of meshes, beside MuJoCo in one run.

    python bench/mesh_robots.py FOLDER [--only PATTERN] [--passes 8] [--steps 50] [--write]

FOLDER: MJCF scenes, such as MuJoCo's Menagerie. A scene counts if MuJoCo compiles it and a hull is among its collision shapes. Both
load it by path alone, begin at its first key, or else as drawn, hold the key's controls, and go 100 steps before time is taken.
Times are the processor's, of this thread, in microseconds: medians of the passes, which alternate. `contacts`: at the end, MuJoCo's
and libdyn's. `dropped`: the scene has physics that libdyn does not support, and its ratio is not in the mean.

--write  puts the table in its place (pages.py)
"""

import argparse
import os
import re
import sys
import time
import warnings
from pathlib import Path

import mujoco
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
if (ROOT / "build/release/lib").is_dir():
    os.environ.setdefault("DYN_LIBRARY", str(ROOT / "build/release/lib"))
sys.path.append(str(ROOT / "capi/python"))
import libdyn as dyn  # noqa: E402
import pages  # noqa: E402


def time_of(step):
    began = time.thread_time_ns()
    step()
    return (time.thread_time_ns() - began) / 1e3


def measured(path, passes, steps):
    """A row of the table and its ratio, or None."""
    try:
        theirs = mujoco.MjModel.from_xml_path(str(path))
    except ValueError:
        return None
    if not any(theirs.geom_type[k] == mujoco.mjtGeom.mjGEOM_MESH and (theirs.geom_contype[k] or theirs.geom_conaffinity[k])
               for k in range(theirs.ngeom)):
        return None
    model = dyn.load(path)
    state, key = mujoco.MjData(theirs), theirs.key(0).name if theirs.nkey else ""
    if key:
        mujoco.mj_resetDataKeyframe(theirs, state, 0)
    ours = dyn.Simulation(model, key or None)
    mujoco.mj_step(theirs, state, 100)
    ours.step(100)
    times = np.array([[time_of(lambda: mujoco.mj_step(theirs, state, steps)) / steps, time_of(lambda: ours.step(steps)) / steps]
                      for _ in range(passes)])
    (a, b), dropped = np.median(times, axis=0), any(e.level == dyn.ReportLevel.DROPPED for e in model.report)
    contacts = f"{state.ncon}, {ours.data.step_report.contacts}"
    return [f"{path.parent.name} {path.name}", f"{a:.1f}", f"{b:.1f}", f"{b / a:.2f}", contacts, "dropped" if dropped else ""], b / a


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", default=r"scene[^/]*\.xml$")
    parser.add_argument("--passes", type=int, default=8)
    parser.add_argument("--steps", type=int, default=50)
    parser.add_argument("--write", action="store_true")
    args = parser.parse_args()
    warnings.simplefilter("ignore")
    rows, ratios = [], []
    for path in sorted(p for p in args.folder.rglob("*.xml") if re.search(args.only, str(p))):
        found = measured(path, args.passes, args.steps)
        if not found:
            continue
        rows.append(found[0])
        print(*found[0], sep=" | ", flush=True)
        if not found[0][-1]:
            ratios.append(found[1])
    if not rows:
        sys.exit(f"no scene with hulls in {args.folder}")
    head = ["scene", f"MuJoCo {mujoco.__version__}, us", "libdyn, us", "ratio", "contacts", ""]
    table = "\n".join("| " + " | ".join(r) + " |" for r in (head, ["---"] * len(head), *rows))
    mean = f"geometric mean {np.exp(np.mean(np.log(ratios))):.2f}, largest {max(ratios):.2f}" if ratios else "none"
    text = f"{table}\n\nRatios of scenes without dropped physics: {mean}.\n\n```\npython bench/mesh_robots.py {args.folder.name} --write\n```\n"
    print(mean)
    if args.write:
        print("written to", pages.write("mesh_robots", text))


if __name__ == "__main__":
    main()
