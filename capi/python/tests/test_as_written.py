"""A loaded model begins and steps as its file states."""

import libdyn as dyn
import numpy as np
import pytest

DROP = """<mujoco><worldbody><geom type="plane" size="1 1 1"/>
  <body pos="0 0 1.25"><joint type="slide" axis="0 0 1" ref="1.25"/><geom type="sphere" size=".1"/></body></worldbody></mujoco>"""
PENDULUM = """<mujoco>{option}<worldbody><body pos="0 0 1"><joint name="hinge" axis="0 1 0" damping="0.5" frictionloss="{friction}"/>
  <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02" mass="1"/></body></worldbody></mujoco>"""
KEYED = """<mujoco><option timestep="0.004" integrator="implicitfast"/><worldbody>
  <body name="box" pos="0 0 1" quat="1 1 0 0"><freejoint name="free"/><geom type="box" size=".1 .2 .3" contype="0" conaffinity="0"/></body>
  <body name="arm" pos="2 0 1"><joint name="hinge" axis="0 1 0" ref="30"/><geom size=".1" pos=".3 0 0"/></body></worldbody>
  <tendon><fixed name="both"><joint joint="hinge" coef="1"/></fixed></tendon>
  <actuator><motor name="m" joint="hinge" gear="2"/><general name="t" joint="hinge" gaintype="user" ctrlrange="-1 1"/>
    <general name="g" joint="hinge" dyntype="filter" dynprm="0.1" gainprm="3"/></actuator>
  <keyframe><key name="away" time="2.5" qpos="1 2 3 .5 .5 .5 .5 .25" qvel="1 2 3 4 5 6 7" ctrl=".1 .2 .3" act=".4"/><key name="blank"/></keyframe>
</mujoco>"""


def load(text, **options):
    return dyn.load_string(text, **options)


def pendulum(friction=0, option=""):
    return load(PENDULUM.format(friction=friction, option=option))


def load_file(folder, text):
    (folder / "m.xml").write_text(text)
    return dyn.load(folder / "m.xml")


def test_a_sphere_drawn_above_a_plane_lands(tmp_path):
    sim = dyn.Simulation(load_file(tmp_path, DROP))
    assert sim.q[0] == 1.25
    sim.run(1.0)
    assert abs(sim.q[0] - 0.1) < 1e-4 and abs(sim.v[0]) < 1e-6


def test_a_pendulum_with_damping_comes_to_rest(tmp_path):
    sim = dyn.Simulation(load_file(tmp_path, PENDULUM.format(friction=0, option="")))
    sim.run(4.0)
    assert abs(sim.q[0] - np.pi / 2) < 1e-3 and abs(sim.v[0]) < 1e-3


def test_joint_friction_of_the_file_holds():
    sim = dyn.Simulation(pendulum(friction=3))
    sim.run(1.0)
    assert 0 < sim.q[0] < 0.01 and 0 < sim.v[0] < 0.01  # it creeps: friction is viscous below 0.01 rad/s
    assert dyn.Simulation(pendulum(friction=3), effects="armature").run(0.1).q[-1, 0] > 0.01


def test_dynamics_of_urdf_act_in_simulations(arm):
    """<dynamics damping friction>: energy of a swing without contacts falls; without the effects it stays to the integrator's
    order."""
    def energy(**options):
        sim = dyn.Simulation(arm, q=[0.5, 0], integrator="rk4", dt=1e-3, **options)
        sim.run(2.0)
        return sum(sim.data.energy(sim.q, sim.v))

    begin = sum(arm.data().energy(np.array([0.5, 0]), np.zeros(2)))
    assert energy() < begin - 0.3
    assert abs(energy(effects=("armature", "limits")) - begin) < 1e-8


