"""Simulation: the loop over Data's steps; and what notebooks show."""

import doctest
import html.parser
import importlib

import numpy as np
import pytest
from conftest import MODELS

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


SCENE = MODELS / "scenes" / "go2_stands.xml"
PUSHED = """<mujoco><worldbody><body><joint name="hinge" axis="0 1 0"/><geom type="capsule" size=".05 .3" pos="0 0 -.3"/></body>
</worldbody>
<actuator><motor name="motor" joint="hinge"/></actuator></mujoco>"""


def test_files(tmp_path):
    """URDF and MJCF, by their paths."""
    arm = dyn.Simulation(str(MODELS / "robots" / "panda.urdf"), base="fixed")
    arm.run(0.01, lambda sim: sim.data.gravity_torque())
    assert np.abs(arm.v).max() < 1e-9 and dyn.Simulation(SCENE, "standing").model.nu == 12
    with pytest.raises(dyn.BaseChoiceError, match='base="fixed"'):
        dyn.Simulation(MODELS / "robots" / "go2.urdf")
    with pytest.raises(dyn.ArgumentError, match="for files"):
        dyn.Simulation(arm.model, base="fixed")
    with pytest.raises(dyn.ArgumentError, match="dyn.Model or the path"):
        dyn.Simulation(3)


def test_the_shape_says_what_a_controller_returns(go2):
    scene = dyn.Simulation(SCENE, "standing")
    nu, nv = scene.model.nu, scene.model.nv
    scene.run(0.01, lambda s: np.full(nu, 0.1))
    assert (scene.ctrl == 0.1).all() and not scene.tau.any()
    scene.run(0.01, lambda s: np.full(nv, 0.2))
    assert (scene.ctrl == 0.1).all() and (scene.tau == 0.2).all()
    scene.run(0.01, lambda s: {"tau": np.zeros(nv), "ctrl": {"FL_hip": 0.3}})
    assert scene.ctrl[0] == 0.3 and scene.ctrl[1] == 0.1 and not scene.tau.any()
    scene.run(0.01, lambda s: None)
    assert scene.ctrl[0] == 0.3
    with pytest.raises(dyn.SizeError, match=r"controls .* have shape \(12,\), torques \(18,\)"):
        scene.run(0.01, lambda s: np.zeros(3))
    with pytest.raises(dyn.ArgumentError, match='keys are "tau" and "ctrl"'):
        scene.run(0.01, lambda s: {"torque": 1})
    with pytest.raises(dyn.SizeError, match=r"np\.r_\[np\.zeros\(6\), x\]"):
        dyn.Simulation(go2).run(0.01, lambda s: np.zeros(12))
    with pytest.raises(dyn.SizeError, match=r"no actuators.*step\(tau=x\)"):
        dyn.Simulation(go2).step(ctrl=np.zeros(12))
    with pytest.raises(dyn.ArgumentError, match=r"step\(tau=x\) for torques"):
        dyn.Simulation(go2).step(np.zeros(18))


def test_as_many_controls_as_freedoms_need_a_word():
    m = dyn.load_string(PUSHED)
    with pytest.raises(dyn.ArgumentError, match='return {"tau": x} or {"ctrl": x}'):
        dyn.Simulation(m).run(0.1, lambda s: [1.0])
    a, b, c, d = (dyn.Simulation(m) for _ in range(4))
    run = a.run(0.1, lambda s: [1.0], returns="ctrl")
    assert np.array_equal(run.q, b.run(0.1, lambda s: {"ctrl": [1.0]}).q)
    assert np.array_equal(c.run(0.1, lambda s: [1.0], returns="tau").q, d.run(0.1, lambda s: {"tau": [1.0]}).q)
    np.testing.assert_allclose(c.q, a.q, atol=1e-12)  # a motor of gear 1
    with pytest.raises(dyn.ArgumentError, match='"tau" or "ctrl"'):
        a.run(0.1, lambda s: [1.0], returns="torque")


def test_torques_and_controls_are_held_by_name(arm):
    sim = dyn.Simulation(arm)
    sim.step(2, tau={"elbow": 0.5})
    assert sim.tau.tolist() == [0, 0.5]
    sim.tau = [1, 2]
    sim.step()
    assert sim.tau.tolist() == [1, 2]
    scene = dyn.Simulation(SCENE)
    scene.ctrl = np.arange(12.0)
    assert np.array_equal(scene.ctrl, np.arange(12.0))


