"""The command `dyn`: answers, the JSON contract, exit status, streams. DYN_CLI names it; otherwise a build tree or PATH does."""

import json
import math
import os
import shutil
import subprocess

import numpy as np
import pytest
from conftest import ARM, CAPI, MODELS

import libdyn as dyn

ROBOTS = MODELS / "robots"
GO2 = str(ROBOTS / "go2.urdf")


def find():
    if os.environ.get("DYN_CLI"):
        return os.environ["DYN_CLI"]
    built = [p for pattern in ("build*/bin/dyn", "build*/*/bin/dyn") for p in CAPI.parent.glob(pattern)]
    return str(max(built, key=lambda p: p.stat().st_mtime)) if built else shutil.which("dyn")


CLI = find()
pytestmark = pytest.mark.skipif(not CLI, reason="the command dyn is not built")


def run(*words, status=0, **kwargs):
    done = subprocess.run([CLI, *map(str, words)], capture_output=True, text=True, timeout=120, **kwargs)
    assert done.returncode == status, done.stderr or done.stdout
    if status:
        assert done.stdout == "" and done.stderr.startswith("dyn: ") and done.stderr.count("dyn: ") == 1
    return done.stderr if status else done.stdout


def answer(*words):
    def refuse(text):
        raise AssertionError(f"{text} is not JSON")

    return json.loads(run(*words, "--json"), parse_constant=refuse)


