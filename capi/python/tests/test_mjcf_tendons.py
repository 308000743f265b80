"""Tendons, their actuators, muscles and couplings of MJCF files, beside MuJoCo where it is installed, and their saving."""

import math

import libdyn as dyn
import numpy as np
import pytest

ARM = """<mujoco><compiler {compiler}/><option>{flags}</option>
<default><joint axis="0 1 0" range="-50 80" damping=".1"/><tendon stiffness="7" width=".01" frictionloss=".2"/>
<default class="stiff"><tendon stiffness="100" damping="3"/></default></default>
<worldbody><site name="anchor" pos="0 .1 .3"/><site name="back" pos="-.2 0 .1"/><site name="side" pos=".3 0 0"/>
<body name="upper"><joint name="a"/><geom type="capsule" size=".03" fromto="0 0 0 0 0 -.4"/>
 <geom name="wrap" type="cylinder" size=".05 .1" euler="90 0 0" mass="0"/>
 <site name="s1" pos=".05 0 -.2"/><site name="s2" pos="-.04 .02 -.25"/>
 <body name="lower" pos="0 0 -.4"><joint name="b" range="-100 -5" ref="-20"/>
  <geom type="capsule" size=".03" fromto="0 0 0 0 0 -.4"/>
  <geom name="b" size=".04" mass="0" contype="0" conaffinity="0"/><site name="s3" pos=".03 0 -.15"/></body></body></worldbody>
<tendon>{tendons}</tendon><actuator>{actuators}</actuator><equality>{equality}</equality></mujoco>"""

TENDONS = """<spatial name="flexor" class="stiff" springlength=".1 .3" range=".5 1.2" margin=".01">
 <site site="anchor"/><geom geom="wrap" sidesite="side"/><site site="s1"/><geom geom="b"/><site site="s3"/></spatial>
<spatial name="second" armature=".01"><site site="back"/><site site="s2"/><pulley divisor="2"/>
 <site site="s1"/><site site="s3"/></spatial>
<fixed name="sum" stiffness="0" springlength=".2" damping=".5"><joint joint="a" coef="2"/><joint joint="b" coef="-.5"/></fixed>"""


def arm(tendons=TENDONS, actuators="", equality="", compiler="", flags=""):
    return ARM.format(tendons=tendons, actuators=actuators, equality=equality, compiler=compiler, flags=flags)


def elements(m, tendon):
    return [(e.type.name.lower(), e.name, e.value, e.side) for e in m.tendon(tendon).elements]


def frame_names(m):
    return [m.frame_name(f) for f in range(m.nframes)]


def test_what_is_read_of_tendons():
    m = dyn.load_string(arm())
    assert m.tendon_names == ["flexor", "second", "sum"]
    flexor, second, total = (m.tendon(k) for k in range(3))
    assert (flexor.stiffness, flexor.damping, flexor.friction, flexor.rest) == (100, 3, 0.2, (0.1, 0.3))
    assert flexor.range == pytest.approx((0.51, 1.19), abs=1e-15)
    assert (second.stiffness, second.armature, second.range) == (7, 0.01, (-math.inf, math.inf))
    assert (total.type, total.stiffness, total.damping, total.rest) == (dyn.TendonType.FIXED, 0, 0.5, (0.2, 0.2))
    assert elements(m, "flexor") == [("site", "anchor", 1, None), ("cylinder", "wrap", 0.05, "side"), ("site", "s1", 1, None),
                                     ("sphere", "b_wrap", 0.04, None), ("site", "s3", 1, None)]
    assert elements(m, 1)[2] == ("pulley", None, 2, None)
    assert elements(m, "sum") == [("joint", "a", 2, None), ("joint", "b", -0.5, None)]
    assert any("called 'b_wrap'" in r.message for r in m.report)


def test_lengths_and_moment_arms_are_mujocos():
    mujoco = pytest.importorskip("mujoco")
    theirs = mujoco.MjModel.from_xml_string(arm().replace(' armature=".01"', ""))
    state = mujoco.MjData(theirs)
    m = dyn.load_string(arm())
    d = m.data()
    for q in ((0.0, math.radians(-20)), (1.2, -0.3), (-0.7, -1.6)):
        state.qpos[:], state.qvel[:] = q, (0.5, -2)
        mujoco.mj_forward(theirs, state)
        found = d.tendons(np.array(q), np.array([0.5, -2]))
        np.testing.assert_allclose(found.length, state.ten_length, atol=1e-12)
        np.testing.assert_allclose(found.velocity, state.ten_velocity, atol=1e-9)
    np.testing.assert_allclose([m.tendon(k).rest for k in range(3)], theirs.tendon_lengthspring, atol=1e-12)


