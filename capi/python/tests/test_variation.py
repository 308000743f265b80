"""Models that differ in their numbers."""

import numpy as np
import pytest

import libdyn as dyn


def test_masses_and_inertias_share_a_factor(go2):
    other = dyn.vary(go2, 1, mass=0.2)
    factors = set()
    for a, b in zip(go2.frames, other.frames):
        if a.mass > 0:
            np.testing.assert_allclose(b.inertia, a.inertia * (b.mass / a.mass), rtol=1e-12)
            np.testing.assert_array_equal(a.com, b.com)
            assert 0.8 <= b.mass / a.mass <= 1.2
            factors.add(b.mass / a.mass)
    assert len(factors) > 10, "each link has its own"
    assert all(map(dyn.is_physically_consistent, other.inertial_parameters().reshape(-1, 10)[1:2]))


def test_a_seed_is_a_model(go2):
    a, b, c = (dyn.vary(go2, seed, mass=0.2, com=0.01, damping=(0.5, 2)) for seed in (1, 1, 2))
    assert a.image() == b.image() and a.image() != c.image()
    assert dyn.vary(go2, np.random.default_rng(1), mass=0.2, com=0.01, damping=(0.5, 2)).image() == a.image()
    assert dyn.vary(go2, 1).image() == dyn.Builder.from_model(go2).finish().image()


def test_other_quantities(go2):
    b = dyn.Builder.from_model(go2).add_actuator("m", "FL_hip_joint", type="position", kp=60, kv=3)
    model = b.finish()
    other = dyn.vary(model, 3, contact_friction=(2, 2), gains=(0.5, 0.5), gravity=(0.1, 0.1), armature=(3, 3), damping=(0, 0),
                     com=0.01)
    assert all(b.material.friction == 2 * a.material.friction for a, b in zip(model.shapes, other.shapes) if a.role == 1)
    assert (other.actuator("m").kp, other.actuator("m").kv) == (30, 1.5) and not other.damping.any()
    np.testing.assert_allclose(other.gravity, 0.1 * model.gravity)
    np.testing.assert_allclose(other.armature, 3 * model.armature)
    shifts = np.array([b.com - a.com for a, b in zip(model.frames, other.frames)])
    assert 0.005 < np.abs(shifts).max() <= 0.01 and other.total_mass == model.total_mass


@pytest.mark.parametrize("wrong, said", [({"weight": 0.1}, "no quantity 'weight'"), ({"mass": 1.5}, "mass is 1.5"),
                                         ({"mass": (2, 1)}, "two factors"), ({"com": -1}, "com is -1")])
def test_refusals(go2, wrong, said):
    with pytest.raises(dyn.ArgumentError, match=said):
        dyn.vary(go2, 1, **wrong)


def test_inertial_parameters_go_back(go2):
    """What was identified makes a model whose torques are those of the parameters."""
    d = go2.data()
    q, v, a = go2.random(1), np.random.default_rng(2).normal(size=go2.nv), np.random.default_rng(3).normal(size=go2.nv)
    pi = go2.inertial_parameters().reshape(-1, 10).copy()
    pi[3] = dyn.parameters_from_log_cholesky(dyn.log_cholesky_from_parameters(pi[3]) + 0.1)
    pi[0] *= 1.25
    other = dyn.with_inertial_parameters(go2, pi.ravel())
    np.testing.assert_allclose(other.inertial_parameters().reshape(-1, 10), pi, atol=1e-14)
    gravity = lambda model: model.data().rnea(q, v, a) - model.armature * a
    np.testing.assert_allclose(gravity(other), d.joint_torque_regressor(q, v, a) @ pi.ravel(), atol=1e-10)
    assert dyn.with_inertial_parameters(go2, go2.inertial_parameters()).image() == dyn.Builder.from_model(go2).finish().image()
    pi[3, 0] = -1
    with pytest.raises(dyn.ArgumentError, match="which no body has"):
        dyn.with_inertial_parameters(go2, pi)
    with pytest.raises(dyn.ArgumentError, match="ten a joint"):
        dyn.with_inertial_parameters(go2, pi[1:])
