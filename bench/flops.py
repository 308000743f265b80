#!/usr/bin/env python3
"""Multiplications and additions that the textbook recursions take on a robot, counted by running them.

Usage:  flops.py MODEL.urdf --fixed|--floating [--json]        (with a Python that has Pinocchio)

Each recursion below is written out in scalars and run on numbers that count their operations; its result is compared with
Pinocchio's (1e-9 relative), so that what is counted is the whole algorithm. Vectors are in world axes, as in libdyn. Joints are
turned beforehand so that they move along or about z. Sines and cosines are not counted; nor are products with the zeros and ones
of the formulas themselves (those of the robot are: a general robot has none). A division counts as a multiplication. Followers of a mimic are joints like
others here.

  fk                rotation and position of each body: two columns turn by q, one product with the parent's rotation
  rnea              Luh, Walker, Paul 1980: Newton-Euler at each body's own origin
  crba              Featherstone 2008, section 6.2, at the origin of the tree's root: composites add, F_i = Ic S_i, M_ji = S_j . F_i
  aba               Featherstone 2008, section 7.3, articulated inertias as three 3 x 3 blocks at each body's own origin
  rnea_derivatives  Singh, Russell, Wensing 2022, equations 18 to 21, with M, at the origin of the tree's root; a body's mass
                    distribution and its rate as first and second moments (22 numbers)
"""
import argparse
import json
import math
import sys


class Count:
    mul = add = 0


class N:
    """A number that counts. Zeros and ones of the formulas are plain Python numbers."""
    __slots__ = ("x",)

    def __init__(self, x):
        self.x = float(x)

    def __add__(self, b):
        if isinstance(b, N):
            Count.add += 1
            return N(self.x + b.x)
        return self if b == 0 else N(self.x + b)

    def __sub__(self, b):
        if isinstance(b, N):
            Count.add += 1
            return N(self.x - b.x)
        return self if b == 0 else N(self.x - b)

    def __mul__(self, b):
        if isinstance(b, N):
            Count.mul += 1
            return N(self.x * b.x)
        if b == 0:
            return 0
        return self if b == 1 else -self if b == -1 else N(self.x * b)  # a 2 of the formulas folds into constants

    def __rsub__(self, b):
        return -self if b == 0 else N(b - self.x)

    def __truediv__(self, b):
        Count.mul += 1
        return N(self.x / b.x)

    def __neg__(self):
        return N(-self.x)

    __radd__, __rmul__ = __add__, __mul__


O3 = (0, 0, 0)
def plus(a, b): return tuple(x + y for x, y in zip(a, b))
def minus(a, b): return tuple(x - y for x, y in zip(a, b))
def times(a, s): return tuple(x * s for x in a)
def neg(a): return tuple(0 - x for x in a)
def dot(a, b): return sum((x * y for x, y in zip(a, b)), 0)
def cross(a, b): return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
# matrices are tuples of columns
def mv(A, x): return tuple(A[0][i] * x[0] + A[1][i] * x[1] + A[2][i] * x[2] for i in range(3))
def tv(A, x): return tuple(dot(c, x) for c in A)                     # A^T x
def mm(A, B): return tuple(mv(A, c) for c in B)
def transposed(A): return tuple(zip(*A))
def mplus(A, B): return tuple(plus(a, b) for a, b in zip(A, B))
def mminus(A, B): return tuple(minus(a, b) for a, b in zip(A, B))
def outer(a, b): return tuple(times(a, y) for y in b)                # a b^T
def skew(a): return ((0, a[2], 0 - a[1]), (0 - a[2], 0, a[0]), (a[1], 0 - a[0], 0))
def symmetric(entry): # of entry(row, column), the six on and above the diagonal
    e = {(i, j): entry(i, j) for j in range(3) for i in range(j + 1)}
    return tuple(tuple(e[min(i, j), max(i, j)] for i in range(3)) for j in range(3))
def congruence(R, I):                                                # R I R^T, I symmetric
    A = mm(R, I)
    return symmetric(lambda i, j: A[0][i] * R[0][j] + A[1][i] * R[1][j] + A[2][i] * R[2][j])
def splus(A, B): return symmetric(lambda i, j: A[j][i] + B[j][i])
# motions and forces: (linear, angular)
def plus6(a, b): return plus(a[0], b[0]), plus(a[1], b[1])
def minus6(a, b): return minus(a[0], b[0]), minus(a[1], b[1])
def times6(a, s): return times(a[0], s), times(a[1], s)
def dot6(a, b): return dot(a[0], b[0]) + dot(a[1], b[1])
def motion_cross(v, s): return plus(cross(v[1], s[0]), cross(v[0], s[1])), cross(v[1], s[1])
def force_cross(s, f): return cross(s[1], f[0]), plus(cross(s[1], f[1]), cross(s[0], f[0]))
WORLD = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


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