@pytest.fixture
def arm_file(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(ARM)
    return path


@pytest.fixture
def state_file(tmp_path):
    def write(content):
        path = tmp_path / "state.json"
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return path

    return write


# ------------------------------------------------------------------------------------------------- usage


def test_help_and_version():
    assert dyn.__version__ in run("--version")
    for words in ([], ["info"], ["eval"], ["ik"], ["sim"], ["bench"]):
        assert "Usage" in run(*words, "--help")
    assert all(name in run("--help") for name in ("info", "eval", "ik", "sim", "bench"))
    assert "Joint 0 and frame 0 are the universe" in run("info", "--help")


@pytest.mark.parametrize(
    "words",
    [
        [], ["fly"], ["info"], ["info", "--nonsense", GO2], ["info", GO2, "--fixed", "--floating"], ["eval", GO2, "--fixed"],
        ["eval", GO2, "--fixed", "--compute", "tau,nonsense"], ["eval", GO2, "--fixed", "--compute", ","],
        ["eval", GO2, "--fixed", "--compute", "frame_velocity"], ["eval", GO2, "--fixed", "--compute", "J", "--reference", "body"],
        ["eval", GO2, "--fixed", "--compute", "g", "--q", "1", "x"], ["eval", GO2, "--fixed", "--compute", "g", "--q", "nan"],
        ["eval", GO2, "--fixed", "--compute", "g", "--q", "1", "--state", "s.json"],
        ["sim", GO2, "--fixed"], ["sim", GO2, "--fixed", "--duration", "0"], ["sim", GO2, "--fixed", "--duration", "-1"],
        ["sim", GO2, "--fixed", "--duration", "nan"], ["sim", GO2, "--fixed", "--duration", "inf"],
        ["sim", GO2, "--fixed", "--duration", "1", "--dt", "0"], ["sim", GO2, "--fixed", "--duration", "1", "--dt", "-0.1"],
        ["sim", GO2, "--fixed", "--duration", "1", "--dt", "inf"], ["sim", GO2, "--fixed", "--duration", "1", "--dt", "abc"],
        ["sim", GO2, "--fixed", "--duration", "1e9", "--dt", "1e-9"],
        ["sim", GO2, "--fixed", "--duration", "1", "--integrator", "euler"], ["sim", GO2, "--fixed", "--duration", "1", "--csv", GO2],
        ["bench", GO2, "--fixed", "--seconds", "0"],
    ],
)  # fmt: skip
def test_bad_usage(words):
    run(*words, status=2)


def test_unknown_quantity_says_where_the_known_are():
    error = run("eval", GO2, "--fixed", "--compute", "Mass", status=2)
    assert '"Mass"' in error and "dyn eval --help" in error
    known = run("eval", "--help")
    assert "Minv" in known and "frame_classical_acceleration" in known


def test_bad_robots(tmp_path):
    assert "nowhere.urdf" in run("info", tmp_path / "nowhere.urdf", status=1)
    (tmp_path / "bad.urdf").write_text("<robot")
    assert "bad.urdf" in run("info", tmp_path / "bad.urdf", status=1)
    error = run("info", GO2, status=1)
    assert "--fixed or --floating" in error


# ------------------------------------------------------------------------------------------------- info


def test_info(go2):
    info = answer("info", GO2, "--floating")
    keys = ["name", "nq", "nv", "gravity", "total_mass", "joints", "frames", "effects", "report", "model_bytes", "data_bytes"]
    assert [k for k in info if k in keys] == keys
    assert (info["name"], info["nq"], info["nv"], info["gravity"]) == (go2.name, 19, 18, [0, 0, -9.81])
    assert info["total_mass"] == go2.total_mass and info["model_bytes"] == go2.size and info["data_bytes"] == go2.data_size()
    assert [j["name"] for j in info["joints"]] == [j.name for j in go2.joints]
    assert (info["joints"][0]["name"], info["joints"][0]["type"], info["frames"][0]["name"]) == ("universe",) * 3
    for said, known in zip(info["joints"][1:], go2.joints[1:]):
        assert said["type"].upper() == known.type.name
        for key in ("parent", "idx_q", "idx_v", "nq", "nv"):
            assert said[key] == getattr(known, key)
        limits = said["limits"]
        lower = [-math.inf if x is None else x for x in limits["lower"]]
        np.testing.assert_array_equal(lower, go2.lower_limit[known.idx_q : known.idx_q + known.nq])
        assert len(limits["velocity"]) == len(limits["effort"]) == known.nv
    assert [(f["name"], f["type"], f["joint"]) for f in info["frames"]][1:] == [
        (f.name, f.type.name, f.joint) for f in go2.frames
    ][1:]
    assert [e["name"] for e in info["effects"]] == ["gravity", "armature", "damping", "springs", "friction", "limits", "contact", "constraints",
                                                    "actuators", "fluid", "gravity_compensation", "mimic", "sleeping"]  # fmt: skip
    assert all(isinstance(e["active"], bool) and e["reason"] and e["bytes"] >= 0 for e in info["effects"])
    assert all(set(e) == {"level", "message", "line"} for e in info["report"])
    assert [e["level"] for e in info["report"] if "not applied" in e["message"] and "12 x effort limit" in e["message"]] == ["info"]


def test_info_for_people(arm_file):
    text = run("info", arm_file, "--fixed")
    for word in ("shoulder", "continuous", "[-2, 2.5]", "tool", "gravity", "load report", "nq 2"):
        assert word in text


def test_info_options(arm_file, tmp_path):
    assert answer("info", arm_file, "--fixed", "--cos-sin")["nq"] == 3
    arm_file.write_text(
        ARM.replace(
            '<link name="base"/>',
            '<link name="base"><visual><geometry><mesh filename="package://p/a.stl"/></geometry></visual></link>',
        )
    )
    (tmp_path / "p").mkdir()
    (tmp_path / "p" / "a.stl").write_text("solid a\nendsolid a\n")
    info = answer("info", arm_file, "--fixed", "--package-dir", tmp_path / "elsewhere", "--package-dir", tmp_path)
    assert any(s["mesh"].endswith("a.stl") for s in info["shapes"])


def test_mimic_in_info():
    info = answer("info", ROBOTS / "gripper.urdf", "--fixed")
    assert [e["active"] for e in info["effects"] if e["name"] == "mimic"] == [True]
    thumb = next(j for j in info["joints"] if j["name"] == "thumb_joint")
    assert thumb["mimic"] == {"leader": "left_knuckle_joint", "ratio": 0.5, "offset": 0.2} and thumb["nv"] == 0


# ------------------------------------------------------------------------------------------------- eval

ALL = (
    "tau,ddq,M,Minv,nle,g,static_torque,coriolis,com,vcom,acom,Jcom,subtree_com,energy,placements,J,dJ,"
    "frame_velocity,frame_acceleration,frame_classical_acceleration"
)


def test_eval_everything(go2, state, state_file):
    q, v, a, tau = state
    path = state_file({"q": q.tolist(), "v": v.tolist(), "a": a.tolist(), "tau": tau.tolist()})
    frame = go2.frame_name(go2.nframes - 1)
    found = answer(
        "eval", GO2, "--floating", "--compute", ALL, "--state", path, "--frame", frame, "--reference", "LOCAL_WORLD_ALIGNED"
    )
    assert list(found) == ALL.split(",")
    d, r = go2.data(), "LOCAL_WORLD_ALIGNED"
    expected = {
        "tau": d.rnea(q, v, a), "ddq": d.aba(q, v, tau), "M": d.crba(q), "Minv": d.minv(q), "nle": d.compute_nle(q, v),
        "g": d.gravity_torque(q), "static_torque": d.compute_static_torque(q), "coriolis": d.coriolis_matrix(q, v),
        "com": d.compute_com(q, v, a), "vcom": d.vcom.copy(), "acom": d.acom.copy(), "Jcom": d.jcom(q),
    }  # fmt: skip
    d.forward_kinematics(q, v, a)
    expected |= {
        "J": d.frame_jacobian(frame, r), "dJ": d.frame_jacobian_time_variation(frame, r), "frame_velocity": d.frame_velocity(frame, r),
        "frame_acceleration": d.frame_acceleration(frame, r), "frame_classical_acceleration": d.frame_classical_acceleration(frame, r),
    }  # fmt: skip
    for name, value in expected.items():
        np.testing.assert_array_equal(found[name], value, name)
    X = d.frame_placement(frame)
    np.testing.assert_array_equal(found["placements"][frame]["rotation"], X.rotation)
    np.testing.assert_array_equal(found["placements"][frame]["translation"], X.translation)
    energy = d.energy(q, v)
    assert found["energy"] == {"kinetic": energy.kinetic, "potential": energy.potential, "mechanical": sum(energy)}
    d.compute_com(q)
    com, mass = d.subtree_com(2)
    assert found["subtree_com"][go2.joint_name(2)] == {"com": com.tolist(), "mass": mass}


@pytest.mark.parametrize("robot", ["go2", "gripper"])
@pytest.mark.parametrize("name", ALL.split(","))
def test_eval_one_by_one(robot, name):
    """Each quantity asks for the parts that it needs."""
    base = "--floating" if robot == "go2" else "--fixed"
    frame = "base" if robot == "go2" else "thumb"
    assert list(answer("eval", ROBOTS / f"{robot}.urdf", base, "--compute", name, "--frame", frame)) == [name]


CENTROIDAL = "Ag,dAg,hg,dhg,Ig,dh_dq,dhdot_dq,dhdot_dv"
DERIVATIVES = "dtau_dq,dtau_dv,ddq_dq,ddq_dv,ddq_dtau"
REGRESSORS = "regressor,static_regressor,kinetic_energy_regressor,potential_energy_regressor,inertial_parameters"


def test_eval_centroidal_and_regressors(go2, state, state_file):
    q, v, a, _ = state
    path = state_file({"q": q.tolist(), "v": v.tolist(), "a": a.tolist()})
    found = answer("eval", GO2, "--floating", "--compute", f"{CENTROIDAL},{REGRESSORS}", "--state", path)
    d = go2.data()
    c, pi = d.centroidal(q, v, a), go2.inertial_parameters().reshape(-1, 10)
    expected = c._asdict() | d.centroidal_derivatives(q, v, a)._asdict() | {
        "regressor": d.joint_torque_regressor(q, v, a), "static_regressor": d.compute_static_regressor(q),
        "kinetic_energy_regressor": d.compute_kinetic_energy_regressor(q, v), "potential_energy_regressor": d.compute_potential_energy_regressor(q),
    }  # fmt: skip
    Ig = found.pop("Ig")
    np.testing.assert_allclose(Ig["inertia"], c.Ig[3:, 3:], atol=1e-14)
    np.testing.assert_allclose(Ig["com"], d.compute_com(q), atol=1e-14)
    assert abs(Ig["mass"] - go2.total_mass) < 1e-12
    for i, (joint, parameters) in enumerate(found.pop("inertial_parameters").items()):
        assert joint == go2.joint_name(i + 1) and parameters == pi[i].tolist()
    assert found.keys() == set(f"{CENTROIDAL},{REGRESSORS}".split(",")) - {"Ig", "inertial_parameters"}
    for name, value in found.items():
        np.testing.assert_allclose(value, expected[name], atol=1e-12, err_msg=name)


OF_FRAMES = "dv_dq,da_dq,da_dv,dclassical_dq,dclassical_dv,kinematic_hessian"
SECOND_ORDER = "d2tau_dqdq,d2tau_dvdv,d2tau_dqdv,d2tau_dadq"


def test_eval_derivatives_of_frames_and_second_order(go2, state, state_file):
    q, v, a, _ = state
    path = state_file({"q": q.tolist(), "v": v.tolist(), "a": a.tolist()})
    names = f"{OF_FRAMES},dvcom_dq,dg_dq,dstatic_torque_dq,{SECOND_ORDER}"
    found = answer("eval", GO2, "--floating", "--compute", names, "--state", path, "--frame", "FL_foot", "--reference", "WORLD")
    d, of = go2.data(), ("FL_foot", "WORLD")
    d.forward_kinematics(q, v, a)
    acceleration, classical = d.frame_acceleration_derivatives(*of), d.frame_classical_acceleration_derivatives(*of)
    expected = d.rnea_second_order_derivatives(q, v, a)._asdict() | {
        "dv_dq": d.frame_velocity_derivatives(*of).dv_dq, "da_dq": acceleration.da_dq, "da_dv": acceleration.da_dv,
        "dclassical_dq": classical.da_dq, "dclassical_dv": classical.da_dv,
        "kinematic_hessian": d.frame_kinematic_hessian(*of).transpose(2, 0, 1), "dg_dq": d.gravity_torque_derivatives(q),
        "dvcom_dq": d.vcom_derivatives(q, v).dvcom_dq, "dstatic_torque_dq": d.static_torque_derivatives(q),
    }  # fmt: skip
    assert found.keys() == expected.keys() == set(names.split(","))
    for name, value in found.items():
        np.testing.assert_allclose(value, expected[name], atol=1e-11, err_msg=name)


@pytest.mark.parametrize("name", f"{OF_FRAMES},dvcom_dq,dg_dq,dstatic_torque_dq,{SECOND_ORDER}".split(","))
@pytest.mark.parametrize("robot", ["go2", "gripper"])
def test_eval_of_one_derivative_alone(robot, name):
    base, frame = ("--floating", "base") if robot == "go2" else ("--fixed", "thumb")
    assert list(answer("eval", ROBOTS / f"{robot}.urdf", base, "--compute", name, "--frame", frame)) == [name]


def test_eval_derivatives(go2, state, state_file):
    q, v, a, tau = state
    path = state_file({"q": q.tolist(), "v": v.tolist(), "a": a.tolist(), "tau": tau.tolist()})
    found = answer("eval", GO2, "--floating", "--compute", DERIVATIVES, "--state", path)
    d = go2.data()
    expected = d.rnea_derivatives(q, v, a)._asdict() | d.aba_derivatives(q, v, tau)._asdict()
    assert list(found) == DERIVATIVES.split(",")
    for name, value in found.items():
        np.testing.assert_allclose(value, expected[name], atol=1e-9, err_msg=name)


@pytest.mark.parametrize("name", f"{CENTROIDAL},{REGRESSORS},{DERIVATIVES}".split(","))
@pytest.mark.parametrize("robot", ["go2", "gripper"])
def test_eval_of_one_quantity_alone(robot, name):
    base = "--floating" if robot == "go2" else "--fixed"
    assert list(answer("eval", ROBOTS / f"{robot}.urdf", base, "--compute", name)) == [name]


def test_eval_defaults(go2):
    found = answer("eval", GO2, "--floating", "--compute", "tau,placements", "--compute", "J")
    np.testing.assert_array_equal(found["tau"], go2.data().rnea(go2.neutral(), np.zeros(18), np.zeros(18)))
    assert len(found["placements"]) == go2.nframes and set(go2.frame_name(i) for i in range(go2.nframes)) <= set(
        found["placements"]
    )
    np.testing.assert_array_equal(found["J"], go2.data().joint_jacobians(go2.neutral()))


def test_eval_lists(arm_file, arm):
    expected = arm.data().rnea([-0.5, 0.25], [1, -2], [0.5, 1e-3]).tolist()
    for q in (["-0.5", "0.25"], ["-0.5,0.25"], ["-0.5,", "+0.25"], ["[-0.5, .25]"], [" -0.5 , 0.25 "]):
        assert (
            answer("eval", arm_file, "--fixed", "--compute", "tau", "--q", *q, "--v", "1,-2", "--a=0.5,1e-3")["tau"] == expected
        )


def test_eval_for_people(arm_file):
    text = run("eval", arm_file, "--fixed", "--compute", "M,energy,com")
    assert "M\n" in text and "kinetic" in text and "com\n" in text


def test_state_by_joint(arm_file, arm, state_file):
    path = state_file({"q": {"elbow": 0.5}, "v": {"shoulder": [2]}})
    found = answer("eval", arm_file, "--fixed", "--compute", "nle", "--state", path)
    assert found["nle"] == arm.data().compute_nle([0, 0.5], [2, 0]).tolist()


@pytest.mark.parametrize(
    "content, words",
    [
        ("{", ["not JSON"]),
        ("", ["not JSON"]),
        ("[1, 2]", ["object"]),
        ('{"q": [1, NaN]}', ["not JSON"]),
        ('{"q":\n [1, 1e999]}', [':2: "1e999" is beyond the range of a double']),
        ('{"q": [[1, 2]]}', ['"q"[0] must be a number, but is [1,2]']),
        ('{"ctrl": [[1]]}', ['"ctrl"[0] must be a number']),
        ('{"q": [1, 2, 3]}', ['"q"', "3", "2"]),
        ('{"v": [1]}', ['"v"', "1", "2"]),
        ('{"q": [1, "x"]}', ['"q"[1]', "number"]),
        ('{"q": [1, null]}', ['"q"[1]']),
        ('{"q": [1, true]}', ['"q"[1]']),
        ('{"q": 5}', ["list"]),
        ('{"position": [1, 2]}', ['"position"', '"tau"']),
        ('{"q": {"knee": 1}}', ["knee"]),
        ('{"q": {"elbow": [1, 2]}}', ["elbow", "2", "1"]),
    ],
)
def test_bad_states(arm_file, state_file, content, words):
    path = state_file(content)
    error = run("eval", arm_file, "--fixed", "--compute", "g", "--state", path, status=1)
    assert str(path) in error and all(w in error for w in words)


def test_more_bad_states(arm_file, tmp_path):
    words = ("eval", arm_file, "--fixed", "--compute", "g")
    assert "No such file" in run(*words, "--state", tmp_path / "none.json", status=1)
    run(*words, "--state", tmp_path, status=1)
    error = run(*words, "--q", "1,2,3", status=1)
    assert "--q has 3 numbers" in error and "2 (nq)" in error
    assert "wrist" in run(*words, "--frame", "wrist", status=1)
    error = run("eval", GO2, "--floating", "--compute", "g", "--q", ",".join(["0"] * 19), status=1)
    assert "quaternion" in error


# ------------------------------------------------------------------------------------------------- sim


def test_sim(arm_file, arm, tmp_path):
    csv = tmp_path / "out.csv"
    found = answer(
        "sim", arm_file, "--fixed", "--duration", "0.5", "--dt", "1e-3", "--integrator", "rk4", "--q", "1,0.5", "--csv", csv, "--effects", "armature"
    )
    keys = "duration steps wall_s real_time_factor q v time energy contacts_max penetration_max residual_max integrator solver dt error_estimate effects warnings"
    assert set(keys.split()) <= set(found)
    assert (found["steps"], found["dt"], found["duration"], found["integrator"], found["contacts_max"]) == (
        500,
        1e-3,
        0.5,
        "rk4",
        0,
    )
    d = arm.data()
    d.set_effects("armature")
    d.set_state([1, 0.5], [0, 0])
    start = sum(d.energy())
    for _ in range(500):
        d.step(1e-3, "rk4")
    assert found["q"] == d.q.tolist() and found["v"] == d.v.tolist() and found["time"] == d.time
    assert found["energy"]["initial"] == start and found["energy"]["final"] == sum(d.energy())
    assert 0 <= found["energy"]["drift_max"] < 1e-9 and 0 < found["error_estimate"] < 1e-9
    assert found["wall_s"] > 0 and found["real_time_factor"] == pytest.approx(0.5 / found["wall_s"])
    rows = np.genfromtxt(csv, delimiter=",", names=True)
    assert rows.dtype.names == ("t", "q0", "q1", "v0", "v1", "kinetic", "potential", "mechanical") and len(rows) == 501
    assert rows["q1"][-1] == d.q[1] and rows["t"][0] == 0 and rows["mechanical"][0] == start  # 17 digits: no loss


@pytest.mark.parametrize("integrator", ["semi_implicit_euler", "implicit_fast", "implicit_midpoint", "rk4", "rk45"])
@pytest.mark.parametrize("robot", sorted(p.stem for p in ROBOTS.glob("*.urdf")))
def test_sim_of_every_robot(robot, integrator, state_file):
    """As tools/run has them move: nothing drives them, so limits, contacts and damping only take energy."""
    robot = ROBOTS / f"{robot}.urdf"
    base = "--floating" if robot.stem in ("go2", "humanoid") else "--fixed"
    state = state_file({"v": [0.5] * answer("info", robot, base)["nv"]})
    found = answer("sim", robot, base, "--duration", "0.2", "--dt", "1e-3", "--integrator", integrator, "--state", state)
    assert found["steps"] == 200 and all(map(math.isfinite, found["q"] + found["v"]))
    energy = found["energy"]
    assert energy["final"] - energy["initial"] < 1e-2 * (abs(energy["initial"]) + abs(energy["final"]))  # of the first order: what Euler's steps of 1 ms make


def test_sim_with_forces_over_time(arm_file, arm, tmp_path):
    forces, again, random, d = tmp_path / "forces.csv", tmp_path / "again.csv", np.random.default_rng(0), arm.data()
    rows = [(1e-3 * k, *random.normal(size=2).tolist()) for k in range(0, 50, 2)]  # each acts for two steps
    forces.write_text("\ufefftau1,t,mechanical,tau0\n" + "".join(f"{b!r},{t!r},,{a!r}\n" for t, a, b in rows), "utf-8")
    d.set_effects("armature")
    d.set_state([1, 0.5], [0, 0])
    for k in range(50):
        d.set_state(None, None, None, rows[k // 2][1:])
        d.step(1e-3, "rk4")
    setting = ("sim", arm_file, "--fixed", "--duration", "0.05", "--dt", "1e-3", "--integrator", "rk4", "--q", "1,0.5", "--effects", "armature")
    found = answer(*setting, "--tau-csv", forces, "--csv", again)
    assert found["q"] == d.q.tolist() and found["v"] == d.v.tolist() and 0 < found["error_estimate"] < 1e-6
    assert answer(*setting, "--tau-csv", again)["q"] == d.q.tolist()
    late = tmp_path / "late.csv"
    late.write_text("t,tau0,tau1\n0.03,1,1\n")
    found = answer(*setting, "--tau-csv", late)
    assert found["q"] != answer(*setting)["q"] and any("first row of --tau-csv is at t = 0.03 s" in w for w in found["warnings"])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "there are no rows"),
        ("t,tau0,tau1\n", "there are no rows"),
        ("t,tau0\n0,1\n", "there is no column tau1"),
        ("0,1,2\n1,1,2\n", "there is no column t:"),
        ("t,tau0,tau1\n0,1,2\n1,1\n", ":3: there are 2 columns, and the first line names 3"),
        ("t,tau0,tau1\n0,1,x\n", ':2: "x" is not a finite number'),
        ("t,tau0,tau1\n0,1,nan\n", "is not a finite number"),
        ("t,tau0,tau1\n0,1,\n", "is not a finite number"),
        ("t,tau0,tau1\n0,1,2\n0,1,2\n", "t must grow from row to row"),
        ("t,tau0,tau1,tau2\n0,1,2,3\n", 'unknown column "tau2"'),
        ("t,tau0,tau1,foo\n0,1,2,3\n", 'unknown column "foo"'),
        ("t,tau0,tau1,q2\n0,1,2,3\n", 'unknown column "q2"'),
        ("t,tau0,tau1,tau1\n0,1,2,3\n", "there are two columns tau1"),
    ],
)
def test_bad_forces_over_time(arm_file, tmp_path, text, said):
    forces = tmp_path / "forces.csv"
    forces.write_text(text)
    assert said in run("sim", arm_file, "--fixed", "--duration", "0.01", "--tau-csv", forces, status=1)


