"""dyn compare: twenty pairs with one planted difference each, logs of MuJoCo, and what is refused."""

from __future__ import annotations

import re
import resource
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from command import CLI, ROBOTS, answer, pytestmark, run  # noqa: F401

SEED = 36
MODELS_ALONE = ["mass", "inertia", "armature", "friction", "damping", "actuators", "contact", "step", "frames", "mimic"]
WITH_LOGS = ["mass", "armature", "damping", "friction", "actuators", "contact", "gravity", "step", "integrator", "start"]


def numbers(x):
    return " ".join(f"{y:.9g}" for y in np.atleast_1d(x))


def arm(random, change=None):
    """Four links under servos; change: what is planted, in one joint or link."""
    n, text, end = 4, "", ""
    at = int(random.integers(n))
    factor = random.uniform(1.05, 1.3) if random.random() < 0.5 else random.uniform(0.75, 0.95)
    servos = ""
    for k in range(n):
        axis = random.normal(size=3)
        mass, com, inertia = random.uniform(0.5, 2), [0, random.uniform(-0.05, 0.05), -0.15], random.uniform(0.01, 0.02, 3)
        damping, friction, armature = random.uniform(0.1, 0.5), random.uniform(0.05, 0.2), random.uniform(0.01, 0.05)
        kp, place = random.uniform(5, 20), [0, 0, -0.3 if k else 0]
        f = factor if k == at else 1
        mass *= f if change == "mass" else 1
        inertia = inertia * (f if change == "inertia" else 1)
        armature *= f if change == "armature" else 1
        damping *= f if change == "damping" else 1
        friction *= f if change == "friction" else 1
        kp *= f if change == "actuators" else 1
        if change == "frames" and k == max(at, 1):
            place[0] += 0.02 * factor
        text += (f'<body name="link{k}" pos="{numbers(place)}"><joint name="j{k}" axis="{numbers(axis)}" damping="{damping:.9g}" '
                 f'frictionloss="{friction:.9g}" armature="{armature:.9g}"/><inertial mass="{mass:.9g}" pos="{numbers(com)}" '
                 f'diaginertia="{numbers(inertia)}"/><geom type="sphere" size=".02" contype="0" conaffinity="0" '
                 f'rgba="{0.5 if change else 1} 0 0 1"/>')
        end += "</body>"
        servos += f'<position name="servo{k}" joint="j{k}" kp="{kp:.9g}" kv="0.3"/>'
    gravity = [0, 0, -9.81 * (factor if change == "gravity" else 1)]
    ctrl, q = random.uniform(-1, 1, n), random.uniform(-1, 1, n)
    step = 0.002 if change == "step" else 0.001
    integrator = ' integrator="RK4"' if change == "integrator" else ""
    return (f'<mujoco><option timestep="{step}" gravity="{numbers(gravity)}"{integrator}/><worldbody>{text}{end}</worldbody>'
            f'<actuator>{servos}</actuator><keyframe><key name="start" qpos="{numbers(q)}" ctrl="{numbers(ctrl)}"/></keyframe></mujoco>')


def sliders(random, change=None):
    """A box and a puck that slide to rest."""
    friction, v = random.uniform(0.2, 0.5, 2), random.uniform(1, 2, 2)
    if change == "contact":
        friction[int(random.integers(2))] *= random.uniform(1.1, 1.4)
    return (f'<mujoco><option timestep="0.001"/><worldbody><geom name="floor" type="plane" size="5 5 1" friction="0.01 0 0"/>'
            f'<body name="box" pos="0 0 .05"><freejoint name="box"/><geom type="box" size=".1 .1 .05" friction="{friction[0]:.9g} 0 0"/></body>'
            f'<body name="puck" pos="0 1 .03"><freejoint name="puck"/><geom type="box" size=".1 .08 .03" friction="{friction[1]:.9g} 0 0"/></body>'
            f'</worldbody><keyframe><key name="start" qpos="0 0 .05 1 0 0 0 0 1 .03 1 0 0 0" qvel="{v[0]:.9g} 0 0 0 0 0 {v[1]:.9g} 0 0 0 0 0"/>'
            "</keyframe></mujoco>")


def followers(random, change=None):
    text = (ROBOTS / "gripper.urdf").read_text()
    factor = random.uniform(1.05, 1.2)
    if change == "mimic":
        text = re.sub(r'multiplier="([^"]*)"', lambda m: f'multiplier="{float(m[1]) * factor}"', text, count=1)
    return text


