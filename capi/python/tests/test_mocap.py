"""Mocap bodies: placed by data, they carry what is fixed to them, touch what moves and pull what is tied to them."""

from __future__ import annotations

import numpy as np
import pytest

import libdyn as dyn

PLATE = """<mujoco><option timestep=".002"/><worldbody>
 <body name="plate" mocap="true" pos="0 0 1"><geom name="plate" type="box" size=".5 .5 .05"/><site name="corner" pos=".5 .5 .05"/>
  <body name="rail" pos="0 0 .1"><site name="end" pos=".1 0 0"/></body></body>
 <body name="box" pos="0 0 1.15"><freejoint/><geom name="box" type="box" size=".1 .1 .1" mass="1"/></body>
</worldbody>
<keyframe><key name="low" qpos="0 0 .65 1 0 0 0" mpos="0 0 .5" mquat="0 0 0 2"/></keyframe></mujoco>"""

WELDED = """<mujoco><option gravity="0 0 0" timestep=".002"/><worldbody>
 <body name="hand" mocap="true" pos="0 0 1"/>
 <body name="tool" pos="0 0 1.2"><freejoint/><geom type="box" size=".1 .05 .02" mass="1"/></body>
</worldbody><equality><weld body1="hand" body2="tool"/></equality></mujoco>"""


