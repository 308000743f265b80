"""Transmissions and laws of actuators beside MuJoCo, in closed forms, in files and in copies."""

import libdyn as dyn
import numpy as np
import pytest
from test_sensors import read_both

ARM = """<mujoco><option timestep=".001"/><default><geom density="700"/></default>
<worldbody><site name="rail" pos=".1 0 .2" euler="0 80 10"/>
<body name="base" pos="0 0 1"><freejoint name="free"/><geom type="box" size=".2 .1 .05"/><site name="seat" pos=".05 .02 .1" euler="10 -20 30"/>
 <body name="arm" pos=".2 0 0" euler="0 10 0"><joint name="hinge" axis="0 1 .3"/><geom type="capsule" size=".03 .2" pos="0 0 -.2"/>
  <site name="pin" pos="0 .01 -.1"/>
  <body name="ball" pos="0 0 -.4"><joint name="socket" type="ball"/><geom type="box" size=".04 .05 .06" pos=".02 0 0"/><site name="tip" euler="5 6 7"/></body></body>
 <body name="slider" pos="-.2 0 0"><joint name="slide" type="slide" axis="1 0 1"/><geom size=".06"/></body></body>
</worldbody>
<tendon><fixed name="sum"><joint joint="hinge" coef="2"/><joint joint="slide" coef="-1"/></fixed></tendon>
<actuator>{actuators}</actuator><sensor>{sensors}</sensor></mujoco>"""

MEASURED = {
    "slider": '<general {} cranksite="pin" slidersite="seat" cranklength="1.5" gear="3" gainprm="2" biastype="affine" biasprm="1 -2 -3"/>',
    "slider of the world": '<position {} cranksite="tip" slidersite="rail" cranklength="2" kp="20"/>',
    "short rod": '<velocity {} cranksite="pin" slidersite="rail" cranklength=".1" kv="20"/>',
    "ball": '<motor {} joint="socket" gear="1 -2 3"/>',
    "ball in the parent": '<motor {} jointinparent="socket" gear="1 -2 3"/>',
    "servo of a ball": '<position {} joint="socket" gear="0 1 0" kp="7" kv="1"/>',
    "servo of a ball in the parent": '<position {} jointinparent="socket" gear=".1 1 .4" kp="7" kv="1"/>',
    "turns": '<position {} site="tip" refsite="pin" gear="0 0 0 .3 1 .2" kp="4"/>',
    "free": '<motor {} joint="free" gear="1 2 3 4 5 6"/>',
    "free in the parent": '<general {} jointinparent="free" gear="1 2 3 4 5 6" gainprm="2" biastype="affine" biasprm="1 -2 -3"/>',
    "damper": '<damper {} joint="hinge" kv="3" ctrlrange="0 2" gear="-2"/>',
    "damper of a tendon": '<damper {} tendon="sum" kv="3" ctrlrange="0 2"/>',
    "gain by length and speed": '<general {} joint="hinge" gaintype="affine" gainprm="1 2 3" biastype="affine" biasprm="4 5 6" gear="2"/>',
    "cylinder": '<cylinder {} joint="slide" timeconst=".3" area=".4" bias="1 -2 -3"/>',
    "integrated velocity": '<intvelocity {} joint="hinge" kp="3" kv="1" actrange="-1 1"/>',
    "filter": '<general {} tendon="sum" dyntype="filter" dynprm=".2" gainprm="3"/>',
    "pid": '<pid {} joint="hinge" kp="3" kv="2" ki="5" imax="1" gear="2"/>',
    "pid of a force": '<pid {} tendon="sum" kp="3" kv="2" input="pos ff" posrange="-.2 .2" ffrange="-.1 .1" forcerange="-1 1"/>',
    "pid of a ball": '<pid {} joint="socket" gear="0 0 2" kp="3" kv="2" ki="1"/>',
    "motor": '<dcmotor {} joint="hinge" motorconst=".3" resistance="2" gear="10"/>',
    "motor of nominal values": '<dcmotor {} joint="hinge" nominal="12 3 40" damping=".01" saturation="1"/>',
    "motor with a controller": '<dcmotor {} joint="slide" motorconst=".3 .2" resistance="2" input="pos vel ff" controller="1 2 3 0 .5 6"/>',
    "motor that warms": '<dcmotor {} joint="hinge" motorconst=".3" resistance="2" thermal="1 2 0 .004 25 40" cogging=".1 7 .2"/>',
    "motor with friction": '<dcmotor {} joint="hinge" motorconst=".3" resistance="2" lugre="10 .5 .1 .3 .2" input="none"/>',
}  # fmt: skip


def both(actuators, sensors="", scene=ARM):
    mujoco = pytest.importorskip("mujoco")
    text = scene.format(actuators="".join(actuators), sensors=sensors)
    return mujoco.MjModel.from_xml_string(text), dyn.load_string(text)