def test_flags_switch_parts_of_tendons_off():
    for flag, changed in (("spring", {"stiffness": 0}), ("damper", {"damping": 0}), ("frictionloss", {"friction": 0}),
                          ("limit", {"range": (-math.inf, math.inf)})):
        expected = dyn.load_string(arm()).tendon("flexor")._replace(**changed)
        assert dyn.load_string(arm(flags=f'<flag {flag}="disable"/>')).tendon("flexor") == expected


def test_limits_follow_autolimits():
    fixed = '<fixed name="t" {}><joint joint="a" coef="1"/></fixed>'
    for given, read in (('range="-1 2"', (-1, 2)), ('range="-1 2" limited="false"', (-math.inf, math.inf)),
                        ('range="0 0"', (-math.inf, math.inf))):
        assert dyn.load_string(arm(fixed.format(given))).tendon("t").range == read
    with pytest.raises(dyn.Error, match="autolimits"):
        dyn.load_string(arm(fixed.format('range="-1 2"'), compiler='autolimits="false"'))
    with pytest.raises(dyn.Error, match="needs range"):
        dyn.load_string(arm(fixed.format('limited="true"')))


@pytest.mark.parametrize(("tendons", "line", "message"), [
    ('\n<spatial><site site="anchor"/>\n<site site="s4"/></spatial>', 3, r"no site 's4' \(did you mean"),
    ('<spatial><site site="anchor"/>\n<geom geom="wrop"/>\n<site site="s1"/></spatial>', 2,
     r"no geom 'wrop' \(did you mean 'wrap'"),
    ('<fixed>\n\n<joint joint="none" coef="1"/></fixed>', 3, "no joint 'none'"),
    ('<spatial><site site="anchor"/><geom geom="wrap" sidesite="nowhere"/><site site="s1"/></spatial>', 1, "no site 'nowhere'"),
    ('<spatial springlength="2 1"><site site="anchor"/><site site="s1"/></spatial>', 1, "springlength"),
    ('<spatial damping="-1"><site site="anchor"/><site site="s1"/></spatial>', 1, "damping"),
    ('<spatial><site site="anchor"/></spatial>', 1, "fewer than two sites"),
    ("<fixed/>", 1, "no element"),
    ('<fixed><joint joint="a"/></fixed>', 1, "coef"),
])
def test_errors_have_lines(tendons, line, message):
    first = arm("\0").split("\0")[0].count("\n")
    with pytest.raises(dyn.Error, match=message) as e:
        dyn.load_string(arm(tendons))
    assert f"line {first + line}:" in str(e.value) or f":{first + line}:" in str(e.value)


def test_replicas_have_their_own_tendons():
    text = """<mujoco><worldbody><site name="top" pos="0 0 1"/><replicate count="3" offset=".1 0 0" sep="-">
<body name="ball"><joint name="j" axis="1 0 0"/><geom size=".02" pos="0 0 -.1"/>
<site name="hook" pos="0 0 -.1"/></body></replicate>
<replicate count="2" offset="0 .2 0" sep="-"><body name="box"><joint name="k" type="slide"/><geom size=".02"/>
<site name="eye"/></body></replicate></worldbody>
<tendon><spatial name="cord"><site site="top"/><site site="hook"/></spatial>
<fixed name="f"><joint joint="k" coef="3"/></fixed></tendon>
<actuator><motor name="m" tendon="cord"/><motor name="n" tendon="f" gear="2"/></actuator></mujoco>"""
    m = dyn.load_string(text)
    assert m.tendon_names == ["cord-0", "cord-1", "cord-2", "f-0", "f-1"]
    assert elements(m, "cord-1") == [("site", "top", 1, None), ("site", "hook-1", 1, None)]
    assert m.actuator_names == ["m-0", "m-1", "m-2", "n-0", "n-1"]
    assert [m.tendon_names[m.actuator(k).tendon] for k in range(5)] == m.tendon_names
    mujoco = pytest.importorskip("mujoco")
    theirs = mujoco.MjModel.from_xml_string(text)
    assert [theirs.tendon(k).name for k in range(5)] == m.tendon_names
    assert [theirs.actuator(k).name for k in range(5)] == m.actuator_names


ACTUATORS = """<motor name="cord" tendon="flexor" gear="3" forcerange="-2 2"/>
<position name="servo" tendon="sum" kp="10" kv="1" inheritrange="1"/>
<general name="push" site="s3" gear="0 0 1 .5 0 0" ctrlrange="-1 1"/>
<position name="to" site="s3" refsite="back" gear="1 0 .2 0 0 0" kp="10" dampratio="1"/>
<position name="ratio" tendon="second" kp="40" dampratio=".5" gear="2" armature=".02"/>"""


