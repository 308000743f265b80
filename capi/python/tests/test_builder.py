"""dyn.Builder: the same robots as from a file, and its errors."""

import math

import libdyn as dyn
import numpy as np
import pytest
from conftest import ARM
from libdyn.joint_spec import ARRAYS, SCALARS, VALUES, joint_spec, sizes


def build_arm():
    inertia = np.diag((0.1, 0.1, 0.01))
    b = dyn.Builder("arm")
    b.add_joint("shoulder", "revolute", axis=(0, 1, 0), lower=-2, upper=[2.5], velocity=4, effort=30, damping=0.1, friction=0.2)
    b.add_body("upper", "shoulder", 1.0, (0, 0, -0.5), inertia)
    b.add_joint("elbow", dyn.JointType.CONTINUOUS, "shoulder", (0, 0, -1), axis=(0, 1, 0))
    b.add_body("lower", "elbow", 1.0, (0, 0, -0.5), inertia)
    return b.add_frame("tool", "elbow", (0, 0, -1))


def test_same_as_from_a_file():
    built, loaded = build_arm().finish(), dyn.load_string(ARM, base="fixed")
    assert (built.nq, built.nv, built.njoints, built.nbodies) == (2, 2, 3, 2) and built.name == "arm"
    q, v, a = np.array([0.3, -0.4]), np.array([1.0, 2.0]), np.array([-1.0, 0.5])
    np.testing.assert_allclose(built.data().rnea(q, v, a), loaded.data().rnea(q, v, a), rtol=1e-13)
    for name in ("lower_limit", "upper_limit", "velocity_limit", "effort_limit", "damping", "friction"):
        np.testing.assert_array_equal(getattr(built, name), getattr(loaded, name))
    d = built.data()
    d.forward_kinematics([0, 0])
    np.testing.assert_allclose(d.frame_placement("tool").translation, (0, 0, -2), atol=1e-15)
    assert built.frame("tool").type == dyn.FrameType.OP_FRAME


def test_finish_again():
    b = build_arm()
    assert b.finish().nq == 2
    b.add_joint("wrist", "revolute", "elbow", (0, 0, -1)).add_body("hand", "wrist", 0.1, inertia=0.01 * np.eye(3))
    assert b.finish().nq == 3


@pytest.mark.parametrize("kind", [t for t in dyn.JointType if t not in (dyn.JointType.FIXED, dyn.JointType.COMPOSITE)])
def test_every_joint(kind):
    b = dyn.Builder()
    b.add_joint("j", kind, axis=(0, 0, 1), axis2=(1, 0, 0), pitch=0.1).add_body("b", "j", 1, (0.1, 0.2, 0.3), np.eye(3))
    m = b.finish()
    joint = m.joint("j")
    assert joint.type == kind and {"nq": joint.nq, "nv": joint.nv} == sizes(joint_spec("j", kind)[0]) == {"nq": m.nq, "nv": m.nv}
    d, q = m.data(), m.random(1)
    a = d.aba(q, np.ones(m.nv), np.ones(m.nv))
    np.testing.assert_allclose(d.rnea(q, np.ones(m.nv), a), np.ones(m.nv), atol=1e-9)


def test_fixed_joint_is_a_frame():
    b = build_arm().add_joint("mount", "fixed", "elbow", (0, 0, -1)).add_body("camera", "mount", 0.2)
    m = b.finish()
    assert m.njoints == 3 and m.frame("mount").type == dyn.FrameType.FIXED_JOINT and m.total_mass == pytest.approx(2.2)


def test_composite():
    parts = [{"type": "revolute", "axis": (1, 0, 0)}, {"type": "prismatic", "placement": (0, 0, 1)}, {"type": "spherical"}]
    b = dyn.Builder().add_joint("c", "composite", parts=parts, lower=[-1] * 6,
                                upper=[1] * 6).add_body("b", "c", 1, inertia=np.eye(3))
    m = b.finish()
    assert (m.nq, m.nv) == (6, 5) and m.joint("c").type == dyn.JointType.COMPOSITE
    for bad, words in (({"axis": (1, 0, 0)}, "no type"), ({"type": "revolute", "name": "x"}, "unknown")):
        with pytest.raises(dyn.ArgumentError, match=words):
            dyn.Builder().add_joint("c", "composite", parts=[bad])


def test_mimic_and_rotor():
    b = dyn.Builder().add_joint("a", "revolute", rotor_inertia=0.01, gear_ratio=10,
                                armature=0.5).add_body("l", "a", 1, inertia=np.eye(3))
    b.add_joint("f", "prismatic", "a", mimic="a", mimic_ratio=2, mimic_offset=0.1).add_body("k", "f", 1, inertia=np.eye(3))
    m = b.finish()
    assert (m.nq, m.nv, m.njoints) == (1, 1, 3)
    assert m.joint("f").mimic_ratio == 2 and m.joint("f").mimic_offset == 0.1
    assert m.armature[0] == pytest.approx(1.5)


