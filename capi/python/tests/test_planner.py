"""Model.planner: shapes, a linear problem, bounds, costs of the caller's, and what is refused."""

import libdyn as dyn
import numpy as np
import pytest


def slider(**actuator):
    b = dyn.Builder("slider")
    b.add_joint("x", "prismatic", axis=(1, 0, 0)).add_body("mass", "x", 2.0)
    return b.add_actuator("force", "x", **actuator).finish()


COSTS = [dyn.PlanCost("state", weight=2.0, terminal=20.0), dyn.PlanCost("input", weight=0.3)]


def at(model, q, v):
    d = model.data()
    d.set_step_options(dt=0.1)
    d.set_state(q, v)
    return d


def test_a_linear_problem_takes_one_iteration():
    m = slider()
    d = at(m, [1.5], [-0.7])
    plan = m.planner(30).solve(d, COSTS, max_iterations=5)
    assert plan.converged and plan.iterations == 2 and plan.step_length == 1 and plan.gap == 0 and plan.knot == -1
    assert plan.q.shape == plan.v.shape == (31, 1) and plan.u.shape == (30, 1)
    assert plan.K.shape == (30, 1, 2) and plan.gaps.shape == (30, 2)
    P, A, B = 20 * np.eye(2), np.array([[1, 0.1], [0, 1]]), np.array([[0.005], [0.05]])
    for k in reversed(range(30)):
        K = -np.linalg.solve(0.3 * np.eye(1) + B.T @ P @ B, B.T @ P @ A)
        np.testing.assert_allclose(plan.K[k], K, atol=1e-9)
        P = 2 * np.eye(2) + A.T @ P @ A + A.T @ P @ B @ K
    np.testing.assert_allclose(plan.u[0], plan.K[0] @ [1.5, -0.7], atol=1e-9)
    assert d.q[0] == 1.5 and d.v[0] == -0.7


def test_bounds_hold():
    m = slider(control_range=(-0.5, 0.6))
    plan = m.planner(30).solve(at(m, [1.5], [-0.7]), COSTS)
    assert plan.converged and plan.u.min() == -0.5 and plan.bound_violation == 0
    tight = m.planner(30).solve(at(m, [1.5], [-0.7]), COSTS, lower=[-0.1], upper=[0.1])
    assert abs(tight.u).max() == 0.1 and tight.cost > plan.cost


def test_costs_of_the_caller():
    m = slider()
    knots = []

    def cost(p):
        knots.append(p.knot)
        w = 20.0 if p.u is None else 2.0
        if p.l_x is not None:
            p.l_x[:] += w * np.concatenate([p.q, p.v])
            p.l_xx[:] += w * np.eye(2)
        return w / 2 * (p.q @ p.q + p.v @ p.v)

    own = m.planner(10).solve(at(m, [1.5], [-0.7]), COSTS)
    plan = m.planner(10).solve(at(m, [1.5], [-0.7]), COSTS[1:], function=cost)
    np.testing.assert_allclose(plan.u, own.u, atol=1e-12)
    assert set(knots) == set(range(11))
    with pytest.raises(ZeroDivisionError):
        m.planner(10).solve(at(m, [1.5], [-0.7]), function=lambda p: 1 / 0)
    with pytest.raises(dyn.ArgumentError, match="must return the cost"):
        m.planner(10).solve(at(m, [1.5], [-0.7]), function=lambda p: None)


def test_references_by_knot_and_frames():
    m = dyn.load(dyn.models / "robots/panda.urdf", base="fixed")
    d = m.data()
    d.set_step_options(dt=0.01)
    q = np.array([0, -0.5, 0, -2, 0, 1.5, 0.8, 0.02, 0.02])[: m.nq]
    d.set_state(q, np.zeros(m.nv))
    hand = m.nframes - 1
    d.forward_kinematics(q)
    start = d.frame_placement(hand).translation.copy()
    N = 20
    path = start + np.linspace(0, 1, N + 1)[:, None] * [0.0, 0.02, -0.02]
    costs = [dyn.PlanCost("frame_position", weight=1e4, reference=path, frame=hand), dyn.PlanCost("input", weight=1e-6),
             dyn.PlanCost("state", weight=1e-3, weights=np.concatenate([np.zeros(m.nv), np.ones(m.nv)]))]
    plan = m.planner(N, "tau").solve(d, costs, max_iterations=30)
    d.forward_kinematics(plan.q[-1])
    np.testing.assert_allclose(d.frame_placement(hand).translation, path[-1], atol=2e-3)


def test_shift_and_guess():
    m = slider()
    p = m.planner(5)
    first = p.solve(at(m, [1.0], [0.0]), COSTS)
    p.shift()
    again = p.solve(at(m, first.q[1], first.v[1]), COSTS, tolerance=1e300, gap_tolerance=1e300)
    np.testing.assert_array_equal(again.u[:4], first.u[1:])
    p.set_guess(first.q, first.v, first.u)
    assert p.solve(at(m, [1.0], [0.0]), COSTS).iterations == 1


def test_refusals():
    m = slider()
    d, p = at(m, [0.0], [0.0]), m.planner(5)
    with pytest.raises(dyn.SizeError, match="u has shape"):
        p.set_guess(u=np.zeros(5))
    with pytest.raises(dyn.SizeError, match="reference"):
        p.solve(d, [dyn.PlanCost("state", reference=[1.0])])
    with pytest.raises(dyn.ArgumentError, match="type"):
        p.solve(d, [dyn.PlanCost("energy")])
    with pytest.raises(dyn.ArgumentError, match="weight"):
        p.solve(d, [dyn.PlanCost("state", weight=-1.0)])
    with pytest.raises(dyn.PartError, match="STEP_DERIVATIVES"):
        p.solve(m.data("simulation"), COSTS)
    with pytest.raises(dyn.LimitError, match="knots"):
        m.planner(0)
    with pytest.raises(dyn.ModelError):
        p.solve(slider().data(), COSTS)
