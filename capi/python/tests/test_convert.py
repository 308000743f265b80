"""States in other libraries' orders and frames, against the libraries that are installed: the same state has the same poses,
velocities, accelerations, kinetic energy and generalised forces."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from conftest import MODELS

import libdyn as dyn

TOLERANCE = 1e-12  # of numbers of size 1 to 100, relative to their largest


def _joint(name, kind, parent, child, xyz="0.1 -0.2 0.3", axis="0 0.6 0.8", more=""):
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="{xyz}" rpy="0.3 -0.2 '
        f'0.5"/><axis xyz="{axis}"/><limit lower="-3" upper="3" effort="1" velocity="1"/>{more}</joint>'
    )


def _link(name, k):
    return (
        f'<link name="{name}"><inertial><origin xyz="0.01 {0.02 * k} -0.03" rpy="0.1 0.2 {0.3 * k}"/><mass value="{1 + 0.3 * k}"/>'
        f'<inertia ixx="0.02" iyy="0.03" izz="{0.025 + 0.001 * k}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


# Siblings in another order than the alphabet's, continuous joints, a follower that comes after its leader.
BEAST = (
    '<robot name="beast">'
    + "".join(_link(name, k) for k, name in enumerate(["trunk", "wheel", "hip", "shin", "slide", "twin", "hub"]))
    + _joint("zeta", "continuous", "trunk", "wheel", axis="1 0 0")
    + _joint("b_hip", "revolute", "trunk", "hip")
    + _joint("knee", "revolute", "hip", "shin", axis="0 1 0")
    + _joint("m_slide", "prismatic", "shin", "slide")
    + _joint("twin", "revolute", "trunk", "twin", more='<mimic joint="knee" multiplier="-0.7" offset="0.2"/>')
    + _joint("alpha", "continuous", "twin", "hub", axis="0 0 1")
    + "</robot>"
)
ROBOTS = {
    "beast": BEAST,
    "go2": (MODELS / "robots" / "go2.urdf").read_text(),
    "gripper": (MODELS / "robots" / "gripper.urdf").read_text(),
    "panda": (MODELS / "robots" / "panda.urdf").read_text(),
}
ROBOTS = {name: ET.tostring(ET.fromstring(text), encoding="unicode") for name, text in ROBOTS.items()}


def plain(text):
    """Without geometry and dynamics, which peers treat in ways of their own."""
    root = ET.fromstring(text)
    for parent, tags in (("link", ("visual", "collision")), ("joint", ("dynamics",))):
        for element in root.findall(parent):
            for tag in tags:
                for child in element.findall(tag):
                    element.remove(child)
    return root


CASES = [("beast", True), ("beast", False), ("go2", True), ("panda", False), ("gripper", False), ("gripper", True)]


def robot(name, floating, cos_sin=False):
    return dyn.load_string(ROBOTS[name], base="floating" if floating else "fixed", cos_sin=cos_sin)


def state(m, seed):
    random = np.random.default_rng(seed)
    return m.random(seed), *(random.standard_normal(m.nv) for _ in range(3))


def near(x, y, what):
    x, y = np.asarray(x, float), np.asarray(y, float)
    assert np.max(np.abs(x - y), initial=0) <= TOLERANCE * max(1, np.max(np.abs(y), initial=0)), what


def links(m):
    return [f.name for f in m.frames if f.type == dyn.FrameType.BODY]


def compare(m, layout, peer, names, seed):
    """peer(q, v, a): (kinetic energy, tau, {link: (R, p, velocity and classical acceleration, both LOCAL_WORLD_ALIGNED)})."""
    q, v, a, tau = state(m, seed)
    d = m.data()
    there = m.to_peer(layout, q, v, a, tau)
    kinetic, forces, motions = peer(there.q, there.v, there.a)
    M = d.crba(q)
    near(kinetic, v @ M @ v / 2, "kinetic energy")
    near(m.from_peer(layout, there.q, there.v, there.a, forces).tau, d.rnea(q, v, a), "forces")
    near(there.tau @ there.v, tau @ v, "power")
    d.forward_kinematics(q, v, a)
    for name in names:
        R, p, velocity, acceleration = motions[name]
        X = d.frame_placement(m.frame_id(name, "body"))
        near(R, X.rotation, name), near(p, X.translation, name)
        near(velocity, d.frame_velocity(m.frame_id(name, "body"), "local_world_aligned"), name)
        if acceleration is not None:
            near(acceleration, d.frame_classical_acceleration(m.frame_id(name, "body"), "local_world_aligned"), name)
    back = m.from_peer(layout, *there)
    assert m.distance(q, back.q) < 1e-12
    for x, y in zip((v, a, tau), back[1:]):
        near(y, x, "back")


# --------------------------------------------------------------------------------------------------- Pinocchio


def pinocchio_peer(pin, model):
    data = model.createData()

    def peer(q, v, a):
        tau = pin.rnea(model, data, q, v, a)
        pin.forwardKinematics(model, data, q, v, a)
        pin.updateFramePlacements(model, data)
        kinetic = pin.computeKineticEnergy(model, data, q, v)
        motions = {}
        for k, frame in enumerate(model.frames):
            if frame.type == pin.FrameType.BODY:
                args = model, data, k, pin.LOCAL_WORLD_ALIGNED
                X = data.oMf[k]
                velocity, acceleration = pin.getFrameVelocity(*args), pin.getFrameClassicalAcceleration(*args)
                motions[frame.name] = X.rotation, X.translation, velocity.vector, acceleration.vector
        return kinetic, tau, motions

    return peer


@pytest.mark.parametrize("cos_sin", [False, True])
@pytest.mark.parametrize("name, floating", CASES)
def test_pinocchio(name, floating, cos_sin):
    pin = pytest.importorskip("pinocchio")
    m = robot(name, floating, cos_sin)
    model = pin.buildModelFromXML(ROBOTS[name], *([pin.JointModelFreeFlyer()] if floating else []))
    layout = dyn.StateLayout.of_pinocchio(model)
    assert layout.sizes(m) == (model.nq, model.nv)
    for seed in range(5):
        compare(m, layout, pinocchio_peer(pin, model), links(m), seed)


def test_pinocchio_without_followers():
    pin = pytest.importorskip("pinocchio")
    m = robot("beast", True)
    model = pin.buildModelFromXML(ROBOTS["beast"], pin.JointModelFreeFlyer(), mimic=True)
    layout = dyn.StateLayout.of_pinocchio(model)
    assert "twin" not in layout.joints and layout.sizes(m) == (model.nq, model.nv)
    q, v, a, tau = state(m, 1)
    there, data = m.to_peer(layout, q, v, a, tau), model.createData()
    near(m.from_peer(layout, there.q, there.v, tau=pin.rnea(model, data, there.q, there.v, there.a)).tau, m.data().rnea(q, v, a),
         "forces")


def test_pinocchio_manifolds():
    pin = pytest.importorskip("pinocchio")
    m, model = dyn.Builder("manifolds").set_gravity((0, 0, -9.81)), pin.Model()
    parent, above = None, 0
    kinds = {
        "planar": pin.JointModelPlanar(), "spherical": pin.JointModelSpherical(), "spherical_zyx": pin.JointModelSphericalZYX(),
        "translation": pin.JointModelTranslation(), "continuous": pin.JointModelRUBZ(),
        "revolute_unbounded": pin.JointModelRUBX(), "free_flyer": pin.JointModelFreeFlyer(),
    }  # fmt: skip
    for k, (kind, joint) in enumerate(kinds.items()):
        p, com, I = np.array([0.1, -0.2, 0.1 * k]), np.array([0.05, 0.02 * k, 0.01]), np.diag([0.02, 0.03, 0.025])
        axis = (1, 0, 0) if kind == "revolute_unbounded" else (0, 0, 1)
        m.add_joint(kind, kind, parent, p, axis=axis).add_body(f"{kind} link", kind, 1 + k, com, I)
        above = model.addJoint(above, joint, pin.SE3(np.eye(3), p), kind)
        model.appendBodyToJoint(above, pin.Inertia(1 + k, com, I), pin.SE3.Identity())
        model.addBodyFrame(f"{kind} link", above, pin.SE3.Identity(), 0)
        parent = kind
    m = m.finish()
    for seed in range(10):
        compare(m, dyn.StateLayout.of_pinocchio(model), pinocchio_peer(pin, model), links(m), seed)


# --------------------------------------------------------------------------------------------------- MuJoCo


def mujoco_peer(mujoco, model):
    data = mujoco.MjData(model)

    def peer(q, v, a):
        data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
        mujoco.mj_inverse(model, data)
        tau = data.qfrc_inverse.copy()
        M = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, M)
        motions = {}
        for k in range(1, model.nbody):
            velocity = np.zeros(6)
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, k, velocity, 0)
            R, p = data.xmat[k].reshape(3, 3).copy(), data.xpos[k].copy()
            motions[model.body(k).name] = R, p, np.r_[velocity[3:], velocity[:3]], None
        return v @ M @ v / 2, tau, motions

    return peer


@pytest.mark.parametrize("name, floating", CASES)
def test_mujoco(name, floating):
    mujoco = pytest.importorskip("mujoco")
    m = robot(name, floating)
    root = plain(ROBOTS[name])
    for tag in root.findall("mujoco"):
        root.remove(tag)
    for joint in root.findall("joint"):
        for tag in joint.findall("mimic"):
            joint.remove(tag)
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", fusestatic="false", balanceinertia="false", inertiafromgeom="false")
    spec = mujoco.MjSpec.from_string(ET.tostring(root, encoding="unicode"))
    if floating:
        spec.worldbody.first_body().add_freejoint()  # without a name
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    try:
        model = spec.compile()
    except ValueError as error:
        pytest.skip(f"MuJoCo refuses the file: {error}")
    model.dof_armature[:] = 0
    layout = dyn.StateLayout.of_mujoco(model, rename={"": "root_joint"})
    assert layout.sizes(m) == (model.nq, model.nv)
    if not any(j.mimic_leader >= 0 for j in m.joints):
        assert np.array_equal(m.to_peer("mujoco", m.random(1)).q, m.to_peer(layout, m.random(1)).q)
    for seed in range(5):
        compare(m, layout, mujoco_peer(mujoco, model),
                [n for n in links(m) if n in {model.body(k).name for k in range(model.nbody)}], seed)


def test_mujoco_ball_and_placed_base():
    mujoco = pytest.importorskip("mujoco")
    inertial = '<inertial pos="0.05 0.02 0.01" mass="1.5" diaginertia="0.02 0.03 0.025"/>'
    model = mujoco.MjModel.from_xml_string(f"""<mujoco><compiler balanceinertia="false"/><worldbody><body name="trunk" pos="1 2 3">
      <freejoint name="base"/>{inertial}<body name="arm" pos="0.1 -0.2 0.3"><joint name="ball" type="ball"/>{inertial}</body>
      </body></worldbody></mujoco>""")
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    b = dyn.Builder("b").add_joint("base", "free_flyer", placement=(turn, (1, 2, 3)))
    b.add_body("trunk", "base", 1.5, (0.05, 0.02, 0.01), np.diag([0.02, 0.03, 0.025]))
    b.add_joint("ball", "spherical", "base", (0.1, -0.2, 0.3)).add_body("arm", "ball", 1.5, (0.05, 0.02, 0.01),
                                                                        np.diag([0.02, 0.03, 0.025]))
    m = b.finish()
    for seed in range(5):
        compare(m, dyn.StateLayout.of_mujoco(model), mujoco_peer(mujoco, model), ["trunk", "arm"], seed)


# --------------------------------------------------------------------------------------------------- Drake


def drake_peer(plant):
    from pydrake.multibody.tree import MultibodyForces

    context = plant.CreateDefaultContext()

    def peer(q, v, a):
        plant.SetPositions(context, q)
        plant.SetVelocities(context, v)
        gravity = MultibodyForces(plant)
        plant.CalcForceElementsContribution(context, gravity)
        tau = plant.CalcInverseDynamics(context, a, gravity)
        kinetic = v @ plant.CalcMassMatrix(context) @ v / 2
        motions = {}
        for index in plant.GetBodyIndices(plant.GetModelInstanceByName("robot")):
            body = plant.get_body(index)
            X, V = plant.EvalBodyPoseInWorld(context, body), plant.EvalBodySpatialVelocityInWorld(context, body)
            motions[body.name()] = X.rotation().matrix(), X.translation(), np.r_[V.translational(), V.rotational()], None
        return kinetic, tau, motions

    return peer


@pytest.mark.parametrize("name, floating", CASES)
def test_drake(name, floating):
    pytest.importorskip("pydrake")
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    m = robot(name, floating)
    root = plain(ROBOTS[name])
    plant = MultibodyPlant(0.0)
    (instance,) = Parser(plant, "robot").AddModelsFromString(ET.tostring(root, encoding="unicode"), "urdf")
    if plant.GetModelInstanceName(instance) != "robot":
        plant.RenameModelInstance(instance, "robot")
    base = root.find("link").get("name")
    if not floating:
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(base))
    plant.Finalize()
    layout = dyn.StateLayout.of_drake(plant, rename={base: "root_joint"})
    assert layout.sizes(m) == (plant.num_positions(), plant.num_velocities())
    for seed in range(5):
        compare(m, layout, drake_peer(plant), links(m), seed)


def test_drake_ball_and_planar():
    pytest.importorskip("pydrake")
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import BallRpyJoint, FixedOffsetFrame, PlanarJoint, RotationalInertia, SpatialInertia, UniversalJoint

    plant, b = MultibodyPlant(0.0), dyn.Builder("b")
    instance = plant.AddModelInstance("robot")
    com, I, frame, parent = np.array([0.05, 0.02, 0.01]), np.diag([0.02, 0.03, 0.025]), plant.world_frame(), None
    for kind, joint in (("planar", PlanarJoint), ("spherical", BallRpyJoint), ("universal", UniversalJoint)):
        inertia = SpatialInertia.MakeFromCentralInertia(1.5, com, RotationalInertia(*np.diag(I)))
        body = plant.AddRigidBody(f"{kind} link", instance, inertia)
        p = np.array([0.1, -0.2, 0.3])
        offset = plant.AddFrame(FixedOffsetFrame(f"{kind} place", frame, RigidTransform(p)))
        plant.AddJoint(joint(kind, offset, body.body_frame()))
        axes = {"axis": (1, 0, 0), "axis2": (0, 1, 0)} if kind == "universal" else {}
        b.add_joint(kind, kind, parent, p, **axes).add_body(f"{kind} link", kind, 1.5, com, I)
        frame, parent = body.body_frame(), kind
    plant.Finalize()
    m = b.finish()
    for seed in range(10):
        compare(m, dyn.StateLayout.of_drake(plant), drake_peer(plant), links(m), seed)


# --------------------------------------------------------------------------------------------------- ROS, and what is refused


def test_ros_messages():
    """A JointState in any order, and an Odometry of a frame other than the base's own."""
    m = robot("beast", True)
    b = ["root_joint", "m_slide", "alpha", "knee", "zeta", "b_hip"]
    d, layout = m.data(), dyn.StateLayout("ros", b, child_frame="trunk")
    q, v, a, tau = state(m, 2)
    there = m.to_peer(layout, q, v, a, tau)
    d.forward_kinematics(q, v)
    X = d.frame_placement("trunk")
    near(there.q[:3], X.translation, "pose"), near(there.v[:6], d.frame_velocity("trunk", "local"), "twist")
    for k, name in enumerate(b[1:]):
        info = m.joint(name)
        assert there.q[7 + k] == q[info.idx_q] and there.v[6 + k] == v[info.idx_v] and there.tau[6 + k] == tau[info.idx_v]