def test_actuators_of_tendons_and_sites():
    text = arm(TENDONS.replace('damping=".5"', 'damping=".5" range="-1 2" actuatorfrcrange="-4 5"'), ACTUATORS)
    m = dyn.load_string(text)
    cord, servo, push, to, ratio = (m.actuator(k) for k in range(5))
    assert (cord.transmission, cord.tendon, cord.gear, cord.force_range) == (dyn.Transmission.TENDON, 0, 3, (-2, 2))
    assert (servo.kp, servo.control_range, servo.force_range) == (10, (-1, 2), (-4, 5))
    assert (push.transmission, push.wrench) == (dyn.Transmission.SITE, (0, 0, 1, 0.5, 0, 0))
    assert (push.control_range, push.reference) == ((-1, 1), -1)
    assert [m.frame_name(f) for f in (push.frame, to.frame, to.reference)] == ["s3", "s3", "back"]
    assert m.tendon("second").armature == pytest.approx(0.01 + 4 * 0.02, rel=1e-15)
    mujoco = pytest.importorskip("mujoco")
    theirs = mujoco.MjModel.from_xml_string(text)
    np.testing.assert_allclose([to.kv, ratio.kv], -theirs.actuator_biasprm[3:, 2], rtol=1e-10)


@pytest.mark.parametrize(("actuator", "message"), [
    ('<general tendon="flexor" dyntype="muscle" gaintype="muscle" gainprm=".7 1 1 1 .5 1.6 1 1 1"/>', "first-order filter"),
    ('<muscle tendon="flexor" force="0"/>', "force is 0"),
])
def test_actuators_that_are_not_supported_keep_their_place(actuator, message):
    m = dyn.load_string(arm(actuators=actuator + '<motor name="next" joint="a"/>'))
    assert m.actuator_names[1] == "next" and m.nu == 2
    assert any(message in r.message and "keeps its control" in r.message for r in m.report)


MUSCLES = """<muscle tendon="flexor"/><muscle tendon="second" gear="2" scale="300"/>
<muscle tendon="sum" force="50" lmin=".4" lmax="1.8" timeconst=".02 .05" tausmooth=".1" range=".7 1.1"
 vmax="2" fpmax="1.1" fvmax="1.4"/>
<muscle joint="b" gear="-.1" ctrlrange="0 1"/><muscle joint="a" gear=".1" lengthrange="-.1 .1"/>
<general joint="a" dyntype="muscle" gaintype="muscle" biastype="muscle" lengthrange="-1 1" dynprm=".03 .06 .1"
 gainprm=".8 1.2 20 1 .6 1.5 2 1 1.3" biasprm=".8 1.2 20 1 .6 1.5 2 1.4 1.3"/>"""


def test_muscles_are_mujocos():
    """Force and parameters are equal. MuJoCo finds ranges of lengths by a simulation, which passes its soft limits."""
    mujoco = pytest.importorskip("mujoco")
    text = arm(TENDONS.replace(' range=".5 1.2" margin=".01"', "").replace(' armature=".01"', ""), MUSCLES)
    theirs, m = mujoco.MjModel.from_xml_string(text), dyn.load_string(text)
    for k in range(theirs.nu):
        x, gain, bias = m.actuator(k).muscle, theirs.actuator_gainprm[k], theirs.actuator_biasprm[k]
        assert m.actuator(k).type == dyn.ActuatorType.MUSCLE
        assert x.force == pytest.approx(gain[2] if gain[2] > 0 else gain[3] / theirs.actuator_acc0[k], rel=1e-10)
        assert (*x.range, x.lmin, x.lmax, x.vmax, x.fpmax, x.fvmax) == (*gain[:2], *gain[4:7], bias[7], gain[8])
        assert (x.t_act, x.t_deact, x.smoothing) == tuple(theirs.actuator_dynprm[k][:3])
        length = theirs.actuator_lengthrange[k]
        np.testing.assert_allclose(x.length_range, length, atol=0.02 * (length[1] - length[0]))


def test_the_range_of_a_muscle_is_that_of_its_joints():
    text = arm(actuators='<muscle joint="a" gear="-2"/><muscle tendon="sum"/>')
    m = dyn.load_string(text)
    a, b = np.radians((-50, 80)), np.radians((-100, -5))
    assert m.actuator(0).muscle.length_range == pytest.approx((-2 * a[1], -2 * a[0]), rel=1e-14)
    assert m.actuator(1).muscle.length_range == pytest.approx((2 * a[0] - b[1] / 2, 2 * a[1] - b[0] / 2), rel=1e-14)
    follows = arm(actuators='<muscle tendon="sum"/>', equality='<joint joint1="b" joint2="a" polycoef="-.5 1 0 0 0"/>')
    ends = [2 * x - (math.radians(-20) - 0.5 + x) / 2 for x in a]
    assert dyn.load_string(follows).actuator(0).muscle.length_range == pytest.approx(ends, rel=1e-12)
    limited = arm(actuators='<muscle tendon="flexor" gear="2"/>').replace('range="-50 80"', "")
    assert dyn.load_string(limited).actuator(0).muscle.length_range == pytest.approx((1.02, 2.38), rel=1e-12)
    free = dyn.load_string(arm(actuators='<muscle tendon="sum"/>').replace('range="-50 80"', ""))
    assert any("has no limits: give lengthrange" in r.message for r in free.report)


