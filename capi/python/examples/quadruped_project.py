"""A quadruped in four stages: what it is, where its feet are, what holds it up, and two threads that share it.

    python quadruped_project.py [ROBOT.urdf]

capi/examples/quadruped.cpp is the same in C++.
"""

import sys
import threading
from collections import Counter
from pathlib import Path

import numpy as np

import libdyn as dyn

GO2 = Path(__file__).resolve().parents[3] / "models" / "robots" / "go2.urdf"
FEET = ("FL_foot", "FR_foot", "RL_foot", "RR_foot")


def what_it_is(path):
    """Stage 1. The base is never guessed: this file's root link has mass, so that loading it wants a word on what holds it."""
    try:
        dyn.load(path)
        raise AssertionError("a root link with mass, and nothing said")
    except dyn.BaseChoiceError:
        pass
    model = dyn.load(path, base="floating")
    assert (model.nq, model.nv, model.njoints) == (19, 18, 14), "position and quaternion, twelve angles; the universe is joint 0"
    assert model.nq == sum(j.nq for j in model.joints) and model.nv == sum(j.nv for j in model.joints)
    kinds = Counter(f.type.name for f in model.frames)
    assert (kinds["JOINT"] == model.njoints - 1
            and kinds["BODY"] == model.nbodies), "each joint has a frame, and each link, merged or not"
    assert kinds["BODY"] == 1 + 12 + kinds["FIXED_JOINT"], "links: the base, one on each joint, one on each fixed joint"
    assert sum(kinds.values()) == model.nframes, "and the universe"
    print(f"1. {model.name}: nq {model.nq}, nv {model.nv}, {model.njoints} joints, {model.nframes} frames: {dict(kinds)}; "
          f"{model.total_mass:.4g} kg")
    return model


def where_the_feet_are(model, data, q, v):
    """Stage 2. Positions and 6 x 18 Jacobians, J v = twist."""
    data.forward_kinematics(q, v)
    for foot in FEET:
        J = data.frame_jacobian(foot, "local_world_aligned")
        assert J.shape == (6, 18)
        assert np.abs(J @ v - data.frame_velocity(foot, "local_world_aligned")).max() < 1e-13
        # a foot follows the base's six coordinates and its own leg's three joints
        assert np.count_nonzero(np.abs(J).max(axis=0) > 1e-12) <= 9
    p = [data.frame_placement(foot).translation for foot in FEET]
    h = 1e-6
    data.forward_kinematics(model.integrate(q, h * v))
    after = [data.frame_placement(foot).translation for foot in FEET]
    data.forward_kinematics(model.integrate(q, -h * v))
    before = [data.frame_placement(foot).translation for foot in FEET]
    data.forward_kinematics(q, v)
    for foot, a, b in zip(FEET, after, before):
        assert np.abs((a - b) / (2 * h) - data.frame_velocity(foot, "local_world_aligned")[:3]).max() < 1e-7
    print("2. feet at", ", ".join(f"{foot[:2]} {np.round(x, 3)}" for foot, x in zip(FEET, p)))


def what_holds_it(model, data, q, v, a):
    """Stage 3. Gravity, inverse dynamics, and back."""
    zero = np.zeros(model.nv)
    assert np.array_equal(data.rnea(q, zero, zero), data.gravity_torque(q)), "at rest inverse dynamics is gravity, bit for bit"
    R = data.frame_placement("base").rotation
    assert (np.abs(R @ data.gravity_torque(q)[:3] - [0, 0, 9.81 * model.total_mass]).max()
            < 1e-11), "what the base lacks is the robot's weight"
    tau = data.rnea(q, v, a)
    eps, M = np.finfo(float).eps, data.crba(q)
    assert np.abs(data.aba(q, v, tau) - a).max() < 50 * eps * np.linalg.cond(M)
    assert np.array_equal(M, M.T), "M is full: no triangle is left for the caller"
    print(f"3. its weight is {9.81 * model.total_mass:.5g} N; the joints hold their links with "
          f"{np.round(data.gravity_torque(q)[6:9], 3)} N m (front left leg)")


def two_threads(model, q, v, a):
    """Stage 4. One model, a data for each thread: a controller and a planner, and the same bits as one after the other."""
    states = [model.integrate(q, 1e-3 * k * v) for k in range(500)]

    def control(data):
        return [data.rnea(x, v, a) for x in states]

    def plan(data):
        return [data.aba_derivatives(x, v, np.zeros(model.nv)).ddq_dq for x in states]

    alone = control(model.data()), plan(model.data())
    together: list = [None, None]

    def work(k, job):
        together[k] = job(model.data())

    threads = [threading.Thread(target=work, args=x) for x in enumerate((control, plan))]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert all(np.array_equal(x, y) for one, two in zip(alone, together) for x, y in zip(one, two))
    print(f"4. two threads with a data each computed {2 * len(states)} states and got the same bits as one alone")


def main(path=GO2):
    model = what_it_is(path)
    random = np.random.default_rng(0)
    q, v, a = model.neutral(), random.standard_normal(model.nv), random.standard_normal(model.nv)
    q[7:] = [0, 0.8, -1.6] * 4
    data = model.data()
    where_the_feet_are(model, data, q, v)
    what_holds_it(model, data, q, v, a)
    two_threads(model, q, v, a)


if __name__ == "__main__":
    main(*sys.argv[1:])
