"""Every URDF of the package example-robot-data loads, but for two that are no robots."""

import sys
from pathlib import Path

import libdyn as dyn
import numpy as np
import pytest

FOLDERS = [Path(p) / "cmeel.prefix" / "share" / "example-robot-data" / "robots" for p in sys.path]
FILES = sorted(f for folder in FOLDERS for f in folder.rglob("*.urdf"))
REFUSED = {"ur3": "the robot has no links", "alex_psyonic_hands": "mimics 'index_q1', which is not in the file"}

pytestmark = [
    pytest.mark.skipif(not FILES, reason="package example-robot-data is not installed"),
    pytest.mark.filterwarnings("ignore::libdyn.LoadWarning"),
]


def load(file, base):
    return dyn.load(file, base=base, package_dirs=file.parents[2], meshes="none")


@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_all_but_two_load(base):
    refused = {}
    for file in FILES:
        try:
            assert load(file, base).nv >= (6 if base == "floating" else 0)
        except dyn.Error as error:
            refused[file.stem] = str(error)
    assert refused.keys() == REFUSED.keys()
    for name, reason in REFUSED.items():
        assert reason in refused[name]


def test_a_floating_base_adds_six_to_what_is_fixed():
    for file in (f for f in FILES if f.stem not in REFUSED):
        fixed, floating = load(file, "fixed"), load(file, "floating")
        assert floating.nv == fixed.nv + 6
        v = np.random.default_rng(1).normal(size=fixed.nv)
        held = np.r_[np.zeros(6), v]  # with its base at rest, the floating robot has the fixed one's energy
        energy = fixed.data().kinetic_energy(fixed.neutral(), v)
        assert floating.data().kinetic_energy(floating.neutral(), held) == pytest.approx(energy, rel=1e-12)
