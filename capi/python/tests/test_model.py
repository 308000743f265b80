"""Loading, and what a model says about itself."""

import gc
import math
import weakref

import numpy as np
import pytest
from conftest import ARM, MODELS

import libdyn as dyn


def test_sizes(go2):
    assert (go2.nq, go2.nv, go2.njoints) == (19, 18, 14)
    assert go2.name and go2.nframes > go2.njoints and go2.nbodies >= 13 and go2.size > 0
    assert "nq 19" in repr(go2) and go2.total_mass > 10


def test_load_accepts_paths_and_enums():
    path = MODELS / "robots" / "go2.urdf"
    assert dyn.load(str(path), dyn.Base.FIXED).nq == dyn.load(path, base="FIXED").nq == 12
    with pytest.raises(dyn.ArgumentError, match="FIXED, FLOATING"):
        dyn.load(path, base="flying")


def test_load_errors(tmp_path):
    with pytest.raises(dyn.FileError, match="nowhere.urdf") as caught:
        dyn.load(tmp_path / "nowhere.urdf", base="fixed")
    assert caught.value.status == dyn.Status.ERROR_FILE and caught.value.status_name == "DYN_ERROR_FILE"
    assert isinstance(caught.value, dyn.LoadError) and str(caught.value) == dyn.last_error()
    with pytest.raises(dyn.ParseError):
        dyn.load_string("<robot", base="fixed")
    with pytest.raises(dyn.BaseChoiceError):
        dyn.load(MODELS / "robots" / "go2.urdf")
    with pytest.raises(dyn.LoadError):
        dyn.load_string(ARM.replace('value="1"', 'value="-1"'), base="fixed")
    with pytest.raises(dyn.ArgumentError, match="zero character"):
        dyn.load("a\0b", base="fixed")
    with pytest.raises(dyn.ArgumentError, match="string"):
        dyn.load_string(b"<robot/>")


def test_strict_and_report():
    text = ARM.replace("</robot>", '<nonsense x="1"/></robot>')
    report = dyn.load_string(text, base="fixed").report
    assert all(isinstance(e.level, dyn.ReportLevel) and e.message for e in report)
    assert any("nonsense" in e.message and e.line > 0 for e in report)


def test_gravity_and_cos_sin():
    m = dyn.load_string(ARM, base="fixed", gravity=(1, 2, 3), cos_sin=True)
    assert m.gravity.tolist() == [1, 2, 3]
    assert (m.nq, m.nv) == (3, 2) and m.joint("elbow").type == dyn.JointType.REVOLUTE_UNBOUNDED
    with pytest.raises(dyn.SizeError, match=r"\(2,\).*\(3,\)"):
        dyn.load_string(ARM, gravity=(1, 2))


def test_package_dirs(tmp_path):
    mesh = '<visual><geometry><mesh filename="package://parts/a.stl"/></geometry></visual></link>'
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "a.stl").write_text("solid a\nendsolid a\n")
    text = ARM.replace('<link name="base"/>', f'<link name="base">{mesh}')
    m = dyn.load_string(text, base="fixed", package_dirs=[tmp_path])
    assert any(s.type == dyn.ShapeType.MESH and s.mesh.endswith("a.stl") and s.role == dyn.ShapeRole.VISUAL for s in m.shapes)
    assert dyn.load_string(text, base="fixed", package_dirs=str(tmp_path)).shapes[0].mesh == m.shapes[0].mesh


def test_names_and_ids(arm):
    assert [arm.joint_name(i) for i in range(arm.njoints)][1:] == ["shoulder", "elbow"]
    assert arm.joint_id("elbow") == 2
    for i in range(arm.nframes):
        assert arm.frame(i).name == arm.frame_name(i)
    assert arm.frame(arm.frame_id("tool")).type == dyn.FrameType.BODY
    assert arm.frame_id("tool", "body") == arm.frame_id("tool", dyn.FrameType.BODY) == arm.frame_id("tool")
    with pytest.raises(dyn.UnknownNameError, match="elbov"):
        arm.joint_id("elbov")
    with pytest.raises(LookupError):
        arm.frame("nothing")
    with pytest.raises(dyn.UnknownNameError):
        arm.frame_id("tool", "sensor")
    for bad in (-1, arm.njoints, 1 << 40):
        with pytest.raises(dyn.ArgumentError, match="ids go from 0"):
            arm.joint(bad)
    with pytest.raises(dyn.ArgumentError):
        arm.frame(1.5)
    with pytest.raises(dyn.ArgumentError, match="zero character"):
        arm.joint_id("a\0")


