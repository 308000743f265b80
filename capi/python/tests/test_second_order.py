"""Derivatives of frame motions, of the centre of mass and at rest, and second derivatives, through the package."""

import numpy as np
import pytest

import libdyn as dyn

close = np.testing.assert_allclose
REFERENCES = ("LOCAL", "WORLD", "LOCAL_WORLD_ALIGNED")


def rate(f, h=1e-5):
    return (f(h) - f(-h)) / (2 * h)


@pytest.mark.parametrize("reference", REFERENCES)
def test_frames(go2, state, reference):
    q, v, a, _ = state
    d, frame, u = go2.data(), "FL_foot", np.cos(np.arange(go2.nv))
    d.forward_kinematics(q, v, a)
    velocity, acceleration = d.frame_velocity_derivatives(frame, reference), d.frame_acceleration_derivatives(frame, reference)
    classical = d.frame_classical_acceleration_derivatives(frame, reference)
    J, H = d.frame_jacobian(frame, reference), d.frame_kinematic_hessian(frame, reference)
    for same in (velocity.dv_dv, acceleration.da_da, classical.da_da):
        np.testing.assert_array_equal(same, J)
    close(H @ v, d.frame_jacobian_time_variation(frame, reference), atol=1e-12)

    def moved(query, q, v):
        d.forward_kinematics(q, v, a)
        return query(frame, reference)

    for query, by_q, by_v in (
        (d.frame_velocity, velocity.dv_dq, J),
        (d.frame_acceleration, acceleration.da_dq, acceleration.da_dv),
        (d.frame_classical_acceleration, classical.da_dq, classical.da_dv),
        (d.frame_jacobian, H, np.zeros((6, go2.nv, go2.nv))),
    ):
        close(by_q @ u, rate(lambda t: moved(query, go2.integrate(q, t * u), v)), atol=1e-6)
        close(by_v @ u, rate(lambda t: moved(query, q, v + t * u)), atol=1e-6)


def test_at_rest_and_center_of_mass(go2, state):
    q, v, _, _ = state
    d, u = go2.data(), np.cos(np.arange(go2.nv))
    fext = np.sin(np.arange(6 * go2.njoints)).reshape((6, -1), order="F")
    close(d.gravity_torque_derivatives(q) @ u, rate(lambda t: d.gravity_torque(go2.integrate(q, t * u))), atol=1e-6)
    close(d.static_torque_derivatives(q, fext) @ u, rate(lambda t: d.compute_static_torque(go2.integrate(q, t * u), fext)),
          atol=1e-6)
    np.testing.assert_array_equal(d.static_torque_derivatives(q, 0 * fext), d.static_torque_derivatives(q))

    def vcom(t):
        d.compute_com(go2.integrate(q, t * u), v, 0 * v)
        return d.vcom.copy()

    x = d.vcom_derivatives(q, v)
    close(x.dvcom_dq @ u, rate(vcom), atol=1e-6)
    np.testing.assert_array_equal(x.dvcom_dv, d.jcom(q))


def test_second_order(go2, state):
    q, v, a, _ = state
    d, nv = go2.data(), go2.nv
    u, lam = np.cos(np.arange(nv)), np.sin(np.arange(nv))
    fext = np.sin(np.arange(6 * go2.njoints)).reshape((6, -1), order="F")
    x, product = d.rnea_second_order_derivatives(q, v, a, fext), d.rnea_second_order_product(lam, q, v, a, fext)
    for name, tensor in zip(product._fields, x):
        assert tensor.shape == (nv, nv, nv)
        close(np.einsum("i,ijk->jk", lam, tensor), getattr(product, name), atol=1e-10)
        np.testing.assert_array_equal(getattr(product, name), d.field(f"lambda_d2tau_{name}"))
    close(x.d2tau_dadq @ u, rate(lambda t: d.crba(go2.integrate(q, t * u))), atol=1e-6)
    # C v by v, twice: velocities enter as a quadratic form
    close(np.einsum("ijk,j,k->i", x.d2tau_dvdv, v, v) / 2 + d.gravity_torque(q), d.compute_nle(q, v), atol=1e-9)

    def along(t):
        return d.rnea(go2.integrate(q, t * u), v, a, fext)

    h = 1e-4
    close(np.einsum("ijk,j,k->i", x.d2tau_dqdq, u, u), (along(h) - 2 * along(0) + along(-h)) / h**2, atol=1e-4)
    # along one direction in q and another in v
    close(
        np.einsum("ijk,j,k->i", x.d2tau_dqdv, u, lam),
        rate(lambda t: rate(lambda s: d.rnea(go2.integrate(q, s * u), v + t * lam, a, fext), 1e-4), 1e-4),
        atol=1e-5,
    )


def test_what_is_refused(go2, state):
    q, v, a, _ = state
    d = go2.data()
    with pytest.raises(dyn.SizeError, match="lam"):
        d.rnea_second_order_product(np.ones(3), q, v, a)
    with pytest.raises(dyn.NonFiniteError, match=r"lambda\[2\]"):
        d.rnea_second_order_product(np.where(np.arange(go2.nv) == 2, np.nan, 1), q, v, a)
    with pytest.raises(dyn.StaleError, match="call Data.forward_kinematics"):
        go2.data().frame_velocity_derivatives("FL_foot")
    with pytest.raises(dyn.PartError, match="SECOND_ORDER"):
        go2.data(parts=dyn.Part.INVERSE).rnea_second_order_derivatives(q, v, a)
