"""Of two geoms: friction, kinds of friction and margin of their contact, by priority, condim and margin, beside MuJoCo's."""

import libdyn as dyn
import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="package mujoco is not installed")

# attributes of two geoms, and of a <pair> or None
LOW, HIGH = 'friction=".2 .03 .002"', 'friction=".5 .01 .004"'
CASES = {
    "equal": (LOW, HIGH, None),
    "no friction beside friction": (f'condim="1" {HIGH}', f'condim="3" {LOW}', None),
    "no friction": (f'condim="1" {HIGH}', f'condim="1" {LOW}', None),
    "torsion beside sliding": (f'condim="3" {LOW}', f'condim="4" {HIGH}', None),
    "torsion": (f'condim="4" {LOW}', f'condim="4" {HIGH}', None),
    "rolling beside sliding": (f'condim="3" {HIGH}', f'condim="6" {LOW}', None),
    "rolling beside none": (f'condim="1" {HIGH}', f'condim="6" {LOW}', None),
    "higher priority slips": (f'priority="1" {LOW}', HIGH, None),
    "higher priority holds": (f'priority="1" {HIGH}', LOW, None),
    "lower priority": (f'priority="-2" {HIGH}', f'priority="-1" {LOW}', None),
    "equal priority": (f'priority="5" {HIGH}', f'priority="5" {LOW}', None),
    "priority and kinds": (f'priority="1" condim="1" {HIGH}', f'condim="6" {LOW}', None),
    "priority of more kinds": (f'priority="7" condim="6" {LOW}', f'priority="3" condim="1" {HIGH}', None),
    "margins": ('margin=".01"', 'margin=".02"', None),
    "one margin, and a gap": ('margin=".01" gap=".005"', 'gap=".01"', None),
    "gaps": ('gap=".01"', 'gap=".02"', None),
    "a pair without numbers": (f'condim="6" {LOW}', f'priority="1" condim="1" {LOW}', ""),
    "a pair with friction": (f'condim="6" {LOW}', LOW, 'friction=".3 .3 .02"'),
    "a pair with kinds": (f'condim="1" {LOW}', LOW, 'condim="4"'),
    "a pair with both": (f'condim="6" {LOW}', LOW, 'condim="6" friction=".3 .3 .02 .003 .003"'),
}


def xml(one, two, pair):
    contact = "" if pair is None else f'<contact><pair geom1="floor" geom2="ball" {pair}/></contact>'
    return (f'<mujoco><worldbody><geom name="floor" type="plane" size="9 9 1" {one}/><body pos="0 0 .1"><freejoint/>'
            f'<geom name="ball" size=".1" {two}/></body></worldbody>{contact}</mujoco>')


def of_mujoco(text):
    """Coefficients that act (sliding, torsion, rolling), and the height at which the ball rests."""
    mm = mujoco.MjModel.from_xml_string(text)
    mm.geom_solref[:] = mm.pair_solref[:] = (0.004, 1)
    mm.geom_solimp[:, :2] = mm.pair_solimp[:, :2] = 0.999
    md = mujoco.MjData(mm)
    mujoco.mj_forward(mm, md)
    c = md.contact[0]
    acting = [c.friction[k] if c.dim > n else 0.0 for k, n in ((0, 1), (2, 3), (3, 4))]
    for _ in range(1000):
        mujoco.mj_step(mm, md)
    return acting, md.qpos[2]


def here(text):
    """The same, of the forces on a ball that slides, turns on the spot and rolls askew."""
    m = dyn.load_string(text)
    d = m.data()
    rest = dyn.Simulation(m)
    rest.run(2.0)
    d.set_state(rest.q, [0, 0, 0, 0, 0, 0])

    def coefficient(v, force, along):
        d.set_state(rest.q, v)
        d.step()
        (c,) = d.step_contacts()
        return np.abs(getattr(c, force) @ along) / c.force_on_b[2]

    turns, slides = np.array([0, 0, 50.0]), np.array([5.0, 0, 0])
    return [coefficient([*slides, 0, 0, 0], "force_on_b", [1, 0, 0]), coefficient([0, 0, 0, *turns], "moment_on_b", [0, 0, 1]),
            coefficient([0, 5.0, 0, -50.0, 0, 0], "moment_on_b", [1, 0, 0])], rest.q[2]


@pytest.mark.parametrize("order", ["as written", "exchanged"])
@pytest.mark.parametrize("name", CASES)
def test_a_contact_has_the_friction_and_margin_of_mujoco(name, order):
    one, two, pair = CASES[name]
    text = xml(*((one, two) if order == "as written" else (two, one)), pair)
    (friction, height), (expected, expected_height) = here(text), of_mujoco(text)
    np.testing.assert_allclose(friction, expected, rtol=1e-3, atol=1e-6)  # MuJoCo's least is 1e-5
    assert height == pytest.approx(expected_height, abs=2e-5)  # MuJoCo's contact sinks in by g over its stiffness


def test_priorities_beyond_eight_levels_are_named():
    geoms = "".join(f'<geom size=".1" priority="{k}"/>' for k in range(-5, 6))
    said = [e.message for e in dyn.load_string(f"<mujoco><worldbody>{geoms}</worldbody></mujoco>").report
            if e.level == dyn.ReportLevel.DROPPED]
    assert [message.split(" counts")[0].split("priority ")[1] for message in said] == ["-5", "4", "5"]


@pytest.mark.parametrize("floor, pair, what", [('margin="-.01"', None, "margin is negative"),
                                               ('margin=".01"', "", "its margin is not used"),
                                               ("", 'margin=".01"', "its margin is not used")])  # yapf: disable
def test_margins_that_are_not_supported_are_named(floor, pair, what):
    said = [e.message for e in dyn.load_string(xml(floor, "", pair)).report if e.level == dyn.ReportLevel.DROPPED]
    assert len(said) == 1 and what in said[0]


def test_a_material_that_is_set_keeps_its_priority():
    m = dyn.load_string(xml(f'priority="1" {LOW}', HIGH, None))
    d = m.data()
    assert [s.material.torsion for s in m.shapes] == [0, 0] and d.shape_material(0).torsion == 0  # condim is 3

    def friction():
        d.set_state(m.configuration("qpos0"), [5, 0, 0, 0, 0, 0])
        d.step()
        (c,) = d.step_contacts()
        return -c.force_on_b[0] / c.force_on_b[2]

    d.set_shape_material(1, dyn.Material(friction=0.9))
    assert friction() == pytest.approx(0.2, rel=1e-6)
    d.set_shape_material(0, dyn.Material(friction=0.7))
    assert friction() == pytest.approx(0.7, rel=1e-6)


@pytest.mark.parametrize("damping", [0, 10, 20])
@pytest.mark.parametrize("where", ["floor", "ball", "pair"])
def test_a_contact_spring_of_little_damping_rebounds(damping, where):
    spring = f'solref="-10000 -{damping}"'
    text = xml(spring if where == "floor" else "", spring if where == "ball" else "", spring if where == "pair" else None)
    mm = mujoco.MjModel.from_xml_string(text)
    mm.opt.timestep, mm.opt.gravity[:] = 1e-4, 0
    md = mujoco.MjData(mm)
    md.qvel[2] = -2
    for _ in range(2000):
        mujoco.mj_step(mm, md)
    m = dyn.load_string(text)
    d = m.data()
    d.set_gravity([0, 0, 0])
    d.set_state(m.configuration("qpos0"), [0, 0, -2, 0, 0, 0])
    d.advance(0.2)
    assert d.v[2] == pytest.approx(md.qvel[2], abs=0.03 * 2)  # MuJoCo's lets go before half a period