def test_refusals(go2):
    with pytest.raises(dyn.ArgumentError, match="convention"):
        go2.to_peer("gazebo", go2.neutral())
    with pytest.raises(dyn.SizeError, match="q has shape"):
        go2.to_peer("mujoco", go2.neutral()[1:])
    with pytest.raises(dyn.UnknownNameError, match="leave out"):
        go2.to_peer(dyn.StateLayout("ros", ["FL_hip_joint"]), go2.neutral())
    with pytest.raises(dyn.SizeError, match="one index for each"):
        dyn.StateLayout("ros", ["FL_hip_joint"], idx_q=[0, 1])
    with pytest.raises(dyn.ArgumentError, match="without v"):
        go2.to_peer("mujoco", go2.neutral(), a=np.zeros(go2.nv))
    with pytest.raises(dyn.NonFiniteError, match="NaN"):
        go2.from_peer("drake", np.full(go2.nq, np.nan))


def test_mujoco_joints_without_names_are_named():
    mujoco = pytest.importorskip("mujoco")
    text = ('<mujoco><worldbody><body name="a"><joint{}/><geom size=".1"/><body name="b"><joint name="h"/><geom size=".1"/>'
            '<body name="c"><joint{}/><geom size=".1"/></body></body></body></worldbody></mujoco>')
    two, one = (mujoco.MjModel.from_xml_string(text.format("", last)) for last in ("", ' name="last"'))
    for model, rename in ((two, None), (two, {"": "a_joint"})):
        with pytest.raises(dyn.ArgumentError, match=r"0 \(of body 'a'\), 2 \(of body 'c'\)"):
            dyn.StateLayout.of_mujoco(model, rename)
    with pytest.raises(dyn.ArgumentError, match=r"0 \(of body 'a'\).*rename"):
        dyn.StateLayout.of_mujoco(one)
    assert dyn.StateLayout.of_mujoco(one, {"": "a_joint"}).joints == ("a_joint", "h", "last")
    assert dyn.StateLayout.of_mujoco(two, {"": None}).joints == ("h",)
