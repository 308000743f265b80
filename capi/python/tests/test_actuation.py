"""Actuators, constraints and pairs of MJCF files, and what drives steps, beside MuJoCo where it is installed."""

import math

import libdyn as dyn
import numpy as np
import pytest

SERVOS = """<mujoco><option timestep="1e-4" integrator="RK4" {option}/>
<default><motor ctrlrange="-1 1"/><default class="soft"><position kp="3" kv="0.5"/></default></default>
<worldbody><body name="upper"><joint name="shoulder" axis="0 1 0" range="-90 90"/><geom type="capsule" fromto="0 0 0 0 0 -.5" size=".04"/>
<body name="lower" pos="0 0 -.5" gravcomp="0.7"><joint name="elbow" axis="0 1 0" ref="10"/><geom type="box" pos="0 0 -.2" size=".03 .05 .2"/></body></body></worldbody>
<actuator>{actuators}</actuator></mujoco>"""

ACTUATORS = {
    "motor": '<motor joint="shoulder" gear="2"/><motor joint="elbow"/>',
    "position": '<position joint="shoulder" kp="40" kv="2"/><position joint="elbow" class="soft" ctrlrange="-0.1 0.1"/>',
    "velocity": '<velocity joint="shoulder" kv="3" gear="0.5"/><velocity joint="elbow" kv="0.2" forcerange="-0.01 0.02"/>',
    "general": '<general joint="shoulder" gainprm="3" biastype="affine" biasprm="1 -20 -1"/><general joint="elbow" gainprm="2"/>',
    "ratio": '<position joint="shoulder" kp="40" dampratio="0.5" gear="2"/><general joint="elbow" gainprm="9" biastype="affine" '
             'biasprm="1 -9 0.3" gear="3" armature="0.002" damping="0.01"/>',
    "integral": '<intvelocity joint="shoulder" kp="40" kv="2" actrange="-1 1"/><general joint="elbow" dyntype="integrator" '
                'gainprm="2"/>',
    "drag": '<motor joint="shoulder"/><motor joint="elbow"/>',
}


@pytest.mark.parametrize("kind", ACTUATORS)
def test_steps_are_mujocos(kind):
    mujoco = pytest.importorskip("mujoco")
    text = SERVOS.format(actuators=ACTUATORS[kind], option='density="1000" viscosity="2" wind="0.3 1 0"' if kind == "drag"
                         else "")
    theirs = mujoco.MjModel.from_xml_string(text)
    state = mujoco.MjData(theirs)
    d = dyn.load_string(text).data()
    d.set_effects("all")
    q = state.qpos.copy()
    d.set_state(q=q)
    d.set_control([0.4, -0.7])
    state.ctrl[:] = 0.4, -0.7
    d.set_step_options("rk4", 1e-4)
    for _ in range(3000):
        d.step()
        mujoco.mj_step(theirs, state)
    assert np.abs(d.q - q).max() > 1e-3
    np.testing.assert_allclose(d.q, state.qpos, atol=1e-9)
    np.testing.assert_allclose(d.v, state.qvel, atol=1e-8)


def test_what_is_read_of_actuators():
    text = SERVOS.format(option="", actuators="""<motor name="m" joint="shoulder" gear="5"/><position joint="shoulder" inheritrange="0.5"/>
<general joint="elbow" gainprm="3" biastype="affine" biasprm="1 -2 -0.1" dyntype="filter" dynprm="0.02"/>
<general joint="elbow" dyntype="muscle"/><orientation joint="elbow"/>""")
    m = dyn.load_string(text)
    assert m.actuator_names == ["m", "position_1", "general_2", "general_3", "orientation_4", "orientation_4_1",
                                "orientation_4_2"]  # the last four exert no force
    motor, servo, affine = (m.actuator(k) for k in range(3))
    assert (motor.type, motor.gear, motor.control_range) == (dyn.ActuatorType.MOTOR, 5, (-1, 1))
    assert (servo.kp, servo.control_range) == (1, pytest.approx((-math.pi / 4, math.pi / 4)))
    assert (affine.gain, affine.bias, affine.time_constant) == (3, (1, -2, -0.1), 0.02)
    messages = "\n".join(r.message for r in m.report)
    for part in ("neither a first-order filter", "<orientation> is not supported"):
        assert part in messages
    for bad, message in (('<motor joint="none"/>', "no joint 'none'"), ('<motor joint="elbow" ctrlrange="1 0"/>', "lower end"),
                         ('<position joint="elbow" kp="-1"/>', "kp is -1"),
                         ('<position joint="elbow" dampratio="-1"/>', "dampratio"),
                         ('<position joint="elbow" kv="1" dampratio="1"/>', "give one of them"),
                         ('<motor joint="elbow" armature="-1"/>', "armature")):
        with pytest.raises(dyn.Error, match=message):
            dyn.load_string(SERVOS.format(option="", actuators=bad))