def test_joint_info(arm):
    elbow = arm.joint("elbow")
    assert elbow.id == 2
    assert (elbow.type, elbow.parent, elbow.idx_q, elbow.idx_v, elbow.nq, elbow.nv) == (dyn.JointType.CONTINUOUS, 1, 1, 1, 1, 1)
    assert elbow.mimic_leader == -1
    np.testing.assert_allclose(elbow.axis, (0, 1, 0), atol=1e-15)
    np.testing.assert_allclose(elbow.placement.rotation, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(elbow.placement.translation, (0, 0, -1))
    assert len(arm.joints) == 3


def test_mimic(gripper):
    followers = [j for j in gripper.joints if j.mimic_leader >= 0]
    assert gripper.nv == 1 and len(followers) == 6
    assert all(j.nq == j.nv == 0 for j in followers)
    thumb = gripper.joint("thumb_joint")
    assert (gripper.joint_name(thumb.mimic_leader), thumb.mimic_ratio, thumb.mimic_offset) == ("left_knuckle_joint", 0.5, 0.2)


def test_frame_info(arm):
    upper = arm.frame("upper")
    assert upper.mass == 1 and upper.joint == 1 and len(arm.frames) == arm.nframes
    np.testing.assert_allclose(upper.com, (0, 0, -0.5))
    np.testing.assert_allclose(upper.inertia, np.diag((0.1, 0.1, 0.01)), atol=1e-15)
    np.testing.assert_allclose(arm.frame("tool").placement.matrix[:3, 3], (0, 0, -1))


def test_shapes(arm):
    (shape,) = arm.shapes
    assert arm.nshapes == 1 and (shape.name, shape.type, shape.role) == ("tip", dyn.ShapeType.SPHERE, dyn.ShapeRole.COLLISION)
    assert shape.size[0] == 0.05 and arm.frame_name(shape.frame) == "lower" and shape.mesh == ""
    with pytest.raises(dyn.ArgumentError):
        arm.shape(1)


def test_limits(arm):
    assert arm.lower_limit.tolist() == [-2, -math.inf] and arm.upper_limit.tolist() == [2.5, math.inf]
    assert arm.velocity_limit.tolist() == [4, math.inf] and arm.effort_limit.tolist() == [30, math.inf]
    assert arm.damping.tolist() == [0.1, 0] and arm.friction.tolist() == [0.2, 0] and arm.armature.tolist() == [0, 0]
    assert arm.gravity.tolist() == [0, 0, -9.81] and arm.array("gravity").tolist() == [0, 0, -9.81]
    with pytest.raises(ValueError):
        arm.damping[0] = 1
    with pytest.raises(dyn.ArgumentError, match="LOWER_LIMIT"):
        arm.array("mass")


def test_views_keep_the_model_alive():
    m = dyn.load_string(ARM, base="fixed")
    owner, upper = weakref.ref(m._owner), m.upper_limit
    del m
    gc.collect()
    assert owner() is not None and upper[0] == 2.5
    del upper
    gc.collect()
    assert owner() is None


def test_configurations(go2):
    assert go2.configuration_names[0] == "neutral"
    np.testing.assert_array_equal(go2.configuration("neutral"), go2.neutral())
    assert set(go2.configurations) == set(go2.configuration_names)
    with pytest.raises(dyn.UnknownNameError):
        go2.configuration("nothing")


def test_permutation(arm):
    idx_q, idx_v = arm.q_permutation(["elbow", "shoulder"])
    assert idx_q.tolist() == [1, 0] and idx_v.tolist() == [1, 0]
    with pytest.raises(dyn.UnknownNameError):
        arm.q_permutation(["elbow", "elbow"])
    with pytest.raises(dyn.UnknownNameError):
        arm.q_permutation(["nothing"])
    with pytest.raises(dyn.ArgumentError):
        arm.q_permutation("elbow")


def test_integrate_and_difference(go2, state):
    q, v = state[0], state[1]
    q1 = go2.integrate(q, v)
    assert q1.shape == (19,) and abs(np.linalg.norm(q1[3:7]) - 1) < 1e-12
    np.testing.assert_allclose(go2.integrate(q, go2.difference(q, q1)), q1, atol=1e-12)
    np.testing.assert_allclose(go2.interpolate(q, q1, 0.0), q, atol=1e-12)
    assert go2.distance(q, q1) == pytest.approx(np.linalg.norm(go2.difference(q, q1)))
    with pytest.raises(dyn.SizeError, match=r"v has shape \(19,\), but must have shape \(18,\)"):
        go2.integrate(q, q)
    with pytest.raises(dyn.NonFiniteError):
        go2.integrate(q, v * np.nan)


def test_random(go2):
    np.testing.assert_array_equal(go2.random(3), go2.random(3))
    assert not np.array_equal(go2.random(), go2.random())
    low, high = np.full(19, -0.1), np.full(19, 0.1)
    assert np.abs(go2.random(5, low, high)[7:]).max() <= 0.1
    for bad in (-1, 1 << 64):
        with pytest.raises(dyn.ArgumentError):
            go2.random(bad)
    with pytest.raises(dyn.SizeError):
        go2.random(0, low[:3], high)


def test_normalize(go2):
    q = go2.neutral()
    q[3:7] *= 3
    assert not go2.is_normalized(q) and go2.is_normalized(go2.normalize(q)) and q[6] == 3
    q[3:7] = 0
    with pytest.raises(dyn.QuaternionError):
        go2.normalize(q)


def test_jacobians_of_integrate_and_difference(go2, state):
    q, v = state[0], 0.3 * state[1]
    dq, dv = go2.integrate_jacobians(q, v)
    d0, d1 = go2.difference_jacobians(q, go2.integrate(q, v))
    assert dq.shape == dv.shape == d0.shape == d1.shape == (18, 18)
    h, e = 1e-6, state[2]
    numeric = go2.difference(go2.integrate(q, v), go2.integrate(q, v + h * e)) / h
    np.testing.assert_allclose(dv @ e, numeric, atol=1e-4)
    numeric = go2.difference(go2.integrate(q, v), go2.integrate(go2.integrate(q, h * e), v)) / h
    np.testing.assert_allclose(dq @ e, numeric, atol=1e-4)
    np.testing.assert_allclose(d1 @ dv, np.eye(18), atol=1e-9)
    np.testing.assert_allclose(d1 @ dq + d0, np.zeros((18, 18)), atol=1e-9)
