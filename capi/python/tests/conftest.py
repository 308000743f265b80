"""Robots and helpers of the tests. Environment: DYN_LIBRARY (the library), DYN_CLI (the command), DYN_MODELS_DIR (models/)."""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CAPI = Path(__file__).resolve().parents[2]
try:
    import libdyn as dyn
except ModuleNotFoundError:  # not installed: the package of this checkout
    sys.path.insert(0, str(CAPI / "python"))
    import libdyn as dyn

MODELS = Path(os.environ.get("DYN_MODELS_DIR", CAPI.parent / "models"))

INERTIAL = '<inertial><origin xyz="0 0 -0.5"/><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
ARM = f"""<robot name="arm">
  <link name="base"/>
  <link name="upper">{INERTIAL}</link>
  <link name="lower">{INERTIAL}<collision name="tip"><geometry><sphere radius="0.05"/></geometry></collision></link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2.5" effort="30" velocity="4"/><dynamics damping="0.1" friction="0.2"/></joint>
  <joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -1"/><axis xyz="0 1 0"/></joint>
  <joint name="flange" type="fixed"><parent link="lower"/><child link="tool"/><origin xyz="0 0 -1"/></joint>
</robot>"""


@pytest.fixture
def arm():
    """Two links of 1 kg that hang down: nq = nv = 2."""
    return dyn.load_string(ARM, base="fixed")


@pytest.fixture(scope="session")
def go2():
    """A quadruped: nq 19, nv 18."""
    return dyn.load(MODELS / "robots" / "go2.urdf", base="floating")


@pytest.fixture(scope="session")
def gripper():
    """One driven joint, seven that follow."""
    return dyn.load(MODELS / "robots" / "gripper.urdf", base="fixed")


@pytest.fixture
def state(go2):
    """A random (q, v, a, tau) of go2."""
    import numpy as np

    random = np.random.default_rng(7)
    return (go2.random(7), *(random.standard_normal(go2.nv) for _ in range(3)))


def bench_problem(name):
    """A problem of bench/accuracy: its model, start, duration and closed form."""
    spec = importlib.util.spec_from_file_location("bench_problems", CAPI.parent / "bench/accuracy/problems.py")
    problems = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(problems)
    return getattr(problems, name)()


@pytest.fixture(scope="session")
def wheel(tmp_path_factory):
    """The wheel of the checkout, and the folder of the libraries that it was built from."""
    if not importlib.util.find_spec("pip"):
        pytest.skip("pip is not installed")
    if not (CAPI / "python/build_backend").is_dir():
        pytest.skip("not a checkout")
    work = tmp_path_factory.mktemp("wheel")
    checkout = work / "checkout"  # of what the build reads, so that nothing is written beside the sources
    shutil.copytree(CAPI / "python", checkout / "capi/python", ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
    shutil.copytree(CAPI.parent / "models", checkout / "models")
    shutil.copy(CAPI.parent / "LICENSE", checkout)
    library = Path(dyn.library_path).resolve().parent
    installed = work / "prefix/lib"  # a tree with this library, its command and its header
    installed.mkdir(parents=True)
    for file in [*library.glob("libdyn.so.1"), *library.glob("libdyn_mesh.so")]:
        shutil.copy(file, installed / file.name)
    (work / "prefix/bin").mkdir()
    try:
        shutil.copy(dyn.accuracy.command(), work / "prefix/bin/dyn")
    except dyn.LibraryError:
        pass  # not built
    shutil.copytree(CAPI.parent / "include", work / "prefix/include")
    command = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", str(work),
               str(checkout / "capi/python")]
    subprocess.run(command, check=True, env={**os.environ, "DYN_PREFIX": str(work / "prefix")}, cwd=work)
    (found,) = work.glob("*.whl")
    return found, installed
