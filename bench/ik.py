#!/usr/bin/env python3
"""Inverse kinematics from random starts to reachable targets: success rate and time, beside Pink and MuJoCo.

Usage:  ik.py [--count N] [--libraries dyn,pink,mujoco] [--restarts R] [--markdown]

Targets are the placements of random configurations within the joint limits; starts are other such configurations, the same for
all libraries. panda: pose of the right finger, whose joint follows the left one's. go2: pose of the base and positions of the
four feet, floating base. A target is met within 1e-6 m and 1e-6 rad. Each library starts from the given configuration and, while
that fails, from up to R random ones (libdyn by itself; the peers here, by its sampling); joint limits are respected by all.
  dyn      Data.ik of the Python package; a line apart tells what the package adds to a call of the C function
  pink     differential inverse kinematics, steps of one second until the error is met, at most 100 a start; QP solver: --solver
  mujoco   mujoco.minimize.least_squares with bounds and analytic Jacobians
Times are of whole solves, one after the other on one thread, in microseconds.
Needs numpy, and for the peers: pip install pin-pink daqp mujoco
"""
import argparse
import statistics
import sys
import time
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

PROJECT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(PROJECT / "capi/python"))
import libdyn as dyn  # noqa: E402
from libdyn import ik  # noqa: E402

TOLERANCE = 1e-6
ROBOTS = {
    "panda": (False, [("pose", "panda_rightfinger")]),
    "go2": (True, [("pose", "base")] + [("position", f"{leg}_foot") for leg in ("FL", "FR", "RL", "RR")]),
}


class Problem:
    """A robot, its targets and starts, from libdyn."""

    def __init__(self, name, count, restarts):
        self.name, (self.floating, self.tasks) = name, ROBOTS[name]
        self.path = PROJECT / f"models/robots/{name}.urdf"
        self.model = dyn.load(self.path, base="floating" if self.floating else "fixed")
        data = self.model.data()
        self.targets, self.starts = [], []
        for k in range(count):
            data.forward_kinematics(self.model.random(2 * k + 1))
            self.targets.append([data.frame_placement(frame) for _, frame in self.tasks])
            self.starts.append(self.model.random(2 * k + 2))
        self.restarts = restarts

    def start(self, k, attempt):
        """Of a peer: the given start, then random ones with the base where it was."""
        if attempt == 0:
            return self.starts[k]
        q = self.model.random(1_000_000 + 1000 * k + attempt)
        if self.floating:
            q[:7] = self.starts[k][:7]
        return q


class Dyn:
    name = "dyn"

    def __init__(self, problem):
        self.p, self.data = problem, problem.model.data()

    def solve(self, k):
        tasks = [(ik.pose(f, X) if kind == "pose" else ik.position(f, X.translation))
                 for (kind, f), X in zip(self.p.tasks, self.p.targets[k])]
        begin = time.perf_counter()
        r = self.data.ik(tasks, self.p.starts[k], restarts=self.p.restarts, seed=k)
        return r.converged, r.restarts, time.perf_counter() - begin

    def overhead(self):
        """Of the package: a call that starts at its solution."""
        p, times = self.p, []
        tasks = [(ik.pose(f, X) if kind == "pose" else ik.position(f, X.translation))
                 for (kind, f), X in zip(p.tasks, p.targets[0])]
        q = self.data.ik(tasks, p.starts[0], restarts=1000, tolerance_linear=1e-9, tolerance_angular=1e-9).q
        for _ in range(1000):
            begin = time.perf_counter()
            self.data.ik(tasks, q)
            times.append(time.perf_counter() - begin)
        return statistics.median(times)


class Peer:
    def solve(self, k):
        begin = time.perf_counter()
        for attempt in range(self.p.restarts + 1):
            if self.once(k, self.p.start(k, attempt)):
                return True, attempt, time.perf_counter() - begin
        return False, self.p.restarts, time.perf_counter() - begin


