"""The JAX door: values, both modes of differentiation, vmap and jit; compiled and through callbacks."""

import doors
import numpy as np
import pytest

jax = pytest.importorskip("jax", reason="package jax is not installed")
jax.config.update("jax_enable_x64", True)

import libdyn as dyn  # noqa: E402
from libdyn.doors import jax as door  # noqa: E402
from libdyn.doors.compiled import compiler  # noqa: E402

def outputs(y):
    return y if isinstance(y, tuple) else (y,)


method = pytest.mark.parametrize("method", ["callback", *(["compiled"] if compiler("c++") else [])])


@method
@doors.every
def test_derivatives(robot, name, method):
    f, x = doors.opened(robot, name)
    g = door.function(f.model, name, method=method, threads=2, **doors.options(f.model, name))
    expected = f(*x)
    for y in (g(*x), jax.jit(jax.vmap(g))(*x)):
        for a, b in zip(doors.tuples(y), expected):
            np.testing.assert_allclose(a, b, atol=1e-11)
    inputs = tuple(range(len(x)))
    for mode in (jax.jacrev, jax.jacfwd):
        J = jax.jit(jax.vmap(mode(lambda *x: outputs(g(*x)), inputs)))(*x)
        doors.assert_derivatives(f, x, J)


@method
def test_a_gradient_through_a_rollout(method):
    """Of the height after ten steps by the first velocity and by a torque held, against differences."""
    m = doors.load("panda")
    step = door.function(m, "step", dt=1e-2, method=method, threads=1)
    q0 = (np.maximum(m.lower_limit, -3) + np.minimum(m.upper_limit, 3)) / 2
    hand = door.function(m, "frame_placement", frame=m.nframes - 1, method=method, threads=1)

    def height(v, tau):
        def body(state, _):
            return step(*state, tau), None

        (q, _), _ = jax.lax.scan(body, (q0, v), None, length=10)
        return hand(q)[11]

    x = [np.full(m.nv, 0.5), np.full(m.nv, 0.1)]
    gradients = jax.jit(jax.grad(height, (0, 1)))(*x)
    doors.assert_derivatives(lambda *x: [np.asarray(jax.jit(height)(*x))[None]], x, [[np.asarray(g)[None] for g in gradients]])


@method
def test_errors_of_the_library(method):
    m = doors.load("go2")
    g = door.function(m, "aba", method=method)
    with pytest.raises(Exception, match=r"v\[0\] is|v.*not finite|NaN|nan"):
        g(m.neutral(), np.full(18, np.nan), np.zeros(18)).block_until_ready()
    assert np.isfinite(g(m.neutral(), np.zeros(18), np.zeros(18))).all(), "it goes on"
    assert g(np.zeros((0, 19)), np.zeros((0, 18)), np.zeros((0, 18))).shape == (0, 18)


def test_refusals():
    m = doors.load("go2")
    with pytest.raises(dyn.ArgumentError, match="method"):
        door.function(m, "aba", method="fast")
    with pytest.raises(dyn.SizeError, match="tau"):
        door.function(m, "aba", method="callback")(m.neutral(), np.zeros(18), np.zeros(3))
    jax.config.update("jax_enable_x64", False)
    try:
        with pytest.raises(dyn.ArgumentError, match="jax_enable_x64"):
            door.function(m, "aba")
    finally:
        jax.config.update("jax_enable_x64", True)
