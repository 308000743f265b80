"""Derivatives of constrained dynamics and of impulses where test_constraint_rows.py does not go: restitution, mimic joints, bounds, redundant rows."""

import numpy as np
import pytest
from conftest import MODELS
from linkages import TIES, arms, differences, random_state

import libdyn as dyn
from libdyn import constraint as dc


def agree(got, expected, what):
    gap = abs(np.vstack(got) - expected).max()
    assert gap < 1e-7 * max(1, abs(expected).max()), (what, gap, abs(expected).max())


def check_dynamics(m, d, q, v, tau):
    both = lambda q, v, tau: np.concatenate(d.constrained_dynamics(q, v, tau))
    x = d.constrained_dynamics_derivatives(q, v, tau)
    agree((x.ddq_dq, x.lambda_dq), differences(lambda e: both(m.integrate(q, e), v, tau), m.nv), "q")
    agree((x.ddq_dv, x.lambda_dv), differences(lambda e: both(q, v + e, tau), m.nv), "v")
    agree((x.ddq_dtau, x.lambda_dtau), differences(lambda e: both(q, v, tau + e), m.nv), "tau")


def check_impulse(m, d, q, v):
    both = lambda q, v: np.concatenate(d.constraint_impulse(q, v))
    x = d.constraint_impulse_derivatives(q, v)
    agree((x.ddq_dq, x.lambda_dq), differences(lambda e: both(m.integrate(q, e), v), m.nv), "impulse by q")
    agree((x.ddq_dv, x.lambda_dv), differences(lambda e: both(q, v + e), m.nv), "impulse by v")


@pytest.mark.parametrize("restitution", [0.4, 1.0])
@pytest.mark.parametrize("name", [name for name in TIES if name != "friction"])
def test_impulses_with_restitution(name, restitution):
    tie = TIES[name]
    m = arms(tie._replace(values={**tie.values, "restitution": restitution}))
    q, v, _ = random_state(m, 6)
    check_impulse(m, m.data(), q, v)


@pytest.mark.parametrize("robot", ["gripper", "panda"])
def test_mimic_joints(robot):
    m = dyn.load(MODELS / "robots" / f"{robot}.urdf", base="floating")
    assert any(j.mimic_leader is not None and j.nv == 0 for j in m.joints[1:])
    d = m.data()
    links = [f.name for f in m.frames if f.type == dyn.FrameType.BODY][-2:]
    d.add_constraint(dc.distance(links[0], links[1], 0.1, stiffness=10, damping=2, restitution=0.5))
    d.add_constraint(dc.point(links[0], stiffness=3, damping=1, restitution=0.3))
    for seed in (2, 3):
        q, v, tau = random_state(m, seed)
        check_dynamics(m, d, q, v, tau)
        check_impulse(m, d, q, v)


@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_bounds(speed):
    """A limit that holds, one that lets go, dry friction that sticks and that slides."""
    b = dyn.Builder("arm")
    parent = None
    for k in range(4):
        b.add_joint(f"j{k}", "revolute", parent, None if k == 0 else (0.5, 0, 0), axis=(0, 1, 0.1 * k), lower=[-0.5], upper=[0.5])
        b.add_body(f"link{k}", f"j{k}", mass=1, com=(0.25, 0.02, 0), inertia=np.diag([0.01, 0.05, 0.06]))
        parent = f"j{k}"
    b.add_constraint("limit0", dc.limit("j0", stiffness=100,
                                        damping=20)).add_constraint("limit1", dc.limit("j1", stiffness=100, damping=20))
    b.add_constraint("sticks", dc.friction("j2", 1e3)).add_constraint("slides", dc.friction("j3", 1e-3))
    m = b.finish()
    d = m.data()
    q, v = np.array([0.7, -0.6, 0.2, -0.1]), speed * np.array([0.3, 0.4, 0.2, 0.5])
    held = []
    for tau in (np.array([40.0, 1, 2, 3]), np.array([-40.0, 60, 1, -2])):
        forces = d.constrained_dynamics(q, v, tau).forces
        held += (forces[:2] != 0).tolist()
        assert abs(abs(forces[3]) - 1e-3) < 1e-12 and 1e-3 < abs(forces[2]) < 999
        check_dynamics(m, d, q, v, tau)
    assert any(held) and not all(held)


def test_redundant_rows():
    """Each foot's point twice: ddq, J' lambda have derivatives, and lambda moves as the least one."""
    m = dyn.load(MODELS / "robots" / "go2.urdf", base="floating")
    d = m.data()
    for foot in ("FL_foot", "FR_foot", "FL_foot"):
        d.add_constraint(dc.point(foot))
    q, v, tau = random_state(m, 2)
    check_dynamics(m, d, q, v, tau)
    check_impulse(m, d, q, v)