class Pink(Peer):
    name = "pink"

    def __init__(self, problem, solver):
        import pink
        import pinocchio as pin

        self.p, self.pin, self.pink, self.solver = problem, pin, pink, solver
        base = (pin.JointModelFreeFlyer(),) if problem.floating else ()
        # Pinocchio's default leaves followers free, which reaches the same targets
        self.model = pin.buildModelFromUrdf(str(problem.path), *base)
        self.data = self.model.createData()
        self.frames = [pink.tasks.FrameTask(f, 1.0, 1.0 if kind == "pose" else 0.0, lm_damping=1e-3) for kind, f in problem.tasks]
        self.names = [problem.model.joint(n) for n in list(self.model.names)[1:]
                      if problem.model.joint(n).type != dyn.JointType.FREE_FLYER]

    def q(self, q):
        out = [q[:7]] if self.p.floating else []
        for j in self.names:  # a follower's coordinate is that of its leader here: ratio 1, offset 0
            out.append(q[j.idx_q : j.idx_q + 1])
        return np.concatenate(out)

    def once(self, k, q):
        c = self.pink.Configuration(self.model, self.data, self.q(q))
        for task, X in zip(self.frames, self.p.targets[k]):
            task.set_target(self.pin.SE3(X.rotation, X.translation))
        for _ in range(100):
            errors = [(t.compute_error(c), kind) for t, (kind, _) in zip(self.frames, self.p.tasks)]
            if all(np.linalg.norm(e[:3]) < TOLERANCE and (kind == "position" or np.linalg.norm(e[3:]) < TOLERANCE)
                   for e, kind in errors):
                return True
            try:
                v = self.pink.solve_ik(c, self.frames, 1.0, solver=self.solver, damping=1e-9, safety_break=False)
            except self.pink.exceptions.PinkError:
                return False
            c.integrate_inplace(v, 1.0)
        return False


