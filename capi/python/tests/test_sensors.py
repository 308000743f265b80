"""Sensors of models: closed forms, copies, files, noise, and values beside MuJoCo where it is installed."""

import libdyn as dyn
import numpy as np
import pytest

SCENE = """<mujoco><option magnetic=".1 -.4 .2" density="0"/>
<default><geom density="700"/></default>
<worldbody><site name="fixed" pos=".1 .2 .3" euler="20 30 40"/>
<body name="base" pos="0 0 1"><freejoint/><geom name="trunk" type="box" size=".2 .1 .05"/><site name="imu" pos=".05 .02 .1" euler="10 -20 30"/>
 <body name="arm" pos=".2 0 0" euler="0 10 0"><joint name="hinge" axis="0 1 .3" range="-30 40"/><geom name="rod" type="capsule" size=".03 .2" pos="0 0 -.2"/>
  <site name="wrist" pos="0 .01 -.4" euler="0 40 10"/>
  <body name="tool" pos="0 0 -.4"><geom name="tip" size=".05" pos="0 .02 -.05"/><site name="welded" pos="0 0 .01" euler="5 6 7"/>
   <body name="ball" pos="0 0 -.1"><joint name="socket" type="ball"/><geom type="box" size=".04 .05 .06" pos=".02 0 0"/></body></body></body>
 <body name="slider" pos="-.2 0 0"><joint name="slide" type="slide" axis="1 0 1" range="-.1 .1"/><geom size=".06"/></body></body>
</worldbody>
<tendon><fixed name="sum" range="-.2 .3"><joint joint="hinge" coef="2"/><joint joint="slide" coef="-1"/></fixed>
<spatial name="cord"><site site="fixed"/><site site="wrist"/></spatial></tendon>
<actuator><position name="servo" joint="hinge" kp="30" kv="2" gear="3"/><motor name="motor" joint="slide" gear="-2"/>
<general name="pull" tendon="sum" gainprm="4" biastype="affine" biasprm="1 -2 -3"/></actuator>
<sensor>{sensors}</sensor></mujoco>"""


def frame_sensors():
    on = [("site", "wrist"), ("xbody", "arm"), ("geom", "rod"), ("xbody", "ball"), ("site", "fixed")]
    refs = [None, ("site", "imu"), ("xbody", "slider"), ("geom", "trunk")]
    out = []
    for kind in ("framepos", "framequat", "framexaxis", "frameyaxis", "framezaxis", "framelinvel", "frameangvel"):
        for t, n in on + ([("body", "arm")] if kind in ("framepos", "framelinvel", "frameangvel") else []):
            for ref in refs:
                more = f' reftype="{ref[0]}" refname="{ref[1]}"' if ref else ""
                out.append(f'<{kind} objtype="{t}" objname="{n}"{more}/>')
    for kind in ("framelinacc", "frameangacc"):
        out += [f'<{kind} objtype="{t}" objname="{n}"/>' for t, n in on + [("body", "arm")]]
    return out


KINEMATIC = frame_sensors() + [
    f"<{kind} {what}/>" for kind, what in [
        *((k, 'joint="hinge"') for k in ("jointpos", "jointvel", "jointactuatorfrc", "jointlimitpos", "jointlimitvel")),
        *((k, 'joint="slide"') for k in ("jointpos", "jointvel", "jointactuatorfrc", "jointlimitpos", "jointlimitvel")),
        ("ballquat", 'joint="socket"'), ("ballangvel", 'joint="socket"'),
        *((k, f'tendon="{t}"') for k in ("tendonpos", "tendonvel") for t in ("sum", "cord")),
        *((k, 'tendon="sum"') for k in ("tendonactuatorfrc", "tendonlimitpos", "tendonlimitvel")),
        *((k, f'actuator="{a}"') for k in ("actuatorpos", "actuatorvel", "actuatorfrc") for a in ("servo", "motor", "pull")),
        *((k, f'site="{s}"') for k in ("accelerometer", "velocimeter", "gyro", "magnetometer") for s in ("imu", "wrist", "welded")),
        *((k, f'site="{s}"') for k in ("force", "torque") for s in ("wrist", "welded", "imu")),
        *((k, f'body="{b}"') for k in ("subtreecom", "subtreelinvel", "subtreeangmom") for b in ("base", "arm", "tool", "slider")),
        ("clock", ""), ("e_potential", ""), ("e_kinetic", ""), ("gyro", 'site="imu" cutoff=".3"'),
    ]]  # fmt: skip


