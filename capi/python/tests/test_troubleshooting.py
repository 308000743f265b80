"""Symptoms that people write about, and what libdyn says instead: the table of capi/pages/exercises.md."""

import threading

import numpy as np
import pytest
from conftest import ARM, MODELS

import libdyn as dyn
from libdyn import ik

FEET = ("FL_foot", "FR_foot", "RL_foot", "RR_foot")


def test_every_placement_is_the_identity(go2, state):
    """Kinematics were not computed, or for another q: an error that names the call, never an identity or last cycle's pose."""
    q, v, *_ = state
    d = go2.data()
    with pytest.raises(dyn.StaleError, match="call Data.forward_kinematics"):
        d.frame_placement("FL_foot")
    d.forward_kinematics(q)
    there = d.frame_placement("FL_foot").translation
    assert np.linalg.norm(there) > 0.1
    d.set_state(go2.integrate(q, 0.1 * v))
    with pytest.raises(dyn.StaleError, match="call Data.forward_kinematics"):
        d.frame_placement("FL_foot")


def test_q_is_seven_short():
    """A root link with mass, and nothing said about what holds it."""
    path = MODELS / "robots" / "go2.urdf"
    with pytest.raises(dyn.BaseChoiceError, match="(?s)go2.urdf.*base.*(fixed|FIXED).*(floating|FLOATING)"):
        dyn.load(path)
    assert dyn.load(path, base="floating").nq == dyn.load(path, base="fixed").nq + 7


def test_torques_are_zero_or_wild(go2):
    """q of a wrong size, with numbers that are none, or with a quaternion that is none."""
    d, zero = go2.data(), np.zeros(go2.nv)
    with pytest.raises(dyn.SizeError, match="12.*19"):
        d.rnea(np.zeros(12), zero, zero)
    with pytest.raises(dyn.QuaternionError, match="root_joint.*zero"):
        d.rnea(np.zeros(19), zero, zero)
    q = go2.neutral()
    q[9] = np.nan
    with pytest.raises(dyn.NonFiniteError, match=r"q\[9\]"):
        d.rnea(q, zero, zero)
    # of any other norm it is the rotation that it points to: the same torques
    q = go2.random(1)
    twice = q.copy()
    twice[3:7] *= 2
    np.testing.assert_allclose(d.rnea(twice, zero, zero), d.rnea(q, zero, zero), atol=1e-12)


def test_inverse_kinematics_does_not_converge():
    """It says why: what cannot be reached is no mystery of frames."""
    m = dyn.load_string(ARM, base="fixed")
    d = m.data()
    far = d.ik([ik.position("tool", (5, 0, 0))], [0.1, 0.1], restarts=0)
    assert (not far.converged and far.reason in (dyn.IkReason.SINGULAR, dyn.IkReason.LOCAL_MINIMUM, dyn.IkReason.LIMITS)
            and far.residuals[0, 0] > 2.9)
    # the error and its Jacobian come from one hand: a pose is met however the reference is turned
    d.forward_kinematics([1.0, -0.5])
    X = d.frame_placement("tool")
    met = d.ik([ik.pose("tool", X)], [0.8, -0.3])
    assert met.converged
    np.testing.assert_allclose(met.q, [1.0, -0.5], atol=1e-5)
    held = d.ik([ik.pose("tool", X)], [0.8, -0.3], upper=[0.9, 4])
    assert held.reason == dyn.IkReason.LIMITS and held.joint == "shoulder"


def test_results_vary_with_threads(go2, state):
    """Each thread with a data of its own: the same bits. (One data in two threads is DYN_ERROR_BUSY in checked builds:
    tests/rt/threads_test.cpp.)"""
    q, v, a, _ = state
    alone = [go2.data().rnea(go2.integrate(q, 1e-3 * k * v), v, a) for k in range(200)]
    results = {}

    def work(name):
        d = go2.data()
        results[name] = [d.rnea(go2.integrate(q, 1e-3 * k * v), v, a) for k in range(200)]

    threads = [threading.Thread(target=work, args=(name,)) for name in range(3)]
    [t.start() for t in threads]
    [t.join() for t in threads]
    assert all(np.array_equal(alone, found) for found in results.values())


@pytest.mark.parametrize("regularisation", [0.0, *10.0 ** np.arange(-12, 1)])
def test_constrained_dynamics_diverges(go2, state, regularisation):
    """Redundant rows, contradictory rows, any regularisation: finite numbers, and a word on what is wrong."""
    q, v, _, tau = state
    d = go2.data()
    for foot in FEET[:2]:
        d.add_constraint(dyn.constraint.weld(foot))
    for foot in FEET[:2]:  # the same once more
        d.add_constraint(dyn.constraint.point(foot))
    ddq, forces = d.constrained_dynamics(q, v, tau, regularisation=regularisation)
    assert np.isfinite(ddq).all() and np.isfinite(forces).all()
    if regularisation == 0:
        once = go2.data()
        for foot in FEET[:2]:
            once.add_constraint(dyn.constraint.weld(foot))
        np.testing.assert_allclose(ddq, once.constrained_dynamics(q, v, tau).ddq, atol=1e-8 * np.abs(ddq).max())
        report = d.constraint_report(q)
        assert (len(report.rows), report.rank, report.redundant) == (18, 12, 6)
        assert all(row.constraint.startswith("slot") for row in report.rows)


def test_frames_are_old_after_all_terms(go2, state):
    """all_terms computes placements, too, and says what it filled."""
    q, v, *_ = state
    d = go2.data()
    filled = d.all_terms("all", q, v)
    there = d.frame_placement("FL_foot").translation
    other = go2.data()
    other.forward_kinematics(q)
    np.testing.assert_array_equal(there, other.frame_placement("FL_foot").translation)
    assert filled == dyn.Term.ALL


def test_collisions_are_missed(tmp_path):
    """Pairs are there from the beginning; a mesh that is not is an error, or stands in the report; queries with q need nothing
    before."""
    go2 = dyn.load(MODELS / "robots" / "go2.urdf", base="floating")
    d = go2.data()
    assert go2.npairs > 0 and sum(p.reason == dyn.PairReason.TESTED for p in go2.pairs) > 100
    q = go2.neutral()
    q[7:] = [0, 0.8, -1.6] * 4
    assert len(d.collisions(q)) == 0
    q[go2.joint("FL_hip_joint").idx_q], q[go2.joint("FR_hip_joint").idx_q] = -1.0, 1.0
    q[go2.joint("FL_calf_joint").idx_q] = q[go2.joint("FR_calf_joint").idx_q] = -0.9
    assert min(x for x in d.compute_distances(q) if np.isfinite(x)) < 0.05, "the front feet come together"

    link = '<link name="{}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry><mesh filename="{}.stl"/></geometry></collision></link>'
    joint = '<joint name="{0}" type="continuous"><parent link="{1}"/><child link="{0}"/></joint>'
    urdf = tmp_path / "meshes.urdf"
    urdf.write_text(f'<robot name="r">{link.format("a", "a")}{link.format("b", "b")}{link.format("c", "c")}{joint.format("b", "a")}{joint.format("c", "b")}</robot>')
    m = dyn.load(urdf, base="fixed")
    assert any(line.level == dyn.ReportLevel.WARNING and "pair" in line.message
               for line in m.report), [line.message for line in m.report]
    with pytest.raises(dyn.FileError, match="a.stl"):
        dyn.load(urdf, base="fixed", meshes="hull")
