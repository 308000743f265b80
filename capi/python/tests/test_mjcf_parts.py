"""Parts of MJCF files that others refer to: by shared names, as copies, or missing because they are not supported."""

import libdyn as dyn
import numpy as np
import pytest

GEOM = '<geom size=".1" pos=".3 0 0" mass="1"/>'
FLEX = '<flexcomp name="f" type="grid" count="3 3 1" spacing=".1 .1 .1" mass="1"/>'

pytestmark = pytest.mark.filterwarnings("ignore::libdyn.LoadWarning")


def load(text, **options):
    return dyn.load_string(f"<mujoco>{text}</mujoco>", **options)


def dropped(m):
    return [e.message for e in m.report if e.level == dyn.ReportLevel.DROPPED]


def test_sites_of_equalities_may_have_names_of_joints_and_bodies():
    m = load('<worldbody><site name="a" pos="0 0 .5"/><body name="a"><joint name="b" axis="0 1 0"/><geom size=".1" mass="1"/>'
             '<body name="b" pos="0 0 .5"><joint name="a" axis="0 1 0"/><geom size=".1" pos=".1 0 0" mass="1"/><site name="b"/>'
             '</body></body></worldbody><equality><connect site1="a" site2="b"/></equality>', strict=True)
    sim = dyn.Simulation(m)
    sim.run(0.5)
    assert abs(sim.q[0]) < 1e-6 and sim.q[1] > 0.5  # the second hinge stays at its place in the world and swings


@pytest.mark.parametrize("kind, open_tag, close_tag", [("frame", '<frame name="x" pos="0 0 9">', "</frame>"), ("body", "", "")])
def test_a_part_of_the_model_is_attached_again(kind, open_tag, close_tag):
    body = f'<body name="{"x" if kind == "body" else "y"}" pos="0 0 1"><geom name="g" size=".1"/></body>'
    m = load(f'<worldbody><body name="around" pos="5 0 0">{open_tag}{body}{close_tag}</body><frame pos="1 2 3">'
             f'<attach {kind}="x" prefix="more_"/></frame></worldbody>', strict=True)
    d = m.data()
    d.forward_kinematics(m.neutral())
    height = 13 if kind == "frame" else 4
    copy = d.frame_placement("more_y" if kind == "frame" else "more_x")
    np.testing.assert_allclose(copy.translation, [1, 2, height], atol=1e-15)
    assert {s.name for s in m.shapes} == {"g", "more_g"}


def test_joints_of_a_copy_move_and_a_copy_of_itself_is_an_error():
    m = load(f'<worldbody><body name="x"><joint name="j"/>{GEOM}</body><attach body="x" prefix="more_"/></worldbody>')
    assert m.nv == 2 and ["actuators and constraints of the copy" in message for message in dropped(m)] == [True]
    with pytest.raises(dyn.Error, match="it attaches itself"):
        load('<worldbody><frame name="x"><attach frame="x" prefix="p"/></frame></worldbody>')
    with pytest.raises(dyn.Error, match="no body 'z'"):
        load('<worldbody><attach body="z" prefix="p"/></worldbody>')


@pytest.mark.parametrize("actuator, controls", [('orientation joint="b"', 3), ('orientation joint="b" input="quat"', 4),
                                                ('pid joint="j"', 2), ('pid joint="j" input="pos vel ff"', 3),
                                                ('dcmotor joint="j" motorconst="1" resistance="1"', 1),
                                                ('dcmotor joint="j" motorconst="1" resistance="1" input="none"', 0),
                                                ('muscle joint="j"', 1)])  # yapf: disable
def test_actuators_with_several_controls_keep_their_places(actuator, controls):
    m = load(f'<worldbody><body><joint name="j"/>{GEOM}<body><joint name="b" type="ball"/>{GEOM}</body></body></worldbody>'
             f'<actuator><motor name="first" joint="j"/><{actuator} name="many"/><motor name="last" joint="j"/></actuator>')
    assert m.nu == controls + 2 and m.actuator_names[0] == "first" and m.actuator_names[-1] == "last"
    unknown = not actuator.startswith(("pid", "dcmotor"))
    assert len(dropped(m)) == unknown and all("exerts no force" in line for line in dropped(m))


