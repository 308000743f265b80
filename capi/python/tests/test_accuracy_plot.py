"""dyn.accuracy: the sweep from Python is that of the command, and its diagram shows every point."""

import json
import sys

import pytest
from command import CLI, ROBOTS

import libdyn as dyn

RESULT = {
    "name": "made up",
    "duration": 1.0,
    "points": [
        {"integrator": name, "dt": dt, "accuracy": accuracy, "errors": None if error is None
         else {"m": error, "rad": 2 * error, "J": error, "kg m/s": error}, "wall_s": time,
         "evaluations": int(1e6 * time), "pareto": pareto, "failed": error is None}
        for name, dt, accuracy, error, time, pareto in (
            ("rk4", 1e-3, None, 1e-8, 2e-3, False), ("rk4", 1e-2, None, 1e-4, 2e-4, True), ("rk4", 1e-1, None, None, 1e-5, False),
            ("reference", None, 1e-6, 1e-8, 3e-4, True), ("reference", None, 1e-9, 0.0, 4e-4, True))
    ],
}  # fmt: skip


@pytest.mark.skipif(not CLI, reason="the command dyn is not built")
def test_sweep_is_the_commands(monkeypatch):
    monkeypatch.setenv("DYN_CLI", CLI)
    said = dyn.accuracy.sweep(ROBOTS / "double_pendulum.urdf", "fixed", q=[1.2, 0.4], without="limits", duration=0.1, budget="30s",
                              target="1e-6m")
    assert said["duration"] == 0.1 and said["recommended"]["error"] <= 1e-6
    lines = dyn.accuracy.methods(said)
    assert {"rk4", "rk45", "rk45, accuracy", "reference, accuracy"} <= set(lines)
    assert all(a["dt"] > b["dt"] for points in lines.values() for a, b in zip(points, points[1:]) if a["dt"])
    with pytest.raises(dyn.ArgumentError, match="--target"):
        dyn.accuracy.sweep(ROBOTS / "double_pendulum.urdf", "fixed", target="1km")
    with pytest.raises(dyn.Error, match="none.urdf"):
        dyn.accuracy.sweep("none.urdf")
    with pytest.raises(dyn.ArgumentError, match="base"):
        dyn.accuracy.sweep("none.urdf", "flying")


def test_every_point_is_drawn(tmp_path):
    pytest.importorskip("matplotlib")
    (tmp_path / "result.json").write_text(json.dumps(RESULT))
    for result, name, begin in ((RESULT, "a.png", b"\x89PNG"), (tmp_path / "result.json", "a.svg", b"<?xml")):
        figure = dyn.accuracy.plot(result, tmp_path / name)
        assert (tmp_path / name).read_bytes().startswith(begin)
    time, evaluations = figure.axes
    for ax, key in ((time, "wall_s"), (evaluations, "evaluations")):
        assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
        by_name = {line.get_label(): line.get_xydata().tolist() for line in ax.get_lines()}
        points = {p: x for p, x in zip("abcde", RESULT["points"])}
        assert by_name["rk4"] == [[1e-4, points["b"][key]], [1e-8, points["a"][key]]]  # one line a method, from the coarsest on
        assert [y for _, y in by_name["reference, accuracy"]] == [points["d"][key], points["e"][key]]
        assert all(x > 0 for x, _ in by_name["reference, accuracy"])  # an error of zero has its place, too
        assert sorted(y for _, y in by_name["cheapest"]) == sorted(p[key] for p in RESULT["points"] if p["pareto"])
        edge = [line for line in ax.get_lines() if line.get_marker() == "x" and len(line.get_xdata())]
        assert [line.get_xydata().tolist() for line in edge] == [[[1.0, points["c"][key]]]]  # in axes: the right edge
    assert time.get_xlabel() == "error, m" and dyn.accuracy.plot(RESULT, error="rad").axes[0].get_xlabel() == "error, rad"


def test_what_is_refused(monkeypatch, tmp_path):
    for bad, message in (({}, "no points"), ([], "no points"), (tmp_path / "none.json", "none.json")):
        with pytest.raises(dyn.Error, match=message):
            dyn.accuracy.plot(bad)
    with pytest.raises(dyn.ArgumentError, match="km"):
        dyn.accuracy.plot(RESULT, error="km")
    for name in [name for name in sys.modules if name.split(".")[0] == "matplotlib"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match="pip install matplotlib"):
        dyn.accuracy.plot(RESULT)