def read_both(theirs, m, random, spread=0.5):
    """Values of libdyn and of MuJoCo, by name, at a random state with the same accelerations, without contacts."""
    import mujoco

    data, d = mujoco.MjData(theirs), m.data()
    mujoco.mj_resetData(theirs, data)
    step = spread * random.standard_normal(theirs.nv)
    mujoco.mj_integratePos(theirs, data.qpos, step, 1)
    data.qvel[:] = random.standard_normal(theirs.nv)
    data.ctrl[:] = 0.3 * random.standard_normal(theirs.nu)
    theirs.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    theirs.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    mujoco.mj_forward(theirs, data)
    q, v, a = data.qpos.copy(), data.qvel.copy(), data.qacc.copy()
    R = np.empty(9)
    for j in range(theirs.njnt):
        kind, at, dof = theirs.jnt_type[j], theirs.jnt_qposadr[j], theirs.jnt_dofadr[j]
        if kind > 1:
            continue
        at += 3 if kind == 0 else 0
        if kind == 0:  # velocities in the body's axes
            mujoco.mju_quat2Mat(R, data.qpos[at : at + 4])
            B = R.reshape(3, 3).T
            w = data.qvel[dof + 3 : dof + 6]
            v[dof : dof + 3] = B @ v[dof : dof + 3]
            a[dof : dof + 3] = B @ a[dof : dof + 3] - np.cross(w, v[dof : dof + 3])
        q[at : at + 4] = data.qpos[[at + 1, at + 2, at + 3, at]]
    if m.nu == theirs.nu and m.nu:
        d.set_control(data.ctrl)
    d.sensors(q, v, a)
    ours, his = {}, {}
    for k in range(theirs.nsensor):
        name = theirs.sensor(k).name or f"sensor_{k}"
        at, n = theirs.sensor_adr[k], theirs.sensor_dim[k]
        his[name] = data.sensordata[at : at + n].copy()
        if name in m.sensor_names:
            ours[name] = d.sensor(name)
            if m.sensor(name).quantity in (dyn.Quantity.FRAMEQUAT, dyn.Quantity.BALLQUAT):
                his[name] = his[name][[1, 2, 3, 0]]
                his[name] *= np.sign(his[name] @ ours[name]) or 1
    return ours, his


def test_values_are_mujocos():
    mujoco = pytest.importorskip("mujoco")
    lines = [s.replace("/>", f' name="s{k}"/>') for k, s in enumerate(KINEMATIC)]
    text = SCENE.format(sensors="\n".join(lines))
    theirs, m = mujoco.MjModel.from_xml_string(text), dyn.load_string(text)
    assert m.nsensors == len(lines) == theirs.nsensor and m.nsensordata == theirs.nsensordata
    random = np.random.default_rng(7)
    for _ in range(5):
        ours, his = read_both(theirs, m, random)
        wrong = {lines[int(n[1:])]: (ours[n], his[n]) for n in ours
                 if not np.allclose(ours[n], his[n], rtol=1e-9, atol=1e-9) and "limit" not in lines[int(n[1:])]}
        assert not wrong, "\n".join(f"{k}: {v}" for k, v in wrong.items())


def pendulum():
    b = dyn.Builder("pendulum")
    b.add_joint("hinge", "revolute", axis=[0, 1, 0])
    b.add_body("rod", "hinge", mass=2.0, com=[0, 0, -0.5], inertia=np.diag([0.01, 0.02, 0.03]))
    X = np.eye(4)
    X[2, 3] = -1.0
    b.add_frame("tip", "rod", X)
    return b


def test_closed_forms_of_a_pendulum():
    m = (pendulum().add_sensor("angle", "hinge", quantity="jointpos").add_sensor("rate", "hinge", quantity="jointvel", cutoff=0.5)
         .add_sensor("imu", "tip", quantity="accelerometer").add_sensor("force", "rod", quantity="force")
         .add_sensor("moment", "rod", quantity="torque").add_sensor("spin", "rod", quantity="subtreeangmom")
         .add_sensor("clock", quantity="clock").finish())  # fmt: skip
    d = m.data()
    q, w, a, g = 0.3, 2.0, -1.5, 9.81
    values = d.sensors([q], [w], [a])
    assert values.shape == (m.nsensordata,) == (15,) and [s.order for s in m.sensors] == [0, 1, 2, 2, 2, 1, 0]
    s, c = np.sin(q), np.cos(q)
    assert d.sensor("angle") == [q] and d.sensor("rate") == [0.5] and d.sensor("clock") == [0]
    np.testing.assert_allclose(d.sensor("imu"), [-a - g * s, 0, w * w + g * c], atol=1e-12)
    np.testing.assert_allclose(d.sensor("force"), [2 * (-0.5 * a - g * s), 0, 2 * (0.5 * w * w + g * c)], atol=1e-12)
    np.testing.assert_allclose(d.sensor("moment"), [0, d.rnea([q], [w], [a])[0], 0], atol=1e-12)
    np.testing.assert_allclose(d.sensor("spin"), [0, 0.02 * w, 0], atol=1e-12)


