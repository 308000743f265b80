"""dyn accuracy: work and precision of a scene, recommendations that hold, and what is refused."""

import csv
import json
import math

import numpy as np
import pytest
from command import CLI, ROBOTS, answer, pytestmark, run  # noqa: F401

PENDULUM = (ROBOTS / "double_pendulum.urdf", "--fixed", "--q", "1.2,0.4", "--without", "limits")


@pytest.fixture(scope="module")
def smooth():
    return answer("accuracy", *PENDULUM, "--duration", "0.5", "--budget", "120s", "--target", "1e-6m")


def by_dt(said, integrator):
    return {p["dt"]: p["error"] for p in said["points"] if p["integrator"] == integrator and p["dt"] and not p["failed"]}


def test_orders_show(smooth):
    assert smooth["reference"]["smooth"] and smooth["reference"]["uncertainty"]["m"] < 1e-13
    for integrator, order in (("semi_implicit_euler", 1), ("implicit_fast", 1), ("implicit_midpoint", 2), ("rk4", 4),
                              ("rk45", 5)):
        errors = by_dt(smooth, integrator)
        assert math.log2(errors[1e-2] / errors[5e-3]) == pytest.approx(order, abs=0.3), integrator
    accuracies = [p for p in smooth["points"] if p["accuracy"]]
    assert len(accuracies) >= 24  # those of the sweep, and what was tried between them for the target
    assert all(p["error"] <= 3 * max(p["accuracy"], 1e-13) for p in accuracies)


def test_the_front(smooth):
    good = [p for p in smooth["points"] if not p["failed"]]
    front = [p for p in good if p["pareto"]]
    assert front
    for p in good:
        beaten = any(x["wall_s"] <= p["wall_s"] and x["error"] <= p["error"]
                     and (x["wall_s"], x["error"]) != (p["wall_s"], p["error"]) for x in good)
        assert p["pareto"] != beaten


def test_the_recommendation_holds(smooth):
    said = smooth["recommended"]
    assert said["error"] <= 0.8e-6 and said["margin"] >= 1.25 and said["command"].startswith("dyn sim ")
    best = min((p for p in smooth["points"] if not p["failed"] and p["error"] <= 0.8e-6), key=lambda p: p["wall_s"])
    assert said["wall_s"] == best["wall_s"]
    again = answer(*said["command"].split()[1:], "--no-error-estimate")
    exact = answer("sim", *PENDULUM, "--duration", "0.5", "--integrator", "reference", "--dt", "0.05", "--no-error-estimate")
    assert np.abs(np.cumsum(np.subtract(again["q"], exact["q"]))).max() <= 1e-6  # of the links' angles, on rods of 1 m


def test_derivatives_make_a_v(smooth):
    curve = {m: {d["step"]: d["error"] for d in smooth["derivatives"] if d["method"] == m}
             for m in ("forward", "central", "extrapolated")}
    best = {m: min(c, key=c.get) for m, c in curve.items()}
    assert best["forward"] < best["central"] < best["extrapolated"]
    assert curve["forward"][best["forward"]] > curve["central"][best["central"]] > curve["extrapolated"][best["extrapolated"]]
    assert all(c[0.1] > 10 * min(c.values()) < c[1e-12] for c in curve.values())


def test_files(tmp_path):
    page, table, picture = tmp_path / "a.html", tmp_path / "a.csv", tmp_path / "a.svg"
    said = answer("accuracy", *PENDULUM, "--duration", "0.2", "--budget", "10s", "--html", page, "--csv", table, "--svg", picture)
    rows = list(csv.DictReader(table.open()))
    assert len(rows) == len(said["points"]) and {r["what"] for r in rows} == {"points"}
    assert float(rows[0]["error_m"]) == said["points"][0]["error"]
    assert picture.read_text().count("<circle") == len(said["points"])
    text = page.read_text()
    assert text.count("<svg") == 2 and "http" not in text.replace("http://www.w3.org/2000/svg", "")
    assert "cheapest" not in text
    assert "1e" in run("accuracy", *PENDULUM, "--duration", "0.2", "--budget", "10s")


