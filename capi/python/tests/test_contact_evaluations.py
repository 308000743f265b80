"""Evaluations that an accuracy takes where shapes slide, press, roll and bounce: counts, which depend on no clock."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

ACCURACY = Path(__file__).resolve().parents[3] / "bench/accuracy"
pytestmark = pytest.mark.skipif(not ACCURACY.is_dir(), reason="needs the repository's bench/accuracy")

# Evaluations of ten calls of advance for each accuracy, 1.05 of what was measured.
MOST = {
    "drag": {1e-2: 190, 1e-4: 270, 1e-6: 1560},
    "slide": {1e-2: 195, 1e-4: 233, 1e-6: 302},
    "stack": {1e-2: 190, 1e-4: 190, 1e-6: 190},
    "rolling": {1e-2: 190, 1e-4: 190, 1e-6: 190},
    "bouncing": {1e-2: 298, 1e-4: 924, 1e-6: 802},
}


@pytest.mark.parametrize("name", MOST)
def test_contact_takes_few_evaluations_and_meets_the_accuracy(name, monkeypatch):
    monkeypatch.setattr(sys, "path", [str(ACCURACY), *sys.path])
    import problems
    import run_dyn

    problem = getattr(problems, name)()
    scene = run_dyn.Scene(problem)
    exact = np.array([problem.exact((k + 1) * problem.duration / 10) for k in range(10)])
    axes = list(problem.axes or (0, 1, 2))
    for accuracy, most in MOST[name].items():
        scene.data.set_step_options("rk45", dt=1e-3, accuracy=accuracy)
        scene.begin()
        places = []
        for k in range(10):
            scene.move(k)
            places.append(scene.look())
        assert scene.evaluations <= most, accuracy
        assert np.abs(np.array(places) - exact)[..., axes].max() <= 10 * accuracy  # each call may err by the accuracy