def place(bodies, q):
    for b in bodies:
        parent = None if b.root else bodies[b.parent]
        R, p = (WORLD, O3) if b.root else (parent.R, parent.p)
        x, y, z = b.Xr
        t = b.Xp
        if b.kind == "revolute":
            c, s = N(math.cos(q[b.idx_q].x)), N(math.sin(q[b.idx_q].x))
            x, y = plus(times(x, c), times(y, s)), minus(times(y, c), times(x, s))
        elif b.kind == "prismatic":
            t = plus(t, times(z, q[b.idx_q]))
        else:
            u = q[b.idx_q:b.idx_q + 7]
            t = plus(t, mv(b.Xr, u[:3]))
            a, b2, c, w = u[3:]
            n = times((a, b2, c), 2)
            aa, bb, cc = a * n[0], b2 * n[1], c * n[2]
            ab, ac, bc, wa, wb, wc = a * n[1], a * n[2], b2 * n[2], w * n[0], w * n[1], w * n[2]
            one = N(1)
            x, y, z = mm(b.Xr, ((one - (bb + cc), ab + wc, ac - wb), (ab - wc, one - (aa + cc), bc + wa), (ac + wb, bc - wa, one - (aa + bb))))
        b.r = mv(R, t)
        b.R = mm(R, (x, y, z))
        b.p = plus(p, b.r)


def fk(bodies, g, q):
    place(bodies, q)
    return [c for b in bodies for c in b.p]


def twist(b, x):  # of a free joint, given in the body's axes
    return mv(b.R, x[b.idx_v:b.idx_v + 3]), mv(b.R, x[b.idx_v + 3:b.idx_v + 6])


def rnea(bodies, g, q, v, a):
    place(bodies, q)
    for b in bodies:
        w, dw, acc = (O3, O3, neg(g)) if b.root else (bodies[b.parent].w, bodies[b.parent].dw, bodies[b.parent].acc)
        acc = plus(acc, plus(cross(dw, b.r), cross(w, cross(w, b.r))))
        z = b.R[2]
        if b.kind == "revolute":
            zv = times(z, v[b.idx_v])
            dw = plus(dw, plus(times(z, a[b.idx_v]), cross(w, zv)))
            w = plus(w, zv)
        elif b.kind == "prismatic":
            acc = plus(acc, plus(times(z, a[b.idx_v]), cross(w, times(z, v[b.idx_v] * 2))))
        else:
            (u, w), (du, dw) = twist(b, v), twist(b, a)
            acc = plus(acc, plus(du, cross(w, u)))
        b.w, b.dw, b.acc = w, dw, acc
        h = mv(b.R, b.h)
        b.f = plus(times(acc, b.m), plus(cross(dw, h), cross(w, cross(w, h))))
        wb, dwb = tv(b.R, w), tv(b.R, dw)
        b.n = plus(cross(h, acc), mv(b.R, plus(mv(b.I, dwb), cross(wb, mv(b.I, wb)))))
    tau = [0] * len(v)
    for b in reversed(bodies):
        if b.kind == "free":
            tau[b.idx_v:b.idx_v + 6] = tv(b.R, b.f) + tv(b.R, b.n)
        else:
            tau[b.idx_v] = dot(b.R[2], b.n if b.kind == "revolute" else b.f)
        if not b.root:
            up = bodies[b.parent]
            up.f, up.n = plus(up.f, b.f), plus(plus(up.n, b.n), cross(b.r, b.f))
    return tau


def columns(b):
    """S at the root's origin, which a body at the root has its own at."""
    z = b.R[2]
    if b.kind == "revolute":
        return [(cross(b.rel, z), z)]
    if b.kind == "prismatic":
        return [(z, O3)]
    return [(c, O3) for c in b.R] + [(cross(b.rel, c), c) for c in b.R]


def relative(bodies):
    for b in bodies:
        b.rel = O3 if b.root else b.r if bodies[b.parent].root else plus(bodies[b.parent].rel, b.r)


def supporting(bodies, b):  # b's own and its ancestors' degrees of freedom up to its k-th
    while True:
        yield b
        if b.root:
            return
        b = bodies[b.parent]


def crba(bodies, g, q):
    place(bodies, q)
    relative(bodies)
    for b in bodies:
        m, r, h = b.m, b.rel, mv(b.R, b.h)
        k = h if r == O3 else plus(h, times(r, m))
        I = congruence(b.R, b.I)
        if r != O3:
            both = dot(r, plus(h, k))
            I = symmetric(lambda i, j: I[j][i] - (r[i] * h[j] + k[i] * r[j]) + (both if i == j else 0))
        b.Y, b.S = [m, k, I], columns(b)
    n = sum(b.nv for b in bodies)
    M = [[0] * n for _ in range(n)]
    for b in reversed(bodies):
        m, h, I = b.Y
        for c, (u, w) in enumerate(b.S):
            F = plus(times(u, m), cross(w, h)), plus(mv(I, w), cross(h, u))
            for j in supporting(bodies, b):
                for l, s in enumerate(j.S if j is not b else j.S[:c + 1]):
                    M[j.idx_v + l][b.idx_v + c] = M[b.idx_v + c][j.idx_v + l] = dot6(s, F)
        if not b.root:
            up = bodies[b.parent].Y
            up[0], up[1], up[2] = up[0] + m, plus(up[1], h), splus(up[2], I)
    return [x for row in M for x in row]


