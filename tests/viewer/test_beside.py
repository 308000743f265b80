"""Plots by body, and two recordings in one page."""

import os
import sys

import pytest
from conftest import MODELS, ROOT, dyn

sys.path.insert(0, str(ROOT / "capi" / "python"))

SCENE = """<mujoco><worldbody><geom type="plane" size="1 1 1"/><body name="box" pos="0 0 {}"><freejoint name="free"/>
<geom type="box" size="0.1 0.1 0.1" mass="2"/></body></worldbody></mujoco>"""


@pytest.fixture
def libdyn(bundle, monkeypatch):
    monkeypatch.setenv("DYN_CLI", os.fspath(dyn.command))
    return pytest.importorskip("libdyn", reason="the package libdyn finds no library")


def dropped(libdyn, height, duration):
    """A box that falls from a height."""
    sim = libdyn.Simulation(libdyn.load_string(SCENE.format(height)), dt=2e-3)
    with sim.record() as recording:
        sim.run(duration)
    return recording


@pytest.fixture
def two(libdyn, tmp_path):
    low, high = dropped(libdyn, 0.1, 0.2), dropped(libdyn, 0.5, 0.3)
    low.to_html(tmp_path / "two.html", beside=high, labels=("low", "high"))
    return tmp_path / "two.html", low, high


def test_two_recordings_share_a_time_line(page, two):
    path, low, high = two
    page.open(f"file://{path}")
    page("dynView.player.play(false)")
    assert page("Number(document.getElementById('scrub').max)") == pytest.approx(high.t[-1], abs=1e-6)
    for t in (0.0, 0.1, 0.3):
        page(f"dynView.player.seek({t})")
        heights = page("[dynView.robot, dynView.beside.robot].map((r) => r.joints[1].position.z)")
        last = min(t, low.t[-1])  # one that has ended stays where it was
        assert heights[0] == pytest.approx(low.q[abs(low.t - last).argmin(), 2], abs=2e-3)
        assert heights[1] == pytest.approx(high.q[abs(high.t - t).argmin(), 2], abs=1e-2)
    assert "low" in page("document.getElementById('header').textContent")
    assert page.complaints == []


def test_beside_or_over(page, two):
    """Both are in the picture; the switch moves the second one over the first."""
    page.open(f"file://{two[0]}")
    page("dynView.player.play(false), dynView.player.seek(0)")
    for robot in ("robot", "beside.robot"):
        assert page.changed(f"dynView.{robot}.root.visible = false") > 0.005
        page(f"dynView.{robot}.root.visible = true")
    assert page("dynView.beside.robot.joints[1].matrixWorld.elements[13]") > 0.2
    page.page.click("#show-beside")
    assert page("dynView.beside.robot.joints[1].matrixWorld.elements[13]") == pytest.approx(0, abs=1e-6)
    page.page.click("#show-collision")  # switches are those of both
    assert page("[dynView.robot, dynView.beside.robot].map((r) => r.pickable.some((m) => m.visible))") == [False, False]


def test_plots_have_the_curves_of_both(page, two):
    path, low, high = two
    page.open(f"file://{path}")
    page("dynView.player.play(false), dynView.player.seek(0.1)")
    q = "dynView.plots.find((p) => p.plot.title === 'q')"
    names = page(f"{q}.plot.names")
    assert names[:2] == ["free[0] (low)", "free[0] (high)"] and len(names) == 14
    assert page(f"{q}.plot.origins.slice(0, 2).map((o) => [o.colour, o.dashed])") == [[0, False], [0, True]]
    # heights at the last moment that both have, and afterwards only the longer one's
    rows = page(f"Array.from({q}.time, (t, k) => [t, ...{q}.plot.values.slice(14 * k + 4, 14 * k + 6)]"
                ".map((x) => isNaN(x) ? null : x))")
    assert [t for t, *_ in rows] == sorted(t for t, *_ in rows)
    for t, a, b in rows:
        assert (a is None) == (t > low.t[-1] + 1e-6)
        assert b == pytest.approx(high.q[abs(high.t - t).argmin(), 2], abs=2e-2)


def test_plots_by_body(page, libdyn, tmp_path):
    """A group for each body, with the curves of its joint and its contact forces, and a field that searches."""
    sim = libdyn.Simulation(MODELS / "scenes/go2_stands.xml", "standing")
    with sim.record() as recording:
        sim.run(0.1)
    recording.to_html(tmp_path / "go2.html")
    page.open(f"file://{tmp_path}/go2.html")
    page("dynView.player.play(false), dynView.player.seek(0.05)")
    page.page.select_option("#plots-by", "body")
    groups = "[...document.querySelectorAll('#search-bodies ~ details')]"
    assert page(f"{groups}.length") == 13
    page.page.locator("#search-bodies").fill("fl_calf")
    shown = page(f"{groups}.filter((g) => !g.hidden).map((g) => g.querySelector('summary').textContent)")
    assert len(shown) == 1 and "FL_calf" in shown[0]
    page(f"{groups}.find((g) => !g.hidden).open = true")
    page.settle()
    page.settle()
    inner = page(f"{groups}.find((g) => !g.hidden).querySelectorAll('.plot canvas').length > 0")
    assert inner
    mine = page("dynView.plots.filter((p) => p.plot.names.join() === 'FL_calf_joint').map((p) => p.plot.title)")
    assert {"q", "v", "tau"} <= set(mine)
    i = sim.model.joint("FL_calf_joint").idx_q
    angle = page("dynView.plots.findLast((p) => p.plot.title === 'q').plot.values[0]")
    assert angle == pytest.approx(recording.q[0, i], abs=1e-3)
    page.page.select_option("#plots-by", "quantity")
    assert page("document.getElementById('search-bodies').checkVisibility()") is False
    assert page.complaints == []
