"""Error bars hold: of random scenes, with and without contact. bench/error_bars.py plays more of them."""

import numpy as np
import pytest
from error_scenes import run, scene

import libdyn as dyn


def test_error_bars_cover_the_errors_of_random_scenes():
    runs = [x for x in map(run, range(100)) if x]
    assert len(runs) > 70 and sum(x.kind != "chain" for x in runs) > 40
    known = [x for x in runs if not x.bar.lost and x.error > 1e-10]
    held = [x.error <= x.bar.q for x in known]
    assert np.mean(held) >= 0.95
    assert np.median([x.bar.q / x.error for x in known]) <= 10
    lost = [x for x in runs if x.bar.lost]
    assert all(x.error > 1e-3 for x in lost)  # they are not called so without need


def pendulum(v):
    model = dyn.load_string('<mujoco><worldbody><body pos="0 0 2"><joint axis="0 1 0"/><geom fromto="0 0 0 0 0 -1" type="capsule" '
                            'size="0.05"/><body pos="0 0 -1"><joint axis="0 1 0"/><geom fromto="0 0 0 0 0 -1" type="capsule" '
                            'size="0.05"/></body></body></worldbody></mujoco>')
    data = model.data(dyn.Part.SIMULATION)
    data.set_state([2.0, 1.0], [v, 0])
    data.set_step_options("semi_implicit_euler", dt=1e-3)
    return data


def test_a_motion_that_amplifies_errors_is_lost():
    data = pendulum(0)
    finer = data.copy()
    finer.set_step_options(dt=5e-4)
    seconds = 0
    while not data.error_bar(finer).lost and seconds < 60:
        data.advance(1.0), finer.advance(1.0)
        seconds += 1
    assert 1 < seconds < 30


def test_two_runs_that_cannot_be_compared_are_refused():
    data = pendulum(0)
    finer = data.copy()
    with pytest.raises(dyn.ArgumentError, match="finer has dt 0.001 s .* half the dt"):
        data.error_bar(finer)
    finer.set_step_options(dt=5e-4)
    finer.advance(0.1)
    with pytest.raises(dyn.ArgumentError, match="data is at 0 s and finer at 0.1 s"):
        data.error_bar(finer)
    data.advance(0.1)
    assert 0 < data.error_bar(finer).q < 1e-2
    data.set_step_options(accuracy=1e-6)
    with pytest.raises(dyn.ArgumentError, match="half the accuracy"):
        data.error_bar(finer)
    finer.set_step_options(accuracy=1e-8)
    assert data.error_bar(finer).q == pytest.approx(4 / 0.99 * np.abs(data.q - finer.q).max(), rel=1e-12)
    with pytest.raises(dyn.ModelError, match="another model"):
        data.error_bar(dyn.load_string("<mujoco><worldbody/></mujoco>").data(dyn.Part.SIMULATION))


def test_noise_of_the_contact_solver_does_not_stop_steps():
    """A chain on a floor at an accuracy near the solver's tolerance: steps fell to 1e-10 s, and never ended."""
    kind, model, q, v, *_ = scene(266)
    data = model.data(dyn.Part.SIMULATION)
    data.set_state(q, v)
    data.set_step_options(accuracy=1e-7, dt=0.1)
    evaluations = 0
    for _ in range(20):
        data.advance(0.02)
        evaluations += data.step_report.evaluations
    assert kind == "free chain" and evaluations < 100000
