"""What type checkers see: stubs that are those of the library's tables, and a user's program, right and wrong, through mypy where it is installed."""

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from conftest import CAPI
from libdyn import stubs

RIGHT = """
import numpy as np
from numpy.typing import NDArray
import libdyn as dyn

m: dyn.Model = dyn.load("x.urdf", base="floating", gravity=(0, 0, -1))
d: dyn.Data = m.data(parts=("inverse", dyn.Part.MASS))
q: NDArray[np.float64] = m.random(seed=1)
tau: NDArray[np.float64] = d.rnea(q, np.zeros(m.nv), [0.0] * m.nv)
M: NDArray[np.float64] = d.M
d.set_step_options(integrator="rk4", solver=dyn.ContactSolverType.ADMM)
dq: NDArray[np.float64] = d.rnea_derivatives(q).dtau_dq
v: NDArray[np.float64] = d.frame_velocity("foot", "world")
t: float = d.time
d.q = q
energy: float = d.energy(q).kinetic
batch: dyn.Batch = m.batch(threads=2)
many: NDArray[np.float64] = batch.rnea(np.tile(q, (3, 1)), out=np.zeros((3, m.nv)))
place: dyn.Placement = batch.frame_placement("foot", q)
r: dyn.Rollout = dyn.batch.rollout(m, q, steps=10, sensors={"com": "com"})
com: NDArray[np.float64] = r.sensors["com"]
limits: NDArray[np.float64] = m.lower_limit
arms: NDArray[np.float64] = d.tendons(q).J
path: NDArray[np.float64] = d.tendon_path("cord").points
cord: dyn.Tendon = m.tendon("cord")
b: dyn.Builder = dyn.Builder("x").add_joint("j", "revolute", axis=(0, 1, 0), damping=0.1)
b.add_tendon("cord", [("joint", "j", 2.0), dyn.TendonElement("joint", "j")], dyn.Tendon("fixed"), stiffness=3.0)
b.add_actuator("m", "cord", dyn.Actuator("muscle", transmission="tendon", muscle=dyn.Muscle(30, lmax=1.5)))
sim: dyn.Simulation = dyn.Simulation(m, dt=1e-3)
x: dyn.Trajectory = sim.run(1.0, lambda s: [0.0])
sim.step(5, tau={"j": 1.0})
sim.step(ctrl=[0.0])
imu: NDArray[np.float64] = sim.sensors["imu"]
recording: dyn.Recording = sim.record(every=5)
rows: NDArray[np.float64] = recording.sensors["imu"]
recording.to_html("page.html")
recording.to_mp4("film.mp4", 320, 240, camera=dyn.Camera(azimuth=30.0), fps=20)
shot: NDArray[np.uint8] = sim.picture(320, 240, dyn.Camera((0, 0, 1)), smooth=False)
shot = dyn.Renderer(m, 64, 48, role="collision").render(q)
dyn.write_png(shot, "x.png")
other: dyn.Model = dyn.vary(m, 1, mass=0.2, contact_friction=(0.5, 1.2), com=0.01)
other = dyn.with_inertial_parameters(m, m.inertial_parameters())
other = dyn.load_description("go2_description", base="floating")
seen: dyn.Viewer = dyn.view(sim, lambda s: None)
written: str = dyn.view(recording, open=False)
X: dyn.Placement = place.inverse() @ dyn.Placement.exp([0.0] * 6)
point: NDArray[np.float64] = X @ [0.0, 0.0, 1.0]
J: NDArray[np.float64] = dyn.spatial.Jexp6(X.log(), "left")
impulses: NDArray[np.float64] = d.lambda_
"""
WRONG = {
    "d.Mass": "has no attribute",
    "d.M = 1": "read-only",
    "batch.rneo(q)": "has no attribute",
    "m.nq()": "not callable",
    "d.rnea(x=1)": "Unexpected keyword",
    "dyn.load(3)": "incompatible type",
    'dyn.load("x.urdf", base="fixd")': "incompatible type",
    'd.set_step_options(integrator="euler")': "incompatible type",
    'm.data(parts="mas")': "incompatible type",
    'd.frame_velocity("foot", "lokal")': "incompatible type",
    "m.joint_names = 3": "has no attribute",
    'b.add_joint("j", "hinge")': "incompatible type",
    'dyn.Tendon("spatal")': "incompatible type",
    'dyn.Actuator(transmission="tendo")': "incompatible type",
    'b.add_joint("j", "revolute", dampin=1)': "Unexpected keyword",
    "f: NDArray[np.float32] = d.M": "Incompatible types",
    "sim.step(control=[0.0])": "Unexpected keyword",
    'dyn.spatial.Jexp6(q, "middle")': "incompatible type",
    "dyn.view(3)": "No overload",
    'dyn.Renderer(m, role="inside")': "incompatible type",
    'dyn.vary(m, 1, mass="much")': "incompatible type",
    "batch.rnea()": "Missing positional argument|Too few arguments",
}



@pytest.fixture(scope="session")
def site(wheel, tmp_path_factory):
    """A folder with the installed package: stubs are written when it is built."""
    folder = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(wheel[0]) as z:
        z.extractall(folder)
    return folder


