"""Steps for an accuracy on problems that have references: whether it is met, and what an error costs in evaluations of forward
dynamics, beside scipy's DOP853 on the same problems (tests/golden/evaluations). Counts depend on no clock."""

import json
import math

import numpy as np
import pytest
from conftest import CAPI, bench_problem

import libdyn as dyn

GOLDEN = json.loads((CAPI.parent / "tests/golden/evaluations/dop853.json").read_text())["problems"]
LEVEL = {"double-pendulum, 20 s": 1e-6}  # m: chaos has made rounding 1e-8 by then; 1e-9 of all others


def cost(points, level):
    """Evaluations at an error of level: by a line through log evaluations over log error of those within two decades (single ones
    may be lucky)."""
    points = sorted(points)
    points = [p for k, p in enumerate(points)
              if all(p[1] < e for _, e in points[:k])]  # more evaluations for no less error: where rounding ends it
    near = [(math.log(e / level), math.log(n)) for n, e in points if level / 100 < e < level * 100]
    assert len(near) >= 5
    slope, at_level = np.polyfit(*zip(*near), 1)
    assert -0.25 < slope < -0.05, "order 8"
    return math.exp(at_level)


class Problem:
    def __init__(self, golden):
        self.golden = golden
        self.model = m = dyn.load_string(golden["mjcf"])
        self.data = m.data()
        self.data.set_effects(dyn.Effect.ALL)
        self.q = m.configurations.get("qpos0", m.configuration("neutral")).copy()
        self.v, self.tau = np.zeros(m.nv), np.zeros(m.nv)
        for name, x in golden["q"].items():
            self.q[m.joint(name).idx_q] = x
        for values, out in ((golden["v"], self.v), (golden["tau"], self.tau)):
            for name, x in values.items():
                first = m.joint(name).idx_v
                out[first : first + np.size(x)] = x

    def run(self, accuracy):
        """The report, and the error at the end, m."""
        d = self.data
        d.set_state(self.q, self.v, tau=self.tau)
        d.set_step_options("reference", accuracy=accuracy)
        report = d.advance(self.golden["duration"])
        d.forward_kinematics()
        places = [d.frame_placement(body) for body, _ in self.golden["markers"]]
        places = [X.translation + X.rotation @ np.array(p) for X, (_, p) in zip(places, self.golden["markers"])]
        return report, float(np.max(np.linalg.norm(np.array(places) - self.golden["reference"], axis=1)))


@pytest.mark.parametrize("golden", GOLDEN, ids=lambda g: g["name"])
def test_evaluations_beside_dop853(golden):
    level = LEVEL.get(golden["name"], 1e-9)
    problem = Problem(golden)
    runs = [problem.run(10.0**-e) for e in np.arange(1, 12.1, 0.05)]
    mine = cost([(report.evaluations, error) for report, error in runs], level)
    theirs = cost(golden["dop853"], level)
    assert mine <= 1.2 * theirs, f"{mine:.0f} evaluations for {level:g} m, DOP853 {theirs:.0f}"


def test_singular_configurations_refuse_no_accuracy():
    """Rods that lie flat are passed at every accuracy, also where a step ends right before: one of some 700 runs did not."""
    golden = next(g for g in GOLDEN if g["name"] == "four-bars, 5 s")
    for accuracy in 10.0 ** -np.concatenate([np.arange(9.28, 9.3, 0.0005), np.arange(11.75, 11.79, 0.0005)]):
        report, _ = Problem(golden).run(accuracy)
        assert report.error_estimate < 1e-2


# Errors that grow by themselves: by chaos, where rods lie flat and accelerations are hardly known.
GROWING = ("double-pendulum, 20 s", "four-bars, 5 s")


@pytest.mark.parametrize("golden", [g for g in GOLDEN if g["name"] not in GROWING], ids=lambda g: g["name"])
def test_accuracy_is_met(golden):
    problem = Problem(golden)
    for accuracy in (10.0**-e for e in range(3, 11)):
        report, error = problem.run(accuracy)
        assert error <= 3 * accuracy and report.error_estimate <= accuracy * (1 + 1e-9), accuracy


@pytest.mark.parametrize("name", ["slide", "drag", "stack", "rolling", "bouncing"])
def test_accuracy_is_met_in_contact(name):
    p = bench_problem(name)
    problem = Problem({"mjcf": p.mjcf, "duration": p.duration, "q": p.q, "v": p.v, "tau": p.tau, "markers": p.markers,
                       "reference": p.exact(p.duration)})
    if p.restitution:
        problem.data.set_shape_material(None, dyn.Material(restitution=p.restitution))
    if p.ctrl:
        problem.data.set_control(list(p.ctrl.values()))
    begin = problem.data.save_state()
    for accuracy in (1e-2, 1e-3, 1e-4, 1e-5):
        problem.data.restore_state(begin)
        assert problem.run(accuracy)[1] <= 3 * accuracy, accuracy
