"""A quadruped that stands on the ground and is pushed, in simulation: half a minute, 60 N for 0.2 s from each of four sides.

    python quadruped_stands.py [SECONDS] [--record FOLDER]

The controller (standing.py: floating base, foot Jacobians, contact forces in their cones) asks for an acceleration of the trunk
that takes it back to where it stood; the simulator knows nothing of it but the torques. Prints what came of it and what it cost.
--record writes where it began and every torque into FOLDER/stands.json and stands.csv, from which `dyn sim` makes the same motion
again, bit for bit:

    dyn sim models/robots/go2.urdf --floating --ground --effects armature,limits --state FOLDER/stands.json \\
        --tau-csv FOLDER/stands.csv --duration SECONDS --html stands.html
"""

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np
from standing import GO2, inverse_dynamics, standing

import libdyn as dyn

PUSHES = (("front", (-1, 0, 0)), ("left", (0, -1, 0)), ("back", (1, 0, 0)), ("right", (0, 1, 0)))
FORCE, LASTS = 60.0, 0.2  # N, s
DT, EVERY = 1e-3, 2  # s, steps of the simulator between those of the controller
STIFFNESS, DAMPING = 120.0, 22.0  # 1/s^2, 1/s, of the trunk
WEIGHTS = np.array([1, 1, 1, 10, 10, 10.0])  # it may be moved, but should not turn over


def grounded(path=GO2):
    """The robot and the half-space below z = 0; its motors alone act in its joints."""
    return dyn.Builder.from_model(dyn.load(path, base="floating")).add_shape("universe", "half_space", name="ground").finish()


def on_the_ground(model, q):
    """q, as low as its shapes allow."""
    data, ground = model.data(), model.nshapes - 1
    d = data.compute_distances(q)
    q = q.copy()
    q[2] -= min(d[k] for k, pair in enumerate(model.pairs) if ground in (pair.shape_a, pair.shape_b))
    return q


def controller(model, data, q, v, home):
    """Torques of the motors."""
    a = np.zeros(model.nv)
    error = model.difference(q, home)[:6]  # in the trunk's axes
    a[:6] = STIFFNESS * error - DAMPING * v[:6]
    return inverse_dynamics(model, data, q, v, a, tolerance=1e-7, epsilon=1e-3, weights=WEIGHTS).tau


def write(folder, start, rows):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "stands.json").write_text(json.dumps({"q": start.tolist()}))
    names = ",".join(["t", *(f"tau{k}" for k in range(len(rows[0]) - 1))])
    (folder / "stands.csv").write_text("\n".join([names, *(",".join(map(repr, map(float, row))) for row in rows)]) + "\n")


def main(seconds=30.0, record=None):
    model = grounded()
    home = on_the_ground(model, standing(model))
    robot, mind = model.data(), model.data()
    robot.set_effects(dyn.Effect.ARMATURE | dyn.Effect.LIMITS)
    robot.set_step_options("semi_implicit_euler", DT)
    robot.set_state(home)
    starts = [seconds * (k + 1) / 5 for k in range(len(PUSHES))]
    steps, away, least = round(seconds / DT), np.zeros(len(PUSHES) + 1), 4
    residual = penetration = thinking = moving = 0.0
    tau, motors, rows = np.zeros(model.nv), np.zeros(model.nv - 6), []
    for k in range(steps):
        t = k * DT
        q, v = np.array(robot.q), np.array(robot.v)
        began = time.perf_counter()
        if k % EVERY == 0:
            motors = controller(model, mind, q, v, home)
        tau[6:] = motors
        tau[:6] = 0
        for (_, direction), start in zip(PUSHES, starts):
            if start <= t < start + LASTS:
                mind.forward_kinematics(q)
                tau[:3] = FORCE * mind.frame_placement("base").rotation.T @ direction
        robot.set_state(None, None, None, tau)
        if record:
            rows.append([t, *tau])
        between = time.perf_counter()
        robot.step()
        moving += time.perf_counter() - between
        thinking += between - began
        report = robot.step_report
        residual, penetration = max(residual, report.residual), max(penetration, report.penetration)
        phase = sum(t >= start for start in starts)
        away[phase] = max(away[phase], np.linalg.norm(robot.q[:3] - home[:3]))
        if t > 0.1:
            least = min(least, report.contacts)
    if record:
        write(Path(record), home, rows)
    mass = model.total_mass
    forces = sum(c.force_on_b * (1 if c.contact.shape_b != model.nshapes - 1 else -1) for c in robot.step_contacts())
    print(f"stood {seconds:g} s in {steps} steps of {DT:g} s; at the end {1e3 * np.linalg.norm(robot.q[:3] - home[:3]):.3g} mm "
          f"from home, speed {np.abs(robot.v).max():.2g}")
    for (side, _), start, far in zip(PUSHES, starts, away[1:]):
        print(f"pushed from the {side} at {start:g} s with {FORCE:g} N for {LASTS:g} s: moved {1e3 * far:.3g} mm")
    print(f"contact forces at the end add up to {forces[2]:.6g} N, its weight is {9.81 * mass:.6g} N; never fewer than {least} "
          "contact points")
    print(f"deepest penetration {penetration:.2g} m, largest residual {residual:.2g}")
    print(f"the simulator took {1e6 * moving / steps:.3g} us a step ({seconds / moving:.3g} times real time), the controller "
          f"{1e6 * thinking / steps:.3g} us")
    fell = robot.q[2] < 0.5 * home[2] or away[0] > 0.05
    return int(fell)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("seconds", nargs="?", type=float, default=30.0)
    parser.add_argument("--record", metavar="FOLDER")
    options = parser.parse_args()
    sys.exit(main(options.seconds, options.record))
