"""Sensors of shapes, contacts, rays and limits, with noise and delays: beside MuJoCo and in closed forms."""

import libdyn as dyn
import numpy as np
import pytest

HEAP = """<mujoco><option timestep=".001" cone="elliptic"/><default><geom density="900"/></default><worldbody>
<geom name="floor" type="plane" size="0 0 1"/><geom name="wall" type="box" size=".1 1 1" pos="1.5 0 1"/>
<body name="a" pos="0 0 .5"><freejoint/><geom name="box" type="box" size=".2 .15 .1"/><site name="eye" pos=".3 0 0" euler="0 90 0"/>
 <site name="up" pos="0 0 .2"/>
 <body name="b" pos=".2 0 .2"><joint name="hinge" axis="0 1 0" range="-10 20"/><geom name="ball" size=".1" pos=".1 0 0"/></body></body>
<body name="c" pos="0 1.1 .6" euler="10 20 30"><freejoint/><geom name="pill" type="capsule" size=".1 .2"/><geom name="knob" size=".12" pos="0 0 .3"/></body>
</worldbody>
<tendon><fixed name="t" limited="true" range="-.1 .1"><joint joint="hinge" coef="2"/></fixed></tendon>
<sensor>{sensors}</sensor></mujoco>"""

SIDES = [("geom1=\"box\"", "geom2=\"pill\""), ("geom1=\"ball\"", "body2=\"c\""), ("body1=\"c\"", "body2=\"a\""), ("geom1=\"knob\"", "geom2=\"wall\"")]


def both(lines):
    mujoco = pytest.importorskip("mujoco")
    text = HEAP.format(sensors="".join(line.replace("/>", f' name="s{k}"/>') for k, line in enumerate(lines)))
    theirs, m = mujoco.MjModel.from_xml_string(text), dyn.load_string(text)
    assert m.nsensordata == theirs.nsensordata and m.nsensors == theirs.nsensor
    return theirs, m


def at_random(theirs, random):
    """qpos, and the same configuration here."""
    import mujoco

    data = mujoco.MjData(theirs)
    mujoco.mj_integratePos(theirs, data.qpos, 0.3 * random.standard_normal(theirs.nv), 1)
    mujoco.mj_forward(theirs, data)
    q = data.qpos.copy()
    for k in (3, 11):
        q[k : k + 4] = np.roll(q[k : k + 4], -1)
    return data, q


def test_distances_are_mujocos():
    kinds = ("distance", "normal", "fromto")
    lines = [f'<{kind} {a} {b} cutoff="{cutoff}"/>' for kind in kinds for a, b in SIDES for cutoff in (0.5, 10)]
    theirs, m = both(lines)
    random, d, apart = np.random.default_rng(1), m.data(), 0
    for _ in range(20):
        data, q = at_random(theirs, random)
        d.sensors(q)
        dist = {k: data.sensordata[k] for k in range(8)}
        for k, line in enumerate(lines):
            if dist[k % 8] < 1e-3:  # penetrating pairs: methods differ
                continue
            at = theirs.sensor_adr[k]
            theirs_k = data.sensordata[at : at + theirs.sensor_dim[k]]
            np.testing.assert_allclose(d.sensor(f"s{k}"), theirs_k, rtol=1e-5, atol=1e-5, err_msg=line)
            if "distance" in line:
                apart += 1
                np.testing.assert_allclose(d.sensor(f"s{k}"), theirs_k, rtol=1e-6, atol=1e-7, err_msg=line)
    assert apart > 50


def test_rays_are_mujocos():
    words = "dist dir origin point normal depth"
    lines = ['<rangefinder site="eye"/>', f'<rangefinder site="eye" data="{words}"/>', '<rangefinder site="up" data="dist normal"/>']
    theirs, m = both(lines)
    random, d, hits = np.random.default_rng(2), m.data(), 0
    for _ in range(40):
        data, q = at_random(theirs, random)
        d.sensors(q)
        if d.sensor("s0")[0] == 0 or d.sensor("s2")[0] == 0:  # inside a shape MuJoCo's rays look outward
            continue
        np.testing.assert_allclose(d.field("sensor_data"), data.sensordata, rtol=1e-9, atol=1e-9)
        hits += data.sensordata[0] > 0
    assert hits > 10


def settled(m, steps=1500):
    d = m.data()
    for _ in range(steps):
        d.step()
    d.sensors()
    return d


