"""What type checkers see: stubs that are those of the library's tables, and a user's program, right and wrong, through mypy where it is installed."""

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import libdyn as dyn
from libdyn import stubs

PACKAGE = Path(dyn.__file__).parent
RIGHT = """
import numpy as np
import libdyn as dyn

m: dyn.Model = dyn.load("x.urdf", base="floating", gravity=(0, 0, -1))
d: dyn.Data = m.data(parts=("inverse", dyn.Part.MASS))
q: np.ndarray = m.random(seed=1)
tau: np.ndarray = d.rnea(q, np.zeros(m.nv), [0.0] * m.nv)
M: np.ndarray = d.M
t: float = d.time
d.q = q
energy: float = d.energy(q).mechanical
batch: dyn.Batch = m.batch(threads=2)
many: np.ndarray = batch.rnea(np.tile(q, (3, 1)), out=np.zeros((3, m.nv)))
place: dyn.Placement = batch.frame_placement("foot", q)
r: dyn.Rollout = dyn.batch.rollout(m, q, steps=10, sensors={"com": "com"})
com: np.ndarray = r.sensors["com"]
sim: dyn.Simulation = dyn.Simulation(m, dt=1e-3)
x: dyn.Trajectory = sim.run(1.0, lambda s: [0.0])
"""
WRONG = {
    "d.Mass": "has no attribute",
    "d.M = 1": "read-only",
    "batch.rneo(q)": "has no attribute",
    "m.nq()": "not callable",
    "d.rnea(x=1)": "Unexpected keyword",
    "dyn.load(3)": "incompatible type",
    "batch.rnea()": "Missing positional argument|Too few arguments",
}


@pytest.mark.parametrize("name", stubs.STUBS)
def test_stubs_are_those_of_the_library(name):
    written = (PACKAGE / name).read_text(encoding="utf-8")
    assert written == stubs.STUBS[name](), "run python -m libdyn.stubs"
    assert (PACKAGE / "py.typed").exists()


@pytest.mark.skipif(not importlib.util.find_spec("mypy"), reason="mypy is not installed")
def test_a_users_program(tmp_path):
    wrong = RIGHT + "".join(f"{line}\n" for line in WRONG)
    (tmp_path / "right.py").write_text(RIGHT)
    (tmp_path / "wrong.py").write_text(wrong)
    where = {} if "site-packages" in PACKAGE.parts else {"MYPYPATH": str(PACKAGE.parent)}  # mypy finds an installed package, and wants no path to it
    out = subprocess.run(
        [sys.executable, "-m", "mypy", "--follow-imports=silent", "--strict", "--allow-any-generics", "--cache-dir", str(tmp_path / "cache"), "right.py", "wrong.py"],
        cwd=tmp_path, capture_output=True, text=True, env=os.environ | where,
    ).stdout  # fmt: skip
    errors = {}
    for file, line, message in re.findall(r"^(\w+)\.py:(\d+): error: (.*)$", out, re.M):
        errors.setdefault((file, int(line)), "")
        errors[file, int(line)] += message
    assert not [e for e in errors if e[0] == "right"], out
    begin = RIGHT.count("\n") + 1
    assert sorted(line for _, line in errors) == list(range(begin, begin + len(WRONG))), out
    for k, (line, words) in enumerate(WRONG.items()):
        assert re.search(words, errors["wrong", begin + k]), (line, errors["wrong", begin + k])
