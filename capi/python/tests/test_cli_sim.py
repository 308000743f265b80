"""`dyn sim`: simulations of a robot."""

import math
import os

import libdyn as dyn
import numpy as np
import pytest
from command import ROBOTS, answer, arm_file, pytestmark, run, state_file  # noqa: F401 (fixtures)


def test_sim(arm_file, arm, tmp_path):
    csv = tmp_path / "out.csv"
    found = answer(
        "sim", arm_file, "--fixed", "--duration", "0.5", "--dt", "1e-3", "--integrator", "rk4", "--q", "1,0.5", "--csv", csv,
        "--effects", "armature"
    )
    keys = "duration steps wall_s real_time_factor q v time energy contacts_max penetration_max residual_max integrator solver dt error_estimate effects warnings"
    assert set(keys.split()) <= set(found)
    assert (found["steps"], found["dt"], found["duration"], found["integrator"], found["contacts_max"]) == (
        500,
        1e-3,
        0.5,
        "rk4",
        0,
    )
    d = arm.data()
    d.set_effects("armature")
    d.set_state([1, 0.5], [0, 0])
    start = sum(d.energy())
    for _ in range(500):
        d.step(1e-3, "rk4")
    assert found["q"] == d.q.tolist() and found["v"] == d.v.tolist() and found["time"] == d.time
    assert found["energy"]["initial"] == start and found["energy"]["final"] == sum(d.energy())
    assert 0 <= found["energy"]["drift_max"] < 1e-9 and 0 < found["error_estimate"] < 1e-9
    assert found["wall_s"] > 0 and found["real_time_factor"] == pytest.approx(0.5 / found["wall_s"])
    rows = np.genfromtxt(csv, delimiter=",", names=True)
    assert rows.dtype.names == ("t", "q0", "q1", "v0", "v1", "kinetic", "potential", "mechanical") and len(rows) == 501
    assert rows["q1"][-1] == d.q[1] and rows["t"][0] == 0 and rows["mechanical"][0] == start  # 17 digits: no loss


@pytest.mark.parametrize("integrator", ["semi_implicit_euler", "implicit_fast", "implicit_midpoint", "rk4", "rk45"])
@pytest.mark.parametrize("robot", sorted(p.stem for p in ROBOTS.glob("*.urdf")))
def test_sim_of_every_robot(robot, integrator, state_file):
    """As tools/run has them move: nothing drives them, so limits, contacts and damping only take energy."""
    robot = ROBOTS / f"{robot}.urdf"
    base = "--floating" if robot.stem in ("go2", "humanoid") else "--fixed"
    state = state_file({"v": [0.5] * answer("info", robot, base)["nv"]})
    found = answer("sim", robot, base, "--duration", "0.2", "--dt", "1e-3", "--integrator", integrator, "--state", state)
    assert found["steps"] == 200 and all(map(math.isfinite, found["q"] + found["v"]))
    energy = found["energy"]
    assert (energy["final"] - energy["initial"]
            < 1e-2 * (abs(energy["initial"]) + abs(energy["final"])))  # of the first order: what Euler's steps of 1 ms make


def test_sim_last_step_is_shorter(arm_file):
    found = answer("sim", arm_file, "--fixed", "--duration", "0.0105", "--dt", "1e-3")
    assert found["steps"] == 11 and found["time"] == pytest.approx(0.0105, abs=1e-15)
    found = answer("sim", arm_file, "--fixed", "--duration", "1e-4", "--dt", "1", "--no-error-estimate")
    assert found["steps"] == 1 and found["time"] == found["dt"] == 1e-4 and found["error_estimate"] is None
    assert run("sim", arm_file, "--fixed", "--duration", "1e-300").startswith("1e-300 s in 1 step of 1e-300 s")


def test_sim_refuses_explicit_steps_of_what_is_too_stiff(tmp_path):
    robot = tmp_path / "blow.xml"
    robot.write_text('<mujoco><worldbody><body><joint name="j" axis="0 1 0" stiffness="1e6"/><geom size=".01" pos=".5 0 '
                     '0"/></body></worldbody></mujoco>')
    words = ("sim", robot, "--duration", "1", "--dt", "0.1", "--q", "1")
    said = run(*words, "--integrator", "rk4", status=1)
    assert "'j' are unstable in explicit steps" in said and "implicit_fast" in said
    assert answer(*words, "--integrator", "implicit_fast")["steps"] == 10


def test_sim_without_an_error_estimate(tmp_path):
    """A mass slides along an arm on a spring, from 2 m to -2 m in the step. Half-way the arm is light: half a step is unstable."""
    robot, csv = tmp_path / "balance.xml", tmp_path / "balance.csv"
    robot.write_text('<mujoco><option gravity="0 0 0"/><worldbody><body><joint name="j" axis="0 0 1" stiffness="4"/><geom size=".1"/>'
                     '<body><joint type="slide" axis="1 0 0"/><geom size=".06"/></body></body></worldbody></mujoco>')
    words = ("sim", robot, "--integrator", "rk4", "--duration", "1", "--dt", "1", "--q", "0", "2", "--v", "0", "-4")
    found = answer(*words, "--csv", csv)
    assert found["q"] == pytest.approx([0, -2], abs=1e-12)
    assert found["error_estimate"] is None and found["steps"] == 1 and len(csv.read_text().splitlines()) == 3
    assert sum(w.startswith("no error estimate: ") and "'j'" in w for w in found["warnings"]) == 1
    assert "error estimate    unknown" in run(*words)