def test_forces_over_time_are_there_once(arm_file, tmp_path):
    assert "cannot be read" in run("sim", arm_file, "--fixed", "--duration", "0.01", "--tau-csv", tmp_path / "none.csv", status=1)
    assert "exclude each other: keep one" in run("sim", arm_file, "--fixed", "--duration", "0.01", "--tau", "1,1", "--tau-csv", tmp_path / "none.csv", status=2)


def test_sim_last_step_is_shorter(arm_file):
    found = answer("sim", arm_file, "--fixed", "--duration", "0.0105", "--dt", "1e-3")
    assert found["steps"] == 11 and found["time"] == pytest.approx(0.0105, abs=1e-15)
    found = answer("sim", arm_file, "--fixed", "--duration", "1e-4", "--dt", "1", "--no-error-estimate")
    assert found["steps"] == 1 and found["time"] == found["dt"] == 1e-4 and found["error_estimate"] is None
    assert run("sim", arm_file, "--fixed", "--duration", "1e-300").startswith("1e-300 s in 1 step of 1e-300 s")


def test_sim_without_an_error_estimate(tmp_path):
    """The steps go well, and their distance from those at half the length is none."""
    robot, csv = tmp_path / "blow.xml", tmp_path / "blow.csv"
    robot.write_text('<mujoco><worldbody><body><joint name="j" axis="0 1 0" stiffness="1e6"/><geom size=".01" pos=".5 0 0"/></body></worldbody></mujoco>')
    words = ("sim", robot, "--integrator", "rk4", "--duration", "1", "--dt", "0.1", "--q", "1")
    found = answer(*words, "--csv", csv)
    assert found["error_estimate"] is None and found["steps"] == 10 and len(csv.read_text().splitlines()) == 12
    assert sum(w.startswith("no error estimate: ") for w in found["warnings"]) == 1
    assert "error estimate    unknown" in run(*words)


