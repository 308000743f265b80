"""What `dyn accuracy --target` recommends, run again: it meets the target, on the robots and mechanisms of models/ and the
problems of bench/accuracy.
All with DYN_SLOW (tools/test --slow), some otherwise."""

import json
import math
import os

import numpy as np
import pytest
from conftest import MODELS, bench_problem
from command import CLI, answer

import libdyn as dyn

pytestmark = pytest.mark.skipif(not CLI, reason="the command dyn is not built")

# name: file, words, target in m
ROBOTS = {
    "double pendulum": ("robots/double_pendulum.urdf", ["--fixed", "--q", "1.2,0.4", "--without", "limits"], "1e-7m"),
    "double pendulum, coarse": ("robots/double_pendulum.urdf", ["--fixed", "--q", "1.2,0.4", "--without", "limits"], "1e-2m"),
    "arm falls": ("robots/panda.urdf", ["--fixed", "--without", "limits,friction,contact"], "1e-6m"),
    "arm with dry friction": ("robots/panda.urdf", ["--fixed"], "1e-4m"),
    "gripper": ("robots/gripper.urdf", ["--fixed", "--without", "friction,limits"], "1e-6m"),
    "quadruped in flight": ("robots/go2.urdf", ["--floating", "--without", "friction,limits,contact"], "1e-8m"),
    "quadruped on the ground": ("robots/go2.urdf", ["--floating", "--ground"], "1e-3m"),
    "humanoid in flight": ("robots/humanoid.urdf", ["--floating", "--without", "friction,limits,contact"], "1e-8m"),
    "humanoid hangs": ("robots/humanoid.urdf", ["--fixed", "--without", "friction,limits,contact"], "1e-5m"),
    "four-bar": ("mechanisms/four_bar.urdf", ["--fixed"], "1e-6m"),
    "four-bar in space": ("mechanisms/four_bar_in_space.urdf", ["--fixed"], "1e-5m"),
    "parallel four-bar": ("mechanisms/parallel_four_bar.urdf", ["--fixed"], "1e-6m"),
    "bricard": ("mechanisms/bricard.urdf", ["--fixed"], "1e-6m"),
    "linkage gripper": ("mechanisms/linkage_gripper.urdf", ["--fixed", "--without", "limits,contact"], "1e-6m"),
}
PROBLEMS = {"pendulum": "1e-6m", "box": "1e-6m", "heavy-top": "1e-6m", "chain": "1e-9m", "slide": "1e-4m", "stack": "1e-5m",
            "bouncing": "1e-3m"}
LONG = {"quadruped on the ground"}  # it starts beyond its limits, and steps converge late: less time leaves the reference in doubt on a busy machine
QUICK = {"double pendulum", "arm falls", "four-bar"}


def scene_of_bench(name, folder):
    """The problem's file and state; its MJCF says the rest."""
    problem = bench_problem({"heavy-top": "heavy_top", "chain": "planar_chain"}.get(name, name))
    file = folder / f"{name}.xml"
    file.write_text(problem.mjcf)
    m = dyn.load(file)
    q, v = m.configurations.get("qpos0", m.configuration("neutral")).copy(), np.zeros(m.nv)
    for joint, x in problem.q.items():
        q[m.joint(joint).idx_q] = x
    for joint, x in problem.v.items():
        first = m.joint(joint).idx_v
        v[first : first + np.size(x)] = x
    state = folder / f"{name}.json"
    state.write_text(json.dumps({"q": q.tolist(), "v": v.tolist()}))
    return file, ["--state", str(state)]


def closed(file):
    """A state in which the loops are closed: the one nearest to neutral, or to angles at random where none is near that."""
    m = dyn.load(file, base="fixed")
    d, rng, q = m.data(), np.random.default_rng(1), m.configuration("neutral")
    while (found := d.project(q)).result.residual > 1e-10:
        q = rng.uniform(-1, 1, m.nq)
    return ["--q", ",".join(map(repr, found.q.tolist()))]


def distance(model, q0, q1):
    """The largest of any frame, m."""
    places = []
    for q in (q0, q1):
        d = model.data()
        d.forward_kinematics(np.array(q))
        places.append(d.frame_placements().translation.copy())
    return float(np.max(np.linalg.norm(places[0] - places[1], axis=1)))


def by_other_means(model, file, words, duration, smooth, target, dt):
    """Where it ends: order 8 where motion is smooth, otherwise steps that are halved until that moves it by a fifth of the target
    at most."""

    def end(*options):
        return answer("sim", file, *words, "--duration", duration, *options, "--no-error-estimate")["q"]

    if smooth:
        return end("--integrator", "reference", "--dt", duration / 7)
    h = min(2e-5, (dt or 1e-3) / 8)
    last, q = None, end("--integrator", "implicit_fast", "--dt", h)
    while last is None or distance(model, last, q) > target / 5:
        h /= 2
        assert h > 1e-7, "no steps are short enough to be compared with"
        last, q = q, end("--integrator", "implicit_fast", "--dt", h)
    return q


@pytest.mark.parametrize("name", [*ROBOTS, *PROBLEMS])
def test_the_recommendation_meets_the_target(name, tmp_path):
    if name not in QUICK and not os.environ.get("DYN_SLOW"):
        pytest.skip("one of the slow ones")
    if name in ROBOTS:
        file, words, target = ROBOTS[name]
        file = MODELS / file
        words = words + (closed(file) if "mechanisms" in str(file) else [])
    else:
        pytest.importorskip("mpmath") if name == "pendulum" else None
        target = PROBLEMS[name]
        file, words = scene_of_bench(name, tmp_path)
    duration = 0.2
    said = answer("accuracy", file, *words, "--duration", duration, "--budget",
                  "5s" if name in QUICK else "60s" if name in LONG else "20s", "--target", target)
    best, target = said["recommended"], float(target.rstrip("m"))
    assert best, f"nothing reached {target} m"
    again = answer(*best["command"].split()[1:], "--no-error-estimate")
    base = "fixed" if "--fixed" in words else "floating" if "--floating" in words else None
    model = dyn.load(file, base=base)
    exact = by_other_means(model, file, words, duration, said["reference"]["smooth"], target, best["dt"])
    assert distance(model, again["q"], exact) <= target and math.isfinite(sum(again["q"]))