def test_contact(tmp_path):
    ball = tmp_path / "ball.xml"
    ball.write_text("""<mujoco><worldbody><geom type="plane" size="1 1 1"/><body pos="0 0 .15"><freejoint/><geom size=".1"/></body></worldbody></mujoco>""")
    said = answer("accuracy", ball, "--duration", "0.3", "--budget", "20s", "--target", "2e-3m")
    assert not said["reference"]["smooth"] and "agree" in said["reference"]["confidence"]
    assert said["recommended"]["verified"] == pytest.approx(said["recommended"]["error"], rel=1e-9)
    assert {p["solver"] for p in said["solvers"]} == {"pgs", "admm", "newton"}
    assert all(p["penetration"] < 1e-3 for p in said["points"] if p["dt"] and p["dt"] <= 1e-3 and not p["failed"])
    assert said["recommended"]["error"] <= 1.6e-3 and "--solver" in said["recommended"]["command"]


def test_sliding_then_rolling_meets_a_fine_target(tmp_path):
    """A ball with speed v slides for 2 v / (7 mu g), then rolls with 5/7 v: closed form."""
    ball, mu, v, end = tmp_path / "ball.xml", 0.4, 1.0, 0.5
    ball.write_text(f'<mujoco><worldbody><geom type="plane" size="5 5 1" friction="{mu} 0 0"/><body pos="0 0 .1"><freejoint/><geom '
                    f'size=".1" mass="1" friction="{mu} 0 0"/></body></worldbody></mujoco>')
    said = answer("accuracy", ball, "--v", f"{v},0,0,0,0,0", "--duration", end, "--budget", "10s", "--target", "1e-7m")
    assert said["recommended"] and 0 < said["reference"]["uncertainty"]["m"] < 1e-7
    x = answer(*said["recommended"]["command"].split()[1:], "--no-error-estimate")["q"][0]
    slides = 2 * v / (7 * mu * 9.81)
    exact = v * slides - mu * 9.81 * slides**2 / 2 + 5 / 7 * v * (end - slides)
    assert abs(x - exact) < 1e-7


def test_a_heap_has_statistics(tmp_path):
    random = np.random.default_rng(1)
    boxes = "".join(f'<body pos="{x:.3f} {y:.3f} {0.15 + 0.12 * k:.3f}"><freejoint/><geom type="box" size=".05 .04 .03" mass="0.2"/></body>'
                    for k, (x, y) in enumerate(random.uniform(-0.1, 0.1, (12, 2))))
    heap = tmp_path / "heap.xml"
    heap.write_text(f'<mujoco><worldbody><geom type="plane" size="5 5 1"/>{boxes}</worldbody></mujoco>')
    said = answer("accuracy", heap, "--duration", "0.5", "--budget", "40s", "--target", "2e-2m")
    reference = said["reference"]
    if not reference["statistics"]:
        pytest.skip("its motion is known")
    assert "means of" in reference["kind"] and 0 < reference["uncertainty"]["m"] < 2e-2
    assert said["recommended"]["verified"] < 2e-2


def test_what_might_touch_and_does_not(tmp_path):
    """Two links swing above a floor that long steps would take for near: the reference is that of smooth motion."""
    (tmp_path / "swing.xml").write_text("""<mujoco><worldbody><geom type="plane" size="1 1 1"/><body pos="0 0 2.2"><joint axis="0 1 0"/><geom type="capsule" size=".05" fromto="0 0 0 0 0 1"/>
<body pos="0 0 1"><joint axis="0 1 0"/><geom type="capsule" size=".05" fromto="0 0 0 0 0 1"/></body></body></worldbody></mujoco>""")
    said = answer("accuracy", tmp_path / "swing.xml", "--q", "2,1", "--duration", "2", "--budget", "60s")
    assert said["reference"]["smooth"] and said["reference"]["uncertainty"]["m"] < 1e-12
    rk4 = by_dt(said, "rk4")
    assert max(rk4[0.001], rk4[0.0005]) < 1e-8