@pytest.mark.parametrize("case", MEASURED)
def test_lengths_rates_and_forces_are_mujocos(case):
    named = [MEASURED[case].format('name="a"')]
    sensors = "".join(f'<{kind} name="{kind}" actuator="a"/>' for kind in ("actuatorpos", "actuatorvel", "actuatorfrc"))
    theirs, m = both(named, sensors)
    assert not [e.message for e in m.report if e.level == dyn.ReportLevel.DROPPED]
    assert (m.nu, m.data().act.size) == (theirs.nu, theirs.na)
    random = np.random.default_rng(3)
    for _ in range(6):
        ours, his = read_both(theirs, m, random)
        for name in his:
            np.testing.assert_allclose(ours[name], his[name], rtol=1e-9, atol=1e-9, err_msg=name)


@pytest.mark.parametrize("case", [c for c in MEASURED if "dcmotor" in MEASURED[c] or "pid" in MEASURED[c]])
def test_drivers_move_as_mujocos(case):
    """Short steps, so that the order of the two integrators does not show."""
    mujoco = pytest.importorskip("mujoco")

    scene = ARM.replace('timestep=".001"', 'timestep="1e-5" gravity="0 0 0"')
    theirs, m = both([MEASURED[case].format('name="a"')], scene=scene)
    data, d = mujoco.MjData(theirs), m.data()
    u = 0.4 + 0.1 * np.arange(m.nu)
    data.ctrl[:] = u
    if m.nu:
        d.set_control(u)
    data.qvel[6:] = v = np.linspace(-1, 1, theirs.nv - 6)
    d.set_state(v=np.r_[np.zeros(6), v])
    for _ in range(300):
        mujoco.mj_step(theirs, data)
        d.step()
    np.testing.assert_allclose(d.v[6:], data.qvel[6:], rtol=2e-4, atol=2e-5)
    np.testing.assert_allclose(d.act, data.act, rtol=1e-3, atol=1e-6)


def test_activations_act_late_unless_actearly():
    mujoco = pytest.importorskip("mujoco")

    for early in ("true", "false"):
        law = f'<general name="a" joint="hinge" dyntype="integrator" gainprm="5" actearly="{early}"/>'
        theirs, m = both([law], scene=ARM.replace("<option", '<option gravity="0 0 0"'))
        assert m.actuator("a").late == (early == "false")
        data, d = mujoco.MjData(theirs), m.data()
        data.ctrl[:] = 1
        d.set_control([1])
        for _ in range(3):
            mujoco.mj_step(theirs, data)
            d.step()
        np.testing.assert_allclose(d.v[6:], data.qvel[6:], rtol=1e-4, atol=1e-9)


LIMITED = """<mujoco><option timestep=".001" gravity="0 0 -10"/><worldbody>
<body name="b" gravcomp="1"><joint name="j" axis="0 1 0" actuatorfrcrange="-3 2" actuatorgravcomp="{weight}"/>
<geom size=".1" pos=".5 0 0" mass="1"/></body></worldbody>
<tendon><fixed name="t" actuatorfrcrange="-1 1"><joint joint="j" coef="1"/></fixed></tendon>
<actuator>{actuators}</actuator><sensor>{sensors}</sensor></mujoco>"""
TWO = ['<motor name="a" joint="j" gear="2"/>', '<position name="b" joint="j" kp="4"/>']


@pytest.mark.parametrize("weight", ["true", "false"])
@pytest.mark.parametrize("u", [(0.5, 0.1), (3, 0), (-3, 0), (0.1, -2)])
def test_the_sum_of_actuators_is_limited(weight, u, tmp_path):
    mujoco = pytest.importorskip("mujoco")

    sensor = '<jointactuatorfrc name="s" joint="j"/>'
    text = LIMITED.format(weight=weight, actuators="".join(TWO), sensors=sensor)
    theirs, m = mujoco.MjModel.from_xml_string(text), dyn.load_string(text)
    assert [(x.range, x.with_weight) for x in m.force_limits] == [((-3, 2), weight == "true")]
    data, d = mujoco.MjData(theirs), m.data()
    data.ctrl[:] = u
    data.qpos[:] = 0.2
    mujoco.mj_forward(theirs, data)
    d.set_control(u)
    d.set_state(q=[0.2])
    d.sensors()
    np.testing.assert_allclose(d.sensor("s"), data.sensordata, rtol=1e-12)
    d.step()
    np.testing.assert_allclose(d.v, data.qacc * 1e-3, rtol=2e-3)
    m.save(tmp_path / "m.dynb"), m.save(tmp_path / "m.xml")
    for again in (dyn.load(tmp_path / "m.dynb"), dyn.load(tmp_path / "m.xml"), dyn.Builder("copy").attach(m).finish()):
        assert again.force_limits == m.force_limits


