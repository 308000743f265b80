"""Placements and rotations: closed forms, finite differences, and Pinocchio where it is installed."""

import numpy as np
import pytest

import libdyn as dyn
from libdyn import Placement, spatial

close = np.testing.assert_allclose


def twists(count=40, angle=None):
    """Random ones; angle: of all of them."""
    random = np.random.default_rng(3)
    m = random.standard_normal((count, 6))
    if angle is not None:
        m[:, 3:] *= angle / np.linalg.norm(m[:, 3:], axis=1, keepdims=True)
    return m


def placements(count=40):
    return Placement.exp(twists(count))


ANGLES = [0.0, 1e-160, 1e-9, 1e-4, 0.1, 0.999, 1.001, 1.999, 2.001, 3.0, np.pi - 1e-7]


def test_group():
    A, B, C = placements(), placements().inverse(), Placement(np.eye(3), np.array([1.0, 2, 3]))
    assert ((A @ B) @ C).is_close(A @ (B @ C), 1e-12) and (A @ A.inverse()).is_close(Placement.identity(), 1e-12)
    assert not A.is_close(B)
    close((A @ C).matrix, A.matrix @ C.matrix, atol=1e-14)
    assert Placement.from_matrix(A.matrix) == A and A == A and not A == B and A != B
    p = np.random.default_rng(0).standard_normal((40, 3))
    close(A @ p, A.act(p))
    close(A.act(p), np.einsum("nij,nj->ni", A.rotation, p) + A.translation, atol=1e-14)
    close(C @ p, p + [1, 2, 3])
    R, t = A  # a pair, as before
    assert R is A.rotation and t is A.translation


def test_motions_forces_and_inertias():
    A = placements(5)
    m, f = twists(5), twists(5)[::-1]
    close(A.act_motion(m), (A.adjoint @ m[..., None])[..., 0], atol=1e-13)
    close(np.sum(A.act_force(f) * A.act_motion(m), 1), np.sum(f * m, 1), atol=1e-12)  # power is the same
    spd = np.random.default_rng(1).standard_normal((5, 6, 6))
    spd = spd @ np.swapaxes(spd, 1, 2)
    momentum = (A.act_inertia(spd) @ A.act_motion(m)[..., None])[..., 0]
    close(momentum, A.act_force((spd @ m[..., None])[..., 0]), rtol=1e-10, atol=1e-10)
    assert (A @ A).adjoint == pytest.approx(A.adjoint @ A.adjoint, abs=1e-12)


@pytest.mark.parametrize("angle", ANGLES)
def test_logarithms_undo_exponentials(angle):
    m = twists(angle=angle)
    tolerance = 2e-7 if angle > 3.1 else 1e-12
    close(spatial.log6(spatial.exp6(m)), m, atol=tolerance)
    close(spatial.log3(spatial.exp3(m[:, 3:])), m[:, 3:], atol=tolerance)
    if 0 < angle < 1e-8:  # the direction of tiny rotations stays
        close(spatial.log3(spatial.exp3(m[:, 3:])) / angle, m[:, 3:] / angle, rtol=1e-8, atol=1e-8)


def test_exponential_is_the_series_of_the_matrix():
    """exp of the 4 x 4 matrix of a twist by its power series."""
    for m in twists(10):
        M, term, total = np.zeros((4, 4)), np.eye(4), np.eye(4)
        M[:3, :3], M[:3, 3] = spatial.skew(m[3:]), m[:3]
        for k in range(1, 40):
            term = term @ M / k
            total = total + term
        close(spatial.exp6(m).matrix, total, atol=1e-12)


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize("angle", [0.0, 1e-5, 0.3, 0.999, 1.001, 1.999, 2.001, 3.0])
def test_jacobians_are_finite_differences(side, angle):
    h = 1e-6
    for m in twists(4, angle):
        J, J3 = spatial.Jexp6(m, side), spatial.Jexp3(m[3:], side)
        X = spatial.exp6(m)
        for k in range(6):
            e = h * np.eye(6)[k]
            a, b = spatial.exp6(m + e), spatial.exp6(m - e)
            change = (b.inverse() @ a if side == "right" else a @ b.inverse()).log() / (2 * h)
            close(J[:, k], change, atol=2e-8)
            if k >= 3:
                close(J3[:, k - 3], change[3:], atol=2e-8)
        close(spatial.Jlog6(X, side) @ J, np.eye(6), atol=1e-11)
        close(spatial.Jlog3(X.rotation, side) @ J3, np.eye(3), atol=1e-11)


def test_right_and_left_are_related_by_the_adjoint():
    m = twists()
    close(spatial.Jexp6(m, "left"), spatial.exp6(m).adjoint @ spatial.Jexp6(m), atol=1e-11)
    with pytest.raises(dyn.ArgumentError, match="'right' or 'left'"):
        spatial.Jexp6(m, "middle")