def test_sim_error_estimate_is_honest(arm_file):
    def end(dt, integrator):
        return answer("sim", arm_file, "--fixed", "--duration", "1", "--dt", dt, "--integrator", integrator, "--q", "1,0.5", "--effects", "damping")

    exact = np.array(end("1e-4", "rk4")["q"])
    for integrator, dt in (("semi_implicit_euler", "1e-3"), ("rk4", "2e-2")):
        found = end(dt, integrator)
        assert found["error_estimate"] == pytest.approx(np.linalg.norm(found["q"] - exact), rel=0.2)


def test_sim_tau_and_text(arm_file, tmp_path):
    csv = tmp_path / "out.csv"
    text = run("sim", arm_file, "--fixed", "--duration", "0.01", "--tau", "1,2", "--csv", csv)
    assert "wall time" in text and "energy" in text and "work" in text
    assert csv.read_text().splitlines()[0] == "t,q0,q1,v0,v1,tau0,tau1,kinetic,potential,mechanical"


def test_sim_limits_are_mentioned(arm_file):
    words = ("sim", arm_file, "--fixed", "--duration", "1", "--v", "8,0")
    warnings = answer(*words, "--effects", "armature")["warnings"]
    assert sum("shoulder" in w and "beyond its limits" in w for w in warnings) == 1
    found = answer(*words)
    assert not any("limits" in w for w in found["warnings"]) and found["solver"] == "admm" and found["residual_max"] <= 1e-9


