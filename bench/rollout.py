#!/usr/bin/env python3
"""Rollouts beside MuJoCo's `rollout`, in one run: steps a second.

    python bench/rollout.py [--threads 2] [--rollouts 64] [--steps 250] [--passes 3] [ROBOT ...]

Needs the packages mujoco and dyn. Both read the same MJCF: a robot of models/ above a floor, with a position servo at every
joint, driven about its stance by the same random controls in steps of 2 ms; both return the state after every step. What counts
is the least wall time of the passes, which alternate. MuJoCo runs as it is by default (Newton, pyramidal cones, Euler) and with
elliptic cones, which are what libdyn's contacts have; the faster one counts. libdyn runs as it is by default (ADMM, residual
1e-4), and with Gauss-Seidel to a residual of 1e-3 in at most 50 sweeps. `apart`: how far bases (of the arm, all joints: rad) are
from libdyn's default ones after a tenth of a second, median of the rollouts.
"""

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

import mujoco
import mujoco.rollout
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
if (ROOT / "build/release/lib").is_dir():
    os.environ.setdefault("DYN_LIBRARY", str(ROOT / "build/release/lib"))
sys.path.append(str(ROOT / "capi/python"))
import libdyn as dyn  # noqa: E402

DT = 2e-3
LEGS = ("FL", "FR", "RL", "RR")
# base, its height, joints that are not at zero, gains of the servos (N m/rad, N m s/rad)
ROBOTS = {
    "panda": ("fixed", None, {"panda_joint4": -1.5, "panda_joint6": 1.5}, (200, 20)),
    "go2": ("floating", 0.27, {f"{leg}_{joint}_joint": x for leg in LEGS for joint, x in (("thigh", 0.9), ("calf", -1.8))},
            (60, 3)),
    "humanoid": ("floating", 0.9, {}, (200, 10)),
}


def scene(name):
    """The model, where it begins, and what its servos hold."""
    base, height, stance, (kp, kv) = ROBOTS[name]
    robot = dyn.load(ROOT / f"models/robots/{name}.urdf", base=base)
    b = dyn.Builder.from_model(robot).add_shape("universe", "half_space", name="floor")
    driven = [j for j in robot.joints[1:] if j.nv == 1 and j.mimic_leader < 0]
    for j in driven:
        b.add_actuator(j.name, j.name, type="position", kp=kp, kv=kv)
    q = robot.normalize(stance)
    if height is not None:
        q[2] = height
    return b.finish(), q, np.array([q[j.idx_q] for j in driven])


OURS = {"default": {}, "fast": {"solver": "pgs", "tolerance": 1e-3, "max_iterations": 50}}
CONES = ("pyramidal", "elliptic")


def timed(kind, times, call):
    begin = time.perf_counter()
    result = call()
    times[kind] = min(times.get(kind, np.inf), time.perf_counter() - begin)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name, default in (("threads", 2), ("rollouts", 64), ("steps", 250), ("passes", 3)):
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("robots", nargs="*", metavar="ROBOT")
    o = parser.parse_args()
    print(f"{o.rollouts} rollouts of {o.steps} steps of 2 ms, {o.threads} threads (MuJoCo {mujoco.__version__}): thousands of "
          "steps a second.\n")
    print("| robot | contacts | libdyn | residual 1e-3 | apart | MuJoCo | elliptic cones | apart | ratio | with 1e-3 |\n|---|"
          + "---:|" * 9)
    for name in o.robots or ROBOTS:
        m, q, stance = scene(name)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "scene.xml"
            m.save(path)
            ours, theirs = dyn.load(path), mujoco.MjModel.from_xml_path(str(path))
        theirs.opt.timestep = DT
        control = stance + 0.2 * np.random.default_rng(1).normal(size=(o.rollouts, o.steps, len(stance)))
        x = m.to_peer("mujoco", q, np.zeros(m.nv))
        q0, batch, data = ours.from_peer("mujoco", x.q,
                                         x.v).q, ours.batch(threads=o.threads), [mujoco.MjData(theirs) for _ in range(o.threads)]
        data[0].qpos, data[0].qvel = x.q, x.v
        full = mujoco.mjtState.mjSTATE_FULLPHYSICS
        begin = np.empty(mujoco.mj_stateSize(theirs, full))
        mujoco.mj_getState(theirs, data[0], begin, full)
        begin = np.tile(begin, (o.rollouts, 1))
        k, base = round(0.1 / DT), slice(3) if ROBOTS[name][1] else slice(m.nq)
        times, at = {}, {}
        with mujoco.rollout.Rollout(nthread=o.threads) as pool:
            for _ in range(o.passes):
                for kind, options in OURS.items():
                    r = timed(kind, times, lambda: batch.rollout(q0, control=control, dt=DT, contacts=1, **options))
                    at[kind] = r.q[:, k, base]
                    if kind == "default":
                        contacts = r.contact_count.mean()
                for cone in CONES:
                    theirs.opt.cone = getattr(mujoco.mjtCone, f"mjCONE_{cone.upper()}")
                    states, _ = timed(cone, times, lambda: pool.rollout(theirs, data, begin, control))
                    at[cone] = states[:, k, 1:][:, base]
        rate = {kind: o.rollouts * o.steps / t / 1e3 for kind, t in times.items()}
        apart = {kind: np.median(np.linalg.norm(there - at["default"], axis=1)) for kind, there in at.items()}
        peer = max(CONES, key=rate.get)
        print(f"| {name} | {contacts:.1f} | {rate['default']:.1f} | {rate['fast']:.1f} | {apart['fast']:.0e} | "
              f"{rate['pyramidal']:.1f} | {rate['elliptic']:.1f} | {apart[peer]:.0e} | {rate['default'] / rate[peer]:.2f} | "
              f"{rate['fast'] / rate[peer]:.2f} |", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
