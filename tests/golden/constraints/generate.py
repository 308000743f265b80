#!/usr/bin/env python3
"""Writes figures.json: Pinocchio's constrained dynamics and its derivatives, of a quadruped on four points and a humanoid on two faces.

Usage:  python tests/golden/constraints/generate.py     (needs pin 4.1.0 and numpy)

In libdyn's order, which is that of the file; Pinocchio's is alphabetical. Velocities keep the feet still, so that references of
accelerations do not differ. push is J' lambda. Each figure is compared with the dense KKT system before it is stored, and the
derivatives with differences of it.
"""
import json
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy as np
import pinocchio as pin

HERE = Path(__file__).resolve().parent
ROBOTS = HERE.parents[2] / "models" / "robots"
FEET = {"go2": ("point", ["FL_foot", "FR_foot", "RL_foot", "RR_foot"]), "humanoid": ("frame", ["left_sole", "right_sole"])}
SETTINGS = pin.ProximalSettings(1e-15, 1e-15, 50)


class Robot:
    def __init__(self, name):
        kind, feet = FEET[name]
        path = ROBOTS / f"{name}.urdf"
        self.model = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
        self.data = self.model.createData()
        self.frames = [self.model.getFrameId(foot) for foot in feet]
        self.point = kind == "point"
        self.contacts, self.work = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for f in self.frames:
            frame = self.model.frames[f]
            type, axes = (pin.ContactType.CONTACT_3D, pin.LOCAL_WORLD_ALIGNED) if self.point else (pin.ContactType.CONTACT_6D, pin.LOCAL)
            self.contacts.append(pin.RigidConstraintModel(type, self.model, frame.parentJoint, frame.placement, axes))
            self.work.append(self.contacts[-1].createData())
        pin.initConstraintDynamics(self.model, self.data, self.contacts, self.work)
        # joints in the order of the file, depth first
        root = xml.parse(path).getroot()
        below = {}
        for j in root.findall("joint"):
            below.setdefault(j.find("parent").get("link"), []).append((j.get("name"), j.find("child").get("link")))
        children = {child for of in below.values() for _, child in of}
        names = []

        def visit(link):
            for joint, child in below.get(link, []):
                if self.model.existJointName(joint):
                    names.append(joint)
                visit(child)

        visit(next(link for link in below if link not in children))
        joints = [self.model.joints[self.model.getJointId(n)] for n in names]
        self.q = list(range(7)) + [j.idx_q for j in joints]
        self.v = list(range(6)) + [j.idx_v for j in joints]
        assert len(self.v) == self.model.nv

    def jacobian(self, q):
        J = [pin.computeFrameJacobian(self.model, self.data, q, f, pin.LOCAL_WORLD_ALIGNED) for f in self.frames]
        return np.vstack([j[:3] if self.point else j for j in J])

    def still(self, q, v):
        M, J = pin.crba(self.model, self.data, q), self.jacobian(q)
        Z = np.linalg.solve(M, J.T)
        for _ in range(3):
            v = v - Z @ np.linalg.solve(J @ Z, J @ v)
        return v

    def dense(self, q, v, tau):
        """ddq of the KKT system."""
        M = pin.crba(self.model, self.data, q)
        h, J = pin.nonLinearEffects(self.model, self.data, q, v), self.jacobian(q)
        pin.forwardKinematics(self.model, self.data, q, v, 0 * v)
        drift = []
        for f in self.frames:
            a = pin.getFrameClassicalAcceleration(self.model, self.data, f, pin.LOCAL_WORLD_ALIGNED).vector
            drift.append(a[:3] if self.point else a)
        n, r = len(v), len(J)
        K = np.block([[M, J.T], [J, np.zeros((r, r))]])
        return np.linalg.solve(K, np.concatenate([tau - h, -np.concatenate(drift)]))[:n]

    def state(self, seed):
        g = np.random.default_rng(seed)
        q = pin.neutral(self.model)
        q = pin.integrate(self.model, q, g.uniform(-0.8, 0.8, self.model.nv))
        v, tau = self.still(q, g.normal(size=self.model.nv)), g.normal(size=self.model.nv)
        ddq = pin.constraintDynamics(self.model, self.data, q, v, tau, self.contacts, self.work, SETTINGS).copy()
        assert abs(ddq - self.dense(q, v, tau)).max() < 1e-10 * abs(ddq).max()
        pin.computeConstraintDynamicsDerivatives(self.model, self.data, self.contacts, self.work, SETTINGS)
        by = {"ddq_dq": self.data.ddq_dq.copy(), "ddq_dv": self.data.ddq_dv.copy(), "ddq_dtau": self.data.ddq_dtau.copy()}
        push = pin.rnea(self.model, self.data, q, v, ddq) - tau
        moves = {"ddq_dq": lambda e: (pin.integrate(self.model, q, e), v, tau), "ddq_dv": lambda e: (q, v + e, tau), "ddq_dtau": lambda e: (q, v, tau + e)}
        for name, move in moves.items():
            for k in range(0, self.model.nv, 5):
                e = np.zeros(self.model.nv)
                e[k] = 1
                slope = lambda h: (self.dense(*move(h * e)) - self.dense(*move(-h * e))) / (2 * h)
                expected = (4 * slope(5e-4) - slope(1e-3)) / 3
                assert abs(by[name][:, k] - expected).max() < 1e-6 * max(1, abs(by[name]).max()), name
        out = {"q": q[self.q], "v": v[self.v], "tau": tau[self.v], "ddq": ddq[self.v], "push": push[self.v]}
        return out | {name: x[np.ix_(self.v, self.v)] for name, x in by.items()}


def main():
    text = {"pin": pin.__version__, "robots": {}}
    for name, seeds in (("go2", (1, 2)), ("humanoid", (1,))):
        robot = Robot(name)
        states = [{k: x.tolist() for k, x in robot.state(seed).items()} for seed in seeds]
        text["robots"][name] = {"kind": FEET[name][0], "feet": FEET[name][1], "states": states}
    (HERE / "figures.json").write_text(json.dumps(text) + "\n")


if __name__ == "__main__":
    main()