def test_sim_failures(arm_file, tmp_path):
    words = ("sim", arm_file, "--fixed", "--duration")
    assert "cannot be written" in run(*words, 1, "--csv", tmp_path / "no" / "out.csv", status=1)
    assert "GB" in run(*words, 1e5, "--dt", 1e-4, "--csv", tmp_path / "big.csv", status=1)
    assert not (tmp_path / "big.csv").exists()
    if os.path.exists("/dev/full"):
        assert "No space" in run(*words, 1, "--csv", "/dev/full", status=1)
    csv = tmp_path / "out.csv"
    error = run(*words, 1e202, "--dt", "1e200", "--v", "1e150,-1e150", "--csv", csv, status=1)
    assert "step 1" in error and len(csv.read_text().splitlines()) == 2


def test_pipes(arm_file):
    if os.path.exists("/dev/full"):
        with open("/dev/full", "w") as full:
            done = subprocess.run([CLI, "info", arm_file, "--fixed"], stdout=full, stderr=subprocess.PIPE, text=True)
        assert done.returncode == 1 and "cannot be written" in done.stderr
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run([CLI, "info", arm_file, "--fixed", "--json"], stdout=write, stderr=subprocess.PIPE, text=True)
    os.close(write)
    assert done.returncode == 1 and "Broken pipe" in done.stderr


