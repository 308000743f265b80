"""The Crocoddyl door: derivatives of its actions, and the cost that Crocoddyl's own dynamics (Pinocchio) reach."""

import re

import doors
import numpy as np
import pytest
from conftest import MODELS

crocoddyl = pytest.importorskip("crocoddyl", reason="package crocoddyl is not installed")

import libdyn as dyn  # noqa: E402
from libdyn.doors import crocoddyl as door  # noqa: E402

close = np.testing.assert_allclose


def nothing(q, v, u):
    """No cost."""
    nv = len(v)
    return np.zeros(1), np.zeros((1, 2 * nv)), np.zeros((1, 0 if u is None else len(u)))


def moved(state, x, k, h):
    return state.integrate(x, h * np.eye(state.ndx)[k])


def slope(f):
    """Central differences of order six of f(h), a vector."""
    return sum(c * (f(t * 1e-3) - f(-t * 1e-3)) for t, c in ((1, 45), (2, -9), (3, 1))) / 60e-3


@pytest.mark.parametrize("kind", ["euler", "step"])
@pytest.mark.parametrize("robot", doors.ROBOTS)
def test_derivatives(robot, kind):
    """On tangent spaces of the state, through Crocoddyl's integrator and in libdyn's step. The base has no motors."""
    f, x = doors.opened(robot, "step")
    m, base = f.model, 6 * (robot == "go2")
    motors = np.eye(m.nv)[:, base:]
    q, v, tau = (a[0] for a in x)
    start, u = np.concatenate([m.normalize(q), v]), tau[base:]
    if kind == "euler":
        action = crocoddyl.IntegratedActionModelEuler(door.DifferentialAction(m, nothing, motors), 1e-2)
    else:
        action = door.StepAction(m, nothing, 1e-3, actuation=motors)
    data, other, state = action.createData(), action.createData(), action.state
    action.calc(data, start, u)
    action.calcDiff(data, start, u)
    Fx, Fu, center = np.array(data.Fx), np.array(data.Fu), np.array(data.xnext)

    def after(x, u):
        action.calc(other, x, u)
        return state.diff(center, np.array(other.xnext))

    by_x = np.stack([slope(lambda h: after(moved(state, start, k, h), u)) for k in range(state.ndx)], -1)
    close(Fx, by_x, atol=1e-8 * abs(Fx).max())
    close(Fu, np.stack([slope(lambda h: after(start, u + h * e)) for e in np.eye(len(u))], -1), atol=1e-8)


def test_state():
    """Its Jacobians are those of its differences."""
    state = door.State(doors.load("go2"))
    x0, x1 = state.rand(), state.rand()
    dx = np.random.default_rng(1).standard_normal(state.ndx)
    columns = [[slope(lambda h: state.diff(moved(state, x0, k, h), x1)), slope(lambda h: state.diff(x0, moved(state, x1, k, h))),
                slope(lambda h: state.diff(state.integrate(x0, dx), state.integrate(moved(state, x0, k, h), dx))),
                slope(lambda h: state.diff(state.integrate(x0, dx), state.integrate(x0, dx + h * np.eye(state.ndx)[k])))]
               for k in range(state.ndx)]
    expected = np.moveaxis(np.array(columns), 0, -1)
    for J, number in zip([*state.Jdiff(x0, x1), *state.Jintegrate(x0, dx)], expected):
        close(J, number, atol=1e-8 * max(1, abs(J).max()))


def reach():
    """The arm of the panda, its fingers fixed."""
    text = (MODELS / "robots/panda.urdf").read_text(encoding="utf-8")
    text = re.sub(r'(<joint name="panda_finger_joint\d" type=)"prismatic"', r'\1"fixed"', re.sub(r"<mimic[^>]*/>", "", text))
    return text, "panda_hand", np.array([0, -0.4, 0, -2, 0, 1.6, 0.7]), np.array([0.3, 0.3, 0.5])