def test_damping_by_ratio():
    """kv = 2 ratio sqrt(kp / (gear^2 (M^-1)_jj)) in the drawn configuration, with the motors' own armature, which joints get by
    the square of the gear."""
    text = SERVOS.format(option="", actuators=ACTUATORS["ratio"])
    m = dyn.load_string(text)
    d = m.data()
    inverse = np.linalg.inv(d.crba(m.configuration("qpos0")))
    plain = dyn.load_string(text.replace('armature="0.002" damping="0.01"', "")).data()
    difference = np.linalg.inv(inverse) - plain.crba(m.configuration("qpos0"))
    np.testing.assert_allclose(difference, np.diag([0, 9 * 0.002]), atol=1e-13)
    assert m.damping[1] == pytest.approx(9 * 0.01, rel=1e-15)
    assert m.actuator(0).kv == pytest.approx(2 * 0.5 * math.sqrt(40 / (4 * inverse[0, 0])), rel=1e-12)
    assert m.actuator(1).bias == pytest.approx((1, -9, -2 * 0.3 * math.sqrt(9 / (9 * inverse[1, 1]))), rel=1e-12)


LOOP = """<mujoco><worldbody>
<body name="crank"><joint name="a" axis="0 1 0" damping="0"/><geom type="capsule" fromto="0 0 0 0.3 0 0" size=".02"/>
 <body name="rod" pos="0.3 0 0"><joint name="b" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0.6 0 -0.3" size=".02"/><site name="tip" pos="0.6 0 -0.3"/></body></body>
<body name="follower" pos="0 1 0"><joint name="c" axis="0 1 0" ref="20"/><geom size=".05" pos=".1 0 0"/></body>
<body name="stone" pos="2 0 0"><freejoint/><geom size=".05"/></body><site name="here" pos="2.2 0 0"/></worldbody>
<equality>{equality}</equality></mujoco>"""


def test_equalities_hold():
    m = dyn.load_string(LOOP.format(equality="""<connect body1="rod" anchor="0.6 0 -0.3"/><joint joint1="c" joint2="a" polycoef="0.1 2 0 0 0"/>
<weld body1="stone" body2="follower"/><connect name="off" site1="tip" site2="here" active="false"/>"""))
    assert m.constraint_names == ["connect_0", "joint_1", "weld_2", "off"]
    assert [m.constraint(k).enabled for k in range(4)] == [1, 1, 1, 0]
    d = m.data()
    d.set_state(q=m.configuration("qpos0"))
    tip = m.frame_id("tip")
    d.forward_kinematics(d.q)
    start = d.frame_placement(tip).translation.copy()
    d.set_step_options(dt=1e-3)
    for k in range(500):
        d.step()
        if k > 200:
            q = dict(zip("abc", (d.q[m.joint(n).idx_q] for n in "abc")))
            assert q["c"] - math.radians(20) == pytest.approx(0.1 + 2 * q["a"], abs=1e-4)
    d.forward_kinematics(d.q)
    np.testing.assert_allclose(d.frame_placement(tip).translation, start, atol=1e-5)