def test_sim_error_estimate_bounds_the_error(arm_file):
    def end(*words):
        return answer("sim", arm_file, "--fixed", "--duration", "1", "--q", "1,0.5", "--effects", "damping", *words)

    exact = np.array(end("--accuracy", "1e-11")["q"])
    for words in (("--dt", "1e-3"), ("--dt", "2e-2", "--integrator", "rk4"), ("--accuracy", "1e-4")):
        found = end(*words)
        error = np.abs(found["q"] - exact).max()
        assert error < found["error_estimate"] < 30 * error + 1e-11, words


def test_sim_says_when_no_digit_is_left(arm_file):
    found = answer("sim", arm_file, "--fixed", "--duration", "20", "--dt", "2e-2", "--q", "3,0.5", "--without", "damping,limits,friction")
    assert found["error_estimate"] is None and any("no digit of the final state is known" in w for w in found["warnings"])


def test_sim_tau_and_text(arm_file, tmp_path):
    csv = tmp_path / "out.csv"
    text = run("sim", arm_file, "--fixed", "--duration", "0.01", "--tau", "1,2", "--csv", csv)
    assert "wall time" in text and "energy" in text and "work" in text
    assert csv.read_text().splitlines()[0] == "t,q0,q1,v0,v1,tau0,tau1,kinetic,potential,mechanical"


def test_sim_limits_are_mentioned(arm_file):
    words = ("sim", arm_file, "--fixed", "--duration", "1", "--v", "8,0")
    warnings = answer(*words, "--effects", "armature")["warnings"]
    assert sum("shoulder" in w and "beyond its limits" in w for w in warnings) == 1
    found = answer(*words)
    assert not any("limits" in w for w in found["warnings"]) and found["solver"] == "admm" and found["residual_max"] <= 1e-9


def test_sim_failures(arm_file, tmp_path):
    words = ("sim", arm_file, "--fixed", "--duration")
    assert "cannot be written" in run(*words, 1, "--csv", tmp_path / "no" / "out.csv", status=1)
    assert "GB" in run(*words, 1e5, "--dt", 1e-4, "--csv", tmp_path / "big.csv", status=1)
    assert not (tmp_path / "big.csv").exists()
    if os.path.exists("/dev/full"):
        assert "No space" in run(*words, 1, "--csv", "/dev/full", status=1)
    csv = tmp_path / "out.csv"
    error = run(*words, 1e202, "--dt", "1e200", "--v", "1e150,-1e150", "--csv", csv, status=1)
    assert "step 1" in error and len(csv.read_text().splitlines()) == 2


def test_sim_to_an_accuracy(arm_file):
    words = ("sim", arm_file, "--fixed", "--duration", "1", "--q", "1,0.5", "--accuracy")
    tight, loose = answer(*words, "1e-11"), answer(*words, "1e-4")
    assert tight["integrator"] == "reference" and tight["steps"] > loose["steps"]
    assert np.abs(np.subtract(tight["q"], loose["q"])).max() < 1e-3 and loose["error_estimate"] <= 1e-4
    for bad in ("-1", "nan", "inf"):
        run(*words, bad, status=2)


STATED = """<mujoco><option timestep="0.004" integrator="implicitfast">FLAGS</option><worldbody><geom type="plane" size="1 1 1"/>
  <body pos="0 0 1"><joint name="hinge" axis="0 1 0" ref="20" damping="0.5" frictionloss="0.2" range="-90 90"/>
  <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02" mass="1"/></body></worldbody>
  <actuator><motor name="m" joint="hinge"/></actuator>
  <keyframe><key name="away" time="2" qpos="0.3" qvel="1" ctrl="0.7"/></keyframe></mujoco>"""


FLAGS = ("", '<flag frictionloss="disable"/>', '<flag damper="disable" limit="disable"/>', '<flag actuation="disable"/>')


@pytest.mark.parametrize("flags", FLAGS)
@pytest.mark.parametrize("key", [None, "away"])
def test_a_file_runs_as_it_states_its_effects_step_and_beginning(tmp_path, flags, key):
    """As dyn.Simulation does; --effects all applies what flags switch off."""
    path = tmp_path / "m.xml"
    path.write_text(STATED.replace("FLAGS", flags))
    at = ["--key", key] if key else []
    found = answer("sim", path, "--duration", "0.4", *at)
    sim = dyn.Simulation(dyn.load(path), key)
    sim.step(100)
    assert (found["dt"], found["integrator"], found["steps"]) == (0.004, "implicit_fast", 100)
    assert found["time"] == pytest.approx(sim.time, abs=1e-12)
    assert found["q"] == sim.q.tolist() and found["v"] == sim.v.tolist()
    every = answer("sim", path, "--duration", "0.4", "--effects", "all", *at)
    assert (every["q"] == found["q"]) == (flags == "" or (flags.startswith("<flag act") and key is None))
    off = {w.split(":")[0] for w in found["warnings"] if "switched off" in w}
    assert off == {"": set(), "<flag f": {"friction"}, "<flag d": {"damping", "limits"}, "<flag a": {"actuators"}}[flags[:7]]


def test_sim_says_that_a_loop_is_open():
    """A four-bar whose rocker ends 1.2 m beside its pin at q = 0, and as `dyn check` closes it."""
    file = ROBOTS.parent / "mechanisms" / "four_bar.urdf"
    words = "sim", file, "--fixed", "--duration", "0.01"
    said = [w for w in answer(*words)["warnings"] if "violated" in w]
    assert len(said) == 1 and "1.2 m" in said[0] and "dyn check" in said[0]
    q = answer("check", file, "--fixed")["q"]
    assert not any("violated" in w for w in answer(*words, "--q", ",".join(map(repr, q)))["warnings"])
