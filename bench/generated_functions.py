"""Rigid-body dynamics of one robot as functions of CasADi, in the forms that take the fewest operations: for generated_code.py.

The recursions are those of body_frames.py, where zeros and ones of the robot fold away. Where there are several ways, the one of
the fewest operations counts: accelerations by articulated inertias or by the sparse factor of M; derivatives by casadi.jacobian or
by the formulas of Singh, Russell and Wensing 2022 (recursions.py); those of forward dynamics also as -M^-1 times those of inverse
dynamics. casadi.cse shares what is equal. Of symmetric matrices the lower triangle is computed.
"""
import functools

import casadi
import numpy as np

import body_frames
import recursions
from counting import cross, neg, plus
from libdyn import JointType

ALGORITHMS = ["rnea", "aba", "crba", "rnea_derivatives", "aba_derivatives"]


class Body:
    pass


def bodies_of(model):
    """Joints' frames turned so that z is the axis, and what bodies weigh in them; parents come first."""
    def clean(x):  # a right angle of a robot file has a cosine of 6e-17
        near = round(float(x))
        return near if abs(x - near) < 1e-14 else float(x)

    columns = lambda M: tuple(tuple(clean(M[r, c]) for r in range(3)) for c in range(3))
    vector = lambda u: tuple(clean(e) for e in u)
    kinds = {JointType.REVOLUTE: "revolute", JointType.CONTINUOUS: "revolute",
             JointType.PRISMATIC: "prismatic", JointType.FREE_FLYER: "free"}
    moments = np.reshape(model.inertial_parameters(), (-1, 10))
    turn, bodies = [np.eye(3)], []
    for joint, pi in zip(model.joints[1:], moments):
        b = Body()
        b.kind = kinds.get(joint.type)
        if not b.kind or joint.mimic_leader >= 0 or (b.kind == "free" and joint.parent):
            raise ValueError(f"joint '{joint.name}': only revolute and prismatic joints that follow no other, and a free root")
        z = np.array([0, 0, 1.0]) if b.kind == "free" else joint.axis
        x = np.eye(3)[(int(np.argmax(abs(z))) + 1) % 3]
        x = x - z * (x @ z)
        x /= np.linalg.norm(x)
        A = np.column_stack([x, np.cross(z, x), z]) if b.kind != "free" else np.eye(3)
        turn.append(A)
        up, X = turn[joint.parent], joint.placement
        I = A.T @ np.array([[pi[4], pi[5], pi[7]], [pi[5], pi[6], pi[8]], [pi[7], pi[8], pi[9]]]) @ A
        b.parent, b.idx_q, b.idx_v, b.nv, b.root = joint.parent - 1, joint.idx_q, joint.idx_v, joint.nv, joint.parent == 0
        b.Xr, b.Xp = columns(up.T @ X.rotation @ A), vector(up.T @ X.translation)
        b.m, b.h, b.I = float(pi[0]), vector(A.T @ pi[1:4]), columns(I)
        b.P = columns(np.trace(I) / 2 * np.eye(3) - I)
        bodies.append(b)
    return bodies


def column(x):
    return casadi.vertcat(*x)


def scalars(x):
    return tuple(casadi.vertsplit(casadi.densify(x)))


def matrix(rows):
    return casadi.sparsify(casadi.vertcat(*(casadi.horzcat(*row) for row in rows)))


class Dynamics:
    """Expressions of a robot in q, v and a (tau for forward dynamics)."""

    def __init__(self, model):
        self.bodies, self.n = bodies_of(model), model.nv
        self.gravity = tuple(float(x) for x in model.gravity)
        self.symbols = [casadi.SX.sym(name, size) for name, size in (("q", model.nq), ("v", model.nv), ("a", model.nv))]
        self.q, self.v, self.a = (scalars(x) for x in self.symbols)
        self.parents = body_frames.parents_of(self.bodies)
        self.root = next((b for b in self.bodies if b.kind == "free"), None)
        self.theta = casadi.SX.sym("theta", 3)  # a turn of the free root, which is zero
        self.up = self.turned = neg(self.gravity)
        if self.root:
            self.up = body_frames.free_gravity(self.gravity, self.root, self.q)
            self.turned = plus(self.up, cross(self.up, scalars(self.theta)))

    def rnea(self, a, up=None):
        return column(body_frames.rnea(self.bodies, up or self.up, self.q, self.v, a))

    def aba(self, up=None):
        return column(body_frames.aba(self.bodies, up or self.up, self.q, self.v, self.a))

    def mass(self):
        return body_frames.crba(self.bodies, self.q)

    @functools.cached_property
    def factor(self):
        return body_frames.factorize(self.mass(), self.parents)

    def solve(self, columns):
        """M^-1 times each column."""
        solved = lambda k: column(body_frames.solve(self.factor, self.parents, scalars(columns[:, k])))
        return casadi.horzcat(*map(solved, range(columns.shape[1])))

    def by_factor(self):
        return self.solve(self.symbols[2] - self.rnea((0,) * self.n))

    def jacobians(self, y):
        """Of y, a function of turned, by the tangent of q and by v."""
        still = lambda J: casadi.sparsify(casadi.substitute(J, self.theta, casadi.SX.zeros(3)))
        by_q = casadi.jacobian(y, self.symbols[0])
        if self.root:
            by_q = casadi.horzcat(casadi.SX(self.n, 3), casadi.jacobian(y, self.theta), by_q[:, self.root.idx_q + 7:])
        return [still(by_q), still(casadi.jacobian(y, self.symbols[1]))]

    def by_formulas(self, a):
        """dtau_dq, dtau_dv, M."""
        x = recursions.rnea_derivatives(self.bodies, self.gravity, self.q, self.v, a)
        rows = [x[k:k + self.n] for k in range(0, len(x), self.n)]
        return [matrix(rows[k:k + self.n]) for k in range(0, 3 * self.n, self.n)]

    def rnea_derivatives(self):
        """dtau_dq, dtau_dv, M, tau."""
        yield [*self.jacobians(self.rnea(self.a, self.turned)), casadi.tril(matrix(self.mass())), self.rnea(self.a)]
        by_q, by_v, M = self.by_formulas(self.a)
        yield [by_q, by_v, casadi.tril(M), self.rnea(self.a)]

    def aba_derivatives(self):
        """ddq_dq, ddq_dv, Minv, ddq."""
        yield [*self.jacobians(self.aba(self.turned)), casadi.tril(casadi.jacobian(self.aba(), self.symbols[2])), self.aba()]
        minv = casadi.tril(self.solve(casadi.SX.eye(self.n)))
        held = casadi.SX.sym("ddq", self.n)
        for ddq in (self.aba(), self.by_factor()):
            for derivatives in (self.jacobians(self.rnea(scalars(held), self.turned)), self.by_formulas(scalars(ddq))):
                yield [self.solve(-casadi.substitute(D, held, ddq)) for D in derivatives[:2]] + [minv, ddq]

    def ways(self, algorithm):
        """Lists of outputs, in the order of libdyn's C call."""
        if algorithm.endswith("derivatives"):
            return getattr(self, algorithm)()
        return {"rnea": lambda: [[self.rnea(self.a)]], "aba": lambda: [[self.aba()], [self.by_factor()]],
                "crba": lambda: [[casadi.tril(matrix(self.mass()))]]}[algorithm]()


def function(model, algorithm):
    """CasADi's function of q, v and a (tau)."""
    dynamics = Dynamics(model)
    found = [casadi.Function(algorithm, dynamics.symbols, casadi.cse(outputs)) for outputs in dynamics.ways(algorithm)]
    return min(found, key=lambda f: f.n_instructions())