def test_contacts_carry_the_weight():
    lines = ['<contact geom1="box" geom2="floor" data="found force pos normal" num="6"/>',
             '<contact body1="a" data="found force torque pos normal tangent" reduce="netforce"/>',
             '<contact subtree1="a" geom2="floor" data="dist" num="2" reduce="mindist"/>',
             '<contact geom1="floor" data="found force normal" num="3" reduce="maxforce"/>',
             '<contact geom1="wall" data="found"/>', '<contact data="found force" num="20"/>']
    theirs, m = both(lines)
    d = settled(m)
    g = 9.81
    mass = {n: theirs.body_subtreemass[theirs.body(n).id] for n in "ac"}
    rows = d.sensor("s0").reshape(6, 10)
    n = int(rows[0, 0])
    assert n == 4 and (rows[:n, 0] == n).all() and not rows[n:].any()
    np.testing.assert_allclose(rows[:n, 1].sum(), mass["a"] * g, rtol=2e-3)  # nothing else holds it
    np.testing.assert_allclose(rows[:n, 6], 0, atol=1e-3)
    np.testing.assert_allclose(rows[:n, 7:], [[0, 0, -1]] * n, atol=1e-9)  # from the box to the floor
    net = d.sensor("s1")
    np.testing.assert_allclose(net[1:4], [0, 0, -mass["a"] * g], rtol=2e-3, atol=0.1)  # on the floor, by the box
    np.testing.assert_allclose(net[10:], [1, 0, 0, 0, 1, 0])
    assert d.sensor("s2")[0] <= d.sensor("s2")[1] <= 0
    strong = d.sensor("s3").reshape(3, 7)
    assert (np.diff(np.linalg.norm(strong[:, 1:4], axis=1)) <= 1e-12).all()
    np.testing.assert_allclose(strong[:, 4:], [[0, 0, 1]] * 3, atol=1e-9)
    assert d.sensor("s4")[0] == 0
    every = d.sensor("s5").reshape(20, 4)
    np.testing.assert_allclose(every[:, 1].sum(), (mass["a"] + mass["c"]) * g, rtol=5e-3)


def test_forces_of_limits_balance_the_weight():
    theirs, m = both(['<jointlimitfrc joint="hinge"/>', '<tendonlimitfrc tendon="t"/>', '<jointlimitpos joint="hinge"/>'])
    d = settled(m)
    mass = theirs.body_mass[theirs.body("b").id]
    # the tendon is the tighter limit: 0.05 rad
    arm = 0.1 * np.cos(d.q[m.idx_q("hinge")] if hasattr(m, "idx_q") else 0.05)
    np.testing.assert_allclose(2 * d.sensor("s1"), mass * 9.81 * arm, rtol=2e-2)
    np.testing.assert_allclose(d.sensor("s0"), 0, atol=1e-9)


def test_force_sensors_know_what_is_applied():
    """A wrench on a link is none that its joint transmits."""
    text = """<mujoco><option gravity="0 0 -9.81"/><worldbody><body name="a"><joint axis="0 1 0"/><geom size=".1" mass="2" pos=".5 0 0"/>
    <site name="s"/><body name="b" pos="1 0 0"><joint axis="0 0 1"/><geom size=".1" mass="1"/></body></body></worldbody>
    <sensor><force name="f" site="s"/><torque name="t" site="s"/></sensor></mujoco>"""
    mujoco = pytest.importorskip("mujoco")
    theirs, m = mujoco.MjModel.from_xml_string(text), dyn.load_string(text)
    data, d = mujoco.MjData(theirs), m.data()
    for body, f in (("a", [1.0, 2, 3, 4, 5, 6]), ("b", [-3.0, 1, 2, 0.5, 0.2, 0.1])):
        data.xfrc_applied[theirs.body(body).id] = f
        d.apply_wrench(m.frame_id(body, "body"), f, point=theirs.body(body).ipos)
    data.qpos[:], data.qvel[:] = [0.3, -0.4], [1, 2]
    mujoco.mj_forward(theirs, data)
    d.sensors(data.qpos, data.qvel, data.qacc)
    np.testing.assert_allclose(d.field("sensor_data"), data.sensordata, rtol=1e-9, atol=1e-9)


def test_values_of_the_caller_have_their_places():
    theirs, m = both(['<user dim="3"/>', '<jointpos joint="hinge"/>'])
    d = m.data()
    d.sensors()
    assert d.sensor("s0").tolist() == [0, 0, 0] and m.sensor("s1").idx == 3


def test_delays_take_the_reading_of_that_time():
    _, m = both(['<jointpos joint="hinge" delay=".02" nsample="40"/>', '<jointvel joint="hinge"/>'])
    assert m.sensor("s0").delay == 0.02
    t = np.arange(10) * 0.01
    readings = np.c_[t * 10, t * 20]
    np.testing.assert_allclose(m.delayed_sensors(t, readings, 0.05), [0.3, 1.0])
    np.testing.assert_allclose(m.delayed_sensors(t, readings, 0.01), [0.0, 0.2])
    with pytest.raises(dyn.Error, match="ascend"):
        m.delayed_sensors([0, 2, 1], np.zeros((3, 2)), 0)


