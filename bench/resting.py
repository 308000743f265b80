#!/usr/bin/env python3
"""Heaps, walls, gears, ropes and hands until they rest, beside MuJoCo in one run: mean, median, p99 and longest step.

    python bench/resting.py [--passes 2] [--dt 0.002] [--only SCENE,...] [--solver admm] [--write]

Needs the packages mujoco and dyn. The same MJCF goes to both. MuJoCo runs with its solver Newton: by default (pyramidal cones,
Euler), with elliptic cones, and with its integrator `discrete` where it has one. libdyn runs as it is by default. Times are the
processor's, of this thread, in microseconds, from the first contact on; of each step the least of the passes, which alternate.
`ratio`: of the means, libdyn's over MuJoCo's by default. `residual`: largest of all steps, `above`: steps in which it is more
than 1e-4. `contacts`: at the end, MuJoCo's and libdyn's.

--write  puts the table in its place (pages.py)
"""

import argparse
import os
import sys
import time
from pathlib import Path

import mujoco
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
if (ROOT / "build/release/lib").is_dir():
    os.environ.setdefault("DYN_LIBRARY", str(ROOT / "build/release/lib"))
sys.path.append(str(ROOT / "capi/python"))
import libdyn as dyn  # noqa: E402
import pages  # noqa: E402


def body(pos, shape, euler=(0, 0, 0), mass=1.0):
    at, turned = (" ".join(f"{x:.6f}" for x in v) for v in (pos, euler))
    return f'<body pos="{at}" euler="{turned}"><freejoint/><geom {shape} mass="{mass}"/></body>'


PLANE = '<geom type="plane" size="5 5 1"/>'


def bin_of(half, height=2.0):
    walls = [(half, 0, 0.05, 2 * half), (-half, 0, 0.05, 2 * half), (0, half, 2 * half, 0.05), (0, -half, 2 * half, 0.05)]
    return PLANE + "".join(f'<geom type="box" size="{x} {y} {height}" pos="{a} {b} {height - 0.5}"/>' for a, b, x, y in walls)


def heap(side, layers, shape, half, spread):
    """Bodies turned at random fall into a bin."""
    random = np.random.default_rng(1)
    at = [((i - side / 2 + 0.5) * spread, (j - side / 2 + 0.5) * spread, 0.2 + spread * k) for k in range(layers)
          for i in range(side) for j in range(side)]
    return bin_of(half) + "".join(body(p, shape, random.uniform(0, 360, 3)) for p in at)


