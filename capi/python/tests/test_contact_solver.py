"""The contact problem alone, its quadratic program, compliance, and the example of a standing robot."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import libdyn as dyn

close = np.testing.assert_allclose


def random_problem(contacts=5, dof=12, mu=0.5, seed=0):
    rng = np.random.default_rng(seed)
    J = rng.standard_normal((3 * contacts, dof))
    return J @ J.T, J @ rng.standard_normal(dof), np.full(contacts, mu)


@pytest.mark.parametrize("solver", ["pgs", "admm", "newton"])
def test_solves(solver):
    G, g, mu = random_problem()
    G = (G + G.T) / 2
    s = dyn.contact_solve(G, g, friction=mu, solver=solver, max_iterations=20000)
    assert s.report.converged and s.report.residual <= 1e-10 and s.report.restitution_scale == 1
    f, c = s.impulse.reshape(-1, 3), s.velocity.reshape(-1, 3)
    close(s.velocity, G @ s.impulse + g, atol=1e-12)
    assert (np.hypot(*f[:, :2].T) <= mu * f[:, 2] + 1e-12).all()
    assert abs((f * (c + np.c_[0 * mu, 0 * mu, mu * np.hypot(*c[:, :2].T)])).sum(1)).max() < 1e-8
    solver_object = dyn.ContactSolver(15)
    again = solver_object.residuals(G, g, s.impulse, friction=mu)
    close(again.residual, s.report.residual, atol=1e-12)
    warm = solver_object.solve(G, g, friction=mu, solver=solver, warm_start=s.impulse)
    assert warm.report.iterations + warm.report.newton_steps <= 1


def test_solver_in_own_memory():
    G, g, mu = random_problem()
    G = (G + G.T) / 2
    size = dyn.ContactSolver.bytes(15)
    block = np.zeros(size + 64, np.uint8)
    start = -block.__array_interface__["data"][0] % 64
    solver = dyn.ContactSolver(15, memory=block[start : start + size])
    assert solver.solve(G, g, friction=mu).impulse.tolist() == dyn.contact_solve(G, g, friction=mu).impulse.tolist()


def test_errors():
    G, g, mu = random_problem()
    with pytest.raises(dyn.InvalidRobotError, match=r"G\(0, 1\).*symmetric"):
        dyn.contact_solve(G + np.triu(np.ones_like(G), 1), g, friction=mu)
    with pytest.raises(dyn.ArgumentError, match=r"friction\[0\] is -1"):
        dyn.contact_solve((G + G.T) / 2, g, friction=[-1, 1, 1, 1, 1])
    with pytest.raises(dyn.SizeError, match="15 rows"):
        dyn.contact_solve(G, g, friction=[1, 1])
    with pytest.raises(dyn.ArgumentError, match="choose from pgs"):
        dyn.contact_solve(G, g, friction=mu, solver="simplex")
    with pytest.raises(dyn.LimitError, match="more than the solver has rows"):
        dyn.ContactSolver(3).solve(G, g, friction=mu)


def test_quadratic_program():
    G, g, mu = random_problem(2, 9)
    G = (G + G.T) / 2
    qp = dyn.contact_problem_qp(G, g, friction=mu, facets=12)
    H, A = qp.dense()
    close(H, G)
    close(qp.g, g)
    assert A.shape == (2 * 13, 6)
    rng = np.random.default_rng(1)
    for x in rng.standard_normal((2000, 6)):  # inside the pyramid: inside the cone; outside of the outer one: outside of the cone
        in_cone = all(np.hypot(*f[:2]) <= m * f[2] for f, m in zip(x.reshape(-1, 3), mu))
        inner = (A @ x <= qp.upper).all() and (A @ x >= qp.lower).all()
        outer = dyn.contact_problem_qp(G, g, friction=mu, facets=12, inscribed=False)
        outer_A = outer.dense()[1]
        outside = not ((outer_A @ x <= outer.upper).all() and (outer_A @ x >= outer.lower).all())
        assert not (inner and not in_cone) and not (in_cone and outside)
    cone = dyn.contact_problem_qp(None, g, friction=mu, facets=0).dense()[1]
    close(cone, np.kron(np.eye(2), [[0, 0, 0.5], [1, 0, 0], [0, 1, 0]]))


def test_quadratic_program_of_all_rows():
    n = 1 + 2 + 1 + 3 + 4 + 6
    problem = dict(
        friction=[0.7, 0.5, 0.0, 0.4], torsion=[0, 0, 0.1, 0.02], rolling=[0, 0, 0, 0.01], contact_rows=[1, 3, 4, 6],
        equalities=1, lower=[0, -1], upper=[np.inf, 1], compliance=np.arange(n) * 0.1,
    )  # fmt: skip
    qp = dyn.contact_problem_qp(np.eye(n), np.arange(n), facets=6, **problem)
    H, A = qp.dense()
    close(H, np.diag(1 + 0.1 * np.arange(n)))
    assert len(qp.lower) == 2 + 1 + 7 + (1 + 2 + 2) + (1 + 6 + 6 + 2)
    close(A[:2, 1:3], np.eye(2))
    assert (np.diff(qp.A[2]) >= 0).all() and qp.A[2][-1] == len(qp.A[0])
    # the inscribed polytope of a contact of six rows is in its ellipsoid
    rng = np.random.default_rng(2)
    inside = 0
    for t in rng.standard_normal((4000, 6)) * [0.4, 0.4, 1, 0.01, 0.01, 0.02]:
        x = np.zeros(n)
        x[-6:] = t
        if (A @ x <= qp.upper + 1e-15).all() and (A @ x >= qp.lower - 1e-15).all():
            inside += 1
            assert np.hypot(*t[:2]) ** 2 / 0.16 + np.hypot(*t[3:5]) ** 2 / 1e-4 + t[5] ** 2 / 4e-4 <= t[2] ** 2 * (1 + 1e-12)
    assert inside > 20


def test_compliance():
    R, b = dyn.contact_compliance(1e-3, stiffness=1e4, damping=10, gap=-1e-3)
    close((R, b), (1 / (1e-3 * 20), -1e4 * 1e-3 / 20))
    k, d = 2 * (2 * np.pi * 5) ** 2, 2 * 0.7 * 2 * 2 * np.pi * 5
    close(dyn.contact_compliance_hertz(1e-3, 5, 0.7, 2, -1e-3), dyn.contact_compliance(1e-3, k, d, -1e-3))
    with pytest.raises(dyn.ArgumentError, match="one must be positive"):
        dyn.contact_compliance(1e-3)


def test_standing():
    path = Path(__file__).resolve().parents[1] / "examples" / "standing.py"
    spec = importlib.util.spec_from_file_location("standing", path)
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    model = dyn.load(example.GO2, base="floating")
    data, q, v = model.data(), example.standing(model), np.zeros(model.nv)
    for push in (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 2):
        a = np.zeros(model.nv)
        a[:3] = push
        answer = example.inverse_dynamics(model, data, q, v, a)
        weight = model.total_mass * 9.81
        assert abs(answer.missing).max() < 1e-3 * weight
        close(answer.forces.sum(0), model.total_mass * (np.array(push) + [0, 0, 9.81]), rtol=1e-3, atol=1e-3 * weight)
        assert (np.hypot(*answer.forces[:, :2].T) <= example.MU * answer.forces[:, 2]).all()
        if answer.qp is not None:
            close(answer.qp, answer.forces, atol=1e-6 * weight)
        # the torques and forces do what was asked for
        data.forward_kinematics(q, v)
        J = np.vstack([data.frame_jacobian(f, reference=dyn.LOCAL_WORLD_ALIGNED)[:3] for f in example.FEET])
        tau = np.concatenate([np.zeros(6), answer.tau]) + J.T @ answer.forces.ravel()
        close(data.aba(q, v, tau)[:6], a[:6], atol=2e-2)
    assert example.main() == 0