def turn(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def position(d, frame):
    d.forward_kinematics(), d.frame_placements()
    return d.placements[9:, d.model.frame_id(frame)].copy()


def test_what_hangs_on_a_mocap_body_goes_along():
    m = dyn.load_string(PLATE)
    assert m.mocap_names == ["plate"] and m.mocap_id("plate") == 0
    assert not any("mocap" in r.message for r in m.report)
    d = m.data()
    np.testing.assert_array_equal(d.mocap[:, 0], [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1])
    np.testing.assert_allclose(position(d, "corner"), [0.5, 0.5, 1.05], atol=1e-15)
    d.set_mocap("plate", [1, 2, 3], turn(np.pi / 2))
    np.testing.assert_allclose(position(d, "corner"), [0.5, 2.5, 3.05], atol=1e-15)
    np.testing.assert_allclose(position(d, "end"), [1, 2.1, 3.1], atol=1e-15)
    d.set_mocap(0, [0, 0, 0])  # turned as before
    np.testing.assert_allclose(position(d, "corner"), [-0.5, 0.5, 0.05], atol=1e-15)
    d.reset("low")
    np.testing.assert_allclose(d.mocap[:, 0], [-1, 0, 0, 0, -1, 0, 0, 0, 1, 0, 0, 0.5], atol=1e-15)
    d.reset()
    np.testing.assert_array_equal(d.mocap[9:, 0], [0, 0, 1])


def test_a_box_rests_on_a_plate_that_is_lowered():
    m = dyn.load_string(PLATE)
    d = m.data()
    for k in range(500):
        d.set_mocap("plate", [0, 0, 1 - 0.2 * k / 500])
        d.step()
    assert abs(d.q[2] - (d.mocap[11, 0] + 0.15)) < 2e-3
    for _ in range(500):
        d.step()
    np.testing.assert_allclose(d.q[:3], [0, 0, d.mocap[11, 0] + 0.15], atol=1e-5)
    assert np.abs(d.v).max() < 1e-6


@pytest.mark.parametrize("shapes", [0, 40])
def test_a_plate_that_moves_wakes_what_sleeps_on_it(shapes):
    more = "".join(f'<body pos="{3 + k} 0 1"><freejoint/><geom type="sphere" size=".1"/></body>' for k in range(shapes))
    m = dyn.load_string(PLATE.replace("</worldbody>", more + '<geom type="plane" size="1 1 1"/></worldbody>'))
    d = m.data()
    d.set_effects(("as_stated", "sleeping"))
    for _ in range(2000):
        d.step()
    z = d.q[2]
    assert d.step_report.sleeping >= 1
    d.set_mocap("plate", [0, 0, 0.7])
    for _ in range(1000):
        d.step()
    assert z == pytest.approx(1.15, abs=1e-4) and d.q[2] == pytest.approx(0.85, abs=1e-4)


def test_a_welded_body_follows():
    m = dyn.load_string(WELDED)
    d = m.data()
    for k in range(500):
        d.set_mocap("hand", [0.2 * k / 500, 0, 1], turn(0.5 * k / 500))
        d.step()
    np.testing.assert_allclose(d.q[:3], [d.mocap[9, 0], 0, 1.2], atol=2e-3)
    for _ in range(500):
        d.step()
    np.testing.assert_allclose(d.q[:3], [d.mocap[9, 0], 0, 1.2], atol=1e-6)
    angle = 0.5 * 499 / 500
    np.testing.assert_allclose(d.q[3:], [0, 0, np.sin(angle / 2), np.cos(angle / 2)], atol=1e-6)


def test_saved_states_hold_mocap_bodies():
    m = dyn.load_string(PLATE)
    d, e = m.data(), m.data()
    d.set_mocap("plate", [0, 0.1, 0.9], turn(0.3))
    for _ in range(200):
        d.step()
    state = d.save_state()
    e.restore_state(state)
    np.testing.assert_array_equal(e.mocap, d.mocap)
    for _ in range(200):
        d.step(), e.step()
    np.testing.assert_array_equal(e.q, d.q)
    assert position(e, "corner") == pytest.approx(position(d, "corner"), abs=0)


def test_files_keep_mocap_bodies(tmp_path):
    m = dyn.load_string(PLATE)
    for name in ("a.dynb", "a.xml"):
        m.save(str(tmp_path / name))
        again = dyn.load(str(tmp_path / name))
        assert again.mocap_names == ["plate"]
        d = again.data()
        d.set_mocap("plate", [1, 2, 3], turn(np.pi / 2))
        np.testing.assert_allclose(position(d, "corner"), [0.5, 2.5, 3.05], atol=1e-12)
        np.testing.assert_allclose(position(d, "end"), [1, 2.1, 3.1], atol=1e-12)
        d.reset("low")
        np.testing.assert_allclose(d.mocap[:, 0], [-1, 0, 0, 0, -1, 0, 0, 0, 1, 0, 0, 0.5], atol=1e-12)


def test_refusals():
    m = dyn.load_string(PLATE)
    d = m.data()
    with pytest.raises(dyn.Error, match="rotation"):
        d.set_mocap("plate", [0, 0, 0], 2 * np.eye(3))
    with pytest.raises(dyn.Error, match="rotation"):
        d.set_mocap("plate", [0, 0, 0], np.diag([1, 1, -1]))
    with pytest.raises(dyn.Error):
        d.set_mocap("plate", [0, 0, np.nan])
    with pytest.raises(dyn.Error, match="nothing"):
        m.mocap_id("nothing")
    with pytest.raises(dyn.Error, match="box_joint|moves it"):
        dyn.Builder.from_model(m).set_mocap("box")


REACHING = """<mujoco><option timestep=".002"/><worldbody>
 <body name="target" mocap="true" pos="1.2 0 1"/>
 <body pos="0 0 1"><joint axis="0 0 1"/><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .5 0 0" size=".04" contype="0"/>
  <body pos=".5 0 0"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .4 0 0" size=".03" contype="0"/>
   <body name="tip" pos=".4 0 0"><joint axis="0 0 1"/><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" contype="0"/>
    <site name="end" pos=".3 0 0"/></body></body></body>
</worldbody><equality><connect body1="tip" body2="target" anchor=".3 0 0"/></equality></mujoco>"""


@pytest.mark.parametrize("distance", [1.21, 2, 5])
def test_an_arm_of_1_2_m_points_at_what_it_cannot_reach(distance):
    m = dyn.load_string(REACHING)
    rng = np.random.default_rng(5)
    for start in [np.zeros(5), *rng.uniform(-1, 1, (3, 5))]:
        d = m.data()
        d.q = start
        toward = rng.normal(size=3)
        toward /= np.linalg.norm(toward)
        d.set_mocap("target", [0, 0, 1] + distance * toward)
        for _ in range(3000):
            d.step()
        np.testing.assert_allclose(position(d, "end"), [0, 0, 1] + 1.2 * toward, atol=1e-3)
        assert np.abs(d.v).max() < 0.5  # gravity sags it within each step, and the correction straightens it


def test_a_weld_far_beyond_reach_does_not_end_a_simulation():
    m = dyn.load_string(REACHING.replace('connect body1="tip" body2="target" anchor=".3 0 0"', 'weld body1="tip" body2="target"'))
    rng = np.random.default_rng(7)
    for _ in range(10):
        d = m.data()
        d.set_mocap("target", rng.normal(size=3) * 2, turn(rng.uniform(0, 6)))
        for _ in range(500):
            d.step()
        assert np.abs(d.v).max() < 1


def placements(m, heights):
    """Of the plate, one for each height."""
    x = np.tile(np.r_[np.eye(3).ravel(), 0, 0, 0.0], (len(heights), m.nmocaps, 1))
    x[:, 0, 11] = heights
    return x


def test_rollouts_move_mocap_bodies():
    m = dyn.load_string(PLATE)
    heights = np.stack([1 - 0.002 * np.arange(50), np.full(50, 1.0)])
    x = np.stack([placements(m, row) for row in heights])
    out = m.batch(2).rollout(mocap=x, every=4, dt=0.002)
    for k in range(2):
        d = m.data()
        d.set_step_options(dt=0.002)
        for r in range(50):
            d.set_mocap("plate", x[k, r, 0, 9:], np.eye(3))
            for _ in range(4):
                d.step()
            np.testing.assert_array_equal(out.q[k, r], d.q)
    again = m.batch(1).rollout(n=2, mocap=x[1], every=4, dt=0.002)  # one row for all, on new data
    np.testing.assert_array_equal(again.q[0], out.q[1])
    np.testing.assert_array_equal(again.q[1], out.q[1])


def test_batches_place_mocap_bodies():
    m = dyn.load_string(PLATE)
    batch, q, heights = m.batch(2), np.tile(m.data().q, (40, 1)), np.linspace(0, 3, 40)
    corner = m.frame_id("corner")
    where = batch.frame_placement(corner, q, mocap=placements(m, heights)).translation
    np.testing.assert_allclose(where, np.c_[np.full((40, 2), 0.5), heights + 0.05], atol=1e-15)
    first = batch.frame_placement(corner, q).translation  # the initial one again
    np.testing.assert_allclose(first, np.tile([0.5, 0.5, 1.05], (40, 1)), atol=1e-15)


def test_placements_that_batches_and_rollouts_refuse():
    m = dyn.load_string(PLATE)
    bad = placements(m, [1, 1])
    bad[1, 0, 0] = 2
    with pytest.raises(dyn.ArgumentError, match="plate.*rotation"):
        m.batch(1).frame_placement(m.frame_id("corner"), np.tile(m.data().q, (2, 1)), mocap=bad)
    with pytest.raises(dyn.ArgumentError, match="plate.*rotation"):
        m.batch(1).rollout(mocap=bad, every=1, dt=0.002)
    for shape in ((2, 1, 11), (2, 2, 12), (12,)):
        with pytest.raises(dyn.SizeError, match="mocap"):
            m.batch(1).rollout(mocap=np.zeros(shape), steps=2)
        with pytest.raises(dyn.SizeError, match="mocap"):
            m.batch(1).frame_placement(m.frame_id("corner"), np.tile(m.data().q, (2, 1)), mocap=np.zeros(shape))
