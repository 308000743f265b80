"""The recursions that flops.py counts, of any numbers: f(bodies, gravity, q, ...), vectors in world axes. Sources there."""
from counting import (N, Count, O3, WORLD, congruence, cross, dot, dot6, force_cross, minus, mm, mminus, motion_cross, mplus, mv,
                      neg, outer, plus, plus6, skew, splus, symmetric, times, times6, transposed, tv)


def place(bodies, q):
    for b in bodies:
        parent = None if b.root else bodies[b.parent]
        R, p = (WORLD, O3) if b.root else (parent.R, parent.p)
        x, y, z = b.Xr
        t = b.Xp
        if b.kind == "revolute":
            c, s = q[b.idx_q].cos(), q[b.idx_q].sin()
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
            one = type(w)(1)
            x, y, z = mm(b.Xr, ((one - (bb + cc), ab + wc, ac - wb), (ab - wc, one - (aa + cc), bc + wa),
                                (ac + wb, bc - wa, one - (aa + bb))))
        b.r = mv(R, t)
        b.R = mm(R, (x, y, z))
        b.p = plus(p, b.r)


def forward_kinematics(bodies, g, q):
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


def supporting(bodies, b):  # b and its ancestors
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
        k = h if r is O3 else plus(h, times(r, m))
        I = congruence(b.R, b.I)
        if r is not O3:
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
        h = Rh if r is O3 else plus(Rh, times(r, m))
        P = symmetric(lambda i, j: dot([A[k][i] for k in range(3)], [b.R[k][j] for k in range(3)]))
        if r is not O3:
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
