"""A simulation of the Python package in a browser: sliders of its controls, single steps."""

import os
import sys
import threading

import pytest
from conftest import MODELS, ROOT, dyn

sys.path.insert(0, str(ROOT / "capi" / "python"))


@pytest.fixture
def viewer(bundle, monkeypatch):
    monkeypatch.setenv("DYN_CLI", os.fspath(dyn.command))
    libdyn = pytest.importorskip("libdyn", reason="the package libdyn finds no library")
    simulation = libdyn.Simulation(MODELS / "scenes/go2_stands.xml", "standing")
    with simulation.view(open=False) as viewer:
        thread = threading.Thread(target=viewer.run)
        thread.start()
        yield viewer
    thread.join(20)
    assert not thread.is_alive()


def test_sliders_hold_controls(page, viewer):
    page.open(viewer.address)
    page.page.wait_for_function("dynView.live.state?.time > 0.1")
    model = viewer.simulation.model
    names = page("Array.from(document.querySelectorAll('[data-control]'), (s) => [s.dataset.control, Number(s.max)])")
    assert [name for name, _ in names] == list(model.actuator_names)
    k = model.actuator("FL_thigh").idx_u
    page(f"((s) => {{ s.value = s.max; s.dispatchEvent(new Event('input')); }})(document.querySelectorAll('[data-control]')[{k}])")
    q = model.joint("FL_thigh_joint").idx_q
    page.page.wait_for_function(f"dynView.live.state.q[{q}] > 1.0")
    assert viewer.held == {k: names[k][1]}
    page.page.wait_for_function("document.querySelectorAll('.joint.held').length === 1")
    page.page.click("#release")
    page.page.wait_for_function("document.querySelectorAll('.joint.held').length === 0")
    assert viewer.held == {} and page.complaints == []


def test_single_steps(page, viewer):
    viewer.paused = True
    page.open(viewer.address)
    page.page.wait_for_function("dynView.live.state?.paused")
    before, dt = page("dynView.live.state.time"), viewer.simulation.dt
    for k in range(1, 4):
        page.page.click("#step")
        page.page.wait_for_function(f"dynView.live.state.time > {before + (k - 0.5) * dt}")
    page.page.wait_for_timeout(100)
    assert page("dynView.live.state.time") == pytest.approx(before + 3 * dt, abs=1e-6)