def test_couplings_of_tendons():
    equality = '<tendon tendon1="flexor" tendon2="sum" polycoef=".02 .1 .03"/><tendon tendon1="sum" active="false"/>'
    m = dyn.load_string(arm(equality=equality))
    assert [r.message for r in m.report if "not active" in r.message]
    d = m.data()
    d.set_effects("all")
    for _ in range(50):
        d.step()
    zero = m.data().tendons(m.configuration("qpos0"), np.zeros(m.nv)).length
    now = d.tendons(d.q, d.v).length - zero
    np.testing.assert_allclose(now[0], 0.02 + 0.1 * now[2] + 0.03 * now[2] ** 2, atol=1e-7)
    for bad in ('tendon1="none"', 'tendon1="flexor" tendon2="none"'):
        with pytest.raises(dyn.Error, match="no tendon 'none'"):
            dyn.load_string(arm(equality=f"<tendon {bad}/>"))
    off = dyn.load_string(arm(equality='<tendon tendon1="flexor"/>', flags='<flag equality="disable"/>')).data()
    for _ in range(50):
        off.step()
    assert abs(off.tendons(off.q, off.v).length[0] - zero[0]) > 1e-3


@pytest.mark.parametrize("ending", ["xml", "dynb"])
def test_what_is_saved_reads_back(tmp_path, ending):
    equality = '<tendon name="tied" tendon1="flexor" tendon2="sum" polycoef=".1 2 3"/>'
    m = dyn.load_string(arm(actuators=ACTUATORS + MUSCLES, equality=equality))
    file = tmp_path / f"arm.{ending}"
    m.save(file)
    again = dyn.load(file)
    assert frame_names(again) == frame_names(m) and again.nshapes == m.nshapes
    for k in range(m.ntendons):
        assert again.tendon(k)._replace(elements=()) == m.tendon(k)._replace(elements=())
        assert elements(again, k) == elements(m, k)
    for k in range(m.nactuators):
        ours, theirs = m.actuator(k), again.actuator(k)
        for field in ("transmission", "gear", "wrench", "muscle", "control_range", "force_range"):
            assert getattr(ours, field) == getattr(theirs, field)
    q, v = np.array([0.3, -0.9]), np.array([1.0, -2])
    for ours, theirs in zip(m.data().tendons(q, v), again.data().tendons(q, v)):
        np.testing.assert_allclose(theirs, ours, atol=1e-14)


def test_wraps_without_a_shape_are_saved_as_geoms(tmp_path):
    b = dyn.Builder("arm").add_joint("hinge", "revolute", axis=(0, 1, 0))
    b.add_body("link", "hinge", mass=1, com=(0, 0, -0.5), inertia=np.eye(3) * 0.1)
    b.add_frame("here", None, [0.3, 0, 0.3]).add_frame("ball", "link", [0, 0, -0.2]).add_frame("there", "link", [0.1, 0, -0.4])
    cord = [("site", "here"), ("sphere", "ball", 0.05, "there"), ("site", "there")]
    m = b.add_tendon("cord", cord, type="spatial", rest=(-1, -1)).finish()
    m.save(tmp_path / "arm.xml")
    again = dyn.load(tmp_path / "arm.xml")
    assert elements(again, 0) == elements(m, 0) and frame_names(again) == frame_names(m) and again.nshapes == 0
    assert again.tendon(0).rest == pytest.approx((-1, -1), rel=1e-15)
    mujoco = pytest.importorskip("mujoco")
    theirs = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    state = mujoco.MjData(theirs)
    state.qpos[0] = 0.4
    mujoco.mj_forward(theirs, state)
    np.testing.assert_allclose(m.data().tendons(np.array([0.4]), np.zeros(1)).length, state.ten_length, atol=1e-12)


def test_urdf_loses_tendons(tmp_path):
    report = dyn.load_string(arm(equality='<tendon tendon1="flexor"/>')).save(tmp_path / "arm.urdf")
    text = "\n".join(str(line) for line in report)
    assert "tendons" in text and "couplings of tendons" in text
