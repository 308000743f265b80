"""Rows of steps as an MJCF file states them (contact_model="as_file"): resting depths in closed form, and motions of MuJoCo."""

import libdyn as dyn
import numpy as np
import pytest
from command import answer
from conftest import MODELS

G = 9.81


def scene(body, option="", floor="", rest=""):
    return (f'<mujoco><option cone="elliptic" timestep=".002" {option}/><worldbody><geom name="floor" type="plane" size="5 5 1" {floor}/>'
            f'{body}</worldbody>{rest}</mujoco>')


def ball(attributes="", z=0.2):
    return f'<body pos="0 0 {z}"><freejoint/><geom name="ball" size=".1" {attributes}/></body>'


def box(attributes="", z=0.08, pose=""):
    return f'<body pos="0 0 {z}" {pose}><freejoint/><geom type="box" size=".1 .15 .05" {attributes}/></body>'


def arm(joint="", name="j"):
    return (f'<body pos="0 0 1"><joint name="{name}" axis="0 1 0" {joint}/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" '
            'contype="0" conaffinity="0"/></body>')


TWO = ('<body name="a" pos="0 0 1"><joint name="j" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" contype="0" '
       'conaffinity="0"/><site name="s1" pos=".1 0 .1"/><body name="c" pos=".3 0 0"><joint name="k" axis="0 1 0"/><geom type="capsule" '
       'fromto="0 0 0 .3 0 0" size=".03" contype="0" conaffinity="0"/><site name="s2" pos=".2 0 .1"/></body></body>')
SPHERES = ('<body name="a" pos="0 0 3"><freejoint/><geom size=".1"/></body><body name="b" pos=".3 0 3.1"><freejoint/><geom size=".08"/>'
           "</body>")


def as_file(text, **options):
    d = dyn.load_string(text).data()
    d.set_step_options(contact_model="as_file", tolerance=1e-10, **options)
    return d


# ------------------------------------------------------------------------------------------------ closed forms

def impedance(r, solimp):
    low, high, width, middle, power = solimp
    x = min(abs(r) / width, 1.0)
    y = x**power / middle ** (power - 1) if x <= middle else 1 - (1 - x) ** power / (1 - middle) ** (power - 1)
    return low + y * (high - low)


def stretch(acceleration, solref, solimp, share=1.0):
    """|r| where share * R f = k d r, the force f held by the row over its inverse inertia."""
    high = solimp[1]
    k = 1 / (high * solref[0] * solref[1]) ** 2 if solref[0] > 0 else -solref[0] / high**2
    low, top = 0.0, 10.0
    for _ in range(200):
        r = (low + top) / 2
        d = impedance(r, solimp)
        (low, top) = (r, top) if k * d * r < share * (1 - d) / d * acceleration else (low, r)
    return r


LAWS = {
    "default": ("", (0.02, 1), (0.9, 0.95, 0.001, 0.5, 2)),
    "soft": ('solref=".1 .7" solimp=".5 .9 .03 .4 3"', (0.1, 0.7), (0.5, 0.9, 0.03, 0.4, 3)),
    "stiffness": ('solref="-500 -30" solimp=".8 .8 .01"', (-500, -30), (0.8, 0.8, 0.01, 0.5, 2)),
}


@pytest.mark.parametrize("law", LAWS)
def test_a_ball_rests_at_the_depth_of_its_law(law):
    text, solref, solimp = LAWS[law]
    d = as_file(scene(ball(text + ' priority="1"', z=0.1)))
    d.advance(6.0)
    assert 0.1 - d.q[2] == pytest.approx(stretch(G, solref, solimp), rel=1e-9)


@pytest.mark.parametrize("law", LAWS)
def test_a_box_rests_on_four_points(law):
    text, solref, solimp = LAWS[law]
    d = as_file(scene(box(text + ' priority="1"', z=0.05)))
    d.advance(6.0)
    assert 0.05 - d.q[2] == pytest.approx(stretch(G / 4, solref, solimp), rel=1e-9)


