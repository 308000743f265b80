"""The mechanisms of models/mechanisms: each loads, closes, moves and is judged by `dyn check`; and dependent rows are found by name."""

import numpy as np
import pytest
from conftest import MODELS
from command import CLI, answer, run

import libdyn as dyn
from libdyn import constraint as dc

MECHANISMS = MODELS / "mechanisms"
# rows, rank, names of constraints with dependent rows
JUDGED = {
    "four_bar": (5, 2, {"pin"}),
    "four_bar_in_space": (5, 2, {"pin"}),
    "parallel_four_bar": (3, 2, {"pin"}),
    "bricard": (5, 4, {"sixth"}),
    "linkage_gripper": (2, 2, set()),
    "humanoid_on_both_feet": (12, 12, set()),
}
commands = pytest.mark.skipif(not CLI, reason="the command dyn is not built")


def test_all_are_here():
    assert {path.stem for path in MECHANISMS.glob("*.urdf")} == set(JUDGED)


@commands
@pytest.mark.parametrize("name", JUDGED)
def test_check(name):
    rows, rank, dependent = JUDGED[name]
    found = answer("check", MECHANISMS / f"{name}.urdf", "--fixed")
    assert found["satisfied"] and found["error"] < 1e-11 and found["contradictory"] == 0
    assert (found["rows"], found["rank"], found["redundant"]) == (rows, rank, rows - rank)
    assert {d["constraint"] for d in found["dependent"]} == dependent
    m = dyn.load(MECHANISMS / f"{name}.urdf", base="fixed")
    assert found["mobility"] == m.nv - rank
    d, q = m.data(), np.array(found["q"])
    # it moves as it may
    g = np.random.default_rng(1)
    tau = g.normal(size=m.nv)
    p = d.project(q, g.normal(size=m.nv))
    ddq, forces = d.constrained_dynamics(p.q, p.v, tau)
    assert d.constraint_result.solved and d.constraint_result.rank == rank
    t = d.constraint_terms(p.q, p.v)
    np.testing.assert_allclose(d.crba(p.q) @ ddq + d.compute_nle(p.q, p.v), tau + t.J.T @ forces,
                               atol=1e-8 * max(1, abs(ddq).max()))
    np.testing.assert_allclose(t.J @ ddq + t.drift, 0, atol=1e-8 * max(1, abs(ddq).max()))


@commands
def test_check_of_singular_and_open_poses():
    flat = answer("check", MECHANISMS / "parallel_four_bar.urdf", "--fixed", "--q", "0", "0", str(np.pi))
    assert (flat["rank"], flat["satisfied"]) == (1, True) and {d["constraint"] for d in flat["dependent"]} == {"pin"}
    text = run("check", MECHANISMS / "four_bar.urdf", "--fixed")
    assert "q satisfies them" in text and "contradictory" not in text
    stretched = run("check", MECHANISMS / "four_bar.urdf", "--fixed", "--as-is")
    assert "q does not satisfy them" in stretched


@commands
def test_eval_of_constraints():
    go2 = MODELS / "robots" / "go2.urdf"
    feet = ("FL_foot", "RR_foot")
    m = dyn.load(go2, base="floating")
    d = m.data()
    for foot in feet:
        d.add_constraint(dc.point(foot))
    q, v, tau = m.random(seed=3), np.linspace(-1, 1, m.nv), np.linspace(2, -2, m.nv)
    words = [f"--{k}={','.join(map(repr, x.tolist()))}" for k, x in (("q", q), ("v", v), ("tau", tau))]
    names = "constrained_ddq,lambda,delassus,constraint_jacobian,constraint_error"
    found = answer("eval", go2, "--floating", "--points", ",".join(feet), "--compute", names, *words)
    ddq, forces = d.constrained_dynamics(q, v, tau)
    t = d.constraint_terms(q, v)
    for name, expected in zip(names.split(","), (ddq, forces, d.delassus(q), t.J, t.C)):
        np.testing.assert_allclose(np.array(found[name]), expected, rtol=1e-12, atol=1e-12 * abs(expected).max(), err_msg=name)
    assert "nobody" in run("eval", go2, "--floating", "--points", "nobody", "--compute", "lambda", status=1)
    assert "nobody" in run("check", go2, "--floating", "--points", "nobody", status=1)


def tree(seed, joints=9):
    """Hinges, sliders and balls on a moving base; frame f0, f1, ... on each body."""
    g = np.random.default_rng(seed)
    b = dyn.Builder("tree")
    b.add_joint("base", "free_flyer").add_body("trunk", "base", mass=3,
                                               inertia=np.diag([0.2, 0.3, 0.4])).add_frame("f0", "base", (0.1, 0, 0))
    names = ["base"]
    for k in range(1, joints):
        parent, type = names[g.integers(len(names))], str(g.choice(["revolute", "prismatic", "spherical", "revolute"]))
        b.add_joint(f"j{k}", type, parent, tuple(0.3 * g.normal(size=3)), axis=tuple(g.normal(size=3)))
        b.add_body(f"link{k}", f"j{k}", mass=1, com=tuple(0.1 * g.normal(size=3)), inertia=np.diag([0.1, 0.12, 0.15]))
        b.add_frame(f"f{k}", f"j{k}", (0.2, 0.1, 0))
        names.append(f"j{k}")
    return b.finish()