@pytest.mark.parametrize("form", ["translation", "pair", "matrix", "twelve", "placement"])
def test_placements(form):
    rotation, p = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), np.array([1.0, 2, 3])
    if form == "translation":
        rotation, given = np.eye(3), p
    elif form == "matrix":
        given = dyn.Placement(rotation, p).matrix
    elif form == "twelve":
        given = np.concatenate([rotation.T.ravel(), p])
    else:
        given = (rotation, p) if form == "pair" else dyn.Placement(rotation, p)
    d = build_arm().add_frame("x", None, given).finish().data()
    d.forward_kinematics([0, 0])
    found = d.frame_placement("x")
    np.testing.assert_allclose(found.rotation, rotation, atol=1e-15)
    np.testing.assert_allclose(found.translation, p)


def test_configuration_and_gravity():
    b = build_arm().set_gravity((0, 0, -1.62)).add_configuration("bent", [0.5, -0.5])
    m = b.finish()
    assert m.configuration_names == ("neutral", "bent") and m.configuration("bent").tolist() == [0.5, -0.5]
    assert m.gravity[2] == -1.62


def test_errors():
    b = build_arm()
    with pytest.raises(dyn.UnknownNameError):
        b.add_joint("elbow", "revolute").finish()
    b = build_arm()
    with pytest.raises(dyn.Error):
        b.add_joint("x", "revolute", "nowhere").finish()
    with pytest.raises(dyn.ArgumentError, match="REVOLUTE"):
        b.add_joint("x", "hinge")
    with pytest.raises(dyn.SizeError, match=r"lower has shape \(2,\), but must have shape \(1,\)"):
        b.add_joint("x", "revolute", lower=[1, 2])
    with pytest.raises(dyn.SizeError, match=r"inertia has shape \(2, 2\), but must have shape \(3, 3\)"):
        b.add_body("x", "elbow", 1.0, inertia=np.eye(2))
    with pytest.raises(dyn.Error):
        b.add_body("x", "elbow", -1.0).finish()
    with pytest.raises(dyn.Error):
        build_arm().add_body("x", "elbow", math.nan).finish()
    with pytest.raises(dyn.SizeError, match="placement"):
        build_arm().add_frame("x", "elbow", (1, 2))
    with pytest.raises(dyn.ArgumentError, match="last row"):
        build_arm().add_frame("x", "elbow", np.ones((4, 4)))
    with pytest.raises(dyn.Error):
        build_arm().add_configuration("short", [1]).finish()
    assert "arm" in repr(b)


def test_shapes_have_colours():
    b = dyn.Builder("c").add_joint("f", "free_flyer").add_body("a", "f", 1, inertia=np.eye(3))
    b.add_shape("a", "box", (1, 1, 1), rgba=(1, 0.2, 0, 0.4)).add_shape("a", "sphere", (1,))
    m = b.finish()
    assert m.shapes[0].rgba == pytest.approx((1, 0.2, 0, 0.4), abs=1e-12) and m.shapes[1].rgba is None
    assert dyn.Builder.from_model(m).finish().shapes[0].rgba == m.shapes[0].rgba
    for bad in ((1, 0, 0), (1, 0, 0, 2), (1, 0, 0, float("nan"))):
        with pytest.raises(dyn.Error, match="rgba"):
            b.add_shape("a", "sphere", (1,), rgba=bad)
    assert b.finish().nshapes == 2


def test_values_of_joints_are_those_of_the_library():
    assert {"lower": "nq", "velocity": "nv", "spring_reference": "nq", "friction": "nv"}.items() <= ARRAYS.items()
    assert set(ARRAYS.values()) == {"nq", "nv"} and "gear_ratio" in SCALARS
    for name in VALUES:
        assert name in dyn.Builder.add_joint.__doc__
    with pytest.raises(TypeError, match="there is no value 'dampin': choose from lower"):
        dyn.Builder().add_joint("j", "revolute", dampin=1)


def test_numbers_are_listed_and_set(go2):
    b = dyn.Builder.from_model(go2)
    parameters = b.parameters()
    for p in parameters:
        b.set_parameter(p, p.values)
    assert b.finish().image() == go2.image()
    thigh = next(p for p in parameters if (p.name, p.quantity) == ("FL_thigh_joint", "damping"))
    assert thigh.object == "joint" and thigh.group is dyn.ParameterGroup.DAMPING
    assert b.set_parameter(thigh.index, 2.5).finish().damping[go2.joint("FL_thigh_joint").idx_v] == 2.5
    with pytest.raises(dyn.Error, match="FL_thigh_joint.*damping is -1"):
        b.set_parameter(thigh, -1)
    with pytest.raises(dyn.SizeError, match="has 1 numbers"):
        b.set_parameter(thigh, [1, 2])