def test_a_box_at_rest_on_a_pad_reads_its_weight():
    text = """<mujoco><option timestep=".002"/><worldbody><geom type="plane" size="2 2 .1"/>
    <body name="box" pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1" mass="3"/>
    <site name="pad" type="box" size=".11 .11 .02" pos="0 0 -.1"/><site name="half" type="box" size=".06 .11 .02" pos="-.06 0 -.1"/>
    <site name="off" size=".01" pos="0 0 .3"/></body></worldbody>
    <sensor><touch name="all" site="pad"/><touch name="half" site="half"/><touch name="none" site="off"/>
    <accelerometer name="imu" site="pad"/><force name="free" site="pad"/></sensor></mujoco>"""
    m = dyn.load_string(text)
    d = m.data()
    for _ in range(200):
        d.step()
    d.sensors(a=np.zeros(6))
    assert d.sensor("all") == pytest.approx([3 * 9.81], rel=1e-3)
    assert d.sensor("half") == pytest.approx([1.5 * 9.81], rel=1e-2) and d.sensor("none") == [0]
    np.testing.assert_allclose(d.sensor("imu"), [0, 0, 9.81], atol=1e-6)
    np.testing.assert_allclose(d.sensor("free"), 0, atol=0.03)


def test_copies_files_and_operations(tmp_path):
    lines = [s.replace("/>", f' name="s{k}"/>') for k, s in enumerate(KINEMATIC)]
    m = dyn.load_string(SCENE.format(sensors="\n".join(lines)))
    random = np.random.default_rng(3)
    q, v, a = m.integrate(m.neutral(), random.standard_normal(m.nv)), random.standard_normal(m.nv), random.standard_normal(m.nv)
    want = m.data().sensors(q, v, a)
    path = str(tmp_path / "scene.dynb")
    m.save(path)
    for other in (dyn.load(path), dyn.Builder.from_model(m).finish()):
        assert other.sensor_names == m.sensor_names
        np.testing.assert_array_equal(other.data().sensors(q, v, a), want)
    xml = str(tmp_path / "scene.xml")
    m.save(xml)
    back = dyn.load(xml)
    assert set(back.sensor_names) < set(m.sensor_names)
    d, theirs = m.data(), back.data()
    d.sensors(q, v, a), theirs.sensors(q, v, a)
    for name in back.sensor_names:
        if not m.sensor(name).quantity.name.startswith(("E_", "FORCE", "TORQUE")):
            np.testing.assert_allclose(theirs.sensor(name), d.sensor(name), atol=1e-9, err_msg=name)


def test_noise_is_a_function_of_seed_and_count():
    m = pendulum().add_sensor("angle", "hinge", quantity="jointpos", noise=0.1).add_sensor("rate", "hinge", quantity="jointvel").finish()
    d = m.data()
    d.sensors([0.2], [0.3])
    x = np.array([d.noisy_sensors(5, k) for k in range(20000)])
    assert np.all(x[:, 1] == 0.3) and abs(x[:, 0].mean() - 0.2) < 3e-3 and abs(x[:, 0].std() - 0.1) < 3e-3
    np.testing.assert_array_equal(d.noisy_sensors(5, 7), x[7])
    assert d.noisy_sensors(6, 7)[0] != x[7, 0]


def test_refusals():
    b = pendulum()
    with pytest.raises(dyn.UnknownNameError, match="sensor 's': there is no moving joint 'elbow'"):
        b.add_sensor("s", "elbow", quantity="jointpos")
    with pytest.raises(dyn.InvalidRobotError, match="joint 'hinge' is not spherical"):
        b.add_sensor("s", "hinge", quantity="ballquat")
    with pytest.raises(dyn.ArgumentError, match="its quantity has no reference frame"):
        b.add_sensor("s", "tip", reference="rod", quantity="gyro")
    with pytest.raises(dyn.ArgumentError, match="it is on nothing"):
        b.add_sensor("s", quantity="gyro")
    b.add_sensor("s", "tip", quantity="gyro")
    with pytest.raises(dyn.UnknownNameError, match="sensor 's' is there already"):
        b.add_sensor("s", "tip", quantity="gyro")


