"""What tests of doors share: robots, states at which functions are smooth, and differences."""

import numpy as np
import pytest
from conftest import MODELS

import libdyn as dyn
from libdyn.doors.function import NAMES, Function

ROBOTS = {"panda": "fixed", "go2": "floating"}
every = pytest.mark.parametrize("robot, name", [(robot, name) for robot in ROBOTS for name in NAMES])


def load(robot):
    return dyn.load(MODELS / "robots" / f"{robot}.urdf", base=ROBOTS[robot])


def options(model, name):
    return {"frame": model.nframes - 1} if name == "frame_placement" else {}


def opened(robot, name):
    """A function, and inputs of three states: joints within their limits, no velocity near zero (dry friction), quaternions of
    norm 1.3."""
    m, rng = load(robot), np.random.default_rng(3)
    f = Function(m, name, threads=1, **options(m, name))
    lower, upper = np.maximum(m.lower_limit, -1), np.minimum(m.upper_limit, 1)
    q = lower + (upper - lower) * rng.uniform(0.4, 0.6, (3, m.nq))
    if m.nq > m.nv:
        q[:, 3:7] = rng.standard_normal((3, 4))
        q[:, 3:7] *= 1.3 / np.linalg.norm(q[:, 3:7], axis=1, keepdims=True)
    x = [q, *(rng.uniform(0.2, 1, (3, i.size)) * rng.choice([-1, 1], (3, i.size)) for i in f.inputs[1:])]
    return f, x


def derivative(f, x, i, k, h=1e-3):
    """Of the outputs f(*x) by number k of input i: central differences of order six."""
    def at(t):
        moved = [np.array(a) for a in x]
        moved[i][..., k] += t * h
        return f(*moved)

    steps = [[(a - b) / h for a, b in zip(at(t), at(-t))] for t in (1, 2, 3)]
    return [(45 * a - 9 * b + c) / 60 for a, b, c in zip(*steps)]


def assert_derivatives(f, x, J, tolerance=1e-8):
    """J[o][i] against differences, relative to the largest number of each output's."""
    for i, a in enumerate(x):
        columns = [derivative(f, x, i, k) for k in range(a.shape[-1])]
        for o, by in enumerate(J):
            expected = np.stack([c[o] for c in columns], -1)
            atol = tolerance * max(1, abs(expected).max())
            np.testing.assert_allclose(by[i], expected, atol=atol, rtol=0, err_msg=f"{o} by {i}")


def tuples(y):
    return tuple(np.asarray(a) for a in y) if isinstance(y, (tuple, list)) else (np.asarray(y),)