def pair(kind, with_log, folder, seed):
    """Command line of one pair: the same random scene twice, one with the planted difference."""
    make = sliders if kind == "contact" else followers if kind == "mimic" else arm
    ending = "urdf" if kind == "mimic" else "xml"
    files = []
    for name, change in (("a", None), ("b", kind)):
        files.append(folder / f"{kind}{with_log}{name}.{ending}")
        files[-1].write_text(make(np.random.default_rng(seed), change))
    words = ["--fixed", "--v", "1"] if kind == "mimic" else ["--configuration", "start"]
    if not with_log:
        return [*files, *words, "--duration", "0.5"]
    log = folder / f"{kind}.csv"
    planted = ["--dt", "0.001"]
    if kind == "step":
        planted = ["--dt", "0.002"]
    if kind == "start":
        q = np.random.default_rng(seed + 1).uniform(-1, 1, 4)
        run("sim", files[0], "--q", ",".join(map(str, q)), "--ctrl", "0,0,0,0", *planted, "--duration", "0.5", "--csv", log, "--no-error-estimate")
        return [log, files[0], "--q", ",".join(map(str, q + [0.01, 0, 0, 0])), "--ctrl", "0,0,0,0"]
    run("sim", files[1], *words, *planted, "--duration", "0.5", "--csv", log, "--no-error-estimate")
    return [log, files[0], *([] if kind == "contact" else ["--ctrl", controls_of(files[0])])]


def controls_of(file):
    return re.search(r'ctrl="([^"]*)"', file.read_text())[1].replace(" ", ",")


def test_planted_differences_are_named_first(tmp_path):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    pairs = [(kind, log, pair(kind, log, tmp_path, SEED + k + 100 * log))
             for log, kinds in ((False, MODELS_ALONE), (True, WITH_LOGS)) for k, kind in enumerate(kinds)]
    assert len(pairs) == 20
    with ThreadPoolExecutor(2) as pool:
        said = list(pool.map(lambda p: answer("compare", *p[2]), pairs))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    named = [x["causes"][0]["name"] if x["causes"] else "" for x in said]
    wrong = [(kind, "log" if log else "models", name) for (kind, log, _), name in zip(pairs, named) if kind != name]
    assert len(wrong) <= 1, wrong
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 120  # s of processor: a minute on two
    for (kind, log, _), x in zip(pairs, said):
        if (kind, "log" if log else "models") in [w[:2] for w in wrong]:
            continue
        assert x["causes"][0]["explained"] > 0.9, (kind, log)
        if not log:
            assert x["unexplained"] < 1e-6 and len(x["causes"]) == 1


def test_the_value_of_the_culprit_is_found(tmp_path):
    words = pair("damping", True, tmp_path, SEED)
    found = answer("compare", *words)["causes"][0]
    a, b = (tmp_path / f"dampingTrue{x}.xml" for x in "ab")
    values = [[float(x) for x in re.findall(r' damping="([^"]*)"', f.read_text())] for f in (a, b)]
    at = int(np.argmax(np.abs(np.subtract(*values))))
    assert found["differences"][0]["what"] == f"joint 'j{at}': damping"
    assert found["differences"][0]["a"] == pytest.approx(values[1][at], rel=1e-4)
    assert found["differences"][0]["b"] == pytest.approx(values[0][at], rel=1e-12)


def test_shares_of_two_differences_and_what_b_alone_is_given(tmp_path):
    a, b = tmp_path / "a.xml", tmp_path / "b.xml"
    a.write_text(arm(np.random.default_rng(SEED))), b.write_text(arm(np.random.default_rng(SEED), "damping"))
    said = answer("compare", a, b, "--configuration", "start", "--integrator-b", "rk4", "--ctrl-b", "0,0,0,0")
    names = [c["name"] for c in said["causes"]]
    assert sorted(names) == ["controls", "damping", "integrator"] and names[0] == "controls"
    assert said["unexplained"] < 1e-6
    assert said["at_end"]["error_a"] > said["at_end"]["error_b"] > 0  # order 1, order 4
    assert said["begins"] == said["every"]


def test_equal_models_do_not_diverge(tmp_path):
    a = tmp_path / "a.xml"
    a.write_text(arm(np.random.default_rng(SEED)))
    said = answer("compare", a, a)
    assert said["begins"] is None and said["causes"] == [] and max(said["divergence"]) == 0
    assert "no divergence" in run("compare", a, a)