def test_locale_does_not_matter(arm_file):
    env = {**os.environ, "LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8"}
    words = ("eval", arm_file, "--fixed", "--compute", "g", "--q", "0.5,0.25", "--json")
    assert run(*words, env=env) == run(*words)


def test_sim_to_an_accuracy(arm_file):
    words = ("sim", arm_file, "--fixed", "--duration", "1", "--q", "1,0.5", "--accuracy")
    tight, loose = answer(*words, "1e-11"), answer(*words, "1e-4")
    assert tight["integrator"] == "reference" and tight["steps"] > loose["steps"]
    assert np.abs(np.subtract(tight["q"], loose["q"])).max() < 1e-3 and loose["error_estimate"] <= 1e-4
    for bad in ("-1", "nan", "inf"):
        run(*words, bad, status=2)


# ------------------------------------------------------------------------------------------------- bench


def test_bench(arm_file):
    rows = answer("bench", arm_file, "--fixed", "--seconds", "0.2")["algorithms"]
    names = [r["name"] for r in rows]
    assert len(set(names)) == len(names) and {"rnea", "aba", "crba", "forward_kinematics", "step_rk4"} <= set(names)
    for row in rows:
        assert set(row) == {"name", "ns_p50", "ns_p99", "percent_of_1ms", "ratio_to_rnea", "instructions"}
        assert 0 < row["ns_p50"] <= row["ns_p99"] and row["percent_of_1ms"] == row["ns_p50"] / 1e4
        assert row["instructions"] is None or row["instructions"] > 0
    assert "rnea" in run("bench", arm_file, "--fixed", "--seconds", "0.1")


