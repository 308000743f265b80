"""Recursions in body frames (Featherstone 2008), of any numbers, for generated_code.py: the axis of a joint is its frame's z.

Linear accelerations are classical ones of the frame's origin, gravity included. A zero of the robot costs nothing when the numbers
fold it. free_gravity is -gravity in the axes of a free root, fixed_gravity in the world's.
"""
from counting import O3, congruence, cross, dot, minus, mm, mplus, mv, neg, plus, skew, splus, symmetric, times, transposed, tv

Z = (0, 0, 1)


def shifted(r, m, h, I):
    """First and second moments about the parent's origin, r from there: h + m r, I - [r][h] - ([r][h + m r])^T."""
    k = plus(h, times(r, m))
    both = dot(r, plus(h, k))
    return k, symmetric(lambda i, j: I[j][i] - (r[i] * h[j] + k[i] * r[j]) + (both if i == j else 0))


def place(bodies, q):
    """b.E: child axes in the parent's, b.r: the child's origin there."""
    for b in bodies:
        if b.kind == "free":
            continue
        x, y, z = b.Xr
        b.E, b.r = b.Xr, b.Xp
        if b.kind == "revolute":
            c, s = q[b.idx_q].cos(), q[b.idx_q].sin()
            b.E = plus(times(x, c), times(y, s)), minus(times(y, c), times(x, s)), z
        else:
            b.r = plus(b.Xp, times(z, q[b.idx_q]))


