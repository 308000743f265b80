"""libdyn: every integrator in steps, and steps for an accuracy."""

import libdyn as dyn
import numpy as np
from libdyn.library import last_error, lib

from common import Failed, ladder, measured, steps_of

NAME, VERSION = "libdyn", dyn.__version__


class Scene:
    def __init__(self, problem):
        self.problem = problem
        self.model = m = dyn.load_string(problem.mjcf)
        self.data = d = m.data()
        d.set_effects(dyn.Effect.ALL)
        if problem.restitution:
            d.set_shape_material(None, dyn.Material(restitution=problem.restitution))
        self.q = m.configurations.get("qpos0", m.configuration("neutral")).copy()
        self.v, self.tau = np.zeros(m.nv), np.zeros(m.nv)
        for name, x in problem.q.items():
            self.q[m.joint(name).idx_q] = x
        for values, out in ((problem.v, self.v), (problem.tau, self.tau)):
            for name, x in values.items():
                j, x = m.joint(name), np.atleast_1d(x)
                out[j.idx_v:j.idx_v + len(x)] = x
        self.frames = [(m.frame_id(body), np.array(point)) for body, point in problem.markers]
        self.start = None

    def set(self, method, value):
        """An integrator in steps of value, or "order 8" or "order 5", in steps for an accuracy of value."""
        if method.startswith("order"):
            self.data.set_step_options({"order 8": "reference", "order 5": "rk45"}[method], dt=1e-3, accuracy=value)
        else:
            self.data.set_step_options(method, dt=value, accuracy=0)

    def begin(self):
        d = self.data
        if self.start is None:
            d.set_state(self.q, self.v, tau=self.tau)
            if self.problem.ctrl:
                d.set_control(list(self.problem.ctrl.values()))
            self.start = d.save_state()
        d.restore_state(self.start)
        self.evaluations = 0

    def move(self, k):
        if lib.dyn_advance(self.data._m, self.data._d, self.problem.duration / 10):
            raise Failed(last_error())

    def look(self):
        d = self.data
        self.evaluations += d.step_report.evaluations
        d.forward_kinematics()
        X = d.frame_placements()
        return np.array([X.translation[f] + X.rotation[f] @ p for f, p in self.frames])


def reference(problem):
    """To rounding, and how far a run in other steps is from it."""
    scene = Scene(problem)
    out = []
    for parts in (1, 3):
        scene.data.set_step_options("reference", problem.duration / 10 / parts)
        scene.begin()
        places = []
        for k in range(10):
            scene.move(k)
            places.append(scene.look())
        out.append(np.array(places))
    return out[0], float(np.abs(out[0] - out[1]).max())


def methods(problem):
    """Integrators in steps, then orders of steps for an accuracy. In contact the last three make the same steps."""
    steps = ["semi_implicit_euler", "implicit_fast"] + ([] if problem.kind == "contact" else ["implicit_midpoint", "rk4"]) + ["rk45"]
    return [*steps, "order 8", "order 5"]


def points(problem, reference):
    scene = Scene(problem)
    out = []
    for method in methods(problem):
        def measure(name, value, method=method):
            scene.set(method, value)
            return measured(name, value, scene.begin, scene.move, scene.look, reference, problem, lambda: scene.evaluations)

        by_accuracy = method.startswith("order")
        out += ladder(method + ", accuracy" * by_accuracy, [10.0**-e for e in range(14)] if by_accuracy else steps_of(problem),
                      measure)
    return out
