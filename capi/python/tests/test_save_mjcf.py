"""What is read of an MJCF file is in the file that is written, and MuJoCo opens what is written of URDF files."""

import collections
import importlib.util
import os
from pathlib import Path

import libdyn as dyn
import numpy as np
import pytest

FULL = """<mujoco><option timestep="0.004" integrator="implicitfast" gravity="1 2 -9" wind="1 0 0" density="1.2" viscosity="0.1">
    <flag frictionloss="disable" limit="disable"/></option>
  <worldbody><geom name="floor" type="plane" size="1 1 1" surfacevel="0.3 0 0"/>
    <body name="box" pos="0 0 1" quat="1 1 0 0" gravcomp="0.3"><freejoint name="free"/>
      <geom name="b" type="box" size=".1 .2 .3"/></body>
    <body name="arm" pos="2 0 1" euler="10 20 30">
      <joint name="turn" axis="0 1 0.5" ref="30" pos=".1 .2 .3" damping="0.2" stiffness="3" springref="12" armature="0.1"/>
      <joint name="swing" axis="1 0 0" ref="-40" pos="-.1 0 0" frictionloss="0.4" range="-90 90"/>
      <joint name="push" type="slide" axis="0 0 1" ref="0.2"/>
      <geom name="a" size=".1" pos=".3 0 0"/><site name="s" pos=".1 0 0"/>
      <body name="tip" pos="0 .5 0"><joint name="wrist" type="ball" pos="0 0 .1" damping="0.1"/>
        <geom name="t" type="capsule" size=".05 .1"/></body></body></worldbody>
  <contact><exclude body1="arm" body2="box"/>
    <pair geom1="t" geom2="floor" friction="0.5 0.5 0.01 0.001 0.001" condim="6"/></contact>
  <equality><joint joint1="turn" joint2="swing" polycoef="0.1 0.5 0.2 0 0.01"/>
    <connect body1="tip" body2="box" anchor="0 0 .1" active="false"/></equality>
  <actuator><motor name="m" joint="turn" gear="2" ctrlrange="-1 1"/>
    <general name="g" joint="swing" dyntype="filterexact" dynprm="0.1" gainprm="3"/>
    <position name="p" joint="push" kp="9" kv="2"/></actuator>
  <keyframe><key name="away" time="2.5" qpos="1 2 3 .5 .5 .5 .5 .25 .1 .2 1 0 0 0"
    qvel="1 2 3 4 5 6 7 8 9 .1 .2 .3" ctrl=".1 .2 .3" act=".4"/>
    <key name="drawn"/></keyframe></mujoco>"""


def again(model, path):
    lines = model.save(path)
    return dyn.load(path), [line.message for line in lines if line.level is dyn.ReportLevel.DROPPED]


def describe(model):
    """Everything that a step depends on, besides the bodies."""
    d = model.data()
    keys = []
    for name in model.configurations:
        d.reset(name)
        keys.append((name, [np.array(d.field(f)).tolist() for f in ("q", "v", "ctrl", "act", "time")]))
    options, shapes = model.step_options, model.shapes
    tested = [p for p in model.pairs if p.reason is dyn.PairReason.TESTED]
    return {
        "sizes": (model.nq, model.nv, model.nu, model.njoints),
        "joints": [j.name for j in model.joints[1:]],
        "actuators": [(name, model.actuator(name)._replace(joint=0)) for name in model.actuator_names],
        "steps": (options.dt, options.integrator, model.data().effects()),
        "gravity": model.data().field("world_gravity").tolist(),
        "pairs": collections.Counter(frozenset((shapes[p.shape_a].name, shapes[p.shape_b].name)) for p in tested),
        "materials": {s.name: s.material for p in tested for s in (shapes[p.shape_a], shapes[p.shape_b])},
        "keys": keys,
    }


def close(a, b, tolerance=1e-12):
    """Equal, numbers within the tolerance."""
    if isinstance(a, (list, tuple)):
        assert len(a) == len(b), (a, b)
        for x, y in zip(a, b):
            close(x, y, tolerance)
    elif isinstance(a, float):
        assert a == b or abs(a - b) < tolerance, (a, b)
    else:
        assert a == b


def compare(one, other, effects="armature"):
    for (what, a), b in zip(describe(one).items(), describe(other).values()):
        if what == "pairs":
            assert a == b
        elif what == "materials":
            assert a.keys() == b.keys()
            for name, material in a.items():
                close(material, b[name], 1e-15)  # a restitution is written as a damping
        else:
            close(a, b)
    x, y, rng = one.data(), other.data(), np.random.default_rng(2)
    for d in (x, y):
        d.set_effects(effects)
    for seed in range(3 if one.nv else 0):
        q, v, a = one.random(seed), rng.uniform(-1, 1, one.nv), rng.uniform(-1, 1, one.nv)
        M = x.crba(q).copy()
        np.testing.assert_allclose(y.crba(q), M, rtol=0, atol=1e-11 * max(1, abs(M).max()))
        tau = x.rnea(q, v, a).copy()
        np.testing.assert_allclose(y.rnea(q, v, a), tau, rtol=0, atol=1e-10 * max(1, abs(tau).max()))


def test_all_that_is_read_is_written(tmp_path):
    first = dyn.load_string(FULL)
    second, lost = again(first, tmp_path / "m.xml")
    assert lost == []
    compare(first, second, ("armature", "damping", "springs", "friction"))
    a, b = dyn.Simulation(first, "away"), dyn.Simulation(second, "away")
    a.step(20), b.step(20)
    np.testing.assert_allclose(b.q, a.q, rtol=0, atol=1e-10)
    third, _ = again(second, tmp_path / "n.xml")
    compare(second, third)


