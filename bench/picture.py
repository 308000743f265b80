#!/usr/bin/env python3
"""The picture of capi/pages/exercises.md: a quadruped that stands and is pushed, with the forces on its feet, from the simulation
of capi/python/examples/quadruped_stands.py.

    PYTHONPATH=capi/python python3 bench/picture.py [--svg bench/quadruped.svg]

Left the robot as the push from the left begins; right the forces on each foot and where the trunk is, over time. Needs
matplotlib.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

PROJECT = Path(__file__).resolve().parent.parent
sys.path.append(str(PROJECT / "capi/python/examples"))

import libdyn as dyn  # noqa: E402
import quadruped_stands as stands  # noqa: E402
from standing import FEET, standing  # noqa: E402

SECONDS, PUSH, LASTS, FORCE = 1.5, 0.5, 0.2, np.array([0, -60.0, 0])
SCALE = 1 / 250  # m/N, of arrows
COLORS = ("#c0392b", "#2471a3", "#d68910", "#1e8449")


def simulate():
    """Times, trunk positions, forces on each foot; and the robot in the push: frames, forces."""
    model = stands.grounded()
    home = stands.on_the_ground(model, standing(model))
    robot, mind = model.data(), model.data()
    robot.set_effects(dyn.Effect.ARMATURE | dyn.Effect.LIMITS)
    robot.set_step_options("semi_implicit_euler", stands.DT)
    robot.set_state(home)
    legs = [foot.split("_")[0] for foot in FEET]
    times, trunk, feet, motors, scene = [], [], [], None, None
    for k in range(round(SECONDS / stands.DT)):
        t = k * stands.DT
        q, v = np.array(robot.q), np.array(robot.v)
        if k % stands.EVERY == 0:
            motors = stands.controller(model, mind, q, v, home)
        robot.clear_wrenches()
        if PUSH <= t < PUSH + LASTS:
            robot.apply_wrench("base", [*FORCE, 0, 0, 0])
        robot.set_state(tau=np.r_[np.zeros(6), motors])
        robot.step()
        forces, points = np.zeros((4, 3)), np.zeros((4, 3))
        for c in robot.step_contacts():
            a, b = (model.frame_name(model.shape(s).frame) for s in (c.contact.shape_a, c.contact.shape_b))
            leg = legs.index((a if a != "universe" else b).split("_")[0])
            forces[leg] += c.force_on_b if a == "universe" else -c.force_on_b
            points[leg] = c.contact.position
        times.append(t), trunk.append(np.array(robot.q[:3]) - home[:3]), feet.append(forces)
        if scene is None and t >= PUSH + LASTS / 4:
            robot.forward_kinematics(robot.q)
            scene = {"frames": {f.name: robot.frame_placement(f.id) for f in model.frames}, "forces": forces, "points": points}
    return model, np.array(times), np.array(trunk), np.array(feet), scene


def box(ax, X, size, **style):
    """Edges of a box."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * np.asarray(size) / 2
    p = X.translation + corners @ X.rotation.T
    for i in range(8):
        for j in range(i):
            if bin(i ^ j).count("1") == 1:
                ax.plot(*np.array([p[i], p[j]]).T, **style)


def arrow(ax, start, vector, color):
    ax.quiver(*start, *(vector * SCALE), color=color, lw=2, arrow_length_ratio=0.15)


def draw(path):
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    model, times, trunk, feet, scene = simulate()
    figure = Figure(figsize=(11, 4.6))
    FigureCanvasSVG(figure)
    ax = figure.add_axes([-0.03, -0.1, 0.52, 1.2], projection="3d", computed_zorder=False)
    X = scene["frames"]
    x, y = np.meshgrid([-0.45, 0.45], [-0.4, 0.4])
    ax.plot_surface(x, y, 0 * x, color="0.93", shade=False, zorder=-1)
    base = max((s for s in model.shapes if model.frame_name(s.frame) == "base" and s.type == dyn.ShapeType.BOX),
               key=lambda s: np.prod(s.size))
    at = dyn.Placement(X["base"].rotation @ base.placement.rotation,
                       X["base"].translation + X["base"].rotation @ base.placement.translation)
    box(ax, at, base.size, color="0.35", lw=1.5)
    for foot, color, force, point in zip(FEET, COLORS, scene["forces"], scene["points"]):
        leg = foot.split("_")[0]
        chain = [X[f"{leg}_{part}"].translation for part in ("hip", "thigh", "calf", "foot")]
        ax.plot(*np.array(chain).T, "-o", color="0.35", lw=3, ms=4)
        arrow(ax, point, force, color)
    arrow(ax, X["base"].translation - FORCE * SCALE - (0, -0.05, 0), FORCE, "k")
    ax.text(*(X["base"].translation - FORCE * SCALE * 1.3), "60 N", fontsize=9)
    ax.set_xlim(-0.35, 0.35), ax.set_ylim(-0.35, 0.35), ax.set_zlim(0, 0.45), ax.set_box_aspect((0.7, 0.7, 0.45))
    ax.view_init(18, -52), ax.set_axis_off()
    top, bottom = figure.add_axes([0.55, 0.58, 0.43, 0.36]), figure.add_axes([0.55, 0.12, 0.43, 0.36])
    for k, (foot, color) in enumerate(zip(FEET, COLORS)):
        top.plot(times, feet[:, k, 2], color=color, lw=1.2, label=foot.split("_")[0])
    bottom.plot(times, 1e3 * trunk[:, 1], "k", lw=1.2)
    top.set_ylabel("on each foot, vertical, N"), bottom.set_ylabel("trunk, sideways, mm"), bottom.set_xlabel("s")
    top.legend(ncols=4, frameon=False, fontsize=8, loc="upper right"), top.set_ylim(0, 1.25 * feet[..., 2].max())
    for plot in (top, bottom):
        plot.axvspan(PUSH, PUSH + LASTS, color="0.9"), plot.set_xlim(0, SECONDS)
        plot.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, metadata={"Date": None})
    weight = 9.81 * model.total_mass
    print(f"{path}: at rest the feet carry {feet[-1, :, 2].sum():.5g} N of {weight:.5g} N; pushed with 60 N for {LASTS} s the "
          f"trunk moves {1e3 * np.abs(trunk[:, 1]).max():.3g} mm")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--svg", type=Path, default=PROJECT / "bench/quadruped.svg")
    draw(parser.parse_args().svg)