# ------------------------------------------------------------------------------------------------- effects

DAMPED = """<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j" type="continuous"><parent link="a"/>
<child link="b"/><axis xyz="0 0 1"/><dynamics damping="0.5" friction="0.25"/></joint></robot>"""


def test_effects(tmp_path):
    robot = tmp_path / "r.urdf"
    robot.write_text(DAMPED)

    def final(*more):
        found = answer("sim", robot, "--fixed", "--duration", "1", "--dt", "1e-4", "--v", "2", *more)
        return found["v"][0], {e["name"] for e in found["effects"] if e["active"]}

    assert final("--effects", "none") == (pytest.approx(2), {"gravity"})
    assert final() == final("--effects", "all")
    warnings = answer("sim", robot, "--fixed", "--duration", "0.01", "--effects", "armature")["warnings"]
    assert [w.split(":")[0] for w in warnings if "--effects" in w] == ["damping", "friction"]
    v, active = final("--effects", "damping")
    assert v == pytest.approx(2 * math.exp(-0.5), rel=1e-4) and active == {"gravity", "damping"}
    v, active = final("--effects", "all")
    assert v == pytest.approx(2.5 * math.exp(-0.5) - 0.5, rel=1e-3) and active == {"gravity", "damping", "friction"}
    for effects, tau in {"armature": 0, "damping": 1, "friction,damping": 1.25, "all": 1.25}.items():
        found = answer("eval", robot, "--fixed", "--compute", "tau", "--v", "2", "--effects", effects)
        assert found["tau"] == pytest.approx([tau])
    for command in (["sim", "--duration", "1"], ["eval", "--compute", "tau"], ["bench"]):
        assert "wind" in run(command[0], robot, "--fixed", *command[1:], "--effects", "wind", status=2)


