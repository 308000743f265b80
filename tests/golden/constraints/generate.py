#!/usr/bin/env python3
"""Writes figures.json: Pinocchio's constrained dynamics and its derivatives, of a quadruped on four points and a humanoid on two
faces.

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
            type, axes = (pin.ContactType.CONTACT_3D,
                          pin.LOCAL_WORLD_ALIGNED) if self.point else (pin.ContactType.CONTACT_6D, pin.LOCAL)
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
        """ddq and lambda of the KKT system, lambda along the world's axes."""
        M = pin.crba(self.model, self.data, q)
        h, J = pin.nonLinearEffects(self.model, self.data, q, v), self.jacobian(q)
        pin.forwardKinematics(self.model, self.data, q, v, 0 * v)
        drift = []
        for f in self.frames:
            a = pin.getFrameClassicalAcceleration(self.model, self.data, f, pin.LOCAL_WORLD_ALIGNED).vector
            drift.append(a[:3] if self.point else a)
        n, r = len(v), len(J)
        K = np.block([[M, J.T], [J, np.zeros((r, r))]])
        x = np.linalg.solve(K, np.concatenate([tau - h, -np.concatenate(drift)]))
        return np.concatenate([x[:n], -x[n:]])

    def forces(self, q):
        """lambda and its derivatives by q, v, tau, along the world's axes; Pinocchio's are in the frames' where these are
        faces."""
        d, value, by = self.data, [], [[], [], []]
        pin.computeJointJacobians(self.model, d, q)
        pin.updateFramePlacements(self.model, d)
        size = 3 if self.point else 6
        for k, f in enumerate(self.frames):
            rows = slice(size * k, size * (k + 1))
            force = d.lambda_c[rows].copy()
            parts = [x[rows].copy() for x in (d.dlambda_dq, d.dlambda_dv, d.dlambda_dtau)]
            if not self.point:
                R = d.oMf[f].rotation
                turn = np.kron(np.eye(2), R)
                w = pin.getFrameJacobian(self.model, d, f, pin.LOCAL_WORLD_ALIGNED)[3:]
                force, parts = turn @ force, [turn @ x for x in parts]
                parts[0] = parts[0] + np.vstack([np.cross(w.T, half).T for half in (force[:3], force[3:])])
            value.append(force)
            for of, x in zip(by, parts):
                of.append(x)
        return np.concatenate(value), [np.vstack(x) for x in by]

    def state(self, seed):
        g = np.random.default_rng(seed)
        q = pin.neutral(self.model)
        q = pin.integrate(self.model, q, g.uniform(-0.8, 0.8, self.model.nv))
        v, tau = self.still(q, g.normal(size=self.model.nv)), g.normal(size=self.model.nv)
        ddq = pin.constraintDynamics(self.model, self.data, q, v, tau, self.contacts, self.work, SETTINGS).copy()
        n, dense = self.model.nv, self.dense(q, v, tau)
        assert abs(ddq - dense[:n]).max() < 1e-10 * abs(ddq).max()
        pin.computeConstraintDynamicsDerivatives(self.model, self.data, self.contacts, self.work, SETTINGS)
        by = {"ddq_dq": self.data.ddq_dq.copy(), "ddq_dv": self.data.ddq_dv.copy(), "ddq_dtau": self.data.ddq_dtau.copy()}
        force, parts = self.forces(q)
        assert abs(force - dense[n:]).max() < 1e-9 * abs(force).max()
        by |= dict(zip(("lambda_dq", "lambda_dv", "lambda_dtau"), parts))
        push = pin.rnea(self.model, self.data, q, v, ddq) - tau
        moves = {"ddq_dq": lambda e: (pin.integrate(self.model, q, e), v, tau), "ddq_dv": lambda e: (q, v + e, tau),
                 "ddq_dtau": lambda e: (q, v, tau + e)}
        for name, move in moves.items():
            for k in range(0, self.model.nv, 5):
                e = np.zeros(self.model.nv)
                e[k] = 1
                slope = lambda h: (self.dense(*move(h * e)) - self.dense(*move(-h * e))) / (2 * h)
                expected = (4 * slope(5e-4) - slope(1e-3)) / 3
                for part, at in ((name, slice(0, n)), (name.replace("ddq", "lambda", 1), slice(n, None))):
                    assert abs(by[part][:, k] - expected[at]).max() < 1e-6 * max(1, abs(by[part]).max()), part
        out = {"q": q[self.q], "v": v[self.v], "tau": tau[self.v], "ddq": ddq[self.v], "push": push[self.v], "lambda": force}
        return out | {name: x[np.ix_(self.v, self.v)] if name.startswith("ddq") else x[:, self.v] for name, x in by.items()}


def main():
    text = {"pin": pin.__version__, "robots": {}}
    for name, seeds in (("go2", (1, 2)), ("humanoid", (1,))):
        robot = Robot(name)
        states = [{k: x.tolist() for k, x in robot.state(seed).items()} for seed in seeds]
        text["robots"][name] = {"kind": FEET[name][0], "feet": FEET[name][1], "states": states}
    (HERE / "figures.json").write_text(json.dumps(text) + "\n")


if __name__ == "__main__":
    main()
