"""Actuators of MJCF files: what they are, and defaults as MuJoCo reads them."""

import libdyn as dyn
import numpy as np
import pytest
from mjcf_pieces import BOXES, HINGE


def test_actuators_that_integrate_and_cylinders():
    """As MuJoCo's compiler makes them: gainprm, biasprm, dyntype, actrange."""
    base = "<mujoco><worldbody><body><joint name='j' range='-10 20'/><geom size='.1'/></body></worldbody><actuator>{}</actuator></mujoco>"
    one = lambda text: dyn.load_string(base.format(text)).actuator(0)  # noqa: E731
    x = one("<intvelocity joint='j' kp='3' kv='2' actrange='-1 2' ctrlrange='-4 4'/>")
    assert ((x.type.name, x.kp, x.kv, x.integrates, x.act_range, x.control_range, x.idx_act)
            == ("POSITION", 3, 2, True, (-1, 2), (-4, 4), 0))
    x = one("<intvelocity joint='j' kp='3' inheritrange='1'/>")
    assert x.act_range == pytest.approx((-np.pi / 18, np.pi / 9)) and x.control_range == (-np.inf, np.inf)
    assert (one("<intvelocity joint='j' kp='3' dampratio='1' actrange='-1 1'/>").kv
            == pytest.approx(0.4483993, rel=1e-6))  # MuJoCo's
    assert one("<intvelocity joint='j'/>").act_range == (-np.inf, np.inf)
    x = one("<general joint='j' dyntype='integrator' gainprm='4' biastype='affine' biasprm='1 -2 -3' actlimited='true' "
            "actrange='0 5'/>")
    assert (x.gain, x.bias, x.integrates, x.act_range) == (4, (1, -2, -3), True, (0, 5))
    assert one("<general joint='j' dyntype='filter' dynprm='.3' actrange='0 5'/>").act_range == (0, 5)
    x = one("<cylinder joint='j' diameter='2' bias='1 -2 -3' timeconst='.2'/>")
    assert x.gain == pytest.approx(np.pi) and (x.bias, x.time_constant) == ((1, -2, -3), 0.2)
    assert one("<motor joint='j'/>").idx_act == -1


def test_an_integrated_control_moves_as_in_mujoco():
    """A servo whose target is the integral of its control follows it: at rest q is the integral, within its range."""
    m = dyn.load_string("<mujoco><option gravity='0 0 0'/><worldbody><body><joint name='j' damping='1'/><geom size='.1' "
                        "mass='1'/></body></worldbody><actuator><intvelocity joint='j' kp='50' kv='5' actrange='-1 "
                        ".4'/></actuator></mujoco>")  # fmt: skip
    d = m.data("simulation")
    d.set_step_options(dt=1e-3)
    d.set_control([0.5])
    for _ in range(400):
        d.step()
    assert d.act[0] == pytest.approx(0.2, abs=1e-12)
    for _ in range(3000):
        d.step()
    assert d.act[0] == 0.4 and d.q[0] == pytest.approx(0.4, abs=1e-6)


def parameters(defaults, element):
    """gain and bias of an actuator as those of <general>."""
    a = dyn.load_string(f"<mujoco><default>{defaults}</default>{HINGE}<actuator>{element}</actuator></mujoco>").actuator(0)
    laws = {"motor": (1, (0, 0, 0)), "position": (a.kp, (0, -a.kp, -a.kv)), "velocity": (a.kv, (0, 0, -a.kv)),
            "affine": (a.gain, tuple(a.bias))}
    gain, bias = laws[a.type.name.lower()]
    return (gain, *bias, a.time_constant)


@pytest.mark.parametrize(("defaults", "element", "expected"),
                         [  # MuJoCo 4.0.0: actuator_gainprm[0], actuator_biasprm[:3], actuator_dynprm[0] of a filter
    ('<general gainprm="10" biastype="affine" biasprm="4 -10 -1"/>', '<position joint="j"/>', (10, 0, -10, -1, 0)),
    ('<general gainprm="10" dyntype="filter" dynprm=".2"/>', '<position joint="j" kp="3"/>', (3, 0, -3, 0, 0)),
    ('<general gainprm="10" biasprm="4 -9 -1" dynprm=".2"/>', '<cylinder joint="j"/>', (10, 4, -9, -1, 0.2)),
    ('<general biastype="affine" gainprm="100" biasprm="0 -100 -10"/>', '<general joint="j" gainprm="50" biasprm="0 -50"/>',
     (50, 0, -50, -10, 0)),
    ('<position kp="77" kv="3"/>', '<general joint="j"/>', (77, 0, -77, -3, 0)),
    ('<position kp="77" kv="3"/>', '<velocity joint="j"/>', (1, 0, 0, -1, 0)),
    ('<position kp="7" timeconst=".3"/>', '<position joint="j"/>', (7, 0, -7, 0, 0.3)),
    ('<position kp="7" timeconst=".3"/>', '<motor joint="j"/>', (1, 0, 0, 0, 0)),
    ('<velocity kv="5"/>', '<position joint="j"/>', (1, 0, -1, 0, 0)),
    ('<cylinder area="5" timeconst=".3" bias="1 2 3"/>', '<general joint="j"/>', (5, 1, 2, 3, 0.3)),
    ('<cylinder area="5" timeconst=".3" bias="1 2 3"/>', '<position joint="j"/>', (1, 0, -1, 0, 0)),
])
def test_actuators_share_their_defaults(defaults, element, expected):
    assert parameters(defaults, element) == expected


def test_the_last_range_of_any_actuator_is_the_default_of_all():
    text = f'<mujoco><default><position ctrlrange="-1 1"/><motor ctrlrange="-2 2"/></default>{HINGE}<actuator><position joint="j"/></actuator></mujoco>'
    assert list(dyn.load_string(text).actuator(0).control_range) == [-2, 2]


def test_a_joints_range_of_forces_bounds_its_actuator():
    joint = HINGE.replace('axis="0 1 0"', 'axis="0 1 0" actuatorfrcrange="-0.5 0.3"')
    for gear, expected in ((1, (-0.5, 0.3)), (-2, (-0.15, 0.25))):
        m = dyn.load_string(f'<mujoco>{joint}<actuator><motor joint="j" gear="{gear}"/></actuator></mujoco>', strict=True)
        assert tuple(m.actuator(0).force_range) == pytest.approx(expected)
    two = f'<mujoco>{joint}<actuator><motor joint="j"/><motor joint="j"/></actuator></mujoco>'
    assert [x.range for x in dyn.load_string(two, strict=True).force_limits] == [(-0.5, 0.3)]


def test_numbers_that_are_not_given_are_those_of_the_class():
    m = dyn.load_string('<mujoco><default><geom friction="0.9 0.3 0.2" condim="6" type="box" size=".1 .2 '
                        '.3"/></default><worldbody><body><joint/><geom name="g" friction="0.5" '
                        'size=".5"/></body></worldbody></mujoco>')
    shape = next(s for s in m.shapes if s.name == "g")
    assert (shape.material.friction, shape.material.torsion, shape.material.rolling) == (0.5, 0.3, 0.2)
    assert tuple(shape.size) == pytest.approx((1.0, 0.4, 0.6))
    m = dyn.load_string(f'<mujoco>{BOXES}<equality><joint joint1="ja" joint2="jb" polycoef="0.27"/></equality></mujoco>')
    q = m.data().project([0.9, 0.4])[0]
    assert q[0] == pytest.approx(0.27 + q[1], abs=1e-9)