def test_what_is_left_out_is_named_once_a_kind():
    text = SCENE.format(sensors='<tactile geom="trunk" mesh="m"/><rangefinder camera="c"/><rangefinder camera="c"/><jointpos joint="hinge"/>')
    m = dyn.load_string(text)
    assert m.nsensors == 1
    messages = sorted(r.message for r in m.report if "<sensor>" in r.message)
    assert len(messages) == 2 and "<tactile>" in messages[0] and "<rangefinder>" in messages[1]


# ------------------------------------------------------------------------------------------------ equalities

LINKAGE = """<mujoco><option timestep=".001" cone="elliptic"/><worldbody>
<body name="a" pos="0 0 1"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" contype="0" conaffinity="0"/>
 <site name="s0" pos=".1 .02 0" euler="10 20 30"/>
 <body name="b" pos=".3 0 0"><joint axis="0 1 .2"/><geom type="capsule" fromto="0 0 0 .3 0 .1" size=".03" contype="0" conaffinity="0"/>
  <site name="s1" pos=".1 0 .02" euler="40 0 10"/>
  <body name="c" pos=".3 0 .1"><geom size=".05" contype="0" conaffinity="0"/><site name="s2" pos="0 .03 0"/></body></body></body>
<body name="w" pos=".6 0 1.3"><joint type="slide" axis="1 0 1"/><joint axis="0 0 1"/><geom size=".06" contype="0" conaffinity="0"/>
 <site name="s3" pos=".02 0 0"/></body></worldbody>
<equality>{}</equality>
<sensor>""" + "".join(f'<{k} name="{k}{i}" site="s{i}"/>' for i in range(4) for k in ("force", "torque")) + "</sensor></mujoco>"
EQUALITIES = {
    "a connect to the world": '<connect body1="c" anchor=".05 0 .02"/>',
    "a connect of bodies": '<connect body1="b" body2="w" anchor=".3 0 .1" solref=".05 .7"/>',
    "a weld to the world": '<weld body1="c"/>',
    "a soft weld": '<weld body1="c" body2="w" solref=".05 .7" torquescale="2"/>',
}


@pytest.mark.parametrize("name", EQUALITIES)
def test_forces_of_equalities_are_mujocos(name):
    """Where both have the same rows, at the state and with the acceleration of MuJoCo's step."""
    mujoco = pytest.importorskip("mujoco", reason="package mujoco is not installed")
    text = LINKAGE.format(EQUALITIES[name])
    theirs, m = mujoco.MjModel.from_xml_string(text), dyn.load_string(text)
    theirs.opt.tolerance, theirs.opt.iterations, theirs.opt.ls_iterations = 1e-14, 200, 100
    data, d, pulled = mujoco.MjData(theirs), m.data(), 0
    d.set_step_options("semi_implicit_euler", dt=1e-3, contact_model="as_file", tolerance=1e-12)
    for _ in range(100):
        q, v = data.qpos.copy(), data.qvel.copy()
        d.set_state(q, v)
        d.step()
        mujoco.mj_step(theirs, data)
        ours = d.sensors(q, v, (d.v - v) / 1e-3)
        np.testing.assert_allclose(ours, data.sensordata, rtol=0, atol=1e-6 * np.abs(data.sensordata).max())
        pulled = max(pulled, np.abs(data.efc_force).max())
    assert pulled > 1


@pytest.mark.parametrize("integrator", ["semi_implicit_euler", "rk4", "rk45"])
def test_a_weld_carries_what_hangs_on_it(integrator):
    """A body at rest hangs on a weld of the link that it carries: the site between them reads its weight."""
    text = """<mujoco><worldbody><body name="a" pos="0 0 1"><freejoint/><geom size=".1" mass="2" pos=".1 .2 .3"/>
    <body name="b" pos=".5 0 0"><geom size=".05" mass="1" pos="0 .1 0"/><site name="s" pos=".1 .2 0"/></body></body></worldbody>
    <equality><weld body1="b"/></equality><sensor><force name="f" site="s"/><torque name="t" site="s"/></sensor></mujoco>"""
    d = dyn.load_string(text).data()
    d.set_step_options(integrator, dt=1e-3)
    for _ in range(10):
        d.step()
    at_rest = np.zeros(6)
    np.testing.assert_allclose(d.v, at_rest, atol=1e-9)
    values = d.sensors(a=at_rest)
    np.testing.assert_allclose(values[:3], [0, 0, -2 * 9.81], atol=1e-6)
    np.testing.assert_allclose(values[3:], np.cross([-0.5, 0, 0.3], [0, 0, -2 * 9.81]), atol=1e-6)