def test_a_pyramid_gives_way_as_its_edges_do():
    """R of each of four edges is 2 mu^2 (1 + mu^2) of the row's; a normal row of four has a quarter of it."""
    mu = 0.7
    d = as_file(scene(ball(f'friction="{mu}" priority="1"', z=0.1)).replace('cone="elliptic"', ""))
    d.advance(2.0)
    _, solref, solimp = LAWS["default"]
    assert 0.1 - d.q[2] == pytest.approx(stretch(G, solref, solimp, mu**2 * (1 + mu**2) / 2), rel=1e-9)


@pytest.mark.parametrize("law", LAWS)
def test_a_limit_gives_way_to_a_constant_torque(law):
    text, solref, solimp = LAWS[law]
    text = text.replace("solref", "solreflimit").replace("solimp", "solimplimit")
    d = as_file(scene(arm(f'range="-20 10" damping="1" {text}'), option='gravity="0 0 0"'))
    inertia = d.model.data().crba([0.0])[0, 0]
    d.set_state([0.0], [0.0], tau=[3.0])
    d.advance(20.0)
    assert d.q[0] - np.radians(10) == pytest.approx(stretch(3.0 / inertia, solref, solimp), rel=1e-9)


@pytest.mark.parametrize("law", LAWS)
def test_a_connect_gives_way_to_a_weight(law):
    text, solref, solimp = LAWS[law]
    d = as_file(scene('<body name="b" pos="0 0 2"><freejoint/><geom size=".1"/></body>',
                      rest=f'<equality><connect body1="b" body2="world" anchor="0 0 0" {text}/></equality>'))
    d.advance(6.0)
    assert 2 - d.q[2] == pytest.approx(stretch(G, solref, solimp), rel=1e-9)


# ------------------------------------------------------------------------------------------------ beside MuJoCo

def pair(attributes, geom=""):
    return scene(ball(f'margin=".01" {geom}', z=0.15), rest=f'<contact><pair geom1="floor" geom2="ball" {attributes}/></contact>')