def test_algorithms_called_alone_keep_their_choice():
    m = pendulum(friction=0.1)
    d = m.data()
    alone = d.rnea([0.3], [2.0], [0.0]).copy()
    d.step()
    assert d.rnea([0.3], [2.0], [0.0]) == alone
    d.set_effects("all")
    assert abs(d.rnea([0.3], [2.0], [0.0]) - alone - 0.5 * 2 - 0.1) < 1e-12
    assert m.data().effects("hinge") == dyn.Effect.DEFAULT
    assert m.data().effects() & (dyn.Effect.DAMPING | dyn.Effect.FRICTION) == dyn.Effect.DAMPING | dyn.Effect.FRICTION  # in steps


def test_algorithms_between_steps_change_no_step():
    m = pendulum(friction=0.1)
    a, b = m.data(), m.data()
    for _ in range(50):
        a.step()
        b.step()
        b.aba(b.q, b.v, [0.0])
        b.rnea(b.q, b.v, [1.0])
    assert a.q == b.q and a.v == b.v


def test_timestep_and_integrator():
    assert ((pendulum().data().step_options.dt, pendulum().data().step_options.integrator)
            == (0.002, dyn.Integrator.SEMI_IMPLICIT_EULER))
    m = load(KEYED)
    options = m.data().step_options
    assert (options.dt, options.integrator) == (0.004, dyn.Integrator.IMPLICIT_FAST)
    assert any("implicit_fast" in line.message for line in m.report)
    assert pendulum(option='<option integrator="RK4" timestep=".01"/>').data().step_options.integrator == dyn.Integrator.RK4
    assert m.step_options.dt == 0.004 and dyn.Simulation(m).dt == 0.004 and dyn.Simulation(m, dt=0.001).dt == 0.001
    with pytest.raises(dyn.Error, match="timestep"):
        pendulum(option='<option timestep="0"/>')


def test_urdf_keeps_its_defaults(arm):
    assert (arm.data().step_options.dt, arm.initial_configuration) == (1e-3, "neutral")


def test_new_data_begins_where_the_file_draws():
    m = load(KEYED)
    d, s = m.data(), np.sqrt(0.5)
    assert m.initial_configuration == "qpos0"
    np.testing.assert_allclose(d.q, [0, 0, 1, s, 0, 0, s, np.pi / 6], atol=1e-15)
    assert not d.v.any() and not d.field("ctrl").any()
    first = m.batch(1).rollout(steps=1, n=1, dt=1e-12)
    np.testing.assert_allclose(first.q[0, 0], d.q, atol=1e-9)


def test_key_states_velocity_controls_activations_and_time():
    m = load(KEYED)
    sim = dyn.Simulation(m, "away")
    np.testing.assert_array_equal(sim.q, [1, 2, 3, 0.5, 0.5, 0.5, 0.5, 0.25])
    # R turns x to y, y to z, z to x: world (1, 2, 3) is (2, 3, 1) in the body's axes
    np.testing.assert_allclose(sim.v, [2, 3, 1, 4, 5, 6, 7], atol=1e-14)
    np.testing.assert_array_equal(sim.data.field("ctrl"), [0.1, 0.2, 0.3])
    np.testing.assert_array_equal(sim.data.field("act"), [0.4])
    assert sim.time == 2.5
    sim.step(3)
    sim.reset("blank")
    np.testing.assert_array_equal(sim.q, m.configuration("qpos0"))
    assert sim.time == 0 and not sim.v.any() and not sim.data.field("ctrl").any() and not sim.data.field("act").any()
    sim.data.reset("away")
    sim.data.reset()
    np.testing.assert_array_equal(sim.q, m.data().q)
    with pytest.raises(dyn.Error, match="awaj"):
        sim.data.reset("awaj")


def test_keys_are_copied_and_saved():
    m = load(KEYED)
    for other in (dyn.Builder.from_model(m).finish(), dyn.Model.from_image(m.image())):
        a, b = dyn.Simulation(m, "away"), dyn.Simulation(other, "away")
        assert a.data.step_options.dt == b.data.step_options.dt == 0.004
        a.step(5)
        b.step(5)
        np.testing.assert_array_equal(np.r_[a.q, a.v, a.time], np.r_[b.q, b.v, b.time])


