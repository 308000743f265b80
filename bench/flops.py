#!/usr/bin/env python3
"""Multiplications and additions that the textbook recursions take on a robot, counted by running them.

Usage:  flops.py MODEL.urdf --fixed|--floating [--json]        (with a Python that has Pinocchio)

Each recursion below is written out in scalars and run on numbers that count their operations; its result is compared with
Pinocchio's (1e-9 relative), so that what is counted is the whole algorithm. Vectors are in world axes, as in libdyn. Joints are
turned beforehand so that they move along or about z. Sines and cosines are not counted; nor are products with the zeros and ones
of the formulas themselves (those of the robot are: a general robot has none). A division counts as a multiplication. Followers of
a mimic are joints like others here.

  forward_kinematics  rotation and position of each body: two columns turn by q, one product with the parent's rotation
  rnea              Luh, Walker, Paul 1980: Newton-Euler at each body's own origin
  crba              Featherstone 2008, section 6.2, at the origin of the tree's root: composites add, F_i = Ic S_i, M_ji = S_j . F_i
  aba               Featherstone 2008, section 7.3, articulated inertias as three 3 x 3 blocks at each body's own origin
  rnea_derivatives  Singh, Russell, Wensing 2022, equations 18 to 21, with M, at the origin of the tree's root; a body's mass
                    distribution and its rate as first and second moments (22 numbers)
"""
import argparse
import json
import sys

from counting import Count, N
from recursions import aba, crba, forward_kinematics, rnea, rnea_derivatives


class Body:
    pass


def bodies_of(pin, model):
    """Joints' frames turned so that z is the axis, and what bodies weigh in them; parents come first."""
    import numpy as np
    turn = [np.eye(3)]
    bodies = []
    for i in range(1, model.njoints):
        joint, name = model.joints[i], model.joints[i].shortname()
        b = Body()
        if name == "JointModelFreeFlyer":
            b.kind, z = "free", np.array([0, 0, 1.0])
        elif name.startswith("JointModelR") and "UB" not in name and "Unbounded" not in name and joint.nv == 1:
            b.kind, z = "revolute", None
        elif name.startswith("JointModelP") and joint.nv == 1:
            b.kind, z = "prismatic", None
        else:
            sys.exit(f"flops: joint '{model.names[i]}' is of type {name}: only revolute, prismatic and free ones are counted")
        if z is None:
            data = joint.createData()
            joint.calc(data, np.zeros(model.nq), np.zeros(model.nv))
            S = np.ravel(data.S)
            z = S[3:] if b.kind == "revolute" else S[:3]
        helper = np.eye(3)[int(np.argmin(abs(z)))]
        x = np.cross(helper, z) / np.linalg.norm(np.cross(helper, z))
        A = np.eye(3) if b.kind == "free" else np.column_stack([x, np.cross(z, x), z])
        turn.append(A)
        p = model.parents[i]
        X, Y = model.jointPlacements[i], model.inertias[i]
        counted = lambda M: tuple(tuple(N(M[r, c]) for r in range(3)) for c in range(3))
        vector = lambda u: tuple(N(e) for e in u)
        c = A.T @ Y.lever
        I = A.T @ Y.inertia @ A + Y.mass * (c @ c * np.eye(3) - np.outer(c, c))
        b.parent, b.idx_q, b.idx_v, b.nv, b.root = p - 1, joint.idx_q, joint.idx_v, joint.nv, p == 0
        b.Xr, b.Xp = counted(turn[p].T @ X.rotation @ A), vector(turn[p].T @ X.translation)
        b.m, b.h, b.I, b.P = N(Y.mass), vector(Y.mass * c), counted(I), counted(np.trace(I) / 2 * np.eye(3) - I)
        if p != 0 and b.kind == "free":
            sys.exit("flops: a free joint must be at the root")
        bodies.append(b)
    return bodies


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("urdf")
    base = parser.add_mutually_exclusive_group(required=True)
    base.add_argument("--fixed", action="store_true")
    base.add_argument("--floating", action="store_true")
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    try:
        import numpy as np
        import pinocchio as pin
    except ImportError as e:
        sys.exit(f"flops: {e}: run it with the Python that bench/peers/build_pinocchio.py prepares")
    try:
        model = pin.buildModelFromUrdf(args.urdf, *([pin.JointModelFreeFlyer()] if args.floating else []))
    except ValueError as e:
        sys.exit(f"flops: {args.urdf}: {e}")
    model.armature = np.zeros(model.nv)
    data = model.createData()
    random = np.random.default_rng(1)
    q = pin.integrate(model, pin.neutral(model), random.uniform(-1, 1, model.nv))
    v, a = random.uniform(-1, 1, (2, model.nv))

    def derivatives():
        pin.computeRNEADerivatives(model, data, q, v, a)
        M = np.triu(data.M) + np.triu(data.M, 1).T
        return np.concatenate([np.ravel(data.dtau_dq), np.ravel(data.dtau_dv), np.ravel(M)])

    def placements():
        pin.forwardKinematics(model, data, q)
        return np.concatenate([data.oMi[i].translation for i in range(1, model.njoints)])

    def mass():
        M = pin.crba(model, data, q)
        return np.ravel(np.triu(M) + np.triu(M, 1).T)

    bodies = bodies_of(pin, model)
    counted = lambda x: [N(e) for e in x]
    out = {}
    for f, inputs, right in ((forward_kinematics, (q,), placements), (rnea, (q, v, a), lambda: pin.rnea(model, data, q, v, a)),
                             (crba, (q,), mass), (aba, (q, v, a), lambda: pin.aba(model, data, q, v, a)),
                             (rnea_derivatives, (q, v, a), derivatives)):
        arguments = [tuple(counted(x)) for x in inputs]
        Count.mul = Count.add = 0
        y = np.array([x.x if isinstance(x, N) else float(x) for x in f(bodies, tuple(counted(model.gravity.linear)), *arguments)])
        out[f.__name__] = {"mul": Count.mul, "add": Count.add}
        x = right()
        error = np.abs(y - x).max() / np.abs(x).max()
        if not error < 1e-9:
            sys.exit(f"flops: {f.__name__} as counted differs from Pinocchio's by {error:g} relative")
    if args.json:
        print(json.dumps(out))
    else:
        for name, n in out.items():
            print(f"{name:18} {n['mul']:8} multiplications {n['add']:8} additions {n['mul'] + n['add']:8} together")


if __name__ == "__main__":
    main()
