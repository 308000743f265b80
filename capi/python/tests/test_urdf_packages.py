"""Every URDF of the package example-robot-data loads, but for two that are no robots."""

import sys
from pathlib import Path

import libdyn as dyn
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


def test_all_but_two_load_with_a_fixed_base():
    refused = {}
    for file in FILES:
        try:
            assert load(file, "fixed").nq >= 0
        except dyn.Error as error:
            refused[file.stem] = str(error)
    assert refused.keys() == REFUSED.keys()
    for name, reason in REFUSED.items():
        assert reason in refused[name]


def test_with_a_floating_base_load_all_that_their_file_does_not_join_to_the_world():
    for file in (f for f in FILES if f.stem not in REFUSED):
        fixed = load(file, "fixed")
        try:
            assert load(file, "floating").nv == fixed.nv + 6
        except dyn.Error as error:
            assert "the file joins the robot to link 'world'" in str(error)