# ------------------------------------------------------------------------------------------------- distance


def test_distance(go2):
    found = answer("distance", GO2, "--floating")
    distances = go2.data().compute_distances(go2.neutral())
    assert [p["distance"] for p in found["pairs"]] == sorted(distances.tolist())
    assert found["collisions"] == 0 and {p["status"] for p in found["pairs"]} == {"separated"}
    nearest = found["pairs"][0]
    assert distances[nearest["pair"]] == nearest["distance"] and {nearest["a"], nearest["b"]} & {"base", "FL_thigh"}
    text = run("distance", GO2, "--floating")
    assert f"{len(distances)} pairs, 0 in collision" in text and "--pairs" in text and text.count("separated") == 10
    assert run("distance", GO2, "--floating", "--pairs").count("separated") == len(distances)
    values = answer("eval", GO2, "--floating", "--compute", "distances,collisions,distance_gradients")
    assert len(values["distances"]) == len(values["distance_gradients"]) == go2.npairs and values["collisions"] == []
    pairs = answer("info", GO2, "--floating", "--pairs")["pairs"]
    assert sum(p["tested"] for p in pairs) == go2.npairs
    assert {p["reason"] for p in pairs} == {"tested", "they belong to one body", "a body and its parent"}
    assert "pairs of collision shapes" in run("info", GO2, "--floating", "--pairs")


def test_distance_sweep(arm_file):
    found = answer("distance", GO2, "--floating", "--sweep", "--samples", "3")
    assert found["reference"] == 1e-15 and found["states"] == 4
    rows = found["sweep"]
    kinds = list(dict.fromkeys(r["kind"] for r in rows))
    assert kinds[-1] == "all" and {"box-cylinder", "cylinder-cylinder"} <= set(kinds)
    gjk = [r for r in rows if r["method"] == "gjk"]
    assert len(gjk) == 11 * len(kinds)
    assert [r["tolerance"] for r in gjk[:11]] == pytest.approx([10.0**-k for k in range(2, 13)])
    assert len(rows) in (len(gjk), 2 * len(gjk))  # with libccd, and without
    total = [r for r in gjk if r["kind"] == "all"]
    for row, tolerance in zip(total, [10.0**-k for k in range(2, 13)]):
        assert row["failed"] == 0 and row["queries"] == row["by_method"] == sum(r["queries"] for r in gjk if r["tolerance"] == row["tolerance"]) / 2
        assert 0 <= row["median_error"] <= row["max_error"] <= tolerance + 1e-14  # shapes are smaller than 1 m
        assert 1e-9 < row["wall_s"] < 1e-3
    assert total[0]["max_error"] > total[-1]["max_error"]
    assert all(r["by_method"] <= r["queries"] for r in rows)
    text, here = (f("distance", GO2, "--floating", "--sweep", "--samples", "0") for f in (run, answer))
    assert "tolerance" in text and text.count("\n") == 1 + sum(r["by_method"] > 0 for r in here["sweep"])
    assert "no pair" in run("distance", arm_file, "--fixed", "--sweep")
    assert answer("distance", arm_file, "--fixed", "--sweep")["sweep"] == []
    assert "--sweep" in run("distance", GO2, "--floating", "--samples", "3", status=2)
    assert "samples" in run("distance", GO2, "--floating", "--sweep", "--samples", "-1", status=2)


def test_distance_without_shapes(arm_file):
    assert "no pair" in run("distance", arm_file, "--fixed")