def test_stubs_are_those_of_the_library(site, tmp_path):
    stubs.write(tmp_path)
    for name in stubs.STUBS:
        assert ((site / "libdyn" / f"{name}.pyi").read_text(encoding="utf-8")
                == (tmp_path / f"{name}.pyi").read_text(encoding="utf-8"))
        compile((tmp_path / f"{name}.pyi").read_text(encoding="utf-8"), name, "exec")
    assert (site / "libdyn" / "py.typed").exists()


def judged(out, begin):
    """Errors by file and line, of a checker's output."""
    errors = {}
    for file, line, message in re.findall(r"(\w+)\.py:(\d+)(?::\d+)?(?: -|:) error:? (.*)$", out, re.M):
        errors[file, int(line)] = errors.get((file, int(line)), "") + message
    assert not [e for e in errors if e[0] == "right"], out
    assert sorted({line for _, line in errors}) == list(range(begin, begin + len(WRONG))), out
    return {line: message for (_, line), message in errors.items()}


@pytest.fixture
def programs(tmp_path):
    (tmp_path / "right.py").write_text(RIGHT)
    (tmp_path / "wrong.py").write_text(RIGHT + "".join(f"{line}\n" for line in WRONG))
    return tmp_path


@pytest.mark.skipif(not importlib.util.find_spec("mypy"), reason="mypy is not installed")
def test_mypy(programs, site):
    command = [sys.executable, "-m", "mypy", "--follow-imports=silent", "--strict", "--allow-any-generics", "--cache-dir",
               str(programs / "cache"), "right.py", "wrong.py"]
    out = subprocess.run(command, cwd=programs, capture_output=True, text=True, env=os.environ | {"MYPYPATH": str(site)}).stdout
    errors = judged(out, RIGHT.count("\n") + 1)
    for k, (line, words) in enumerate(WRONG.items()):
        message = errors[RIGHT.count("\n") + 1 + k]
        assert re.search(words, message), (line, message)


# a newcomer's eight programs
EXAMPLES = ("gravity_compensation", "inverse_kinematics", "operational_space", "swing_up", "thrown_box", "pushes", "identification",
            "self_collision")


@pytest.mark.skipif(not importlib.util.find_spec("mypy"), reason="mypy is not installed")
def test_mypy_of_examples(site, tmp_path):
    command = [sys.executable, "-m", "mypy", "--follow-imports=silent", "--strict", "--allow-any-generics", "--cache-dir",
               str(tmp_path), *(f"{name}.py" for name in EXAMPLES)]
    done = subprocess.run(command, cwd=CAPI / "python" / "examples", capture_output=True, text=True,
                          env=os.environ | {"MYPYPATH": str(site)})
    assert done.returncode == 0, done.stdout


@pytest.fixture(scope="module")
def pyright():
    """Its command. The package fetches the program at its first call."""
    command = [sys.executable, "-m", "pyright"]
    if not importlib.util.find_spec("pyright") or subprocess.run([*command, "--version"], capture_output=True).returncode != 0:
        pytest.skip("pyright is not installed, or could not be fetched")
    return [*command, "--pythonpath", sys.executable]


def test_pyright(programs, site, pyright):
    (programs / "pyrightconfig.json").write_text(json.dumps({"extraPaths": [str(site)], "pythonVersion": "3.9"}))
    done = subprocess.run([*pyright, "right.py", "wrong.py"], cwd=programs, capture_output=True, text=True)
    judged(done.stdout, RIGHT.count("\n") + 1)


# modules whose classes are derived from those of another package: unknown where that is not installed
BASES = {"gym": "gymnasium", "sb3": "stable_baselines3", "doors.crocoddyl": "crocoddyl"}


def test_pyright_knows_every_type(site, pyright):
    env = os.environ | {"PYTHONPATH": str(site), "PATH": os.pathsep.join([os.path.dirname(sys.executable), os.environ["PATH"]])}
    done = subprocess.run([*pyright, "--verifytypes", "libdyn", "--ignoreexternal", "--outputjson"], cwd=site, env=env,
                          capture_output=True, text=True)
    symbols = json.loads(done.stdout)["typeCompleteness"]["symbols"]
    assert sum(s["isExported"] for s in symbols) > 3000
    absent = tuple(f"libdyn.{module}." for module, package in BASES.items() if not importlib.util.find_spec(package))
    unknown = {s["name"]: [d["message"] for d in s.get("diagnostics", [])] for s in symbols
               if (not s["isTypeKnown"] or s["isTypeAmbiguous"]) and not s["name"].startswith(absent)}
    assert not unknown


@pytest.mark.skipif(int(np.__version__.split(".")[0]) < 2, reason="stubs of numpy before 2 leave types unknown to strict mode")
def test_pyright_of_examples(site, tmp_path, pyright):
    for name in EXAMPLES:
        shutil.copy(CAPI / "python" / "examples" / f"{name}.py", tmp_path)
    # of this Python: the stubs of new numpy have syntax that 3.9 lacks
    (tmp_path / "pyrightconfig.json").write_text(json.dumps({"extraPaths": [str(site)], "typeCheckingMode": "strict"}))
    done = subprocess.run(pyright, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
