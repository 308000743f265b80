"""The tangent map, and the functions that all doors open."""

import doors
import numpy as np
import pytest

import libdyn as dyn
from libdyn.doors.function import Function
from libdyn.doors.tangent import blocks, tangent_map, tangent_map_inverse, tangent_map_inverse_product, tangent_map_product

close = np.testing.assert_allclose


def joints():
    """A ball joint, cosines, a planar joint and a free flyer."""
    b = dyn.Builder("joints").add_joint("ball", "spherical").add_body("a", "ball", 1, (0.1, 0, 0.2), np.eye(3))
    b.add_joint("turn", "revolute_unbounded", parent="ball", axis=(0, 1, 0)).add_body("b", "turn", 1, (0.1, 0.3, 0), np.eye(3))
    b.add_joint("plane", "planar", parent="turn", axis=(0, 0, 1)).add_body("c", "plane", 1, (0.1, 0, 0.2), np.eye(3))
    b.add_joint("free", "free_flyer").add_body("d", "free", 1, (0.1, 0, 0.2), np.eye(3))
    return b.finish()


def stretched(m, q, factor):
    """q with quaternions and cosines of norm `factor`."""
    q = np.array(q)
    for block in blocks(m):
        normed = {"euclidean": 0, "circle": 2}.get(block.kind, 4)
        q[block.q.stop - normed : block.q.stop] *= factor
    return q


@pytest.mark.parametrize("m", [joints(), doors.load("go2"), doors.load("panda")], ids=lambda m: m.name)
def test_tangent_map(m):
    """T is the rate of integrate, and T+ that of difference, of quaternions of any norm. Order six: errors are of rounding."""
    q = m.random(4)
    T, inverse = tangent_map(m, q), tangent_map_inverse(m, q)
    assert T.shape == (m.nq, m.nv) and inverse.shape == (m.nv, m.nq)
    for k in range(m.nv):
        rate = doors.derivative(lambda v: [m.integrate(q, v)], [np.zeros(m.nv)], 0, k)[0]
        close(T[:, k], rate, atol=1e-10)
    long = stretched(m, q, 1.7)
    for k in range(m.nq):
        velocity = doors.derivative(lambda x: [m.difference(long, x)], [long], 0, k)[0]
        close(tangent_map_inverse(m, long)[:, k], velocity, atol=1e-10)
    close(inverse @ T, np.eye(m.nv), atol=1e-14)


def test_products_take_axes_in_front():
    m, rng = joints(), np.random.default_rng(1)
    q = np.array([[m.random(k) for k in range(3)], [m.random(k + 3) for k in range(3)]])
    v, dq = rng.standard_normal((2, 3, m.nv)), rng.standard_normal((2, 3, m.nq))
    close(tangent_map_product(m, q, v), np.einsum("abij,abj->abi", tangent_map(m, q), v), atol=1e-14)
    close(tangent_map_inverse_product(m, q, dq), np.einsum("abij,abj->abi", tangent_map_inverse(m, q), dq), atol=1e-14)


@doors.every
def test_jacobians(robot, name):
    f, x = doors.opened(robot, name)
    y, J = f.jacobians(*x)
    for a, b in zip(y, f(*x)):
        np.testing.assert_array_equal(a, b)
    doors.assert_derivatives(f, x, J)


def test_a_rolling_ball():
    """A step through a contact that sticks. Contacts are solved to 1e-12, which differences over 1e-3 make 1e-9."""
    b = dyn.Builder("ball").add_shape("universe", "half_space", material=dyn.Material(friction=0.5))
    b.add_joint("free", "free_flyer").add_body("ball", "free", 1.0, (0, 0, 0), 4e-3 * np.eye(3))
    f = Function(b.add_shape("ball", "sphere", (0.1,), material=dyn.Material(friction=0.5)).finish(), "step", dt=2e-3)
    x = [np.array([0, 0, 0.09, 0, 0, 0, 1.0]), np.array([0.3, 0, 0, 0, 3, 0]), np.zeros(6)]
    y, J = f.jacobians(*x)
    assert y[1][2] > 0, "pushed out"
    doors.assert_derivatives(f, x, J)


def test_controls_of_actuators():
    m = dyn.load_string("""<mujoco><worldbody><body><joint name="j" type="hinge" axis="0 1 0"/>
      <geom size="0.1" pos="0 0 -1"/></body></worldbody><actuator><position joint="j" kp="5"/></actuator></mujoco>""")
    f = Function(m, "step", dt=1e-2)
    assert [i.name for i in f.inputs] == ["q", "v", "tau", "control"]
    x = [np.array([0.3]), np.array([0.5]), np.array([0.1]), np.array([0.7])]
    doors.assert_derivatives(f, x, f.jacobians(*x)[1])


def test_refusals():
    m = doors.load("go2")
    for wrong, words in (({"name": "abba"}, "abba"), ({"name": "aba", "frame": 1}, "frame_placement"),
                         ({"name": "frame_placement"}, "frame"), ({"name": "rnea", "dt": 1e-3}, "dt")):
        with pytest.raises(dyn.ArgumentError, match=words):
            Function(m, **wrong)
    f = Function(m, "aba")
    with pytest.raises(dyn.SizeError, match="q, v, tau"):
        f(np.zeros(19), np.zeros(18))
    with pytest.raises(dyn.SizeError, match=r"v has shape \(3,\)"):
        f(m.neutral(), np.zeros(3), np.zeros(18))
    with pytest.raises(dyn.NonFiniteError):
        f(m.neutral(), np.full(18, np.nan), np.zeros(18))
    parts = [{"type": "spherical"}, {"type": "prismatic", "axis": (0, 0, 1)}]
    chain = dyn.Builder("chain").add_joint("c", "composite", parts=parts)
    with pytest.raises(dyn.UnsupportedError, match="'c'"):
        blocks(chain.add_body("a", "c", 1, (0, 0, 0), np.eye(3)).finish())