SOFT = 'solref=".1 .4" solimp=".6 .9 .1"'
SLIDES = [1.0, 0, 0, 0, 0, 0]
OVERRIDE = '><flag override="enable"/></option><worldbody>'
SCENES = {
    "a ball falls": (scene(ball()), None),
    "a soft ball falls": (scene(ball('solref=".1 .3" solimp=".5 .9 .05 .4 3"')), None),
    "stiffness and damping": (scene(ball('solref="-2000 -20" priority="1"')), None),
    "mixed laws and margins": (scene(ball('solref=".05 1.2" solmix="3" margin=".01"'),
                                     floor='solref=".03 .6" solimp=".7 .8 .01 .3 1.5" margin=".02"'), SLIDES),
    "a time constant below two steps": (scene(ball('solref=".001 1"')), None),
    "a box falls flat": (scene(box()), None),
    "a box sticks on a slope": (scene(box(z=0.0499), option='gravity="3 0 -9"'), None),
    "a box slides": (scene(box('friction=".2"', z=0.0499), option='gravity="3 0 -9"', floor='friction=".2"'), None),
    "torsion and rolling": (scene(ball('condim="6" friction="1 .01 .002"', z=0.0999), option='gravity="2 0 -9"'), None),
    "impratio": (scene(ball(z=0.0999), option='gravity="2 0 -9" impratio="10"'), None),
    "no friction": (scene(ball('condim="1"'), floor='condim="1"'), SLIDES),
    "a pair's own law": (pair('margin=".01" solref=".05 .3" solimp=".6 .8 .02" condim="4" friction=".5 .5 .01 .01 .01"'), SLIDES),
    "a pair's friction law": (pair('margin=".01" solref=".05 .3" solreffriction=".2 1"'), SLIDES),
    "a pair without the geom's margin": (pair(""), SLIDES),
    "a pyramid": (scene(ball('friction=".7"')).replace('cone="elliptic"', ""), None),
    "a pyramid with rolling": (scene(ball('condim="6" friction=".7 .02 .01"')).replace('cone="elliptic"', ""), None),
    "a limit": (scene(arm('range="-20 10"')), None),
    "a soft limit with a margin": (scene(arm('range="-20 10" solreflimit=".1 .5" solimplimit=".6 .9 .1" margin=".05"')), None),
    "a ball joint's limit": (scene('<body pos="0 0 1"><joint type="ball" range="0 30"/><geom type="capsule" fromto="0 0 0 .3 .1 0" '
                                   'size=".03" contype="0" conaffinity="0"/></body>'), None),
    "a connect": (scene(TWO, rest='<equality><connect body1="c" body2="world" anchor=".3 0 0"/></equality>'), None),
    "a soft connect": (scene(TWO, rest=f'<equality><connect body1="c" body2="world" anchor=".3 0 0" {SOFT}/></equality>'), None),
    "a connect of sites": (scene(TWO + '<site name="w" pos=".3 0 .8"/>',
                                 rest='<equality><connect site1="s2" site2="w"/></equality>'), None),
    "a weld": (scene(TWO, rest='<equality><weld body1="c" body2="world"/></equality>'), None),
    "a soft weld": (scene(TWO, rest=f'<equality><weld body1="c" body2="world" {SOFT} torquescale="2"/></equality>'), None),
    "an equality of joints": (scene(TWO, rest='<equality><joint joint1="j" joint2="k" polycoef="0 1 2 3" solref=".05 1"/></equality>'),
                              None),
    "a tendon's limit": (scene(TWO, rest='<tendon><spatial limited="true" range="0 .28" solreflimit=".05 .7"><site site="s1"/>'
                                         '<site site="s2"/></spatial></tendon>'), None),
    "an equality of tendons": (scene(TWO, rest='<tendon><spatial name="t"><site site="s1"/><site site="s2"/></spatial><fixed name="u">'
                                               '<joint joint="j" coef="1"/><joint joint="k" coef="-.5"/></fixed></tendon><equality>'
                                               '<tendon tendon1="t" tendon2="u" polycoef="0 .1" solref=".1 .7"/></equality>'), None),
    "dry friction": (scene(TWO.replace("<joint ", '<joint frictionloss=".3" ', 1)), None),
    "soft dry friction": (scene(TWO.replace("<joint ", '<joint frictionloss=".3" solreffriction=".2 1" solimpfriction=".5 .9" ')),
                          [2, -1]),
    "dry friction of a ball joint": (scene('<body pos="0 0 1"><joint type="ball" frictionloss=".05"/><geom type="capsule" '
                                           'fromto="0 0 0 .3 .1 0" size=".03" contype="0" conaffinity="0"/></body>'), [1, 2, 3]),
    "dry friction of a tendon": (scene(TWO, rest='<tendon><spatial frictionloss=".5" solreffriction=".1 .7"><site site="s1"/>'
                                                 '<site site="s2"/></spatial></tendon>'), [1, -2]),
    "overridden contacts": (scene(ball('solref=".1 .3" friction=".1"'), option='o_solref=".05 .8" o_solimp=".5 .9 .02" '
                                  'o_friction=".4 .4 .01 .001 .001"').replace("/><worldbody>", OVERRIDE, 1), SLIDES),
    "overridden pairs": (pair('condim="1"').replace('margin=".01"', "").replace(
        "/><worldbody>", ' o_solref="-900 -9"' + OVERRIDE, 1), SLIDES),
    "a box falls askew": (scene(box(z=0.15, pose='euler="20 30 10"')), [0.5, 0, 0, 3, 2, 1]),
    "a ball slides on rails": (scene('<body pos="0 0 .099"><joint type="slide" axis="1 0 0" damping=".3"/><joint type="slide" '
                                     'axis="0 0 1" stiffness="50" armature=".1"/><geom size=".1"/></body>'), [1, -0.3]),
    "spheres welded": (scene(SPHERES, rest=f'<equality><weld body1="a" body2="b" {SOFT} relpose="0 .1 -.3 1 .3 .2 .1"/></equality>'),
                       [0, 0, 0, 1, 2, 3, 0, 0, 0, -1, -2, 3]),
    "spheres welded at an anchor": (scene(SPHERES, rest='<equality><weld body1="a" body2="b" torquescale="3" anchor=".1 0 .2" '
                                                        f'relpose="0 .1 -.3 1 .3 .2 .1" {SOFT}/></equality>'), None),
    "spheres connected": (scene(SPHERES, rest=f'<equality><connect body1="a" body2="b" anchor=".2 .1 0" {SOFT}/></equality>'),
                          [0, 0, 0, 1, 2, 3, 0, 0, 0, -1, -2, -3]),
}