def test_pairs():
    text = """<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1" contype="0" conaffinity="0"/>
<body name="box" pos="0 0 .1"><freejoint/><geom name="side" type="box" size=".1 .1 .1"/></body></worldbody>
<contact><pair geom1="floor" geom2="side" friction="0.2 0.2 0.01 0.001 0.001" condim="3"/></contact></mujoco>"""
    m = dyn.load_string(text)
    d = m.data()
    d.set_state(q=m.configuration("qpos0"), v=[1, 0, 0, 0, 0, 0])
    d.set_step_options(dt=1e-3)
    for _ in range(200):
        d.step()
    assert d.v[0] == pytest.approx(1 - 0.2 * 9.81 * 0.2, abs=1e-6)
    with pytest.raises(dyn.Error, match="no collision shape 'roof'"):
        dyn.load_string(text.replace('geom1="floor"', 'geom1="roof"'))


def test_python_calls():
    b = dyn.Builder("arm")
    b.add_joint("hinge", "revolute", None, axis=(0, 1, 0)).add_body("arm", "hinge", 2.0, (0.5, 0, 0))
    b.add_actuator("servo", "hinge", type="position", kp=1e4, kv=1e3)
    b.set_gravity_compensation("arm").set_medium(1.2, 1e-5)
    m = b.finish()
    assert (m.nu, m.nactuators, m.actuator("servo").kp) == (1, 1, 1e4)
    d = m.data()
    d.set_control([0.3])
    d.set_step_options(dt=0.01)
    d.advance(5.0)
    assert d.q[0] == pytest.approx(0.3, abs=1e-6) and abs(d.actuator_force[0]) < 1e-3
    d.set_gravity([0, 0, 0])
    assert list(d.world_gravity) == [0, 0, 0]
    d.apply_wrench("arm", [0, 0, -10, 0, 0, 0], point=[0.5, 0, 0])
    d.advance(5.0)
    assert d.actuator_force[0] == pytest.approx(-5 * math.cos(d.q[0]), abs=1e-3)
    d.clear_wrenches()
    for call, message in (
        (lambda: d.set_control([1, 2]), "u"), (lambda: d.set_control([math.nan]), "u"),
        (lambda: d.apply_wrench("none", [0] * 6), "none"), (lambda: m.actuator("x"), "no actuator"),
        (lambda: b.add_actuator("x", "none"), "none"), (lambda: b.set_medium(-1), "density"),
    ):
        with pytest.raises(dyn.Error, match=message):
            call()


HELD = """<mujoco><worldbody><body name="rod" pos="0 0 1"><joint name="hinge" axis="0 1 0"/><geom type="capsule" size="0.02" fromto="0 0 0 0 0 -1" mass="1"/>{}</body></worldbody>
<equality><weld body1="rod"/></equality></mujoco>"""
LOWER = '<body pos="0 0 -1"><joint axis="0 1 0"/><geom type="capsule" size="0.02" fromto="0 0 0 0 0 -1" mass="1"/></body>'


@pytest.mark.parametrize("options", [{"integrator": "reference", "dt": 2e-3}, {"accuracy": 1e-3}, {"accuracy": 1e-9},
                                     {"accuracy": 1e-6, "integrator": "rk45"}])
@pytest.mark.parametrize("v", [[0.1, -0.1], [0.5, -0.5], [-3.0, 2.0]])
def test_a_velocity_that_a_weld_forbids_is_gone_at_once(options, v):
    """Redundant rows, and a state that they do not allow: the upper link stops by an impulse, the lower one swings on as a
    pendulum."""
    m = dyn.load_string(HELD.format(LOWER))
    d = m.data()
    d.set_step_options(**options)
    d.set_state([0, 0], v)
    energy, swing = None, []
    for _ in range(50):
        assert d.advance(2e-3).steps < 500
        assert abs(d.q[0]) < 1e-9 and abs(d.v[0]) < 1e-9
        swing.append(sum(d.energy()))
        energy = swing[0] if energy is None else energy
    assert np.ptp(swing) < 1e-6 * max(1, abs(energy))


def test_what_a_weld_holds_stays():
    m = dyn.load_string(HELD.format(""))
    d = m.data()
    for options in ({"integrator": "reference", "dt": 1e-3}, {"accuracy": 1e-6}, {"accuracy": 1e-9}):
        d.set_step_options(**options)
        d.set_state([0], [0.1])
        d.advance(0.2)
        assert abs(d.q[0]) < 1e-12 and abs(d.v[0]) < 1e-12
