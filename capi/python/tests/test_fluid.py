"""Fluid forces on ellipsoids: closed forms, power, files, copies, and forces beside MuJoCo."""

import sys
from pathlib import Path

import libdyn as dyn
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "bench"))
COEFFICIENTS = (0.5, 0.25, 1.5, 1.0, 1.0)  # blunt, slender, angular drag, Kutta lift, Magnus force
STILL = 'gravity="0 0 0"'


def scene(bodies, option=""):
    return f"<mujoco><option {option}/><worldbody>{bodies}</worldbody></mujoco>"


def free(geoms, name="b"):
    return f'<body name="{name}"><freejoint/>{geoms}</body>'


def ellipsoid(size, coefficients=COEFFICIENTS, more=""):
    numbers = " ".join(map(str, coefficients))
    return (f'<geom type="ellipsoid" size="{" ".join(map(str, size))}" contype="0" conaffinity="0" fluidshape="ellipsoid" '
            f'fluidcoef="{numbers}" {more}/>')


def steps(d, n):
    for _ in range(n):
        d.step()


# ------------------------------------------------------------------------------------------------ beside MuJoCo

SHAPES = {
    "ellipsoid": 'type="ellipsoid" size=".3 .1 .2"', "disc": 'type="ellipsoid" size=".01 .3 .3"', "sphere": 'size=".2"',
    "box": 'type="box" size=".1 .3 .2"', "capsule": 'type="capsule" size=".1 .2"', "cylinder": 'type="cylinder" size=".2 .1"',
}  # fmt: skip
TREE = scene(
    free('<geom type="ellipsoid" size=".2 .1 .3" pos=".1 0 .2" euler="20 30 40" fluidshape="ellipsoid"/>'
         '<geom type="box" size=".1 .05 .2" pos="-.3 .1 0" euler="50 0 10" fluidshape="ellipsoid" fluidcoef="1 .2 .3 1.7 .4"/>'
         '<geom size=".1"/><body pos="0 .3 0"><joint axis="1 0 .2"/><geom type="capsule" size=".05 .2" fluidshape="ellipsoid"/>'
         '<body pos=".3 0 0" euler="0 30 0"><joint axis="0 1 0"/><geom type="box" size=".1 .1 .02"/></body></body>'),
    'density="30" viscosity=".7" wind="1 -.5 .3"')
MESH = ('<mujoco><option density="30" viscosity=".7"/><asset><mesh name="m" vertex="0 0 0  .3 0 0  0 .5 0  0 0 .7  .2 .4 .1"/></asset>'
        '<worldbody>' + free('<geom type="mesh" mesh="m" euler="10 20 30" pos=".1 0 .2" contype="0" conaffinity="0" '
                             'fluidshape="ellipsoid"/>') + "</worldbody></mujoco>")
# a wing of the fruit fly flybody, in centimetres and grams, with the coefficients of its authors
WING = scene(free(ellipsoid((0.0005, 0.0551, 0.114), (1, 0.5, 1.5, 1.7, 1), 'quat="-.685 -.634 .265 -.243" mass="8e-6"')),
             'density=".00128" viscosity=".000185"')


def passive(text, speed=1.0, states=20, body=None):
    """Passive forces here and in MuJoCo at random states, in MuJoCo's coordinates, and the states; of a body alone if one is named.
    Those here are from short steps: rounding and the length of the step bound the best of them."""
    mujoco = pytest.importorskip("mujoco", reason="package mujoco is not installed")
    from beside_mujoco import Beside, links_forces

    mm, m = mujoco.MjModel.from_xml_string(text), dyn.load_string(text)
    beside, md, d, random = Beside(mm, m), mujoco.MjData(mm), m.data(), np.random.default_rng(3)
    for _ in range(states):
        mujoco.mj_resetData(mm, md)
        mujoco.mj_integratePos(mm, md.qpos, random.uniform(-1, 1, mm.nv), 0.5)
        md.qvel[:] = speed * random.uniform(-1, 1, mm.nv)
        mujoco.mj_forward(mm, md)
        T, q = beside.velocity_map(md.qpos), beside.q(md.qpos)
        ways = [T.T @ links_forces(m, d, q, T @ md.qvel, h) for h in (1e-6, 1e-5, 1e-4, 1e-3)]
        first, n = (mm.body_dofadr[mm.body(body).id], 6) if body else (0, mm.nv)
        theirs = md.qfrc_passive[first : first + n].copy()
        yield min((way[first : first + n] for way in ways), key=lambda way: np.abs(way - theirs).max()), theirs, md