def turned(mm, q, v):
    """MuJoCo's q and v in the order and axes of this library."""
    q, v = q.copy(), v.copy()
    for j, kind in enumerate(mm.jnt_type):
        at, dof = mm.jnt_qposadr[j], mm.jnt_dofadr[j]
        if kind == 0:
            w, x, y, z = q[at + 3 : at + 7]
            R = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                          [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                          [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
            v[dof : dof + 3] = R.T @ v[dof : dof + 3]
        if kind < 2:
            first = at + (3 if kind == 0 else 0)
            q[first : first + 4] = np.roll(q[first : first + 4], -1)
    return q, v


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.filterwarnings("ignore::libdyn.LoadWarning")
def test_steps_are_mujocos(name):
    """Each of 300 steps from MuJoCo's state ends at its velocity."""
    mujoco = pytest.importorskip("mujoco", reason="package mujoco is not installed")
    text, v = SCENES[name]
    d = as_file(text)
    mm = mujoco.MjModel.from_xml_string(text)
    mm.opt.tolerance, mm.opt.iterations, mm.opt.ls_iterations = 1e-14, 200, 100
    md = mujoco.MjData(mm)
    if v is not None:
        md.qvel[:] = v
    rows = 0
    for _ in range(300):
        d.set_state(*turned(mm, md.qpos, md.qvel))
        d.step()
        mujoco.mj_step(mm, md)
        rows += md.nefc
        _, expected = turned(mm, md.qpos, md.qvel)
        np.testing.assert_allclose(d.v, expected, rtol=0, atol=1e-8)
        assert d.step_report.unsolved == 0
    assert rows > 0


FILES = [("gymnasium", f"envs/mujoco/assets/{x}.xml") for x in ("ant", "humanoid", "pusher", "walker2d")] + [
    ("dm_control", f"suite/{x}.xml") for x in ("ball_in_cup", "cheetah", "finger", "manipulator", "stacker", "walker")]


@pytest.mark.parametrize("package, name", FILES)
@pytest.mark.filterwarnings("ignore::libdyn.LoadWarning")
def test_motions_of_files_are_mujocos(package, name):
    """Half a second from the file's start with random controls."""
    mujoco = pytest.importorskip("mujoco", reason="package mujoco is not installed")
    folder = pytest.importorskip(package, reason=f"package {package} is not installed").__path__[0]
    spec = mujoco.MjSpec.from_file(f"{folder}/{name}")
    spec.option.cone, spec.option.integrator = mujoco.mjtCone.mjCONE_ELLIPTIC, mujoco.mjtIntegrator.mjINT_EULER
    spec.compile()
    text = spec.to_xml()
    mm = mujoco.MjModel.from_xml_string(text)
    mm.opt.solver, mm.opt.tolerance, mm.opt.iterations, mm.opt.ls_iterations = mujoco.mjtSolver.mjSOL_NEWTON, 1e-14, 200, 100
    md = mujoco.MjData(mm)
    d = as_file(text, integrator="semi_implicit_euler", dt=mm.opt.timestep)
    d.set_state(*turned(mm, md.qpos, md.qvel))
    random = np.random.RandomState(1)
    low, high = np.where(mm.actuator_ctrllimited[:, None], mm.actuator_ctrlrange, [-1.0, 1.0]).T
    rows = 0
    for k in range(int(0.5 / mm.opt.timestep)):
        if k % 50 == 0:
            u = random.uniform(low, high)
        md.ctrl[:] = u
        d.set_control(u)
        d.step()
        mujoco.mj_step(mm, md)
        rows += md.nefc
    q, _ = turned(mm, md.qpos, md.qvel)
    for j in np.flatnonzero(mm.jnt_type < 2):
        at = mm.jnt_qposadr[j] + (3 if mm.jnt_type[j] == 0 else 0)
        q[at : at + 4] *= np.sign(q[at : at + 4] @ d.q[at : at + 4])
    assert rows > 0
    np.testing.assert_allclose(d.q, q, rtol=0, atol=1e-7)


# ------------------------------------------------------------------------------------------------ the option

def test_the_default_is_rigid():
    d = dyn.load_string(scene(ball('solref=".1 1"', z=0.1))).data()
    assert d.step_options.contact_model == dyn.ContactModel.RIGID
    d.advance(1.0)
    assert abs(d.q[2] - 0.1) < 1e-6


def test_what_it_refuses():
    d = dyn.load_string(scene(ball())).data()
    for options, word in (({"integrator": "rk4"}, "SEMI_IMPLICIT_EULER"), ({"accuracy": 1e-6}, "accuracy")):
        with pytest.raises(dyn.UnsupportedError, match=word):
            d.set_step_options(contact_model="as_file", **options)
    with pytest.raises(dyn.ArgumentError, match="contact_model"):
        d.set_step_options(contact_model="soft")
    dyn.load_string("<mujoco/>").data().set_step_options(contact_model="as_file")  # nothing gives way
    urdf = dyn.load(MODELS / "robots/go2.urdf", base="fixed").data()
    with pytest.raises(dyn.UnsupportedError, match="MJCF"):
        urdf.set_step_options(contact_model="as_file")
    assert d.step_options.contact_model == 0


def test_the_report_says_once_that_rigid_steps_do_without():
    text = scene(ball('solref=".1 1"') + ball('solref=".1 1" solimp=".5 .9"', z=2).replace('name="ball"', ""))
    said = [x for x in dyn.load_string(text).report if "solref" in x.message]
    assert len(said) == 1 and "as_file" in said[0].message


def test_models_keep_it(tmp_path):
    """In a .dynb, and in a model that is made again."""
    text = scene(ball('solref=".1 .3"') + arm('range="-20 10" solreflimit=".1 .5"'),
                 rest='<equality><connect body1="ball_body" body2="world" anchor="0 0 .1" solref=".2 1"/></equality>').replace(
        '<body pos="0 0 0.2">', '<body name="ball_body" pos="0 0 0.2">')
    m = dyn.load_string(text)
    m.save(tmp_path / "m.dynb")
    ends = []
    for model in (m, dyn.load(tmp_path / "m.dynb"), dyn.Builder.from_model(m).finish()):
        d = model.data()
        d.set_step_options(dt=0.002, contact_model="as_file")
        d.advance(0.5)
        ends.append(np.concatenate([d.q, d.v]))
    np.testing.assert_array_equal(ends[0], ends[1])
    np.testing.assert_array_equal(ends[0], ends[2])


@pytest.mark.filterwarnings("ignore::libdyn.LoadWarning")
@pytest.mark.parametrize("name", ["mixed laws and margins", "a pair's friction law", "impratio", "a soft limit with a margin",
                                  "a soft weld", "a tendon's limit", "an equality of tendons", "soft dry friction",
                                  "dry friction of a tendon", "overridden contacts"])
def test_saved_files_keep_it(tmp_path, name):
    m = dyn.load_string(SCENES[name][0])
    m.save(tmp_path / "m.xml")
    ends = []
    for model in (m, dyn.load(tmp_path / "m.xml")):
        d = model.data()
        d.set_step_options(dt=0.002, contact_model="as_file", tolerance=1e-10)
        d.advance(0.3)
        ends.append(np.concatenate([d.q, d.v]))
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-9)


def test_rollouts_and_the_command_have_it(tmp_path):
    text = scene(ball('solref=".1 .7" priority="1"', z=0.1))
    m = dyn.load_string(text)
    out = m.batch(1).rollout(steps=500, every=500, dt=0.002, contact_model="as_file")
    d = m.data()
    d.set_step_options(dt=0.002, contact_model="as_file")
    d.advance(1.0)
    np.testing.assert_array_equal(out.q[0, -1], d.q)
    (tmp_path / "m.xml").write_text(text)
    said = answer("sim", tmp_path / "m.xml", "--duration", 1, "--contact-model", "as_file")
    np.testing.assert_allclose(said["q"], d.q, atol=1e-15)