def test_pinocchio():
    pin = pytest.importorskip("pinocchio")
    for m in [*twists(20), *twists(3, 1e-5), *twists(3, 3.0)]:
        X, mine = pin.exp6(m), spatial.exp6(m)
        close(mine.matrix, X.homogeneous, atol=1e-13)
        close(spatial.log6(mine), pin.log6(X).vector, atol=1e-10)
        close(spatial.Jexp6(m), pin.Jexp6(m), atol=1e-9)
        close(spatial.Jlog6(mine), pin.Jlog6(X), atol=1e-9)
        close(spatial.Jexp3(m[3:]), pin.Jexp3(m[3:]), atol=1e-9)
        close(spatial.Jlog3(mine.rotation), pin.Jlog3(X.rotation), atol=1e-9)
        close(mine.adjoint, X.action, atol=1e-13)
        close(mine.act_force(m), X.act(pin.Force(m)).vector, atol=1e-12)
        close(mine.rpy, pin.rpy.matrixToRpy(X.rotation), atol=1e-12)
        q = pin.Quaternion(X.rotation).coeffs()
        close(mine.quaternion, q if q[3] >= 0 else -q, atol=1e-12)


def test_conversions():
    A = placements()
    p = A.translation
    assert Placement.from_quaternion(A.quaternion, p).is_close(A, 1e-13) and Placement.from_rpy(A.rpy, p).is_close(A, 1e-13)
    assert Placement.from_quaternion(-3 * A.quaternion, p).is_close(A, 1e-13)
    quarter = Placement.from_rpy((0, 0, np.pi / 2))
    close(quarter @ [1.0, 0, 0], [0, 1, 0], atol=1e-15)
    for turn in np.eye(3) * np.pi:  # half turns, where the scalar part is zero
        close(np.abs(spatial.log3(spatial.exp3(turn))), turn, atol=1e-14)
    gimbal = spatial.rpy_to_matrix([0.3, np.pi / 2, -0.2])
    close(spatial.rpy_to_matrix(spatial.matrix_to_rpy(gimbal)), gimbal, atol=1e-12)


def test_shapes():
    """Leading axes stay, those of several arguments are broadcast, and none or no elements are arrays as well."""
    w = np.random.default_rng(2).standard_normal((2, 3, 3))
    R = spatial.exp3(w)
    assert R.shape == (2, 3, 3, 3) and spatial.log3(R).shape == (2, 3, 3)
    assert spatial.Jexp6(np.zeros((4, 0, 6))).shape == (4, 0, 6, 6)
    close(R[1, 2], spatial.exp3(w[1, 2]), atol=0)
    close(spatial.exp3(w[::-1, ::2]), R[::-1, ::2], atol=0)  # of views
    between = spatial.interpolate(np.eye(3), R[0], [[0.0], [0.5], [1.0]])
    assert between.shape == (3, 3, 3, 3)
    close(between[1, 2], spatial.exp3(w[0, 2] / 2), atol=1e-14)


def test_interpolation():
    A, B = placements(1), Placement.exp(twists(2)[1:])
    A, B = Placement(A.rotation[0], A.translation[0]), Placement(B.rotation[0], B.translation[0])
    between = A.interpolate(B, np.linspace(0, 1, 5))
    assert Placement(between.rotation[0], between.translation[0]).is_close(A, 1e-13)
    assert Placement(between.rotation[4], between.translation[4]).is_close(B, 1e-13)
    steps = [(Placement(*(x[k] for x in between)).inverse() @ Placement(*(x[k + 1] for x in between))).log() for k in range(4)]
    close(steps, np.tile(steps[0], (4, 1)), atol=1e-12)
    close(spatial.interpolate(A.rotation, B.rotation, 0.5) @ spatial.exp3(np.zeros(3)),
          spatial.interpolate(B.rotation, A.rotation, 0.5), atol=1e-12)


def test_what_makes_no_sense():
    A = placements(1)
    for wrong in (lambda: A + A, lambda: A + (1,), lambda: (1,) + A, lambda: np.eye(4) + A, lambda: A * 2, lambda: 2 * A,
                  lambda: A - A):
        with pytest.raises(TypeError, match="A @ B composes"):
            wrong()
    with pytest.raises(TypeError, match="from_matrix"):
        A @ np.eye(4)
    with pytest.raises(TypeError, match="left side of @"):
        np.eye(4) @ A
    with pytest.raises(dyn.SizeError, match="twist has shape"):
        Placement.exp([1, 2, 3])
    with pytest.raises(dyn.SizeError, match="last row"):
        Placement.from_matrix(np.ones((4, 4)))
    with pytest.raises(dyn.QuaternionError, match="quaternion_to_matrix: quaternion, element 0, .*no rotation"):
        Placement.from_quaternion([0, 0, 0, 0])
    with pytest.raises(dyn.NonFiniteError, match=r"spatial.exp6: twist\[2\] is NaN"):
        Placement.exp([0, 0, np.nan, 0, 0, 0])
    with pytest.raises(dyn.InvalidRobotError, match="spatial.log3: R, element 1, is no rotation"):
        spatial.log3([np.eye(3), np.ones((3, 3))])
    with pytest.raises(TypeError, match="unhashable"):
        hash(A)


def test_those_of_frames(go2, state):
    """A model's placements are such: the relative pose of two frames, and what an arm sees of a point."""
    d = go2.data()
    d.forward_kinematics(state[0])
    base, foot = d.frame_placement("base"), d.frame_placement("FL_foot")
    relative = base.inverse() @ foot
    close((base @ relative).matrix, foot.matrix, atol=1e-12)
    close(base @ relative.translation, foot.translation, atol=1e-12)
    every = d.frame_placements()
    assert (every @ every.inverse()).is_close(Placement.identity(), 1e-12)
    with pytest.raises(dyn.ArgumentError, match="read|view"):
        d.q[0] = 1