@pytest.mark.parametrize("shape", SHAPES)
def test_forces_on_shapes_are_mujocos(shape):
    text = scene(free(f'<geom {SHAPES[shape]} euler="20 30 40" pos=".1 .2 0" fluidshape="ellipsoid"/>'),
                 'density="900" viscosity="3" wind=".2 .1 -.3"')
    for ours, theirs, _ in passive(text):
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-10 * np.abs(theirs).max())


@pytest.mark.parametrize("term", range(5))
def test_each_coefficient_is_mujocos(term):
    coefficients = np.eye(5)[term]
    text = scene(free(ellipsoid((0.3, 0.1, 0.2), coefficients)), 'density="900"')
    for ours, theirs, _ in passive(text, states=5):
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-10 * np.abs(theirs).max())


# axes of a mesh follow from its inertia by eigenvectors
@pytest.mark.parametrize("text, speed, within", [(TREE, 1, 1e-10), (MESH, 1, 1e-9), (WING, 100, 1e-10)],
                         ids=["tree", "mesh", "wing of flybody"])
def test_forces_on_links_are_mujocos(text, speed, within):
    for ours, theirs, _ in passive(text, speed):
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=within * np.abs(theirs).max())


@pytest.mark.filterwarnings("ignore::libdyn.LoadWarning")
def test_mujocos_own_file_has_its_forces():
    """model.xml of MuJoCo's package: two thin plates that tumble. MuJoCo bounds |u| |n|^2 by 1e-15 in the lift, which takes it
    away from plates this small at low speed or edge on: states where that bound acts are left out."""
    mujoco = pytest.importorskip("mujoco", reason="package mujoco is not installed")
    text = Path(mujoco.__path__[0], "testdata", "model.xml").read_text()
    text = text.replace('fluidshape="ellipsoid"', 'fluidshape="ellipsoid" contype="0" conaffinity="0"')  # without contact forces
    compared = 0
    for ours, theirs, md in passive(text, speed=30, states=10, body="tumbling"):
        bounded = False
        for geom in np.flatnonzero(md.model.geom_bodyid == md.body("tumbling").id):
            v = np.zeros(6)
            mujoco.mj_objectVelocity(md.model, md, mujoco.mjtObj.mjOBJ_GEOM, geom, v, 1)
            u = v[3:] - md.geom_xmat[geom].reshape(3, 3).T @ md.model.opt.wind
            a, b, c = md.model.geom_size[geom]
            n = np.array([b * c, c * a, a * b]) ** 2 * u
            bounded |= np.linalg.norm(u) * (n @ n) < 1e-15
        if not bounded:
            np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-9 * np.abs(theirs).max())
            compared += 1
    assert compared >= 3


# ------------------------------------------------------------------------------------------------ closed forms

def test_a_sphere_sinks_at_the_speed_of_its_drag():
    """Stokes: 6 pi r beta v; Newton: rho C_blunt pi r^2 v^2."""
    r, m = 0.1, 2.0
    for density, viscosity, speed in ((0, 3, m * 9.81 / (6 * np.pi * r * 3)), (40, 0, np.sqrt(m * 9.81 / (40 * 0.5 * np.pi * r**2)))):
        text = scene(free(f'<geom size="{r}" mass="{m}" fluidshape="ellipsoid"/>'), f'density="{density}" viscosity="{viscosity}"')
        d = dyn.load_string(text).data()
        d.set_step_options("rk4", dt=1e-3)
        steps(d, 20000)
        assert -d.v[2] == pytest.approx(speed, rel=1e-9)


def test_a_ball_with_spin_is_lifted():
    """Magnus force: rho V w x v, half of that of added mass beside it; the moment of a sphere is drag alone."""
    r, m, rho, v, w = 0.1, 2.0, 40.0, 3.0, 5.0
    d = dyn.load_string(scene(free(ellipsoid((r, r, r), (0, 0, 0, 0, 1), f'mass="{m}"')), f'{STILL} density="{rho}"')).data()
    d.set_step_options("semi_implicit_euler", dt=1e-7)
    d.set_state(None, [v, 0, 0, 0, 0, w])
    d.step()
    d.forward_kinematics(d.q, d.v)
    velocity = d.frame_velocity("b", "local_world_aligned")
    force = rho * 4 / 3 * np.pi * r**3 * (1 - 0.5) * w * v
    assert velocity[1] / 1e-7 * m == pytest.approx(force, rel=1e-5)


