"""The page of lists says what the library says."""

import subprocess
import sys
from pathlib import Path

import pytest
from conftest import CAPI, MODELS
from command import CLI

import libdyn as dyn
from libdyn.choices import member

BENCH = CAPI.parent / "bench"
if not (BENCH / "lists.py").exists():  # an installed package without its checkout
    pytest.skip("no bench here", allow_module_level=True)
sys.path.insert(0, str(BENCH))
lists = pytest.importorskip("lists")


def test_the_page_is_current():
    assert lists.PAGE.read_text(encoding="utf-8") == lists.page(), "bench/lists.py writes it anew"


@pytest.mark.parametrize("title", lists.SECTIONS)
def test_every_row_is_filled(title):
    rows = lists.SECTIONS[title]().splitlines()[2:]
    assert rows and all(row.split(" | ")[0].strip("| `") for row in rows)


def test_a_wrong_name_is_answered_by_the_nearest():
    with pytest.raises(dyn.ArgumentError, match="member of dyn.Algorithm; did you mean 'rnea'"):
        member(dyn.Algorithm, "rnae", "algorithm")
    with pytest.raises(dyn.ArgumentError, match="one of .*RK4.*; did you mean 'rk4'"):
        member(dyn.Integrator, "rk", "integrator")
    with pytest.raises(dyn.ArgumentError, match="RK4[^;]*[.]$"):
        member(dyn.Integrator, "something else", "integrator")


@pytest.mark.skipif(not CLI or not Path(CLI).exists(), reason="no command here")
def test_eval_names_the_nearest_quantity():
    words = [CLI, "eval", MODELS / "robots/panda.urdf", "--fixed", "--compute", "taau"]
    refused = subprocess.run(words, capture_output=True, text=True)
    assert refused.returncode == 2
    assert 'unknown name "taau" (did you mean "tau"?)' in refused.stderr and len(refused.stderr) < 150
