"""Simulation: the loop over Data's steps; and what notebooks show."""

import html.parser

import numpy as np
import pytest

import libdyn as dyn


def test_it_is_the_loop_over_steps(arm):
    q = [0.4, -0.2]
    sim = dyn.Simulation(arm, q, dt=1e-3, integrator="rk4", effects=("damping",))
    d = arm.data()
    d.set_effects("damping")
    d.set_state(q)
    times = []

    def push(s):
        times.append(s.time)
        s.data.tau_applied = [0.3, -s.q[1]]

    run = sim.run(0.1, push, every=5)
    for _ in range(20):
        d.tau_applied = [0.3, -d.q[1]]
        for _ in range(5):
            d.step(1e-3, "rk4")
    assert np.array_equal(run.q[-1], d.q) and np.array_equal(run.v[-1], d.v) and np.array_equal(run.q[0], q)
    np.testing.assert_allclose(run.t, 5e-3 * np.arange(21), atol=1e-15)
    assert times == run.t[:-1].tolist() and "t 0.1 s" in repr(sim)
    sim.reset()
    again = sim.run(0.1, push, every=5)
    assert np.array_equal(again.q, run.q) and again.t[0] == 0
    sim.reset(v=[1.0, 0.0])
    assert sim.v.tolist() == [1, 0] and sim.q.tolist() == q


def test_a_controller_returns_torques_where_nothing_actuates(arm):
    """The example of the docstring: a model without actuators is driven to a target, as step(tau=...) drives it."""
    target, data = np.array([0.5, -0.3]), arm.data()

    def controller(s):
        return data.gravity_torque(s.q) + 80 * (target - s.q) - 20 * s.v

    sim, other = dyn.Simulation(arm, [0.4, -0.2]), dyn.Simulation(arm, [0.4, -0.2])
    run = sim.run(3.0, controller)
    np.testing.assert_allclose(run.q[-1], target, atol=1e-3)
    for _ in range(len(run.t) - 1):
        other.step(tau=controller(other))
    assert np.array_equal(other.q, run.q[-1])
    with pytest.raises(dyn.SizeError, match="tau has shape"):
        sim.run(0.01, lambda s: np.zeros(3))


def test_it_begins_as_the_file_draws_it():
    box = '<geom type="box" size=".1 .1 .1" mass="1"/>'
    robot = dyn.load_string(f'<mujoco><worldbody><body pos="0 0 2"><freejoint/>{box}</body></worldbody><keyframe><key '
                            'name="low" qpos="0 0 1 1 0 0 0"/></keyframe></mujoco>')
    assert dyn.Simulation(robot).q[2] == 2 and dyn.Simulation(robot, robot.neutral()).q[2] == 0
    low = dyn.Simulation(robot, "low")
    low.step()
    low.reset()
    assert low.q[2] == 1
    low.reset("qpos0")
    assert low.q[2] == 2
    with pytest.raises(dyn.Error, match="lwo"):
        dyn.Simulation(robot, "lwo")


def test_refusals(arm):
    with pytest.raises(dyn.ArgumentError, match="multiple of every"):
        dyn.Simulation(arm).run(0.0105)
    with pytest.raises(dyn.ArgumentError, match="dt"):
        dyn.Simulation(arm, dt=-1)


class Well(html.parser.HTMLParser):
    """Counts cells; asserts that what opens closes."""

    def __init__(self, text):
        super().__init__()
        self.open, self.cells = [], []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1:] == ["td"]:
            self.cells.append(data)


def test_html(arm, gripper):
    cells = Well(arm._repr_html_()).cells
    assert "shoulder" in cells and "-2 to 2.5" in cells and "revolute" in cells
    assert any(c.startswith(("1 ", "-1 ")) for c in Well(gripper._repr_html_()).cells), "what a follower follows"
    evil = dyn.Builder("a<b>").add_joint("<i>&", "revolute").add_body("x", "<i>&", mass=1, inertia=np.eye(3)).finish()
    assert "<i>&" in Well(evil._repr_html_()).cells
    d = arm.data()
    assert "M" not in Well(d._repr_html_()).cells
    d.crba()
    assert {"M", "q", "kg m^2, kg"} <= set(Well(d._repr_html_()).cells)


def test_docstrings_say_shape_unit_and_frame():
    for info in dyn.FIELDS.values():
        doc = getattr(dyn.Data, info.name).__doc__
        if isinstance(getattr(dyn.Data, info.name), property) and info.name not in ("ledger", "stepping"):
            assert info.sentence in doc and info.shape in doc and (info.unit or "no unit") in doc, info.name