def test_lift_magnus_force_and_added_mass_do_no_work():
    text = scene(free(ellipsoid((0.3, 0.1, 0.2), (0, 0, 0, 1, 1), 'mass="5"')), f'{STILL} density="20"')
    m = dyn.load_string(text)
    d = m.data()
    d.set_step_options("rk4", dt=1e-3)
    d.set_state(None, [1, -2, 0.5, 1, 2, 3])
    begin = sum(d.energy())
    steps(d, 1000)
    assert np.abs(d.v - [1, -2, 0.5, 1, 2, 3]).max() > 0.1
    assert sum(d.energy()) == pytest.approx(begin, rel=1e-9)


def test_the_ledger_closes():
    d = dyn.load_string(TREE).data()
    d.set_step_options("rk4", dt=1e-3, ledger=True)
    d.set_state(None, [1, -2, 0.5, 1, 2, 3, 1, -1])
    work = defect = 0
    for _ in range(200):
        d.step()
        work += d.ledger.fluid
        defect += d.ledger.energy_defect
    assert work < -1 and abs(defect) < 1e-5 * abs(work)  # of a quadrature of order 2


# ------------------------------------------------------------------------------------------------ models

def test_ellipsoids_are_an_effect_of_their_own():
    d = dyn.load_string(TREE).data()
    plan = d.plan()
    assert plan["fluid_ellipsoids"].present == 3 and plan["fluid_ellipsoids"].acting
    assert plan["fluid"].present == 1  # the box of the link without ellipsoids
    plan = dyn.load_string(TREE.replace('fluidshape="ellipsoid"', "")).data().plan()
    assert plan["fluid_ellipsoids"].present == 0 and plan["fluid"].present == 3
    still = dyn.load_string(scene(free(ellipsoid((0.1, 0.1, 0.2))))).data().plan()
    assert still["fluid_ellipsoids"].present == 0


def end(m):
    d = m.data()
    d.set_step_options(dt=1e-3)
    d.set_state(None, np.linspace(-1, 2, m.nv))
    steps(d, 100)
    return np.r_[d.q, d.v]


def test_copies_files_and_the_builder_have_them(tmp_path):
    m = dyn.load_string(TREE)
    m.save(tmp_path / "m.dynb"), m.save(tmp_path / "m.xml")
    np.testing.assert_array_equal(end(m), end(dyn.load(tmp_path / "m.dynb")))
    np.testing.assert_array_equal(end(m), end(dyn.Builder.from_model(m).finish()))
    np.testing.assert_allclose(end(m), end(dyn.load(tmp_path / "m.xml")), atol=1e-12)
    # without a medium they stay with their shapes
    still = dyn.Builder.from_model(dyn.load_string(TREE.replace('density="30" viscosity=".7"', "")))
    np.testing.assert_array_equal(end(still.set_medium(30, 0.7, (1, -0.5, 0.3)).finish()), end(m))
    b = dyn.Builder("b").set_medium(40, 0.1)
    b.add_joint("j", "free_flyer")
    b.add_body("l", "j", mass=2, inertia=np.diag([0.1, 0.2, 0.25]))
    b.add_shape("l", "box", (0.2, 0.6, 0.4), role="visual", fluid=(1, 0.2, 0.3, 0.4, 0.5))
    twin = scene('<body><freejoint/><inertial pos="0 0 0" mass="2" diaginertia=".1 .2 .25"/><geom type="box" size=".1 .3 .2" '
                 'contype="0" conaffinity="0" fluidshape="ellipsoid" fluidcoef="1 .2 .3 .4 .5"/></body>', 'density="40" viscosity=".1"')
    np.testing.assert_allclose(end(b.finish()), end(dyn.load_string(twin)), atol=1e-13)


def test_what_is_refused():
    b = dyn.Builder("b").set_medium(40, 0.1)
    b.add_joint("j", "free_flyer")
    b.add_body("l", "j", mass=2, inertia=np.eye(3))
    for more, word in (({"fluid": (1, 2, 3, 4, -1)}, "coefficient"), ({"fluid": (1, 2)}, "fluid"),
                       ({"fluid": True, "semiaxes": (1, 1, 0)}, "semiaxes"), ({"fluid": True, "type": "cone", "size": (1, 1)}, "type")):
        with pytest.raises(dyn.Error, match=word):
            b.add_shape("l", **{"type": "sphere", "size": (0.1,), **more})
    for text, word in (('fluidshape="cube"', "fluidshape"), ('fluidshape="ellipsoid" fluidcoef="1 -1"', "fluidcoef")):
        with pytest.raises(dyn.Error, match=word):
            dyn.load_string(scene(free(f'<geom size=".1" {text}/>'), 'density="1"'))
    d = dyn.load_string(scene(free(ellipsoid((0.1, 0.1, 0.2))), 'density="1"')).data()
    d.step()
    with pytest.raises(dyn.UnsupportedError, match="medium"):
        d.step_derivatives("analytic")