def test_a_log_of_mujoco(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    a, b, log = tmp_path / "a.xml", tmp_path / "b.xml", tmp_path / "mujoco.csv"
    a.write_text(arm(np.random.default_rng(SEED))), b.write_text(arm(np.random.default_rng(SEED), "damping"))
    m = mujoco.MjModel.from_xml_path(str(b))
    d = mujoco.MjData(m)
    mujoco.mj_resetDataKeyframe(m, d, 0)
    rows = []
    for _ in range(300):
        rows.append([d.time, *d.qpos, *d.qvel, *d.ctrl])
        mujoco.mj_step(m, d)
    names = ["time", *(f"qpos{k}" for k in range(m.nq)), *(f"qvel{k}" for k in range(m.nv)), *(f"ctrl{k}" for k in range(m.nu))]
    np.savetxt(log, rows, delimiter=",", header=",".join(names), comments="", fmt="%.17g")
    said = answer("compare", log, a)
    first = said["causes"][0]  # servos, dry friction and Euler's step differ a little in MuJoCo, too
    assert first["name"] == "damping" and first["explained"] > 0.15
    values = [[float(x) for x in re.findall(r' damping="([^"]*)"', f.read_text())] for f in (a, b)]
    at = int(np.argmax(np.abs(np.subtract(*values))))
    assert first["differences"][0]["what"] == f"joint 'j{at}': damping"
    assert first["differences"][0]["a"] == pytest.approx(values[1][at], rel=0.05)
    turned = answer("compare", a, log)
    assert turned["causes"][0]["name"] == "damping" and any("B is the log" in w for w in turned["warnings"])


def test_two_logs(tmp_path):
    robot, logs = ROBOTS / "double_pendulum.urdf", [tmp_path / "a.csv", tmp_path / "b.csv"]
    for log, q in zip(logs, ("1,0.5", "1,0.501")):
        run("sim", robot, "--fixed", "--q", q, "--duration", "0.2", "--dt", "0.001", "--csv", log, "--no-error-estimate")
    said = answer("compare", *logs)
    assert said["causes"][0]["name"] == "start" and said["causes"][0]["differences"][0]["what"] == "q1" and said["begins"] == 0
    both = answer("compare", *logs, "--fixed", "--model", robot)
    assert both["log_a"]["causes"] == [] and both["log_b"]["causes"] == []  # each is a motion of the model
    assert "B beside the model" in run("compare", *logs, "--fixed", "--model", robot)


def test_pages_and_pictures(tmp_path):
    a, b = tmp_path / "a.xml", tmp_path / "b.xml"
    a.write_text(arm(np.random.default_rng(SEED))), b.write_text(arm(np.random.default_rng(SEED), "mass"))
    page, picture = tmp_path / "page.html", tmp_path / "picture.svg"
    text = run("compare", a, b, "--html", page, "--svg", picture)
    assert "mass" in text and "divergence begins at" in text
    assert picture.read_text().count("<polyline") == 4 and "without mass" in picture.read_text()
    assert page.read_text().count("<svg") == 1 and "http" not in page.read_text().replace("http://www.w3.org/2000/svg", "")


def write(path, text):
    path.write_text(text)
    return path


@pytest.mark.parametrize("log, message", [
    ("", "at least two rows"), ("1,2\n3,4\n", ":1: the first line holds numbers"), ("t,q0\n0,1\n", "at least two rows"),
    ("x,q0\n0,1\n1,2\n", "no column t"), ("t,q0,q1,v0,v1\n0,0,0,0\n", ":2: there are 4 columns"),
    ("t,q0,q1,v0,v1\n0,0,0,0,x\n1,0,0,0,0\n", ':2: "x" is not a finite number'), ("t,q0,v0\n0,0,0\n1,0,0\n", "columns of positions"),
    ("t,q0,q1,v0,v1\n1,0,0,0,0\n1,0,0,0,0\n", "t must grow"), ("t,q0,q0,v0\n", 'two columns "q0"'),
    ("t,q0,q1,v0,v1,ctrl0\n0,0,0,0,0,0\n1,0,0,0,0,0\n", "columns of controls"),
])  # fmt: skip
def test_logs_that_are_refused(log, message, tmp_path):
    said = run("compare", write(tmp_path / "log.csv", log), ROBOTS / "double_pendulum.urdf", "--fixed", status=1)
    assert message in said and "log.csv" in said


@pytest.mark.parametrize("words, status, message", [
    (("/none.urdf",), 1, "/none.urdf"), ((ROBOTS / "double_pendulum.urdf", "--layout-a", "mujoco"), 2, "no log"),
    ((ROBOTS / "double_pendulum.urdf", "--model", "x"), 2, "--model"), ((), 2, "B is required"),
    ((ROBOTS / "double_pendulum.urdf", "--integrator-b", "euler"), 2, "euler"),
    ((ROBOTS / "double_pendulum.urdf", "--dt-b", "-1"), 2, '--dt-b: "-1" is no positive number of seconds'),
    ((ROBOTS / "double_pendulum.urdf", "--dt-b", "nan"), 2, '--dt-b: "nan" is no positive number of seconds'),
    ((ROBOTS / "double_pendulum.urdf", "--q-b", "1"), 1, "--q has 1 numbers"),
    ((ROBOTS / "double_pendulum.urdf", "--svg", "/none/a.svg"), 1, "/none/a.svg"),
])  # fmt: skip
def test_bad_usage(words, status, message):
    assert message in run("compare", ROBOTS / "double_pendulum.urdf", *words, "--fixed", status=status)