def free_gravity(gravity, b, q):
    """-gravity in the root's axes."""
    x, y, z, w = q[b.idx_q + 3:b.idx_q + 7]
    R = ((1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
         (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
         (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)))
    return tv(mm(b.Xr, R), neg(gravity))


def rate(w, dw):
    """[dw] + [w][w]: acceleration of a point by its place."""
    square = symmetric(lambda i, j: w[i] * w[j])
    d = (square[1][1] + square[2][2], square[0][0] + square[2][2], square[0][0] + square[1][1])
    S = skew(dw)
    return tuple(tuple(S[j][i] + (square[j][i] if i != j else 0 - d[i]) for i in range(3)) for j in range(3))


def rnea(bodies, up, q, v, a):
    place(bodies, q)
    for b in bodies:
        k = b.idx_v
        if b.kind == "free":
            b.w, b.dw = v[k + 3:k + 6], a[k + 3:k + 6]
            b.acc = plus(up, plus(a[k:k + 3], cross(b.w, v[k:k + 3])))
        elif b.root:
            b.w, b.dw, b.acc = O3, O3, tv(b.E, up)
        else:
            p = bodies[b.parent]
            b.w, b.dw, b.acc = tv(b.E, p.w), tv(b.E, p.dw), tv(b.E, plus(p.acc, mv(p.A, b.r)))
        if b.kind == "revolute":
            b.dw = plus(b.dw, plus(times(Z, a[k]), cross(b.w, times(Z, v[k]))))
            b.w = plus(b.w, times(Z, v[k]))
        elif b.kind == "prismatic":
            b.acc = plus(b.acc, plus(times(Z, a[k]), times(cross(b.w, Z), 2 * v[k])))
        b.A = rate(b.w, b.dw)
        b.f = plus(times(b.acc, b.m), mv(b.A, b.h))
        b.n = plus(cross(b.h, b.acc), plus(mv(b.I, b.dw), cross(b.w, mv(b.I, b.w))))
    tau = [0] * len(v)
    for b in reversed(bodies):
        if b.kind == "free":
            tau[b.idx_v:b.idx_v + 6] = b.f + b.n
            continue
        tau[b.idx_v] = (b.n if b.kind == "revolute" else b.f)[2]
        if not b.root:
            p, f = bodies[b.parent], mv(b.E, b.f)
            p.f, p.n = plus(p.f, f), plus(plus(p.n, mv(b.E, b.n)), cross(b.r, f))
    return tau


def crba(bodies, q):
    """Rows of the lower triangle's entries; those that the tree has not are 0."""
    place(bodies, q)
    n = sum(b.nv for b in bodies)
    M = [[0] * n for _ in range(n)]
    for b in bodies:
        b.Y = b.m, b.h, b.I
    for b in reversed(bodies):
        m, h, I = b.Y
        if b.kind == "free":
            S = [((e, O3), (times(e, m), cross(h, e))) for e in ((1, 0, 0), (0, 1, 0), Z)]
            S += [((O3, e), (cross(e, h), I[i])) for i, e in enumerate(((1, 0, 0), (0, 1, 0), Z))]
            for c, (_, (f, t)) in enumerate(S):
                M[b.idx_v + c][b.idx_v:b.idx_v + c + 1] = (f + t)[:c + 1]
            continue
        f, t = (cross(Z, h), I[2]) if b.kind == "revolute" else (times(Z, m), cross(h, Z))
        j = b
        while True:
            if j.kind == "free":
                M[b.idx_v][j.idx_v:j.idx_v + 6] = f + t
            else:
                M[b.idx_v][j.idx_v] = (t if j.kind == "revolute" else f)[2]
            if j.root:
                break
            f, t = mv(j.E, f), mv(j.E, t)
            t = plus(t, cross(j.r, f))
            j = bodies[j.parent]
        if not b.root:
            k, J = shifted(b.r, m, mv(b.E, h), congruence(b.E, I))
            M0, h0, I0 = bodies[b.parent].Y
            bodies[b.parent].Y = M0 + m, plus(h0, k), splus(I0, J)
    return M


def aba(bodies, up, q, v, tau):
    place(bodies, q)
    for b in bodies:
        k = b.idx_v
        b.w = v[k + 3:k + 6] if b.kind == "free" else O3 if b.root else tv(b.E, bodies[b.parent].w)
        b.ca = O3
        b.cl = cross(b.w, v[k:k + 3]) if b.kind == "free" else O3
        if not b.root:
            pw = bodies[b.parent].w
            b.cl = tv(b.E, cross(pw, cross(pw, b.r)))
        if b.kind == "revolute":
            b.ca, b.w = cross(b.w, times(Z, v[k])), plus(b.w, times(Z, v[k]))
        elif b.kind == "prismatic":
            b.cl = plus(b.cl, times(cross(b.w, Z), 2 * v[k]))
        b.M, b.H, b.J = symmetric(lambda i, j: b.m if i == j else 0), skew(neg(b.h)), b.I
        b.pf, b.pn = cross(b.w, cross(b.w, b.h)), cross(b.w, mv(b.I, b.w))
    for b in reversed(bodies):
        if b.kind == "free":
            continue
        b.U = (b.H[2], b.J[2]) if b.kind == "revolute" else (b.M[2], tuple(c[2] for c in b.H))
        b.D = 1 / (b.J if b.kind == "revolute" else b.M)[2][2]
        b.u = tau[b.idx_v] - (b.pn if b.kind == "revolute" else b.pf)[2]
        if b.root:
            continue
        (Ul, Ua), (Vl, Va) = b.U, (times(b.U[0], b.D), times(b.U[1], b.D))
        M = symmetric(lambda i, j: b.M[j][i] - Ul[i] * Vl[j])
        H = tuple(minus(c, times(Ul, x)) for c, x in zip(b.H, Va))
        J = symmetric(lambda i, j: b.J[j][i] - Ua[i] * Va[j])
        # along the axis nothing is left
        if b.kind == "revolute":
            H, J = H[:2] + (O3,), symmetric(lambda i, j: 0 if 2 in (i, j) else J[j][i])
        else:
            M, H = symmetric(lambda i, j: 0 if 2 in (i, j) else M[j][i]), tuple((c[0], c[1], 0) for c in H)
        f = plus(plus(b.pf, times(Vl, b.u)), plus(mv(M, b.cl), mv(H, b.ca)))
        n = plus(plus(b.pn, times(Va, b.u)), plus(tv(H, b.cl), mv(J, b.ca)))
        E, p, S = b.E, bodies[b.parent], skew(b.r)
        f, n = mv(E, f), mv(E, n)
        M, J, H = congruence(E, M), congruence(E, J), mm(mm(E, H), transposed(E))
        Hs = tuple(minus(c, d) for c, d in zip(H, mm(M, S)))
        A, B = mm(transposed(H), S), mm(S, Hs)
        p.M, p.H = splus(p.M, M), mplus(p.H, Hs)
        p.J = symmetric(lambda i, j: p.J[j][i] + (J[j][i] - A[j][i] + B[j][i]))
        p.pf, p.pn = plus(p.pf, f), plus(p.pn, plus(n, cross(b.r, f)))
    ddq = [0] * len(v)
    for b in bodies:
        k = b.idx_v
        if b.kind == "free":
            rows = [[b.M[j][i] for j in range(3)] + [b.H[j][i] for j in range(3)] for i in range(3)]
            rows += [[b.H[i][j] for j in range(3)] + [b.J[j][i] for j in range(3)] for i in range(3)]
            L = factorize([list(r) for r in rows], [i - 1 for i in range(6)])
            x = solve(L, [i - 1 for i in range(6)], [t - p for t, p in zip(tau[k:k + 6], b.pf + b.pn)])
            b.al, b.aw = tuple(x[:3]), tuple(x[3:])
            ddq[k:k + 6] = minus(minus(b.al, up), b.cl) + b.aw
            continue
        if b.root:
            al, aw = tv(b.E, up), O3
        else:
            p = bodies[b.parent]
            al, aw = tv(b.E, plus(p.al, cross(p.aw, b.r))), tv(b.E, p.aw)
        al, aw = plus(al, b.cl), plus(aw, b.ca)
        ddq[k] = (b.u - (dot(b.U[0], al) + dot(b.U[1], aw))) * b.D
        s = times(Z, ddq[k])
        b.al, b.aw = (al, plus(aw, s)) if b.kind == "revolute" else (plus(al, s), aw)
    return ddq


def parents_of(bodies):
    """Of each degree of freedom the next one towards the root, -1 for none (Featherstone 2008, section 6.5)."""
    parents = []
    for b in bodies:
        above = -1 if b.root else bodies[b.parent].idx_v + bodies[b.parent].nv - 1
        parents += [above if c == 0 else b.idx_v + c - 1 for c in range(b.nv)]
    return parents


def factorize(M, parents):
    """L^T D L of the lower triangle M, in its place: L below the diagonal, 1 / D on it."""
    for k in reversed(range(len(M))):
        M[k][k] = 1 / M[k][k]
        i = parents[k]
        while i >= 0:
            a, j = M[k][i] * M[k][k], i
            while j >= 0:
                M[i][j] = M[i][j] - a * M[k][j]
                j = parents[j]
            M[k][i], i = a, parents[i]
    return M


def solve(L, parents, b):
    """M^-1 b by the factor."""
    x = list(b)
    for i in reversed(range(len(x))):  # L^T
        j = parents[i]
        while j >= 0:
            x[j], j = x[j] - L[i][j] * x[i], parents[j]
    x = [L[i][i] * e for i, e in enumerate(x)]
    for i in range(len(x)):
        j = parents[i]
        while j >= 0:
            x[i], j = x[i] - L[i][j] * x[j], parents[j]
    return x