def test_what_refers_to_unsupported_parts_is_dropped():
    m = load(f'<worldbody><body name="a"><joint name="j"/>{GEOM}{FLEX}</body></worldbody><contact>'
             '<exclude body1="a" body2="f_1"/></contact><equality><connect body1="f_0" anchor="0 0 0"/></equality>'
             '<actuator><motor joint="f_2"/></actuator>'
             '<keyframe><key name="k" qpos="1 2 3 4"/></keyframe>')
    assert (m.nv, m.nu, m.nconstraints) == (1, 1, 0) and "k" not in m.configurations
    said = "\n".join(dropped(m))
    for part in ("<flexcomp> is not used", "'connect_0': it is left out", "its joint is missing", "key 'k': it is left out"):
        assert part in said


def test_a_body_whose_mass_is_not_supported_is_dropped_physics():
    text = '<worldbody><body name="a"><joint name="j"/><geom type="sdf" mesh="m"/></body></worldbody>'
    m = load(text)
    assert m.nv == 1 and any("nothing resists it" in message for message in dropped(m))
    with pytest.raises(dyn.Error):
        load(text, strict=True)
    with pytest.raises(dyn.Error, match="nothing resists it"):  # without such a geom it is an error
        load('<worldbody><body name="a"><joint name="j"/></body></worldbody>')


def test_what_is_fixed_to_one_another_needs_no_weld_and_no_pair():
    m = load(f'<worldbody><body name="a"><joint/>{GEOM}<geom name="g" size=".1"/><body name="b"><geom name="h" size=".1"/></body>'
             '</body></worldbody><contact><pair geom1="g" geom2="h"/></contact><equality><weld body1="a" body2="b"/></equality>',
             strict=True)
    assert m.nconstraints == 0 and m.npairs == 0
    assert sum("it has no effect" in e.message for e in m.report) == 2


@pytest.mark.parametrize("limit", ['limited="true"', 'limited="true" range="0 0"'])
def test_a_ball_joint_of_limit_zero_is_named(limit):
    m = load(f'<worldbody><body><joint type="ball" {limit}/>{GEOM}</body></worldbody>')
    assert m.nv == 3 and len(dropped(m)) == 1 and "the limit of its angle is 0" in dropped(m)[0]


@pytest.mark.parametrize("joint, coordinate", [('type="hinge" axis="0 1 0"', lambda q: q[0]),
                                               ('type="ball"', lambda q: 2 * np.arccos(q[3]))])  # yapf: disable
def test_a_limit_holds_by_its_margin_inside_the_range(joint, coordinate):
    first = 0 if "ball" in joint else -30
    m = load(f'<worldbody><body><joint {joint} range="{first} 30" margin=".1" damping=".5"/>{GEOM}</body></worldbody>',
             strict=True)
    sim = dyn.Simulation(m)
    sim.run(4.0)
    assert coordinate(sim.q) == pytest.approx(np.pi / 6 - 0.1, abs=1e-4)


@pytest.mark.parametrize("rule", ["legacy", "exact"])
def test_the_mass_of_an_open_mesh_is_that_of_mujoco(rule):
    mujoco = pytest.importorskip("mujoco", reason="package mujoco is not installed")
    corners = "0 0 0  1 0 0  0 1 0  0 0 1  1 1 1  .2 .3 -1"
    text = (f'<asset><mesh name="m" inertia="{rule}" vertex="{corners}" face="0 2 5  0 5 1  1 5 2  1 2 4  0 1 3  0 3 2"/></asset>'
            '<worldbody><body name="b"><freejoint/><geom type="mesh" mesh="m"/></body></worldbody>')
    mm, m = mujoco.MjModel.from_xml_string(f"<mujoco>{text}</mujoco>"), load(text)
    d = m.data()
    assert m.total_mass == pytest.approx(mm.body_mass[1], rel=1e-12)
    d.compute_com(m.neutral())
    md = mujoco.MjData(mm)
    mujoco.mj_forward(mm, md)
    np.testing.assert_allclose(d.com, md.xipos[1], atol=1e-12)
    assert any("not closed" in e.message for e in m.report)