def reaching_action(model, frame, q0, goal, weight, dt):
    d = model.data()

    def residual(q, v, u):
        """0.1 (x - x0), the distance to the goal, 0.01 u."""
        d.forward_kinematics(q)
        p, J = d.frame_placement(frame).translation, d.frame_jacobian(frame, "local_world_aligned")[:3]
        k = 0 if u is None else 7
        by_x, by_u = np.zeros((17 + k, 14)), np.zeros((17 + k, 7))
        by_x[:14], by_x[14:17, :7], by_u[17:] = 0.1 * np.eye(14), weight * J, 0.01 * np.eye(7)[:k]
        return np.concatenate([0.1 * (q - q0), 0.1 * v, weight * (p - goal), 0.01 * u if k else []]), by_x, by_u

    return crocoddyl.IntegratedActionModelEuler(door.DifferentialAction(model, residual), dt)


def solved(start, actions, steps=30):
    running, terminal = actions
    solver = crocoddyl.SolverFDDP(crocoddyl.ShootingProblem(start, [running] * steps, terminal))
    solver.th_stop = 1e-12
    assert solver.solve([], [], 100)
    return solver


def test_the_cost_of_the_native_model():
    """A reach without contacts: the same cost within 1e-8, in as many iterations, the same torques."""
    pin = pytest.importorskip("pinocchio", reason="package pin is not installed")
    text, frame, q0, goal = reach()
    start = np.concatenate([q0, np.zeros(7)])
    theirs = pin.buildModelFromXML(text)
    state = crocoddyl.StateMultibody(theirs)

    def native(weight, dt):
        costs = crocoddyl.CostModelSum(state, 7)
        for name, residual, w in (
            ("state", crocoddyl.ResidualModelState(state, start, 7), 0.01),
            ("goal", crocoddyl.ResidualModelFrameTranslation(state, theirs.getFrameId(frame), goal, 7), weight**2),
            ("torque", crocoddyl.ResidualModelControl(state, 7), 1e-4),
        ):
            costs.addCost(name, crocoddyl.CostModelResidual(state, residual), w)
        dynamics = crocoddyl.DifferentialActionModelFreeFwdDynamics(state, crocoddyl.ActuationModelFull(state), costs)
        return crocoddyl.IntegratedActionModelEuler(dynamics, dt)

    a = solved(start, [native(1, 2e-2), native(10, 0)])
    m = dyn.load_string(text, base="fixed")
    b = solved(start, [reaching_action(m, frame, q0, goal, w, dt) for w, dt in ((1, 2e-2), (10, 0))])
    assert abs(a.cost - b.cost) < 1e-8 * a.cost and a.iter == b.iter
    close(np.array(b.us), np.array(a.us), atol=1e-6)


def test_a_leap_of_the_quadruped():
    """Steps of 2 ms on the floor: the base reaches a height, by the motors of the legs."""
    m = dyn.Builder.from_model(doors.load("go2")).add_shape("universe", "half_space", name="floor").finish()
    motors = np.eye(m.nv)[:, 6:]
    q0 = m.normalize({"root_joint": [0, 0, 0.345, 0, 0, 0, 1], **{f"{leg}_{j}_joint": a for leg in ("FL", "FR", "RL", "RR")
                                                               for j, a in (("thigh", 0.7), ("calf", -1.4))}})
    start = np.concatenate([q0, np.zeros(m.nv)])

    def cost(w_height, w_torque):
        def residual(q, v, u):
            k = 0 if u is None else len(u)
            by_x, by_u = np.zeros((1 + m.nv + k, 2 * m.nv)), np.zeros((1 + m.nv + k, 12))
            by_x[0, 2] = w_height  # the base is level
            by_x[1 : 1 + m.nv, m.nv :], by_u[1 + m.nv :] = 0.01 * np.eye(m.nv), w_torque * np.eye(12)[:k]
            return np.concatenate([[w_height * (q[2] - 0.4)], 0.01 * v, w_torque * u if k else []]), by_x, by_u

        return residual

    running, terminal = (door.StepAction(m, cost(*w), 2e-3, actuation=motors) for w in ((1, 1e-3), (100, 1e-3)))
    problem = crocoddyl.ShootingProblem(start, [running] * 20, terminal)
    us = [np.zeros(12)] * 20
    solver = crocoddyl.SolverDDP(problem)
    before = problem.calc(problem.rollout(us), us)
    solver.solve(problem.rollout(us), us, 5)
    assert solver.cost < 0.2 * before and solver.xs[-1][2] > 0.37