def solve6(A, b):
    """L D L^T."""
    n = len(b)
    A, b = [list(row) for row in A], list(b)
    for k in range(n):
        for i in reversed(range(k + 1, n)):
            l = A[i][k] / A[k][k]
            for j in range(k + 1, i + 1):
                A[i][j] = A[i][j] - l * A[j][k]
            b[i] = b[i] - l * b[k]
            A[i][k] = l
    b = [x / A[k][k] for k, x in enumerate(b)]
    for k in reversed(range(n)):
        for i in range(k):
            b[i] = b[i] - A[k][i] * b[k]
    return b


def aba(bodies, g, q, v, tau):
    place(bodies, q)
    for b in bodies:
        w = O3 if b.root else bodies[b.parent].w
        z = b.R[2]
        cl, ca = cross(w, cross(w, b.r)), O3
        if b.kind == "revolute":
            zv = times(z, v[b.idx_v])
            ca, w = cross(w, zv), plus(w, zv)
        elif b.kind == "prismatic":
            cl = plus(cl, cross(w, times(z, v[b.idx_v] * 2)))
        else:
            u, w = twist(b, v)
            cl = cross(w, u)
        b.w, b.c = w, (cl, ca)
        h, I = mv(b.R, b.h), congruence(b.R, b.I)
        b.M, b.H, b.J = symmetric(lambda i, j: b.m if i == j else 0), skew(neg(h)), I
        b.pa = cross(w, cross(w, h)), cross(w, mv(I, w))
    for b in reversed(bodies):
        if b.kind == "free":
            continue
        z, k = b.R[2], b.idx_v
        U = (mv(b.H, z), mv(b.J, z)) if b.kind == "revolute" else (mv(b.M, z), tv(b.H, z))
        D = dot(z, U[1] if b.kind == "revolute" else U[0])
        b.u = tau[k] - dot(z, b.pa[1] if b.kind == "revolute" else b.pa[0])
        b.U, b.D = U, N(1) / D
        if b.root:
            continue
        V = times6(U, b.D)
        M = symmetric(lambda i, j: b.M[j][i] - U[0][i] * V[0][j])
        H = mminus(b.H, outer(U[0], V[1]))
        J = symmetric(lambda i, j: b.J[j][i] - U[1][i] * V[1][j])
        cl, ca = b.c
        Ic = plus(mv(M, cl), mv(H, ca)), plus(tv(H, cl), mv(J, ca))
        f, n = plus6(plus6(b.pa, times6(V, b.u)), Ic)
        up, S = bodies[b.parent], skew(b.r)
        Hs = mminus(H, mm(M, S))
        A, B = mm(transposed(H), S), mm(S, Hs)  # only the six entries on and above the diagonal are used
        up.M, up.H = splus(up.M, M), mplus(up.H, Hs)
        up.J = symmetric(lambda i, j: up.J[j][i] + (J[j][i] - A[j][i] + B[j][i]))
        Count.mul -= 12  # those below it
        Count.add -= 6
        up.pa = plus6(up.pa, (f, plus(n, cross(b.r, f))))
    ddq = [0] * len(v)
    for b in bodies:
        k = b.idx_v
        al, aw = (neg(g), O3) if b.root else (bodies[b.parent].al, bodies[b.parent].aw)
        al, aw = plus(plus(al, cross(aw, b.r)), b.c[0]), plus(aw, b.c[1])
        if b.kind == "free":
            fl, fa = twist(b, tau)
            rows = [[b.M[j][i] for j in range(3)] + [b.H[j][i] for j in range(3)] for i in range(3)]
            rows += [[b.H[i][j] for j in range(3)] + [b.J[j][i] for j in range(3)] for i in range(3)]
            x = solve6(rows, minus(fl, b.pa[0]) + minus(fa, b.pa[1]))
            b.al, b.aw = tuple(x[:3]), tuple(x[3:])
            ddq[k:k + 6] = tv(b.R, minus(b.al, al)) + tv(b.R, b.aw)
            continue
        ddq[k] = (b.u - dot6(b.U, (al, aw))) * b.D
        s = times(b.R[2], ddq[k])
        b.al, b.aw = (al, plus(aw, s)) if b.kind == "revolute" else (plus(al, s), aw)
    return ddq