def test_sensors_by_name():
    """A falling accelerometer measures nothing, one that rests the opposite of gravity; values follow the steps."""
    m = dyn.load_string("""<mujoco><worldbody><geom name="floor" type="plane" size="5 5 1"/><body pos="0 0 .5">
      <freejoint name="free"/><geom type="sphere" size="0.1"/><site name="s"/></body></worldbody>
      <sensor><accelerometer name="imu" site="s"/>
      <framepos name="where" objtype="site" objname="s"/></sensor></mujoco>""")
    sim = dyn.Simulation(m)
    assert set(sim.sensors) == {"imu", "where"} and len(sim.sensors) == 2 and "imu" in repr(sim.sensors)
    sim.run(0.1)
    np.testing.assert_allclose(sim.sensors["imu"], 0, atol=1e-9)
    np.testing.assert_allclose(sim.sensors["where"], sim.q[:3], atol=1e-12)
    sim.run(2.0)
    np.testing.assert_allclose(sim.sensors["imu"], [0, 0, 9.81], atol=1e-3)
    assert sum(c.force_on_b[2] for c in sim.contacts) == pytest.approx(9.81 * m.total_mass, rel=1e-3)
    assert "where" in sim.sensors and "were" not in sim.sensors and sim.sensors.get("were") is None
    with pytest.raises(dyn.UnknownNameError, match="were"):
        sim.sensors["were"]


def test_accelerations_of_steps_that_the_data_made_by_itself_are_stale():
    sim = dyn.Simulation(dyn.load_string("""<mujoco><worldbody><geom type="plane" size="5 5 1"/><body pos="0 0 .5">
      <freejoint/><geom type="sphere" size="0.1"/><site name="s"/></body></worldbody>
      <sensor><accelerometer name="imu" site="s"/><framepos name="where" objtype="site" objname="s"/></sensor></mujoco>"""))
    sim.step()
    sim.data.advance(1.0)
    with pytest.raises(dyn.StaleError, match="'imu'.*Simulation.step"):
        sim.sensors["imu"]
    np.testing.assert_allclose(sim.sensors["where"], sim.q[:3], atol=1e-12)
    sim.step()
    np.testing.assert_allclose(sim.sensors["imu"], [0, 0, 9.81], atol=1e-3)
    sim.data.advance(0.1)
    sim.reset()
    assert sim.sensors["imu"].shape == (3,)


def test_dt_is_that_of_the_data():
    """Runs, accelerations and recordings follow a step that was changed in the data."""
    sim = dyn.Simulation(dyn.load_string("""<mujoco><option timestep="0.002"/><worldbody><body><freejoint/><geom size="0.1"/>
      <site name="s"/></body></worldbody><sensor><accelerometer name="imu" site="s"/></sensor></mujoco>"""))
    sim.data.set_step_options(dt=5e-4)
    assert sim.dt == 5e-4 and sim.run(0.1).t[-1] == pytest.approx(0.1, abs=1e-12)
    np.testing.assert_allclose(sim.sensors["imu"], 0, atol=1e-9)


def test_states_and_configurations():
    sim = dyn.Simulation(SCENE, "standing")
    assert "standing" in sim.configurations
    sim.step(20)
    saved, q = sim.save_state(), None
    sim.step(20)
    q = sim.q.copy()
    sim.restore_state(saved)
    sim.step(20)
    assert np.array_equal(sim.q, q)


def test_docstrings_run(monkeypatch):
    monkeypatch.chdir(MODELS.parent)
    for module in ("simulate", "recording"):
        found = importlib.import_module(f"libdyn.{module}")
        failed, tried = doctest.testmod(found)
        assert failed == 0 and tried > 2


def test_refusals(arm):
    with pytest.raises(dyn.ArgumentError, match="multiple of every"):
        dyn.Simulation(arm).run(0.0105)
    with pytest.raises(dyn.ArgumentError, match="dt"):
        dyn.Simulation(arm, dt=-1)
    for duration in (np.nan, np.inf, -1.0):
        with pytest.raises(dyn.ArgumentError, match=f"duration is {duration} s"):
            dyn.Simulation(arm).run(duration)
    with pytest.raises(dyn.ArgumentError, match="every is 0.5"):
        dyn.Simulation(arm).run(0.01, every=0.5)
    with pytest.raises(dyn.ArgumentError, match="steps is -1"):
        dyn.Simulation(arm).step(-1)


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
