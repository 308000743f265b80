"""Inverse kinematics through the package and the command."""

import numpy as np
import pytest
from command import CLI, GO2, answer, run

import libdyn as dyn
from libdyn import ik

close = np.testing.assert_allclose


def quaternion(R):
    w = np.sqrt(max(0.0, 1 + np.trace(R))) / 2
    return np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], 4 * w * w]) / (4 * w)


def test_reaches_a_pose_however_it_is_given(go2):
    d = go2.data()
    d.forward_kinematics(go2.random(5))
    X = d.frame_placement("FL_foot")
    for given in (X, X.matrix, (X.rotation, X.translation), (quaternion(X.rotation), X.translation)):
        r = d.ik(ik.pose("FL_foot", given), go2.random(6))
        assert r.converged and r.reason == dyn.IkReason.CONVERGED and r.joint is None
        assert r.residuals.shape == (1, 2) and (r.residuals <= 1e-6).all()
        reached = d.frame_placement("FL_foot")  # data is at the solution
        close(reached.translation, X.translation, atol=1.1e-6)
        close(reached.rotation, X.rotation, atol=1.1e-6)
        np.testing.assert_array_equal(d.q, r.q)
        lower, upper = go2.array("lower_limit"), go2.array("upper_limit")
        assert (lower <= r.q).all() and (r.q <= upper).all()
        np.testing.assert_array_equal(d.ik(ik.pose("FL_foot", given), go2.random(6)).q, r.q)  # the same seed


def test_tasks_together(go2):
    d = go2.data()
    q = go2.neutral()
    q[2], q[7:] = 0.3, [0, 0.8, -1.6] * 4
    com = d.compute_com(q)
    feet = ["FL_foot", "FR_foot", "RL_foot", "RR_foot"]
    tasks = [ik.position(f, d.frame_placement(f).translation) for f in feet]
    tasks += [ik.com(com + [0.02, 0.01, -0.03]), ik.orientation("base", np.eye(3)), ik.posture(q)]
    r = d.ik(tasks, q, restarts=0)
    assert r.converged and (r.residuals[:-1] <= 1e-6).all() and r.residuals[-1].max() > 1e-3
    close(d.compute_com(), com + [0.02, 0.01, -0.03], atol=1.1e-6)
    close(d.frame_placement("base").rotation, np.eye(3), atol=1e-6)


def test_what_holds_it_back(arm):
    d = arm.data()
    r = d.ik(ik.position("tool", [0, 0, -3]), [0.3, 0.4])
    assert r.reason == dyn.IkReason.SINGULAR and not r.converged
    close(r.residuals[0, 0], 1, atol=1e-9)
    r = d.ik(ik.position("tool", [0, 0, -3]), [0.3, 0.4], lower=[0.2, -9], upper=[1, 9])
    assert r.reason == dyn.IkReason.LIMITS and r.joint == "shoulder" and r.q[0] == 0.2
    assert d.ik(ik.position("tool", [0, 0, 1.5]), [0.3, 0.4], limits=False).converged
    assert d.ik(ik.position("tool", [0.5, 7, -1], weights=[1, 0, 1]), [0.3, 0.4]).converged
    r = d.ik([ik.position("tool", [0.5, 0, -1]), ik.posture({"elbow": 1.0}, priority=0, weights=[0, 1])], [0.3, 0.4])
    assert r.reason == dyn.IkReason.LOCAL_MINIMUM
    assert d.ik(ik.position("tool", [0.5, 0, -1]), [2, -2], max_iterations=1, restarts=0).reason == dyn.IkReason.MAX_ITERATIONS


def test_refusals(arm):
    d = arm.data()
    for tasks, error, words in (
        ([3], dyn.ArgumentError, "tasks"),
        ([], dyn.ArgumentError, "ntasks is 0"),
        (ik.position("hand", [0, 0, 0]), dyn.UnknownNameError, "hand"),
        (ik.position("tool", [np.nan, 0, 0]), dyn.NonFiniteError, "target"),
        (ik.posture([0, 0, 0]), dyn.SizeError, "posture"),
        (ik.com([0, 0, 0], weights=[1, 1]), dyn.SizeError, "weights"),
        (ik.com([0, 0, 0], weight=-1), dyn.ArgumentError, "weight"),
        (ik.orientation("tool", 2 * np.eye(3)), dyn.ArgumentError, "no rotation"),
    ):
        with pytest.raises(error, match=words):
            d.ik(tasks)
    for bad in ([0, 0], np.eye(3)):
        with pytest.raises(dyn.SizeError):
            ik.pose("tool", bad)
    with pytest.raises(dyn.ArgumentError, match="zero quaternion"):
        ik.orientation("tool", [0, 0, 0, 0])
    with pytest.raises(dyn.PartError):
        arm.data(parts="com").ik(ik.com([0, 0, 0]))


@pytest.mark.skipif(not CLI, reason="the command dyn is not built")
def test_command(go2):
    d = go2.data()
    d.forward_kinematics(go2.random(3))
    words = ["ik", GO2, "--floating"]
    for frame in ("base", "FL_foot"):
        X = d.frame_placement(frame)
        words += ["--frame", frame, "--target", ",".join(map(repr, map(float, [*X.translation, *quaternion(X.rotation)])))]
    out = answer(*words)
    assert out["converged"] and out["reason"] == "converged" and [t["name"] for t in out["tasks"]] == ["base", "FL_foot"]
    assert max(max(t["linear"], t["angular"]) for t in out["tasks"]) <= 1e-6
    q = np.array(out["q"])
    e = go2.data()
    e.forward_kinematics(q)
    close(e.frame_placement("FL_foot").translation, d.frame_placement("FL_foot").translation, atol=2e-6)
    assert run(*words).startswith("converged after")
    assert answer("ik", GO2, "--floating", "--com", "0.1,0,0.2", "--frame", "base", "--target", "0,0,0,1",
                  "--stay")["tasks"][2]["name"] == "start"
    far = ["ik", GO2, "--fixed", "--frame", "FL_foot", "--target", "9,0,0"]
    assert "not reached" in run(*far, status=1) and "--best" in run(*far, status=1)
    assert answer(*far, "--best")["converged"] is False
    for extra, message in ((["--target", "1,2"], "2 numbers"), (["--target", "0,0,0,0"], "zero"),
                           ([], "one target for each frame")):
        assert message in run("ik", GO2, "--fixed", "--frame", "FL_foot", *extra, status=2)
    assert "nothing to reach" in run("ik", GO2, "--fixed", status=2)
    assert "no_such" in run("ik", GO2, "--fixed", "--frame", "no_such", "--target", "0,0,0", status=1)
