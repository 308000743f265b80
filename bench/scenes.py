#!/usr/bin/env python3
"""Steps of scenes with contact, beside MuJoCo in one run: time of a step, and what each lets through.

    chrt -f 50 python bench/scenes.py [--seconds 1] [--dt 0.002] [SCENE ...]

Needs the packages mujoco and dyn. The same MJCF text goes to both, with MuJoCo's options as they are by default (Newton, tolerance 1e-8, elliptic
cones) and libdyn's as they are by default (admm, residual 1e-9). Errors: the deepest overlap in all steps, and by how much the sum of the energies
of a scene that nothing drives has grown over its smallest value before. Prints a table in Markdown.
"""

import argparse
import tempfile
import time
from pathlib import Path

import mujoco
import numpy as np

import dyn


def free(pos, shape):
    return f'<body pos="{pos[0]:.6f} {pos[1]:.6f} {pos[2]:.6f}"><freejoint/><geom {shape} mass="1"/></body>'


def on_plane(bodies):
    return '<geom type="plane" size="5 5 1"/>' + "".join(bodies)


def stack(n):
    return on_plane(free((0, 0, 0.1 + 0.2 * k), 'type="box" size=".1 .1 .1"') for k in range(n))


def poured(side):
    walls = "".join(f'<geom type="box" size="{a} 2 1" pos="{x} {y} .5"/>' for a, x, y in ((".05", 1, 0), (".05", -1, 0)))
    walls += "".join(f'<geom type="box" size="2 .05 1" pos="0 {y} .5"/>' for y in (1, -1))
    shake = np.random.default_rng(0).uniform(-0.01, 0.01, (side**3, 2))
    at = [((i - side / 2) * 0.22, (j - side / 2) * 0.22, 0.1 + 0.22 * k) for i in range(side) for j in range(side) for k in range(side)]
    return walls + on_plane(free((x + s[0], y + s[1], z), 'type="sphere" size=".1"') for (x, y, z), s in zip(at, shake))


def chain(n):
    text = ""
    for _ in range(n):
        text = f'<body pos="0 0 -.1"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -.1" size=".02" contype="0" conaffinity="0"/>{text}</body>'
    return text.replace('pos="0 0 -.1"', 'pos="0 0 0" euler="0 60 0"', 1)


SCENES = {
    "box": stack(1),
    "stack of 10 boxes": stack(10),
    "27 spheres poured": poured(3),
    "216 spheres poured": poured(6),
    "chain of 20 links": chain(20),
    "chain of 60 links": chain(60),
}


def scene_text(world, dt):
    return f'<mujoco><option timestep="{dt}"><flag energy="enable"/></option><size memory="200M"/><worldbody>{world}</worldbody></mujoco>'


def growth(energies):
    """By how much energy exceeds its smallest value so far."""
    return float(np.max(energies - np.minimum.accumulate(energies)))


def of_mujoco(path, steps):
    model = mujoco.MjModel.from_xml_path(str(path))

    def run(watch):
        data, overlap, energies = mujoco.MjData(model), 0.0, []
        mujoco.mj_forward(model, data)
        began = time.perf_counter()
        for _ in range(steps):
            mujoco.mj_step(model, data)
            if watch:
                overlap = min(overlap, data.contact.dist.min() if data.ncon else 0.0)
                energies.append(data.energy.sum())
        return time.perf_counter() - began, -overlap, energies

    seconds = run(False)[0]
    _, overlap, energies = run(True)
    return seconds / steps, overlap, growth(np.array(energies))


def of_libdyn(path, steps, dt):
    model = dyn.load(str(path))
    named = "qpos0" in model.configuration_names

    def fresh():
        data = model.data(dyn.Part.SIMULATION | dyn.Part.ENERGY)
        data.set_effects("all")
        data.set_state(model.configuration("qpos0") if named else model.neutral())
        data.set_stepping("semi_implicit_euler", dt)
        return data

    data = fresh()
    began = time.perf_counter()
    report = data.advance(steps * dt)
    seconds = time.perf_counter() - began
    data, energies = fresh(), []
    for _ in range(steps):
        data.step()
        energies.append(data.energy().mechanical)
    return seconds / steps, report.penetration, growth(np.array(energies)), report


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"of {', '.join(SCENES)}; default all")
    parser.add_argument("--seconds", type=float, default=1.0)
    parser.add_argument("--dt", type=float, default=0.002)
    options = parser.parse_args()
    unknown = set(options.scenes) - set(SCENES)
    if unknown:
        parser.error(f"no such scene: {', '.join(sorted(unknown))}")
    steps = round(options.seconds / options.dt)
    print("| scene | MuJoCo, us | libdyn, us | ratio | overlap, m | | energy grown, J | | residual |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name in options.scenes or SCENES:
            path = Path(folder) / "scene.xml"
            path.write_text(scene_text(SCENES[name], options.dt))
            theirs, mine = of_mujoco(path, steps), of_libdyn(path, steps, options.dt)
            print(
                f"| {name} | {1e6 * theirs[0]:.3g} | {1e6 * mine[0]:.3g} | {mine[0] / theirs[0]:.2f} | {theirs[1]:.1g} | {mine[1]:.1g} "
                f"| {theirs[2]:.1g} | {mine[2]:.1g} | {mine[3].residual:.1g} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