def test_resuming(tmp_path):
    kept = tmp_path / "points"
    words = ("accuracy", *PENDULUM, "--duration", "0.2", "--budget", "60s", "--resume", kept)
    first = answer(*words)
    lines = kept.read_text().splitlines()
    assert len(lines) == 2 + len(first["points"])  # the scene, the reference
    kept.write_text("\n".join(lines[:10]) + "\n" + lines[10][:30])  # interrupted
    again = answer(*words)
    assert len(again["points"]) == len(first["points"])
    same = {(p["integrator"], p["dt"], p["accuracy"]): p["error"] for p in again["points"]}
    assert all(same[p["integrator"], p["dt"], p["accuracy"]] == p["error"] for p in first["points"])
    third = answer(*words)  # with nothing left to do
    assert third["points"] == again["points"]
    assert "another scene" in run("accuracy", *PENDULUM, "--duration", "0.3", "--resume", kept, status=1)
    kept.write_text("not json\n")
    assert "is not a file of points" in run(*words, status=1)


def test_resumed_points_are_measured_from_one_reference(tmp_path):
    """Where bodies touch, the reference is as good as its time allows: it is kept, and points follow a better one."""
    ball = tmp_path / "ball.xml"
    ball.write_text('<mujoco><worldbody><geom type="plane" size="1 1 1"/><body pos="0 0 .2"><freejoint/><geom '
                    'size=".1"/></body></worldbody></mujoco>')
    words = ("accuracy", ball, "--v", "0.5,0,0,0,3,0", "--duration", "0.3", "--resume", tmp_path / "points")
    first, again = answer(*words, "--budget", "2s"), answer(*words, "--budget", "2s")
    assert again["reference"] == first["reference"]
    errors = [{(p["integrator"], p["dt"], p["accuracy"]): p["errors"] for p in x["points"]} for x in (first, again)]
    assert errors[0].items() <= errors[1].items()
    longer = answer(*words, "--budget", "20s")
    assert longer["reference"]["uncertainty"]["m"] <= first["reference"]["uncertainty"]["m"]
    moved = {(p["integrator"], p["dt"], p["accuracy"]): p["errors"] for p in longer["points"]}
    assert all(moved[k] and abs(moved[k]["m"] - e["m"]) <= 2 * first["reference"]["uncertainty"]["m"]
               for k, e in errors[0].items() if e)


def test_a_given_reference(tmp_path):
    exact = answer("sim", *PENDULUM, "--duration", "0.2", "--integrator", "reference", "--dt", "0.02", "--no-error-estimate")
    file = tmp_path / "end.json"
    file.write_text(json.dumps({"q": exact["q"], "v": exact["v"]}))
    said = answer("accuracy", *PENDULUM, "--duration", "0.2", "--budget", "10s", "--reference", file)
    assert said["reference"]["kind"].startswith("given")
    assert min(p["error"] for p in said["points"] if not p["failed"]) < 1e-12


def test_what_fails_stands_in_the_table(tmp_path):
    stiff = tmp_path / "stiff.xml"
    stiff.write_text("""<mujoco><worldbody><body><joint axis="0 1 0" stiffness="1e9" ref="0"/><geom size=".1" pos=".3 0 0"/></body></worldbody></mujoco>""")
    said = answer("accuracy", stiff, "--q", "0.01", "--duration", "0.2", "--budget", "10s")
    failed = [p for p in said["points"] if p["failed"]]
    assert any(p["integrator"] == "rk4" and p["failure"] for p in failed) and any(not p["failed"] for p in said["points"])
    assert all(p["error"] is None for p in failed)


@pytest.mark.parametrize("words, status, message", [
    (("--target", "1e-4"), 0, ""), (("--target", "fast"), 2, "--target"), (("--target", "-1m"), 2, "--target"),
    (("--target", "1km"), 2, "km"), (("--budget", "0s"), 2, "--budget"), (("--budget", "1h"), 2, "1h"),
    (("--reference", "/none.json"), 1, "none.json"), (("--csv", "/none/a.csv"), 1, "/none/a.csv"),
    (("--duration", "0"), 2, "--duration"), (("--integrator", "rk4"), 2, "integrator"),
])  # fmt: skip
def test_bad_usage(words, status, message):
    budget = () if "--budget" in words else ("--budget", "2s")
    duration = () if "--duration" in words else ("--duration", "0.05")
    said = run("accuracy", *PENDULUM, *duration, *budget, *words, status=status)
    assert message in said
