"""capi/pages/coming_from.md, row by row: both sides evaluated where the other library is installed, ours against its stored
figures where it is not.

    python test_coming_from.py --record     stores the figures (tests/golden/coming_from/coming_from.json); needs pin, mujoco
                                           and drake
"""

import json
import re
import sys

import numpy as np
import pytest
from conftest import CAPI, MODELS

GOLDEN = CAPI.parent / "tests/golden/coming_from/coming_from.json"
PEERS = {"Pinocchio": "pinocchio", "MuJoCo": "mujoco", "Drake": "pydrake"}


def page():
    """{section: (its code, {row: (their expression, ours)})}; "" is what comes before."""
    text, out = (CAPI / "pages/coming_from.md").read_text(), {}
    for part in re.split(r"^## ", text, flags=re.M):
        title = part.splitlines()[0] if out else ""
        code = "\n".join(re.findall(r"^```python\n(.*?)^```", part, re.M | re.S))
        rows = re.findall(r"^\| ([^|`]+) \| `([^`|]+)` \| `([^`|]+)` \|$", part, re.M)
        out[title] = code, {what: (theirs, ours) for what, theirs, ours in rows}
    return out


PAGE = page()
ROWS = [(peer, row) for peer in PEERS for row in PAGE[peer][1]]


def names(state=None):
    """What the page's beginning defines, with a state."""
    out = {"models": MODELS / "robots"}
    exec(PAGE[""][0], out)
    m, g = out["m"], np.random.default_rng(4)
    given = state or {"q": m.random(4).tolist(), **{x: g.normal(size=m.nv).tolist() for x in ("v", "a", "tau")}}
    out.update({name: np.array(x) for name, x in given.items()})
    return out


def with_peer(peer):
    pytest.importorskip(PEERS[peer])
    out = names()
    exec(PAGE[peer][0], out)
    return out


def without_peer(peer, state):
    """What rows of ours need, of the page's code: s, T, R and the like."""
    out = names(state)
    m, d = out["m"], out["d"]
    d.forward_kinematics(out["q"], out["v"], out["a"])
    out["s"], out["T"], out["at_rest"] = out["peer"](peer.lower())
    out["R"], out["swap"], out["upper"] = d.frame_placement("base").rotation, [3, 4, 5, 0, 1, 2], np.triu_indices(m.nv)
    return out


def near(theirs, ours):
    theirs, ours = np.asarray(theirs, float), np.asarray(ours, float)
    assert theirs.shape == ours.shape
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-9 * max(1, abs(theirs).max()))


def test_the_page_has_rows():
    assert len(ROWS) > 45 and len(PAGE["RBDL"][1]) > 8


@pytest.mark.parametrize("peer, row", ROWS)
def test_row(peer, row):
    theirs, ours = PAGE[peer][1][row]
    now = with_peer(peer)
    near(eval(theirs, now), eval(ours, now))


@pytest.mark.parametrize("peer, row", ROWS)
def test_golden(peer, row):
    golden = json.loads(GOLDEN.read_text())
    near(golden["figures"][peer][row], eval(PAGE[peer][1][row][1], without_peer(peer, golden["state"])))


# ------------------------------------------------------------------------------------------- RBDL: what its functions mean


def rbdl(row, n):
    """The row's meaning, by other means: differences along the motion, sums over bodies, the equation of motion."""
    m, d, q, v, a, tau = (n[x] for x in ("m", "d", "q", "v", "a", "tau"))
    point = np.array([0.1, 0, 0.2])

    def foot(t, local=(0, 0, 0)):
        d.forward_kinematics(m.integrate(q, v * t))
        X = d.frame_placement("FL_foot")
        return X.rotation @ local + X.translation, X.rotation

    def rate(f, h=1e-3):
        D = lambda s: (f(s) - f(-s)) / (2 * s)
        return (4 * D(h / 2) - D(h)) / 3

    def bodies(q):
        d.forward_kinematics(q, v)
        for f in m.frames:
            if f.mass:
                X = d.frame_placement(f.id)
                yield f, X, d.frame_velocity(f.id, "local")

    if row == "q":
        return np.r_[q[:3], q[3:6], [q[m.joint(j.name).idx_q] for j in m.joints[2:]], q[6]]
    if row == "q̇":
        base = lambda t: m.integrate(q, v * t)[:3]
        return np.r_[rate(base), v[3:]]
    if row == "inverse dynamics":
        return (d.crba(q) @ a + d.compute_nle(q, v))[6:]
    if row == "joint-space inertia":
        return np.column_stack([d.rnea(q, 0 * v, e) - d.gravity_torque(q) for e in np.eye(m.nv)])[6:, 6:]
    if row == "bias forces":
        return d.rnea(q, v, 0 * v)[6:]
    if row == "forward dynamics":
        return np.linalg.solve(d.crba(q), tau - d.compute_nle(q, v))[6:]
    if row == "place of a point of a body":
        return foot(0, point)[0]
    if row == "velocity of a frame":
        R, dR = foot(0)[1], rate(lambda t: foot(t)[1])
        W = dR @ R.T
        return np.r_[W[2, 1], W[0, 2], W[1, 0], rate(lambda t: foot(t)[0])]
    if row == "Jacobian of a point":

        def moved(k):
            def at(t):
                d.forward_kinematics(m.integrate(q, t * np.eye(m.nv)[k]))
                return d.frame_placement("FL_foot").translation

            return rate(at)

        return np.column_stack([moved(k) for k in range(6, m.nv)])
    masses = [(f.mass, X.rotation @ f.com + X.translation) for f, X, _ in bodies(q)]
    com = sum(mass * p for mass, p in masses) / m.total_mass
    if row == "centre of mass":
        return com
    assert row == "energies"
    kinetic = 0.0
    for f, _, w in bodies(q):
        u = w[:3] + np.cross(w[3:], f.com)
        kinetic += 0.5 * (f.mass * u @ u + w[3:] @ f.inertia @ w[3:])
    return [kinetic, m.total_mass * 9.81 * com[2]]


@pytest.mark.parametrize("row", PAGE["RBDL"][1])
def test_rbdl(row):
    n = names()
    exec(PAGE["RBDL"][0], n)
    ours = np.array(eval(PAGE["RBDL"][1][row][1], n))
    expected = np.array(rbdl(row, n))
    assert ours.shape == expected.shape
    np.testing.assert_allclose(ours, expected, rtol=0, atol=1e-8 * max(1, abs(expected).max()))


def record():
    state = {name: np.asarray(names()[name]).tolist() for name in ("q", "v", "a", "tau")}
    figures = {}
    for peer in PEERS:
        figures[peer] = {row: np.asarray(eval(theirs, with_peer(peer)), float).tolist()
                         for row, (theirs, _) in PAGE[peer][1].items()}
    GOLDEN.write_text(json.dumps({"state": state, "figures": figures}) + "\n")


if __name__ == "__main__" and sys.argv[1:] == ["--record"]:
    record()
