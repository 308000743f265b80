"""Every example runs by itself, as a newcomer would run it, keeps what it claims (each asserts it), and prints what it found."""

import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import CAPI
from command import CLI

import libdyn as dyn

EXAMPLES = CAPI / "python" / "examples"
# arguments, and what a reader finds in the answer
RUNS = {
    "accuracy_study": ([], "cheapest for"),
    "derivatives": ([], "best:"),
    "effects_study": ([], "the scene does without damping"),
    "four_bar": ([], "3 redundant"),
    "grasp": ([], "the knuckle needs"),
    "gravity_compensation": ([], "bit for bit"),
    "identification": ([], "torques determine"),
    "inverse_kinematics": (["100"], "dyn's ik met"),
    "learn": (["cart_pole", "--actions", "60000", "--envs", "32", "--goal", "100"], "mean return"),
    "operational_space": ([], "mrad off"),
    "pushes": ([], "stand after a kick"),
    "quadruped_project": ([], "nq 19, nv 18, 14 joints"),
    "quadruped_stands": (["5"], "pushed from the left"),
    "self_collision": ([], "keep 10 mm away"),
    "standing": ([], "share of the cone"),
    "swing_up": ([], "it ends upright"),
    "thrown_box": ([], "4 corners carry"),
    "two_muscles": ([], "times as stiff"),
}


def run(script, *arguments):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(dyn.__file__).parents[1]),
                                                                os.environ.get("PYTHONPATH", "")])}
    return subprocess.run([sys.executable, str(script), *arguments], capture_output=True, text=True, timeout=300, env=environment)


def test_all_of_them_are_here():
    assert sorted(RUNS) == sorted(p.stem for p in EXAMPLES.glob("*.py"))


@pytest.mark.parametrize("name", RUNS)
def test_example(name):
    if name.endswith("_study") and not CLI:
        pytest.skip("the command dyn is not built")
    arguments, said = RUNS[name]
    done = run(EXAMPLES / f"{name}.py", *arguments)
    assert done.returncode == 0, done.stdout + done.stderr
    assert said in done.stdout and not done.stderr


def test_what_stood_is_simulated_again(tmp_path):
    """dyn sim ends where the quadruped did, by the torques alone: without its controller, and with nothing in between."""
    if not CLI:
        pytest.skip("the command dyn is not built")
    done = run(EXAMPLES / "quadruped_stands.py", "2", "--record", str(tmp_path))
    assert done.returncode == 0, done.stdout + done.stderr
    setting = "--floating --ground --effects armature,limits --duration 2 --dt 1e-3 --no-error-estimate --json".split()
    command = [CLI, "sim", str(CAPI.parent / "models/robots/go2.urdf"), *setting, "--state", str(tmp_path / "stands.json"),
               "--tau-csv", str(tmp_path / "stands.csv")]
    again = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    away = [x - y for x, y in zip(again["q"][:3], json.loads((tmp_path / "stands.json").read_text())["q"][:3])]
    assert f"at the end {1e3 * math.hypot(*away):.3g} mm from home, speed {max(map(abs, again['v'])):.2g}" in done.stdout


def test_the_picture_of_a_push(tmp_path):
    pytest.importorskip("matplotlib")
    done = run(CAPI.parent / "bench" / "picture.py", "--svg", str(tmp_path / "quadruped.svg"))
    assert done.returncode == 0, done.stderr
    carried, weight = (float(x) for x in re.search(r"carry ([\d.]+) N of ([\d.]+) N", done.stdout).groups())
    assert abs(carried - weight) < 0.1 and (tmp_path / "quadruped.svg").stat().st_size > 10000
