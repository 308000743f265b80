"""Evaluations that the page measured_accuracy.md states, made again: a change that makes libdyn dearer must publish it."""

from __future__ import annotations

import sys

import pytest
from conftest import CAPI

ACCURACY = CAPI.parent / "bench/accuracy"
pytestmark = pytest.mark.skipif(not ACCURACY.is_dir(), reason="needs the repository's bench/accuracy")
AGAIN = {"box": "box", "heavy-top": "heavy_top", "chain": "planar_chain", "slide": "slide", "drag": "drag",
         "stack": "stack"}  # fmt: skip
MOST = 1.05


@pytest.fixture
def counts(monkeypatch):
    monkeypatch.setattr(sys, "path", [str(ACCURACY), *sys.path])
    import counts

    return counts


def test_the_table_is_whole(counts):
    rows = counts.published(CAPI / "pages/measured_accuracy.md")
    assert len({name for name, *_ in rows}) == 14
    assert {level for _, level, *_ in rows} == set(counts.LEVELS)


@pytest.mark.parametrize("name", AGAIN)
def test_published_counts_hold(name, counts):
    import problems
    import run_dyn

    problem = getattr(problems, AGAIN[name])()
    scene = run_dyn.Scene(problem)
    reference, _ = counts.reference_of(problem)
    rows = [row for row in counts.published(CAPI / "pages/measured_accuracy.md") if row[0] == problem.name]
    assert len(rows) >= 3
    for _, level, evaluations, method, value in rows:
        again, error = counts.run(scene, reference, method, value)
        assert again <= MOST * evaluations, (level, method, value)
        assert error <= 1.05 * level, (level, method, value)  # other processors round otherwise