KINDS = {
    "point": dc.point,
    "frame": dc.frame,
    "connect": dc.connect,
    "weld": dc.weld,
    "hinge": lambda *a, **k: dc.loop("revolute", *a, axis=(0, 0.6, 0.8), **k),
    "slider": lambda *a, **k: dc.loop("prismatic", *a, axis=(0.6, 0, 0.8), **k),
    "ball": lambda *a, **k: dc.loop("spherical", *a, **k),
    "distance": dc.distance,
}


@pytest.mark.parametrize("kind", KINDS)
def test_planted_redundancy_and_contradiction_are_named(kind):
    """What there is twice is redundant, and named; 1 mm apart it contradicts itself, and is named; what is independent beside it
    never is."""
    cases = 0
    for seed in range(1, 61):
        m = tree(seed)
        q = m.random(seed=seed)
        d = m.data()
        d.forward_kinematics(q)
        g = np.random.default_rng(100 + seed)
        first, second, beside = (f"f{k}" for k in g.permutation(9)[:3])
        if kind in ("point", "frame"):
            second = None
        R, p = d.frame_placement(first)
        R2, p2 = d.frame_placement(second) if second else (np.eye(3), np.zeros(3))

        def ask(off):  # off: m
            if kind == "distance":
                return dc.distance(first, second, np.linalg.norm(p - p2) + off)
            return KINDS[kind](first, second, placement2=(R2.T @ R, R2.T @ (p - p2 + off * np.array([0.48, 0.6, 0.64]))))

        def report(*off):
            b = dyn.Builder.from_model(m)
            b.add_constraint("beside", dc.point(beside, placement2=d.frame_placement(beside)[1]))
            for k, x in enumerate(off):
                b.add_constraint(f"planted {k}", ask(x))
            return b.finish().data().constraint_report(q)

        def named(r, *verdicts):
            return {row.constraint for row in r.rows if row.verdict in verdicts}

        alone = report(0)
        assert alone.error < 1e-12
        if alone.rank < len(alone.rows):
            continue  # the joints between the two hold some of the rows already
        cases += 1
        both = {"planted 0", "planted 1"}
        twice = report(0, 0)
        assert (twice.rank, twice.redundant, twice.contradictory) == (alone.rank, len(twice.rows) - alone.rank, 0)
        assert named(twice, dyn.RowVerdict.REDUNDANT) == both and named(twice, dyn.RowVerdict.INDEPENDENT) == {"beside"}
        apart = report(0, 1e-3)
        assert apart.rank == alone.rank and named(apart, dyn.RowVerdict.CONTRADICTORY) == both
        assert named(apart, dyn.RowVerdict.INDEPENDENT) == {"beside"} and 1e-4 < apart.contradiction < 1e-3
    assert cases >= 5


# of hinges a and b at q, pairs that are the same row; and by how much each pair is off (m or rad), where it contradicts itself
JOINT_ROWS = {
    "coupling": (lambda a, b, qa, qb, off: (dc.coupling(a, b, (qa - 0.7 * qb, 0.7)),
                                            dc.coupling(a, b, (qa - 0.7 * qb - off, 0.7))), True),
    "curved coupling": (lambda a, b, qa, qb, off: (dc.coupling(a, b, (qa - 0.3 * qb**2, 0, 0.3)),
                                                   dc.coupling(a, b, (qa - 0.3 * qb**2 - off, 0, 0.3))), True),
    "limit": (lambda a, b, qa, qb, off: (dc.limit(a), dc.limit(a)), False),
    "limit and coupling": (lambda a, b, qa, qb, off: (dc.limit(a), dc.coupling(a, b, (qa - off,))), True),
    "friction": (lambda a, b, qa, qb, off: (dc.friction(b, 1.0), dc.friction(b, 2.0)), False),
    "friction and coupling": (lambda a, b, qa, qb, off: (dc.friction(b, 1.0), dc.coupling(b, a, (qb - off,))), False),
    "friction and limit": (lambda a, b, qa, qb, off: (dc.friction(a, 1.0), dc.limit(a)), False),
}