class MuJoCo(Peer):
    name = "mujoco"

    def __init__(self, problem):
        import mujoco
        from mujoco import minimize

        self.p, self.mj, self.minimize = problem, mujoco, minimize
        root = ET.parse(problem.path).getroot()
        for link in root.iter("link"):
            for tag in ("visual", "collision"):
                for shape in link.findall(tag):
                    link.remove(shape)
        ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", fusestatic="false")
        if problem.floating:
            ET.SubElement(root, "link", name="world")
            joint = ET.SubElement(root, "joint", name="root_joint", type="floating")
            ET.SubElement(joint, "parent", link="world")
            ET.SubElement(joint, "child", link="base")
        m = self.m = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
        self.d = mujoco.MjData(m)
        self.bodies = [m.body(f).id for _, f in problem.tasks]
        # variables: position and rotation vector of the base from the start, then each joint of libdyn's q
        self.base = 6 if problem.floating else 0
        offset = 7 if problem.floating else 0
        joints = [m.joint(i) for i in range(m.njnt) if m.jnt_type[i] != mujoco.mjtJoint.mjJNT_FREE]
        self.index = np.array([problem.model.joint(j.name).idx_q - offset for j in joints])  # followers: of the leader
        self.qpos, self.dofs = np.array([j.qposadr[0] for j in joints]), np.array([j.dofadr[0] for j in joints])
        self.n = problem.model.nq - offset
        lower, upper = problem.model.array("lower_limit")[offset:], problem.model.array("upper_limit")[offset:]
        free = np.full(self.base, 1e3)
        self.bounds = [np.concatenate([-free, lower]), np.concatenate([free, upper])]

    def place(self, x):
        mj, d = self.mj, self.d
        if self.base:
            d.qpos[:3] = x[:3]
            d.qpos[3:7] = self.quat
            mj.mju_quatIntegrate(d.qpos[3:7], np.ascontiguousarray(x[3:6]), 1.0)
        d.qpos[self.qpos] = x[self.base :][self.index]
        mj.mj_kinematics(self.m, d)
        mj.mj_comPos(self.m, d)

    def rows(self, target):
        out = []
        for (kind, _), body, (X, quat) in zip(self.p.tasks, self.bodies, target):
            out.append(self.d.xpos[body] - X.translation)
            if kind == "pose":
                e = np.empty(3)
                self.mj.mju_subQuat(e, quat, self.d.xquat[body])
                out.append(e)
        return np.concatenate(out)

    def once(self, k, q):
        mj, m, d = self.mj, self.m, self.d
        target = []
        for X in self.p.targets[k]:
            quat = np.empty(4)
            mj.mju_mat2Quat(quat, np.ascontiguousarray(X.rotation).ravel())
            target.append((X, quat))
        self.quat = np.roll(q[3:7], 1) if self.base else None
        x0 = np.concatenate([q[:3], np.zeros(3), q[7:]]) if self.base else q

        def residual(x):
            out = []
            for column in np.atleast_2d(x.T):
                self.place(column)
                out.append(self.rows(target))
            return np.stack(out, axis=1)

        def jacobian(x, _):
            x = x.ravel()
            self.place(x)
            blocks = []
            for (kind, _), body, (_, quat) in zip(self.p.tasks, self.bodies, target):
                linear, angular = np.zeros((3, m.nv)), np.zeros((3, m.nv))
                mj.mj_jacBody(m, d, linear, angular, body)
                blocks.append(linear)
                if kind == "pose":
                    by = np.empty(9)
                    mj.mjd_subQuat(quat, d.xquat[body], None, by)
                    blocks.append(by.reshape(3, 3) @ d.xmat[body].reshape(3, 3).T @ angular)
            J, out = np.concatenate(blocks), np.zeros((sum(len(b) for b in blocks), self.base + self.n))
            if self.base:  # MuJoCo's angular velocity is in the base's axes: by the right Jacobian of the exponential
                w = x[3:6]
                t, W = np.linalg.norm(w), np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
                a, b = ((1 - np.cos(t)) / t**2, (t - np.sin(t)) / t**3) if t > 1e-4 else (0.5, 1 / 6)
                out[:, :3], out[:, 3:6] = J[:, :3], J[:, 3:6] @ (np.eye(3) - a * W + b * W @ W)
            for dof, i in zip(self.dofs, self.index):
                out[:, self.base + i] += J[:, dof]
            return out

        x, _ = self.minimize.least_squares(x0, residual, self.bounds, jacobian=jacobian, max_iter=100, verbose=0)
        self.place(x)
        r, at, good = self.rows(target), 0, True
        for kind, _ in self.p.tasks:
            for _ in range(2 if kind == "pose" else 1):
                good, at = good and np.linalg.norm(r[at : at + 3]) < TOLERANCE, at + 3
        return good


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--peer-count", type=int, help="fewer for the peers")
    parser.add_argument("--restarts", type=int, default=20)
    parser.add_argument("--robots", default="panda,go2")
    parser.add_argument("--libraries", default="dyn,pink,mujoco")
    parser.add_argument("--solver", default="daqp", help="Pink's QP solver")
    parser.add_argument("--markdown", action="store_true")
    options = parser.parse_args()
    head = ["robot", "library", "targets", "met from the first start", "met", "median us", "p90 us", "p99 us"]
    table, notes = [], []
    for robot in options.robots.split(","):
        problem = Problem(robot, options.count, options.restarts)
        for library in options.libraries.split(","):
            solver = {"dyn": lambda p: Dyn(p), "pink": lambda p: Pink(p, options.solver),
                      "mujoco": lambda p: MuJoCo(p)}[library](problem)
            count = options.count if library == "dyn" else options.peer_count or options.count
            solver.solve(0)  # warm
            results = [solver.solve(k) for k in range(count)]
            times = np.array([1e6 * t for *_, t in results])
            met, first = sum(r[0] for r in results), sum(r[0] and r[1] == 0 for r in results)
            table.append([robot, library, str(count), f"{100 * first / count:.1f} %", f"{100 * met / count:.1f} %"]
                         + [f"{np.percentile(times, p):.0f}" for p in (50, 90, 99)])
            if library == "dyn":
                notes.append(f"{robot}: of libdyn's times the Python package takes {1e6 * solver.overhead():.1f} us a call")
    if options.markdown:
        for row in [head, ["---"] * len(head), *table]:
            print("| " + " | ".join(row) + " |")
    else:
        width = [max(len(row[c]) for row in [head, *table]) for c in range(len(head))]
        for row in [head, *table]:
            print("  ".join(x.ljust(w) for x, w in zip(row, width)).rstrip())
    print()
    for note in notes:
        print(note + ".")


if __name__ == "__main__":
    main()
