"""Operations on whole robots, from Python; locked as Pinocchio's buildReducedModel does."""

import numpy as np
import pytest
from conftest import MODELS

import libdyn as dyn


def test_lock_attach_subtree(arm):
    reduced = dyn.Builder.from_model(arm).lock("elbow", [0.1, 0.4]).finish()
    assert (reduced.nv, arm.nv) == (1, 2)
    full, less = arm.data(), reduced.data()
    assert np.allclose(full.crba([0.1, 0.4])[0, 0], less.crba([0.1])[0, 0], rtol=1e-14)
    less.forward_kinematics([0.1]), full.forward_kinematics([0.1, 0.4])
    assert np.allclose(less.frame_placement("elbow").matrix, full.frame_placement("elbow").matrix, atol=1e-15)
    pair = dyn.Builder.from_model(arm).attach(arm, "right_", "rail", "prismatic", parent="tool", axis=(1, 0, 0), lower=-1,
                                              upper=1).finish()
    assert [pair.joint_name(j) for j in range(1, 6)] == ["shoulder", "elbow", "rail", "right_shoulder", "right_elbow"]
    assert dyn.Builder.from_model(pair).keep_subtree("right_shoulder").finish().nv == 2
    assert dyn.Builder.from_model(pair).remove_subtree("rail").finish().nv == 2
    with pytest.raises(dyn.UnknownNameError, match="its link and the link of 'arm' would both be named 'base'"):
        dyn.Builder.from_model(arm).attach(arm)
    with pytest.raises(dyn.InvalidRobotError, match="shoulder.*-2 to 2.5"):
        dyn.Builder.from_model(arm).lock(["shoulder"], [3, 0])


def test_pinocchio_reduces_alike():
    pin = pytest.importorskip("pinocchio")
    path = MODELS / "robots" / "go2.urdf"
    theirs = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
    ours = dyn.load(path, base="floating")
    q = ours.random(5)
    locked = [n for n in theirs.names if "calf" in n]
    q_pin = ours.to_peer(dyn.StateLayout.of_pinocchio(theirs), q).q
    less = pin.buildReducedModel(theirs, [theirs.getJointId(n) for n in locked], q_pin)
    reduced = dyn.Builder.from_model(ours).lock(locked, q).finish()
    assert reduced.nv == less.nv == 14
    random = np.random.default_rng(3)
    x, v, a = reduced.random(3), random.standard_normal(14), random.standard_normal(14)
    layout = dyn.StateLayout.of_pinocchio(less)
    peer = reduced.to_peer(layout, x, v, a)
    data = less.createData()
    tau = pin.rnea(less, data, peer.q, peer.v, peer.a)
    mine = reduced.data().rnea(x, v, a)
    assert np.allclose(reduced.from_peer(layout, peer.q, tau=tau).tau, mine, atol=1e-12 * np.abs(mine).max())
    pin.framesForwardKinematics(less, data, peer.q)
    d = reduced.data()
    d.forward_kinematics(x)
    for name in locked:  # frames still
        assert np.allclose(data.oMf[less.getFrameId(name)].homogeneous, d.frame_placement(name).matrix, atol=1e-13)