def rocks():
    random = np.random.default_rng(2)
    assets, geoms = "", []
    for k in range(8):
        points = random.normal(size=(24, 3))
        points = 0.09 * points / np.linalg.norm(points, axis=1)[:, None] * random.uniform(0.75, 1, (24, 1)) * (1, 0.85, 0.7)
        assets += f'<mesh name="rock{k}" vertex="{" ".join(f"{x:.5f}" for x in points.ravel())}"/>'
    for k in range(64):
        p = ((k % 4 - 1.5) * 0.2, (k // 4 % 4 - 1.5) * 0.2, 0.2 + 0.2 * (k // 16))
        geoms.append(body(p, f'type="mesh" mesh="rock{k % 8}"', random.uniform(0, 360, 3)))
    return bin_of(0.45) + "".join(geoms), assets


def wall(columns, rows):
    """Bricks in bond, 1 mm apart."""
    size, out = (0.1, 0.05, 0.04), PLANE
    for k in range(rows):
        for i in range(columns):
            out += body(((i + 0.5 * (k % 2)) * 0.201, 0, 0.04 + 0.08 * k), 'type="box" size="{} {} {}"'.format(*size))
    return out


def domino(n):
    out = PLANE
    for k in range(n):
        out += body((0.06 * k, 0, 0.1), 'type="box" size=".01 .04 .1"', (0, 8, 0) if k == 0 else (0, 0, 0), 0.1)
    return out.replace("0.000000 0.000000 0.100000", "0.010000 0.000000 0.101000", 1)


def arch(n):
    """Voussoirs on two abutments: a semicircle of thickness 0.2."""
    out, inner, outer, half = PLANE, 0.9, 1.15, np.pi / n / 2
    assets = ""
    points = [(r * np.sin(a), y, r * np.cos(a) - 1.025) for r in (inner, outer) for a in (-half, half) for y in (-0.1, 0.1)]
    assets = f'<mesh name="voussoir" vertex="{" ".join(f"{x:.9f}" for p in points for x in p)}"/>'
    for k in range(n):
        a = -np.pi / 2 + (2 * k + 1) * half
        out += f'<body pos="{1.025 * np.sin(a):.9f} 0 {1.025 * np.cos(a):.9f}" euler="0 {np.degrees(a):.9f} 0"><freejoint/><geom type="mesh" mesh="voussoir" mass="1"/></body>'
    return out, assets


def gears(n, teeth=12):
    """Wheels with capsules as teeth, on hinges, the first one driven."""
    out = ""
    for k in range(n):
        turned = 0 if k % 2 == 0 else 180 / teeth
        geoms = '<geom type="cylinder" size=".1 .02" mass="1" contype="0" conaffinity="0"/>'
        for t in range(teeth):
            a = 2 * np.pi * t / teeth + np.radians(turned)
            geoms += f'<geom type="capsule" size=".011" fromto="{0.1 * np.cos(a):.6f} {0.1 * np.sin(a):.6f} 0 {0.14 * np.cos(a):.6f} {0.14 * np.sin(a):.6f} 0" mass=".01"/>'
        out += f'<body name="wheel{k}" pos="{0.25 * k} 0 1"><joint name="axle{k}" type="hinge" axis="0 0 1" damping=".01"/>{geoms}</body>'
    return out, "", '<actuator><velocity joint="axle0" kv="1" ctrlrange="-10 10"/></actuator>'


def rope(n):
    """A chain of capsules falls on a cylinder and the ground."""
    open_, close = "", ""
    for k in range(n):
        joint = "<freejoint/>" if k == 0 else '<joint type="ball" damping=".001"/>'
        open_ += f'<body pos="{0.06 if k else -0.03 * n} 0 {0 if k else 0.6}">{joint}<geom type="capsule" size=".02" fromto="0 0 0 .06 0 0" mass=".02"/>'
        close += "</body>"
    return PLANE + '<geom type="cylinder" size=".1 .3" pos="0 0 .3" euler="90 0 0"/>' + open_ + close


def hand():
    """Four fingers of three links close around a box by position servos and hold it."""
    out, act = body((0, 0, 0.35), 'type="box" size=".04 .04 .05"', (0, 0, 0), 0.2), ""
    for k in range(4):
        a = np.pi / 2 * k
        c, s = np.cos(a), np.sin(a)
        link, end = "", ""
        for j in range(3):
            at = f"{0.09 * c:.6f} {0.09 * s:.6f} .55" if j == 0 else "0 0 -.1"
            name = f"f{k}{j}"
            link += (
                f'<body pos="{at}"><joint name="{name}" type="hinge" axis="{-s:.6f} {c:.6f} 0" damping=".05" armature=".001"/>'
                '<geom type="capsule" size=".012" fromto="0 0 0 0 0 -.1" mass=".05"/>'
            )
            end += "</body>"
            act += f'<position joint="{name}" kp="5" ctrlrange="-2 2"/>'
        out += link + end
    return PLANE + out, "", f"<actuator>{act}</actuator>"


def quadruped():
    """Lies on its belly."""
    legs = ""
    for x in (-0.2, 0.2):
        for y in (-0.12, 0.12):
            legs += (
                f'<body pos="{x} {y} 0"><joint type="hinge" axis="0 1 0" range="-100 100" damping=".5" armature=".01"/><geom '
                'type="capsule" size=".02" fromto="0 0 0 0 0 -.2" mass=".3"/><body pos="0 0 -.2"><joint type="hinge" axis="0 1 '
                '0" range="-150 150" damping=".5" armature=".01"/><geom type="capsule" size=".02" fromto="0 0 0 0 0 -.2" '
                'mass=".2"/></body></body>'
            )
    return PLANE + f'<body pos="0 0 .35"><freejoint/><geom type="box" size=".25 .1 .05" mass="8"/>{legs}</body>'


# Worlds with assets and actuators; seconds; controls
SCENES = {
    "boxes": (lambda: heap(5, 5, 'type="box" size=".06 .06 .06"', 0.5, 0.19), 2.0),
    "capsules": (lambda: heap(5, 5, 'type="capsule" size=".045 .06"', 0.5, 0.22), 2.0),
    "rocks": (rocks, 2.0),
    "spheres": (lambda: heap(6, 6, 'type="sphere" size=".07"', 0.5, 0.16), 3.0),  # the columns fall into one heap after 1.8 s
    "wall30": (lambda: wall(6, 5), 1.0),
    "wall100": (lambda: wall(10, 10), 0.6),
    "wall225": (lambda: wall(15, 15), 0.4),
    "wall484": (lambda: wall(22, 22), 0.2),
    "domino": (lambda: domino(30), 3.0),
    "arch": (lambda: arch(21), 1.0),
    "gears": (lambda: gears(5), 1.0),
    "rope": (lambda: rope(40), 2.0),
    "hand": (hand, 1.0),
    "quadruped": (quadruped, 2.0),
}


def text_of(world, dt):
    world, assets, more = (*((world,) if isinstance(world, str) else world), "", "")[:3]
    return f'<mujoco><compiler angle="degree"/><option timestep="{dt}"/><size memory="1G"/><asset>{assets}</asset><worldbody>{world}</worldbody>{more}</mujoco>'


def settings():
    cones = {"pyramidal": mujoco.mjtCone.mjCONE_PYRAMIDAL, "elliptic": mujoco.mjtCone.mjCONE_ELLIPTIC}
    out = {name: (cone, mujoco.mjtIntegrator.mjINT_EULER) for name, cone in cones.items()}
    discrete = getattr(mujoco.mjtIntegrator, "mjINT_DISCRETE", None)
    if discrete is not None:
        out["discrete"] = (cones["pyramidal"], discrete)
    return out


def theirs(model, steps, ctrl, setting):
    model.opt.cone, model.opt.integrator = setting
    data = mujoco.MjData(model)
    if ctrl:
        data.ctrl[:] = ctrl
    times, met = np.zeros(steps), np.zeros(steps, int)
    for k in range(steps):
        began = time.thread_time_ns()
        mujoco.mj_step(model, data)
        times[k], met[k] = time.thread_time_ns() - began, data.ncon
    return times / 1e3, met


def ours(model, steps, dt, ctrl, options):
    data = model.data(dyn.Part.SIMULATION)
    data.set_state(model.configuration("qpos0") if "qpos0" in model.configuration_names else model.neutral())
    data.set_step_options("semi_implicit_euler", dt, **options)
    if ctrl:
        data.set_control(np.full(model.nu, ctrl))
    times, met, residual = np.zeros(steps), np.zeros(steps, int), np.zeros(steps)
    iterations = np.zeros(steps)
    for k in range(steps):
        began = time.thread_time_ns()
        data.step()
        times[k] = time.thread_time_ns() - began
        report = data.step_report
        met[k], residual[k], iterations[k] = report.contacts, report.residual, report.iterations
    return times / 1e3, met, residual, iterations


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--passes", type=int, default=2)
    parser.add_argument("--dt", type=float, default=0.002)
    parser.add_argument("--only", default=",".join(SCENES), metavar="SCENE,...")
    parser.add_argument("--solver", default="admm")
    parser.add_argument("--tolerance", type=float, default=0)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    names = options.only.split(",")
    if unknown := set(names) - set(SCENES):
        parser.error(f"no such scene: {', '.join(sorted(unknown))}")
    print(f"libdyn: {dyn.library_path}", file=sys.stderr)
    peers = list(settings())
    table = ["| scene | " + " | ".join(f"MuJoCo, {key}: mean" for key in peers) + " | p99, by default | max | libdyn: mean | median | p99 | "
             "max | ratio | residual | above | iterations | contacts |"]
    table.append("|---" * (12 + len(peers)) + "|")
    print("\n".join(table))
    ratios = []
    for name in names:
        build, seconds = SCENES[name]
        xml = text_of(build(), options.dt)
        steps, ctrl = round(seconds / options.dt), {"gears": 3.0, "hand": 0.6}.get(name)
        model, mine = mujoco.MjModel.from_xml_string(xml), dyn.load_string(xml, meshes="hull")
        best, kept = {}, None
        for _ in range(options.passes):
            for key, setting in settings().items():
                times, met = theirs(model, steps, ctrl, setting)
                best[key] = (np.minimum(times, best[key][0]), met) if key in best else (times, met)
            times, *rest = ours(mine, steps, options.dt, ctrl, {"solver": options.solver, "tolerance": options.tolerance})
            kept = (np.minimum(times, kept[0]), *rest) if kept else (times, *rest)
        times, met, residual, iterations = kept
        begin = int(np.argmax(met > 0)) + 1  # the first touch allocates nothing but caches
        usual, their_met = best[peers[0]]
        peer, own = usual[begin:], times[begin:]
        ratios.append(own.mean() / peer.mean())
        figures = [best[key][0][begin:].mean() for key in peers]
        figures += [np.percentile(peer, 99), peer.max(), own.mean(), np.median(own), np.percentile(own, 99), own.max()]
        row = (f"| {name} | {' | '.join(f'{x:.3g}' for x in figures)} | {ratios[-1]:.2f} | {residual.max():.1g} | "
               f"{(residual > 1e-4).sum()} of {steps} | {iterations[begin:].mean():.0f} | {their_met[-1]}, {met[-1]} |")
        table.append(row)
        print(row, flush=True)
    mean = f"Geometric mean of the ratios: {np.exp(np.mean(np.log(ratios))):.2f}."
    print(f"\n{mean}")
    if options.write:
        command = "python bench/resting.py " + " ".join(sys.argv[1:])
        pages.write("resting", "\n".join([f"Microseconds of a step of {options.dt * 1e3:g} ms, MuJoCo {mujoco.__version__}. {mean}", ""]
                                         + table + ["", "```", command, "```"]))


if __name__ == "__main__":
    main()
