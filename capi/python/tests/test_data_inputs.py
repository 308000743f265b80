"""Inputs of data: arrays of all kinds, what is refused, states held and by joint."""

import json

import numpy as np
import pytest

import libdyn as dyn


@pytest.fixture
def d(go2):
    return go2.data()


def test_array_likes(arm):
    d = arm.data()
    expected = d.rnea(np.array([1.0, 2]), np.array([3.0, 4]), np.array([5.0, 6]))
    strided = np.arange(1.0, 13).reshape(6, 2)[:, ::1]
    for q in (
        [1, 2],
        (1.0, 2.0),
        np.array([1, 2]),
        np.array([1, 2], np.float32),
        range(1, 3),
        strided[0],
        np.array([1.0, 9, 2])[::2],
    ):
        np.testing.assert_array_equal(d.rnea(q, [3, 4], np.array([5, 9, 6])[::2]), expected)


def test_wrong_shapes(d, go2):
    q, v = go2.neutral(), np.zeros(18)
    for bad in (v, q[None], 1.0, [], np.zeros((0,))):
        with pytest.raises(dyn.SizeError, match=r"q has shape .* must have shape \(19,\)"):
            d.gravity_torque(bad)
    with pytest.raises(dyn.SizeError, match=r"v has shape \(19,\), but must have shape \(18,\)"):
        d.rnea(q, q, v)
    with pytest.raises(dyn.SizeError, match=r"fext has shape \(18,\), but must have shape \(6, 14\)"):
        d.rnea(q, v, v, v)
    with pytest.raises(ValueError):
        d.q = v


def test_wrong_kinds(d, go2):
    for bad in ("text", ["a"] * 19, np.zeros(19, complex), np.zeros(19, object), [[1, 2], [3]], np.zeros(19, bool)):
        with pytest.raises(dyn.ArgumentError):
            d.gravity_torque(bad)


def test_not_finite_leaves_the_data_alone(d, go2, state):
    q, v, a, _ = state
    tau = d.rnea(q, v, a)
    bad = v.copy()
    bad[4] = np.nan
    with pytest.raises(dyn.NonFiniteError, match="4"):
        d.rnea(q, bad, a)
    np.testing.assert_array_equal(d.tau, tau)
    np.testing.assert_array_equal(d.v, v)
    q = q.copy()
    q[3:7] = 0
    with pytest.raises(dyn.QuaternionError):
        d.gravity_torque(q)


def test_held_state(d, state):
    q, v, a, tau = state
    d.set_state(q, v, a, tau)
    np.testing.assert_array_equal(d.rnea(), d.rnea(q, v, a))
    d.set_state(tau=tau)
    np.testing.assert_array_equal(d.aba(), d.aba(q, v, tau))
    d.v = 2 * v
    np.testing.assert_array_equal(d.v, 2 * v)
    np.testing.assert_array_equal(d.tau_applied, tau)


def test_state_dictionaries(d, go2, state, gripper):
    q, v, a, tau = state
    d.set_state(q, v, a, tau)
    saved = json.loads(json.dumps({k: x.tolist() for k, x in d.state.items()}))
    assert set(saved) == {"q", "v", "a", "tau"}
    other = go2.data()
    other.set_state(**saved)
    np.testing.assert_array_equal(other.aba(), d.aba())
    # by joint
    joint = go2.joints[3]
    d.set_state(q={joint.name: 0.25}, v={joint.name: [2]})
    expected = go2.neutral()
    expected[joint.idx_q] = 0.25
    np.testing.assert_array_equal(d.q, expected)
    assert d.v[joint.idx_v] == 2 and np.count_nonzero(d.v) == 1
    d.q = {"root_joint": [1, 2, 3, 0, 0, 0, 1]}
    assert d.q[:3].tolist() == [1, 2, 3]
    assert go2.integrate(go2.neutral(), {joint.name: 0.5})[joint.idx_q] == 0.5
    with pytest.raises(dyn.SizeError, match=r"q\['root_joint'\] has shape \(2,\), but must have shape \(7,\)"):
        d.q = {"root_joint": [1, 2]}
    with pytest.raises(dyn.UnknownNameError):
        d.q = {"nothing": 1}
    with pytest.raises(dyn.ArgumentError, match="follows 'left_knuckle_joint'"):
        gripper.data().q = {"thumb_joint": 1}