def test_actuators_on_a_limited_tendon_are_scaled():
    mujoco = pytest.importorskip("mujoco")

    sensors = '<actuatorfrc name="a" actuator="a"/><actuatorfrc name="b" actuator="b"/>'
    actuators = ['<motor name="a" tendon="t"/>', '<motor name="b" tendon="t" gear="2"/>']
    text = LIMITED.format(weight="false", actuators="".join(actuators), sensors=sensors)
    theirs, m = mujoco.MjModel.from_xml_string(text), dyn.load_string(text)
    data, d = mujoco.MjData(theirs), m.data()
    for u in ((0.2, 0.3), (2, 1), (-3, 1)):
        data.ctrl[:] = u
        mujoco.mj_forward(theirs, data)
        d.set_control(u)
        np.testing.assert_allclose(d.sensors(), data.sensordata, rtol=1e-12)


STUCK = """<mujoco><option timestep=".002"/><worldbody>
<body name="plate" pos="0 0 1"><geom name="plate" type="box" size="1 1 .1"/></body>
<body name="ball" pos="0 0 .8"><freejoint/><geom name="ball" size=".1" mass="1"/></body></worldbody>
<actuator><adhesion name="glue" body="ball" gain="20" ctrlrange="0 1"/></actuator>
<sensor><contact name="c" geom1="ball" data="force"/></sensor></mujoco>"""


def test_adhesion_holds_a_ball_below_a_plate():
    m = dyn.load_string(STUCK)
    d = m.data()
    d.set_control([1])
    d.set_state(q=[0, 0, 0.8 + 1e-6, 0, 0, 0, 1])  # it touches
    for _ in range(200):
        d.step()
    assert abs(d.q[2] - 0.8) < 2e-3  # a step passes before the first contact pulls
    d.sensors()
    np.testing.assert_allclose(d.sensor("c")[0], 20 - 9.81, rtol=1e-6)
    d.set_control([0.2])
    for _ in range(200):
        d.step()
    assert d.q[2] < 0.5


def test_files_and_copies_keep_all(tmp_path):
    m = dyn.load_string(ARM.format(actuators="".join(a.format(f'name="{n}"') for n, a in MEASURED.items()), sensors=""))
    m.save(tmp_path / "m.dynb"), m.save(tmp_path / "m.xml")
    d = m.data()
    u = np.linspace(-0.3, 0.5, m.nu)
    for copy in (dyn.load(tmp_path / "m.dynb"), dyn.load(tmp_path / "m.xml"), dyn.Builder("copy").attach(m).finish()):
        assert copy.nactuators == m.nactuators and copy.nu == m.nu
        c = copy.data()
        for x in (d, c):
            x.reset(), x.set_control(u)
            for _ in range(3):
                x.step(1e-3)
        np.testing.assert_allclose(c.v, d.v, rtol=1e-9, atol=1e-11)


def test_bad_input_is_refused():
    def builder():
        b = dyn.Builder("b")
        b.add_joint("j", "revolute", axis=(0, 0, 1)), b.add_body("link", "j", mass=1, inertia=np.eye(3))
        return b

    for message, target, values in [
        ("rod is 0", "link", {"transmission": "slider_crank", "reference": "link"}),
        ("reference is missing", "link", {"transmission": "slider_crank", "rod": 1}),
        ("no ball and no free joint", "j", {"transmission": "axes"}),
        ("there is no moving joint 'k'", "k", {"transmission": "axes"}),
        ("gain_slope needs the type AFFINE", "j", {"gain_slope": (1, 0)}),
        ("adhesion has no length", "link", {"transmission": "body", "type": "position", "kp": 1}),
        ("inputs is 16", "j", {"type": "pid", "inputs": 16}),
        ("inputs is 8", "j", {"type": "pid", "inputs": 8}),
        ("slew is -1", "j", {"type": "pid", "slew": -1}),
        ("motor.resistance and motor.constant", "j", {"type": "dc_motor", "motor": dyn.DcMotor(resistance=0)}),
        ("heat_capacity is 0", "j", {"type": "dc_motor", "motor": dyn.DcMotor(thermal_resistance=1)}),
    ]:
        with pytest.raises(dyn.Error, match=message):
            builder().add_actuator("a", target, **values)
    with pytest.raises(dyn.Error, match="lower"):
        builder().limit_actuators("j", 1, -1)
    with pytest.raises(dyn.Error, match="it has one already"):
        builder().limit_actuators("j", -1, 1).limit_actuators("j", -1, 1)


def test_controls_are_set_by_assignment():
    m = dyn.load_string("<mujoco><worldbody><body name='a'><joint name='j'/><geom size='.1'/></body></worldbody>"
                        "<actuator><motor joint='j' gear='2'/></actuator></mujoco>")
    d = m.data()
    d.ctrl = [3.0]
    d.step(1e-3)
    assert d.ctrl[0] == 3 and d.actuator_force[0] == 3
    with pytest.raises(dyn.Error, match="ctrl|u "):
        d.ctrl = [1.0, 2.0]
    with pytest.raises(AttributeError, match="data.com is a view .* follows from the state"):
        d.com = np.zeros(3)
    with pytest.raises(AttributeError, match=r"data.set_gravity\(x\)"):
        d.world_gravity = np.zeros(3)
