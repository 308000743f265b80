"""What accuracy costs: orders of the integrators, measured, and a recommendation that is kept.

    python accuracy_study.py [FILE.svg]

dyn.accuracy.sweep tries every integrator at every step on a double pendulum, against a reference known to rounding. In a diagram
of error against step, both logarithmic, an integrator of order p falls with slope p until rounding stops it. The cheapest setting
that meets a target is then run by itself.
"""

import json
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np

import libdyn as dyn

PENDULUM = Path(__file__).resolve().parents[3] / "models" / "robots" / "double_pendulum.urdf"
ORDERS = {"semi_implicit_euler": 1, "implicit_fast": 1, "implicit_midpoint": 2, "rk4": 4}
Q, DURATION, TARGET = [1.2, 0.4], 1.0, 1e-6


def order(points):
    """Slope of the error where it is neither so large that it is no error any more, nor near rounding."""
    good = [(p["dt"], p["errors"]["m"]) for p in points if not p["failed"] and 1e-11 < p["errors"]["m"] < 1e-2]
    steps, errors = np.array(sorted(good)[:4]).T
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


def data_at(q):
    """Data of the pendulum at q."""
    data = dyn.load(PENDULUM, base="fixed").data()
    data.forward_kinematics(q, [0, 0], [0, 0])
    return data


def main(svg=None):
    result = dyn.accuracy.sweep(PENDULUM, base="fixed", q=Q, without="limits", duration=DURATION, target=f"{TARGET}m",
                                budget="3s")
    reference = result["reference"]
    print(f"reference: {reference['kind']}, known to {reference['uncertainty']['m']:.1g} m")
    for name, points in dyn.accuracy.methods(result).items():
        if name in ORDERS:
            slope = order(points)
            print(f"{name:20} order {ORDERS[name]}, measured {slope:.2f}")
            assert abs(slope - ORDERS[name]) < 0.3
    best = result["recommended"]
    print(f"cheapest for {TARGET} m: {best['command']}")
    assert best["errors"]["m"] <= TARGET

    # the recommended command, run by itself, beside the reference
    words = [dyn.accuracy.command(), *shlex.split(best["command"])[1:], "--json"]
    found = json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
    robot = data_at(found["q"])
    exact = data_at(Q)
    exact.set_effects(dyn.Effect.ALL & ~dyn.Effect.LIMITS & ~dyn.Effect.SLEEPING)
    exact.set_step_options("reference", 1e-2)
    exact.advance(DURATION)
    exact.forward_kinematics()
    apart = np.linalg.norm(robot.frame_placements().translation - exact.frame_placements().translation, axis=1).max()
    print(f"that command ends {apart:.2g} m from the reference")
    assert apart <= TARGET
    if svg:
        dyn.accuracy.plot(result, svg)


if __name__ == "__main__":
    main(*sys.argv[1:])