@pytest.mark.parametrize("key, size", [("qvel", 7), ("ctrl", 3), ("act", 1), ("qpos", 8)])
def test_a_key_of_more_numbers_is_an_error(key, size):
    with pytest.raises(dyn.Error, match=f"{key} has {size + 1} numbers"):
        load(KEYED.replace('<key name="blank"/>', f'<key name="blank" {key}="{"1 " * (size + 1)}"/>'))


def test_what_a_key_leaves_out_is_as_drawn():
    m = load(KEYED.replace('<key name="blank"/>', '<key name="blank" qpos="3 4" qvel="5" ctrl="6 7"/>'))
    sim = dyn.Simulation(m, "blank")
    np.testing.assert_array_equal(sim.q, [3, 4, *m.configuration("qpos0")[2:]])
    np.testing.assert_allclose(sim.v, [5, 0, 0, 0, 0, 0, 0], atol=1e-15)
    np.testing.assert_array_equal(sim.data.field("ctrl"), [6, 7, 0])
    assert sum("the rest is as in the drawn pose" in line.message for line in m.report) == 3


def test_a_zero_quaternion_in_a_key_is_the_identity():
    m = load(KEYED.replace('<key name="blank"/>', '<key name="blank" qpos="0 0 0 0 0 0 0 0"/>'))
    np.testing.assert_array_equal(m.configuration("blank"), [0, 0, 0, 0, 0, 0, 1, 0])


def test_actuators_that_are_not_supported_keep_their_place():
    m = load(KEYED)
    assert m.nu == 3 and m.actuator_names == ["m", "t", "g"]
    assert any("'t'" in line.message and "exerts no force" in line.message for line in m.report)
    d = m.data()
    d.set_control([0, 1, 0])
    d.step()
    assert d.field("actuator_force")[1] == 0
    with pytest.raises(dyn.Error, match="exerts no force"):
        load(KEYED, strict=True)


def test_position_actuator_on_a_ball_joint_acts_on_its_rotation_vector():
    m = load("""<mujoco><worldbody><body><joint name="b" type="ball"/><geom size=".1" pos=".1 0 0"/></body></worldbody>
      <actuator><position name="p" joint="b" gear="1 0 0" kp="3"/></actuator></mujoco>""")
    assert m.nu == 1 and m.actuator("p").transmission == dyn.Transmission.AXES
    d = m.data()
    d.set_control([0.2])
    for _ in range(3):
        d.step()
    assert d.v[0] > 0


@pytest.mark.parametrize("flag, effect", [("damper", "DAMPING"), ("frictionloss", "FRICTION"), ("passive", "DAMPING"),
                                          ("constraint", "FRICTION")])
def test_flags_switch_effects_off(flag, effect):
    m = pendulum(friction=0.1, option=f'<option><flag {flag}="disable"/></option>')
    assert not m.data().effects() & dyn.Effect[effect]
    d = m.data()
    d.set_effects("all")
    assert d.effects() & dyn.Effect[effect]


def test_flags_switch_contacts_and_equalities_off():
    sim = dyn.Simulation(load(DROP.replace("<worldbody>", '<option><flag contact="disable"/></option><worldbody>')))
    sim.run(1.0)
    assert sim.q[0] < -3
    text = """<mujoco><option><flag equality="disable"/></option><worldbody><body name="a"><joint name="j" axis="0 1 0"/><geom size=".1" pos=".3 0 0"/></body>
      </worldbody><equality><weld body1="a"/></equality></mujoco>"""
    sim = dyn.Simulation(load(text))
    sim.run(0.5)
    assert sim.q[0] > 1


def test_rollouts_are_simulations():
    m = load(KEYED)
    r = m.batch(2).rollout(steps=20, n=2)
    sim = dyn.Simulation(m)
    sim.step(20)
    for k in range(2):
        np.testing.assert_array_equal(r.q[k, -1], sim.q)
        np.testing.assert_array_equal(r.v[k, -1], sim.v)