def test_mujoco_reads_what_is_written_as_what_was_read(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    (tmp_path / "one.xml").write_text(FULL)
    dyn.load_string(FULL).save(tmp_path / "two.xml")
    one, two = (mujoco.MjModel.from_xml_path(str(tmp_path / name)) for name in ("one.xml", "two.xml"))
    np.testing.assert_allclose(two.qpos0, one.qpos0, atol=1e-12)
    a, b = mujoco.MjData(one), mujoco.MjData(two)
    for m, d in ((one, a), (two, b)):
        mujoco.mj_resetDataKeyframe(m, d, 0)
        mujoco.mj_step(m, d, 20)
    np.testing.assert_allclose(b.qpos, a.qpos, atol=1e-8)
    assert b.time == a.time and two.opt.integrator == one.opt.integrator


@pytest.mark.parametrize("file", ["m.xml", "m.dynb"])
def test_friction_of_contacts_is_written(tmp_path, file):
    text = ('<mujoco><worldbody><geom type="plane" size="9 9 1" friction=".4" condim="1"/><body pos="0 0 .11"><freejoint/><geom '
            'type="box" size=".1 .1 .1" friction=".2" priority="%d" margin=".01"/></body></worldbody></mujoco>')
    for priority, friction in (3, 0.2), (0, 0.4), (-3, 0):
        second, lost = again(dyn.load_string(text % priority), tmp_path / file)
        d = second.data()
        d.set_state(second.configuration("qpos0"), [1, 0, 0, 0, 0, 0])
        d.advance(0.2)
        assert lost == [] and d.v[0] == pytest.approx(1 - friction * 9.81 * 0.2, abs=1e-6)
        assert d.q[2] == pytest.approx(0.11, abs=1e-6)


@pytest.mark.parametrize("file, says", [("m.xml", "moving bodies get 1e-14 kg and kg m2 at least, as MuJoCo refuses less"),
                                        ("m.urdf", "moving links have no mass")])  # yapf: disable
def test_moving_links_without_mass_are_named(tmp_path, file, says):
    b = dyn.Builder("arm")
    links = ((None, "shoulder", (0, 1, 0), "upper", 0.0), ("upper", "elbow", (0, 0, 1), "lower", 1.0))
    for parent, joint, axis, body, mass in links:
        b.add_joint(joint, "revolute", parent, axis=axis)
        b.add_body(body, joint, mass=mass, inertia=mass * np.eye(3))
    report = b.finish().save(tmp_path / file)
    assert [e.message for e in report if e.message.startswith("moving")] == [f"{says}: 'upper'"]


def package(name, inner=""):
    spec = importlib.util.find_spec(name)
    return Path(spec.origin).parent / inner if spec and spec.origin else None


def files_of(folder, pattern):
    return sorted(folder.rglob(pattern)) if folder and folder.is_dir() else []


SUITES = [
    f
    for f in files_of(package("gymnasium", "envs/mujoco/assets"), "*.xml") + files_of(package("dm_control", "suite"), "*.xml")
    if "<mujoco" in f.read_text() and "<worldbody" in f.read_text()
]


@pytest.mark.parametrize("file", SUITES, ids=[f"{f.parent.name}-{f.stem}" for f in SUITES])
@pytest.mark.filterwarnings("ignore::libdyn.LoadWarning")
def test_files_of_other_packages(tmp_path, file):
    first = dyn.load(file)
    second, _ = again(first, tmp_path / "m.xml")
    assert second.nv == first.nv
    compare(first, second, ("armature", "damping", "springs"))


def robots():
    cmeel = [p for p in (package("cmeel"), package("numpy")) if p]
    for p in cmeel:
        folder = p.parent / "cmeel.prefix" / "share" / "example-robot-data" / "robots"
        if folder.is_dir():
            return folder
    return None


URDFS = files_of(robots(), "*.urdf")
FEW = "double_pendulum finger_edu panda solo12 ur5_joint_limited_robot human icub_reduced romeo_laas_small".split()
if not os.environ.get("DYN_SLOW"):  # all of them take minutes
    URDFS = [f for f in URDFS if f.stem in FEW]


def loaded(file, base="fixed"):
    """The model of a file, or a skipped test if it is none."""
    try:
        return dyn.load(file, base, package_dirs=[robots().parent.parent, robots().parent])
    except dyn.Error as error:
        pytest.skip(str(error).splitlines()[0])


@pytest.mark.parametrize("file", URDFS, ids=[f.stem for f in URDFS])
@pytest.mark.filterwarnings("ignore::libdyn.LoadWarning")
def test_mujoco_opens_robots_of_urdf_files(tmp_path, file):
    """Whatever their meshes are: moving joints in the same order, followers as equalities, and M of the same bodies."""
    mujoco = pytest.importorskip("mujoco")
    first = loaded(file)
    second, lost = again(first, tmp_path / "m.xml")
    mm = mujoco.MjModel.from_xml_path(str(tmp_path / "m.xml"))
    assert (mm.nq, mm.nv) == (second.nq, second.nv)
    if first.nv != second.nv or any(j.mimic_leader >= 0 for j in first.joints) or not first.nv:
        return
    assert [mm.joint(j).name for j in range(mm.njnt)] == [j.name for j in second.joints[1:]]
    if first.nq != first.nv or first.nq != mm.nq or any("moments" in line or "inertias" in line for line in lost):
        return  # what MuJoCo refuses as an inertia is said to be lost
    q, md, theirs = first.random(1), mujoco.MjData(mm), np.empty((mm.nv, mm.nv))
    md.qpos[:] = q
    mujoco.mj_forward(mm, md)
    mujoco.mj_fullM(mm, md, theirs)
    ours = first.data().crba(q)
    np.testing.assert_allclose(theirs, ours, rtol=0, atol=1e-9 * abs(ours).max())