def test_rollouts_record_the_models_sensors():
    lines = ['<jointpos joint="hinge" delay=".004" nsample="40"/>', '<accelerometer site="up" noise=".1"/>',
             '<contact geom1="floor" data="found" delay=".01" nsample="40"/>', '<clock/>']
    _, m = both(lines)
    batch = m.batch(threads=2)
    plain = batch.rollout(n=3, steps=40, every=2, model_sensors=True)
    d, v = m.data(), None
    rows, moments = [], [0.0]
    d.sensors(a=np.zeros(m.nv))
    every = [np.array(d.field("sensor_data"))]
    for k in range(40):
        v = np.array(d.v)
        d.step()
        d.sensors(a=(d.v - v) / 1e-3)
        every.append(np.array(d.field("sensor_data")))
        moments.append((k + 1) * 1e-3)
        if k % 2:
            rows.append(every[-1])
    for s in m.sensors:
        place = slice(s.idx, s.idx + s.size)
        np.testing.assert_array_equal(plain.sensors[s.name][2], np.array(rows)[:, place])
    late = batch.rollout(n=1, steps=40, every=2, model_sensors=True, sensor_delays=True)
    for r in range(20):
        wanted = m.delayed_sensors(np.array(moments), np.array(every), moments[2 * r + 2])
        for s in m.sensors:
            np.testing.assert_array_equal(late.sensors[s.name][0, r], wanted[s.idx : s.idx + s.size])
    noisy = batch.rollout(n=2, steps=40, every=2, model_sensors=True, sensor_noise=7)
    off = noisy.sensors["s1"] - plain.sensors["s1"][:2]
    assert 0.05 < off.std() < 0.2 and (off[0] != off[1]).all()
    np.testing.assert_array_equal(noisy.sensors["s0"], plain.sensors["s0"][:2])
    again = batch.rollout(n=2, steps=40, every=2, model_sensors=True, sensor_noise=7)
    np.testing.assert_array_equal(again.sensors["s1"], noisy.sensors["s1"])


def test_batches_read_sensors():
    _, m = both(['<framepos objtype="site" objname="up"/>', '<rangefinder site="eye"/>'])
    q = np.array([m.random(k) for k in range(5)])
    values = m.batch(threads=2).sensors(q=q)
    d = m.data()
    for k in range(5):
        np.testing.assert_array_equal(values[k], d.sensors(q[k]))


def test_files_and_copies_keep_them(tmp_path):
    lines = ['<distance geom1="box" body2="c" cutoff="3"/>', '<rangefinder site="eye" data="dist normal"/>',
             '<contact subtree1="a" geom2="floor" data="found pos" num="3" reduce="maxforce"/>', '<user dim="2"/>',
             '<jointlimitfrc joint="hinge"/>', '<gyro site="up" delay=".01" nsample="20"/>']
    _, m = both(lines)
    m.save(tmp_path / "m.dynb"), m.save(tmp_path / "m.xml")
    kept = [(s.quantity, s.size, s.values, s.count, s.reduction, s.side, s.other_side, s.delay) for s in m.sensors]
    for copy in (dyn.load(tmp_path / "m.dynb"), dyn.load(tmp_path / "m.xml"), dyn.Builder("copy").attach(m).finish()):
        assert [(s.quantity, s.size, s.values, s.count, s.reduction, s.side, s.other_side, s.delay) for s in copy.sensors] == kept
        q = m.random(3)
        np.testing.assert_allclose(copy.data().sensors(q), m.data().sensors(q), rtol=1e-9, atol=1e-12)


def test_bad_input_is_refused():
    def builder():
        b = dyn.Builder("b")
        b.add_joint("j", "revolute", axis=(0, 0, 1)), b.add_body("link", "j", mass=1, inertia=np.eye(3))
        return b

    for message, target, values in [
        ("both sides must be LINK or SHAPE", "link", {"quantity": "distance", "side": "link", "other_side": "subtree", "reference": "link"}),
        ("there is no collision shape", "link", {"quantity": "distance", "side": "shape", "other_side": "link", "reference": "link"}),
        ("a side that is ANY", "link", {"quantity": "contact"}),
        ("the first side alone", "link", {"quantity": "contact", "side": "link", "other_side": "zone", "reference": "link"}),
        ("values is 1", "link", {"quantity": "rangefinder", "values": 1}),
        ("count is 0", "link", {"quantity": "contact", "side": "link", "count": 0}),
        ("cutoff, noise and delay", "link", {"quantity": "gyro", "delay": -1}),
    ]:
        with pytest.raises(dyn.Error, match=message):
            builder().add_sensor("s", target, **values)