def trace_turn(A, w):  # tr(A) w - A w
    d = (A[1][1] + A[2][2], A[0][0] + A[2][2], A[0][0] + A[1][1])
    off = tuple(sum((A[j][i] * w[j] for j in range(3) if j != i), 0) for i in range(3))
    return tuple(d[i] * w[i] - off[i] for i in range(3))


def rnea_derivatives(bodies, g, q, v, a):
    place(bodies, q)
    relative(bodies)
    for b in bodies:
        vp, ap = ((O3, O3), (neg(g), O3)) if b.root else (bodies[b.parent].v, bodies[b.parent].a)
        b.S = columns(b)
        b.dS = [motion_cross(vp, s) for s in b.S]
        b.ddS = [plus6(motion_cross(ap, s), motion_cross(vp, d)) for s, d in zip(b.S, b.dS)]
        vi, ai = vp, ap
        for c, (s, d) in enumerate(zip(b.S, b.dS)):
            vi = plus6(vi, times6(s, v[b.idx_v + c]))
            ai = plus6(ai, plus6(times6(s, a[b.idx_v + c]), times6(d, v[b.idx_v + c])))
        b.W = [times6(d, 2) for d in b.dS] if b.nv == 1 else [plus6(d, motion_cross(vi, s)) for s, d in zip(b.S, b.dS)]
        b.v, b.a = vi, ai
        # moments and their rates
        m, r = b.m, b.rel
        Rh, A = mv(b.R, b.h), mm(b.R, b.P)
        h = Rh if r == O3 else plus(Rh, times(r, m))
        P = symmetric(lambda i, j: dot([A[k][i] for k in range(3)], [b.R[k][j] for k in range(3)]))
        if r != O3:
            P = symmetric(lambda i, j: P[j][i] + (r[i] * Rh[j] + h[i] * r[j]))
        p = plus(times(vi[0], m), cross(vi[1], h))
        V = tuple(plus(cross(vi[1], P[j]), times(vi[0], h[j])) for j in range(3))
        f = plus(times(ai[0], m), plus(cross(ai[1], h), cross(vi[1], p)))
        n = plus(cross(h, ai[0]), plus(trace_turn(P, ai[1]), trace_turn(V, vi[1])))
        b.Y, b.B, b.f = [m, h, P], [p, V], (f, n)
    n = sum(b.nv for b in bodies)
    dq, dv, M = ([[0] * n for _ in range(n)] for _ in range(3))
    for b in reversed(bodies):
        m, h, P = b.Y
        p, V = b.B
        apply = lambda s: (plus(times(s[0], m), cross(s[1], h)), plus(cross(h, s[0]), trace_turn(P, s[1])))
        coriolis = lambda s: (times(cross(s[1], p), 2), times(trace_turn(V, s[1]), 2))
        for c in range(b.nv):
            s, i = b.S[c], b.idx_v + c
            F = apply(s)
            Fq = plus6(plus6(coriolis(b.dS[c]), apply(b.ddS[c])), force_cross(s, b.f))
            Fv = plus6(coriolis(s), apply(b.W[c]))
            t = V[0][0] + V[1][1] + V[2][2]
            Q = times(plus(cross(p, s[0]), minus(times(s[1], t), tv(V, s[1]))), 2)
            for j in supporting(bodies, b):
                for l in range(j.nv):
                    k = j.idx_v + l
                    if j is b and l > c:
                        continue
                    M[k][i] = M[i][k] = dot6(j.S[l], F)
                    dq[k][i], dv[k][i] = dot6(j.S[l], Fq), dot6(j.S[l], Fv)
                    if k != i:
                        dq[i][k] = dot6(j.ddS[l], F) + dot(j.dS[l][1], Q)
                        dv[i][k] = dot6(j.W[l], F) + dot(j.S[l][1], Q)
        for c in range(1, b.nv):  # what turns the force turns the columns of one joint as well
            turned = force_cross(b.S[c], b.f)
            for l in range(c):
                dq[b.idx_v + l][b.idx_v + c] = dq[b.idx_v + l][b.idx_v + c] - dot6(b.S[l], turned)
        if not b.root:
            up = bodies[b.parent]
            up.Y = [up.Y[0] + m, plus(up.Y[1], h), splus(up.Y[2], P)]
            up.B = [plus(up.B[0], p), mplus(up.B[1], V)]
            up.f = plus6(up.f, b.f)
    return [x for matrix in (dq, dv, M) for row in matrix for x in row]


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
    for f, inputs, right in ((fk, (q,), placements), (rnea, (q, v, a), lambda: pin.rnea(model, data, q, v, a)), (crba, (q,), mass),
                             (aba, (q, v, a), lambda: pin.aba(model, data, q, v, a)), (rnea_derivatives, (q, v, a), derivatives)):
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