@pytest.mark.parametrize("kind", JOINT_ROWS)
def test_planted_rows_of_joints_are_named(kind):
    make, contradicts = JOINT_ROWS[kind]
    for seed in range(1, 21):
        g = np.random.default_rng(seed)
        at = g.uniform(-1, 1, 6)  # of six hinges; the limited one at its limit
        b = dyn.Builder("hinges")  # a chain: q in their order
        limited, other, third = g.permutation(6)[:3]
        for k in range(6):
            bounds = {"lower": [at[k]], "upper": [at[k] + 1]} if k == limited else {}
            b.add_joint(f"j{k}", "revolute", f"j{k - 1}" if k else None, tuple(0.3 * g.normal(size=3)),
                        axis=tuple(g.normal(size=3)), **bounds)
            b.add_body(f"link{k}", f"j{k}", mass=1, com=tuple(0.1 * g.normal(size=3)), inertia=np.diag([0.1, 0.12, 0.15]))
        m = b.finish()

        def report(off):
            b = dyn.Builder.from_model(m)
            b.add_constraint("beside", dc.coupling(f"j{third}", f"j{other}", (at[third] - 0.5 * at[other], 0.5)))
            for k, c in enumerate(make(f"j{limited}", f"j{other}", at[limited], at[other], off)):
                b.add_constraint(f"planted {k}", c)
            return b.finish().data().constraint_report(at)

        def named(r, verdict):
            return {row.constraint for row in r.rows if row.verdict == verdict}

        r = report(0)
        assert (r.rank, r.redundant, r.contradictory) == (2, 1, 0) and r.error < 1e-12, (seed, r)
        assert (named(r, dyn.RowVerdict.REDUNDANT) == {"planted 0", "planted 1"}
                and named(r, dyn.RowVerdict.INDEPENDENT) == {"beside"})
        r = report(1e-3)
        if not contradicts:  # friction asks for no position
            assert r.contradictory == 0 and r.contradiction < 1e-12
        else:
            assert (named(r, dyn.RowVerdict.CONTRADICTORY) == {"planted 0", "planted 1"}
                    and named(r, dyn.RowVerdict.INDEPENDENT) == {"beside"})
            assert 1e-4 < r.contradiction < 1e-3


def test_branch_without_mass():
    """The builder refuses it; where only an armature resisted, and is switched off, each call names the joint and leaves q, v as
    they were."""

    def tool(armature):
        b = dyn.Builder("tool")
        b.add_joint("arm", "revolute", axis=(0, 1, 0)).add_body("arm_link", "arm", mass=1, com=(0.2, 0, 0),
                                                                inertia=np.diag([0.01, 0.1, 0.1]))
        b.add_joint("pointer", "revolute", "arm", (0.5, 0, 0), axis=(0, 1, 0),
                    armature=armature).add_frame("tip", "pointer", (0.3, 0, 0))
        return b.add_constraint("on_the_wall", dc.point("tip", placement2=(0.7, 0, 0))).finish()

    with pytest.raises(dyn.InvalidRobotError, match="pointer.*no mass"):
        tool(None)
    d = tool([0.1]).data()
    d.set_effects(())
    q, v, tau = np.array([0.3, -0.5]), np.array([0.1, 0.2]), np.array([1.0, 2.0])
    d.forward_kinematics(q, v)
    before = d.q.copy(), d.v.copy()
    elsewhere = q + 1
    calls = {
        "constrained_dynamics": lambda: d.constrained_dynamics(elsewhere, v, tau),
        "derivatives": lambda: d.constrained_dynamics_derivatives(elsewhere, v, tau),
        "impulse": lambda: d.constraint_impulse(elsewhere, v),
        "impulse derivatives": lambda: d.constraint_impulse_derivatives(elsewhere, v),
        "delassus": lambda: d.delassus(elsewhere),
        "project": lambda: d.project(elsewhere),
        "report": lambda: d.constraint_report(elsewhere),
    }
    for name, call in calls.items():
        with pytest.raises(dyn.NumericError, match="pointer"):
            call()
        assert np.array_equal(d.q, before[0]) and np.array_equal(d.v, before[1]), name


@pytest.mark.parametrize("damping, stiffness", ((5, 0), (1, 100), (50, 1000)))
def test_the_midpoint_rule_comes_to_rest_on_a_closed_loop(damping, stiffness):
    """Forces that balance leave rounding of the velocity that gravity adds in a step, and the equations are solved no finer."""
    d = dyn.load_string(f"""<mujoco><default><geom type="capsule" size=".02" contype="0" conaffinity="0"/></default><worldbody>
      <body pos="0 0 1"><joint axis="0 1 0" damping="{damping}" stiffness="{stiffness}"/><geom fromto="0 0 0 0 0 -.3"/>
        <body pos="0 0 -.3"><joint axis="0 1 0"/><geom fromto="0 0 0 .5 0 0"/><site name="end" pos=".5 0 0"/></body></body>
      <body pos=".5 0 1.1"><joint axis="0 1 0"/><geom fromto="0 0 0 0 0 -.4"/><site name="other" pos="0 0 -.4"/></body>
      </worldbody><equality><connect site1="end" site2="other"/></equality></mujoco>""").data()
    d.set_state(v=[0.5, 0, 0])
    d.set_step_options("implicit_midpoint", 1e-3)
    d.advance(20.0)
    assert abs(d.v).max() < 1e-7  # it has fallen by e in less than 1.3 s
