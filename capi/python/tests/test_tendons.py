"""Tendons, and actuators that act through them or on frames: lengths, moment arms, forces, what is refused, and what is kept."""

import math
import struct

import libdyn as dyn
import numpy as np
import pytest

TREES = """<mujoco><option integrator="RK4" timestep="1e-3"><flag contact="disable"/></option><compiler angle="radian"/>
<default><geom density="800" contype="0" conaffinity="0"/></default><worldbody>
<site name="ceiling" pos=".2 .3 1.2"/><site name="corner" pos="-.4 .1 .3"/><site name="hub" pos=".1 -.1 .6"/>
<geom name="hub" type="sphere" size=".08" pos=".1 -.1 .6"/>
<body name="base" pos="0 0 1"><freejoint name="base"/><geom type="box" size=".1 .08 .05"/>
 <site name="base_top" pos=".05 .02 .05"/><site name="base_side" pos="-.1 0 .02"/>
 <body name="arm" pos=".1 0 0"><joint name="ball" type="ball"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/>
  <site name="arm_in" pos=".1 .03 0"/><site name="arm_out" pos=".28 .02 .03"/>
  <site name="roll" pos=".2 0 0" euler=".3 .2 0"/>
  <geom name="roll" type="cylinder" size=".06 .1" pos=".2 0 0" euler=".3 .2 0"/>
  <site name="roll_side" pos=".2 .1 .02"/>
  <body name="hand" pos=".3 0 0"><joint name="wrist" axis="0 1 .2" damping=".1"/>
   <geom type="capsule" fromto="0 0 0 .2 0 0" size=".02"/>
   <site name="tip" pos=".2 .01 .02" euler="0 .4 .1"/><site name="knuckle" pos=".05 0 .03"/></body></body></body>
<body name="cart" pos=".5 0 .4"><joint name="rail" type="slide" axis="0 1 0"/><geom type="box" size=".1 .1 .05"/>
 <site name="mast" pos="0 0 .2"/>
 <body name="pole" pos="0 0 .05"><joint name="hinge" axis="1 0 0" ref=".2"/>
  <geom type="capsule" fromto="0 0 0 0 0 .5" size=".02"/><site name="pole_top" pos=".02 0 .5"/>
  <site name="drum" pos="0 .05 .3"/><geom name="drum" type="sphere" size=".1" pos="0 .05 .3"/>
  <site name="drum_side" pos="0 -.1 .35"/><site name="ring" pos="0 0 .42" euler=".2 0 .1"/>
  <geom name="ring" type="cylinder" size=".09 .1" pos="0 0 .42" euler=".2 0 .1"/><site name="ring_in" pos=".01 .03 .4"/>
  <site name="pole_low" pos=".02 -.15 .1"/></body></body>
</worldbody>{}</mujoco>"""
RADIUS = {"hub": 0.08, "roll": 0.06, "drum": 0.1, "ring": 0.09}
SHAPE = {"hub": "sphere", "roll": "cylinder", "drum": "sphere", "ring": "cylinder"}

# (element, ...): a name is a site; with RADIUS a wrap, (wrap, side) too; a number is a pulley's divisor
PATHS = {
    "straight": ["base_top", "arm_out", "tip"],
    "across": ["ceiling", "pole_top", "tip", "corner"],
    "pulleys": ["corner", "mast", "pole_top", 2, "ceiling", "base_side", 3, "arm_in", "tip", "mast"],
    "around_sphere": ["corner", "drum", "pole_top", "hub", "ceiling"],
    "around_cylinder": ["base_top", "roll", "tip", "ring", "pole_low"],
    "begins_with_pulley": [2.5, "arm_in", "roll", "knuckle", 1.5, "ceiling", "hub", "mast"],
}
SIDES = {"sides": ["arm_in", ("roll", "roll_side"), "knuckle", "tip", ("drum", "drum_side"), "pole_low"]}
INSIDE = {"inside_cylinder": ["ceiling", ("ring", "ring_in"), "mast"], "inside_sphere": ["tip", ("drum", "drum"), "ceiling"]}
SPATIAL = {**PATHS, **SIDES, **INSIDE}
SUMS = {"sum": [("wrist", 0.7), ("hinge", -1.3), ("rail", 2.0)], "one": [("hinge", -0.5)]}


def elements(path):
    """Of a path, as the builder takes them."""
    out = []
    for e in path:
        name, side = e if isinstance(e, tuple) else (e, None)
        wraps = name in RADIUS
        out.append(("pulley", None, e) if isinstance(e, (int, float)) else
                   (SHAPE[name], name, RADIUS[name], side) if wraps else ("site", name))  # fmt: skip
    return out


def written(paths, sums, values=""):
    """The same in MJCF."""
    def element(e):
        name, side = e if isinstance(e, tuple) else (e, None)
        if isinstance(e, (int, float)):
            return f'<pulley divisor="{e}"/>'
        if name not in RADIUS:
            return f'<site site="{name}"/>'
        return f'<geom geom="{name}"' + (f' sidesite="{side}"' if side else "") + "/>"

    spatial = [f'<spatial name="{name}" {values}>{"".join(map(element, path))}</spatial>' for name, path in paths.items()]
    fixed = [f'<fixed name="{name}" {values}>' + "".join(f'<joint joint="{j}" coef="{c}"/>' for j, c in terms) + "</fixed>"
             for name, terms in sums.items()]  # fmt: skip
    return f"<tendon>{''.join(spatial + fixed)}</tendon>"


def built(paths=PATHS, sums=SUMS, text=TREES, **values):
    b = dyn.Builder.from_model(dyn.load_string(text.format("")))
    for name, path in paths.items():
        b.add_tendon(name, elements(path), type="spatial", **values)
    for name, terms in sums.items():
        b.add_tendon(name, [("joint", j, c) for j, c in terms], **values)
    return b


@pytest.fixture(scope="module")
def trees():
    return built(SPATIAL).finish()


def test_what_was_added_is_read_back(trees):
    assert trees.ntendons == len(trees.tendon_names) == len({**SPATIAL, **SUMS})
    assert trees.tendon_id("sum") == trees.tendon_names.index("sum")
    for name, path in SPATIAL.items():
        t = trees.tendon(name)
        assert t == trees.tendon(trees.tendon_id(name)) and t.type == dyn.TendonType.SPATIAL
        assert [(e.type.name.lower(), e.name, e.value, e.side) for e in t.elements] == [
            (*e, 1.0, None)[:3] + ((e[3] if len(e) == 4 else None),) for e in map(tuple, elements(path))
        ]
        for e in t.elements:
            assert e.id == (-1 if e.name is None else trees.frame_id(e.name))
            assert e.side_id == (-1 if e.side is None else trees.frame_id(e.side))
    assert [(e.id, e.value) for e in trees.tendon("sum").elements] == [(trees.joint_id(j), c) for j, c in SUMS["sum"]]
    b = built({}, {})
    spec = dyn.Tendon("fixed", stiffness=3, rest=(-0.1, 0.2), damping=0.4, friction=0.5, armature=0.6, range=(-1, 2))
    b.add_tendon("t", [dyn.TendonElement("joint", "hinge", 2)], spec)
    again = b.finish().tendon("t")
    assert again._replace(elements=()) == spec._replace(type=dyn.TendonType.FIXED)
    with pytest.raises(dyn.UnknownNameError, match="there is no tendon 'nope'"):
        trees.tendon("nope")
    with pytest.raises(dyn.ArgumentError, match=f"tendon is 11, but ids go from 0 to {trees.ntendons - 1}"):
        trees.tendon(11)


def differences(m, q, v, h=1e-6):
    """dL/dt along v, by central differences of fourth order."""
    d = m.data()
    length = {k: d.tendons(m.integrate(q, k * h * v)).length for k in (-2, -1, 1, 2)}
    return (8 * (length[1] - length[-1]) - (length[2] - length[-2])) / (12 * h)


def check_rates(m, seeds):
    d, random = m.data(), np.random.default_rng(1)
    for seed in range(seeds):
        q, v = m.random(seed), random.standard_normal(m.nv)
        q[: m.nq] = m.integrate(m.configuration(m.initial_configuration), m.difference(
            m.configuration(m.initial_configuration), q) * 0.3)
        length, velocity, J = d.tendons(q, v)
        np.testing.assert_allclose(J @ v, velocity, rtol=1e-12, atol=1e-12)
        np.testing.assert_array_equal(d.tendon_length, length)
        np.testing.assert_array_equal(d.tendon_velocity, velocity)
        np.testing.assert_allclose(differences(m, q, v), velocity, rtol=1e-7, atol=1e-7)
        for k in range(m.nv):
            np.testing.assert_allclose(differences(m, q, np.eye(m.nv)[k]), J[:, k], rtol=1e-7, atol=1e-7)


def test_moment_arms_are_differences_of_lengths(trees):
    check_rates(trees, 30)


@pytest.mark.parametrize("paths", [PATHS, SIDES, INSIDE], ids=["around", "sides", "inside"])
def test_lengths_are_mujocos(paths):
    """Inside wraps: MuJoCo's own iteration ends at 1e-6."""
    mujoco = pytest.importorskip("mujoco")
    tolerance = 1e-5 if paths is INSIDE else 1e-9
    m, theirs = built(paths).finish(), mujoco.MjModel.from_xml_string(TREES.format(written(paths, SUMS)))
    d, state, layout, random = m.data(), mujoco.MjData(theirs), dyn.StateLayout.of_mujoco(theirs), np.random.default_rng(2)
    for seed in range(200):
        q, v = m.random(seed), random.standard_normal(m.nv)
        theirs_q, theirs_v = m.to_peer(layout, q, v)[:2]
        state.qpos[:], state.qvel[:] = theirs_q, theirs_v
        mujoco.mj_forward(theirs, state)
        length, velocity, J = d.tendons(q, v)
        np.testing.assert_allclose(length, state.ten_length, rtol=tolerance, atol=tolerance)
        np.testing.assert_allclose(velocity, state.ten_velocity, rtol=100 * tolerance, atol=10 * tolerance)
        f = random.standard_normal(m.ntendons)
        jt = np.zeros(theirs.nv)
        for k in range(theirs.nv):  # column by column: their storage of J differs by version
            state.qvel[:] = np.eye(theirs.nv)[k]
            mujoco.mj_fwdVelocity(theirs, state)
            jt[k] = f @ state.ten_velocity
        np.testing.assert_allclose(m.to_peer(layout, q, v, tau=J.T @ f).tau, jt, atol=100 * tolerance)


def test_points_of_a_path_make_its_length(trees):
    d = trees.data()
    with pytest.raises(dyn.StaleError, match="tendons"):
        d.tendon_path("straight")
    bent = 0
    for seed in range(40):
        length = d.tendons(trees.random(seed)).length
        for name, path in SPATIAL.items():
            points, begins = d.tendon_path(name)
            divisors = [e for e in path if isinstance(e, (int, float))]
            if not isinstance(path[0], (int, float)):
                divisors.insert(0, 1)
            branches = np.split(points, np.flatnonzero(begins)[1:])
            sides = [np.linalg.norm(np.diff(b, axis=0), axis=1).sum() / by for b, by in zip(branches, divisors)]
            assert begins[0] == 1 and len(branches) == len(divisors)
            assert sum(sides) == pytest.approx(length[trees.tendon_id(name)], rel=1e-3)
            assert sum(sides) <= length[trees.tendon_id(name)] * (1 + 1e-12)
            sites = [e for e in path if isinstance(e, str) and e not in RADIUS]
            bent += len(points) > len(sites)
            for e in (sites[0], sites[-1]):
                assert np.abs(points - d.frame_placement(e).translation).sum(axis=1).min() < 1e-12
        assert len(d.tendon_path("sum").points) == 0
    assert bent > 50


MIMIC = """<robot name="fingers"><link name="base">{0}</link>
<link name="a">{0}</link><link name="b">{0}</link><link name="c">{0}</link>
<joint name="ja" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 1 0"/>
 <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="jb" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 -.5"/><axis xyz="0 1 0.1"/>
 <limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="ja" multiplier="-1.5" offset="0.2"/></joint>
<joint name="jc" type="prismatic"><parent link="b"/><child link="c"/><origin xyz="0 0 -.5"/><axis xyz="0 0 1"/>
 <limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="ja" multiplier="0.3" offset="0"/></joint>
</robot>""".format('<inertial><origin xyz="0 0 -.25"/><mass value="1"/>'
                   '<inertia ixx=".1" iyy=".1" izz=".02" ixy="0" ixz="0" iyz="0"/></inertial>')  # fmt: skip


@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_mimic_joints_give_their_share(base):
    def fingers(text):
        b = dyn.Builder.from_model(dyn.load_string(text, base=base))
        b.add_frame("anchor", None, (0.3, 0.1, -0.2)).add_frame("tip", "c", (0.05, 0, -0.3)).add_frame("roll", "a", (0, 0, -0.4))
        b.add_tendon("cord", [("site", "anchor"), ("cylinder", "roll", 0.1), ("site", "tip")], type="spatial")
        b.add_tendon("sum", [("joint", "ja", 1), ("joint", "jb", 2), ("joint", "jc", 3)])
        return b.finish()

    m = fingers(MIMIC)
    plain = fingers("".join(part.split("/>", 1)[1] if k else part for k, part in enumerate(MIMIC.split("<mimic"))))
    check_rates(m, 10)
    d, e, random = m.data(), plain.data(), np.random.default_rng(3)
    q, v = m.random(3), random.standard_normal(m.nv)
    full = np.concatenate([q, [-1.5 * q[-1] + 0.2, 0.3 * q[-1]]])
    rates = np.concatenate([v, [-1.5 * v[-1], 0.3 * v[-1]]])
    ours, theirs = d.tendons(q, v), e.tendons(full, rates)
    np.testing.assert_allclose(ours.length, theirs.length, rtol=1e-14)
    np.testing.assert_allclose(ours.velocity, theirs.velocity, rtol=1e-13)


def test_rests_where_the_file_draws_it():
    """NaN: the length where joint springs rest, at 0 for the hinge, which the file draws at 0.2."""
    m = built(stiffness=1.0).finish()
    q = m.configuration(m.initial_configuration)
    q[m.joint("hinge").idx_q] = 0
    length = m.data().tendons(q).length
    for k in range(m.ntendons):
        assert m.tendon(k).rest == (length[k], length[k])
    mujoco = pytest.importorskip("mujoco")
    theirs = mujoco.MjModel.from_xml_string(TREES.format(written(PATHS, SUMS, 'stiffness="1"')))
    np.testing.assert_allclose(theirs.tendon_lengthspring, [m.tendon(k).rest for k in range(m.ntendons)], atol=1e-12)


BAD_ELEMENTS = {
    "no element": ("spatial", [], "tendon 'z': it has no element"),
    "unknown site": ("spatial", [("site", "tip"), ("site", "nope")], "element 1: there is no .*'nope'"),
    "unknown side": ("spatial", [("site", "tip"), ("sphere", "drum", 1, "nope"), ("site", "mast")], "element 1: .*'nope'"),
    "one site": ("spatial", [("site", "tip")], "fewer than two sites"),
    "short branch": ("spatial", [("site", "tip"), ("pulley", None, 2), ("site", "tip"), ("site", "mast")], "before element 1"),
    "joint in space": ("spatial", [("joint", "hinge")], "element 0 is a joint"),
    "site in a sum": ("fixed", [("joint", "hinge"), ("site", "tip")], "element 1 is no joint"),
    "unknown joint": ("fixed", [("joint", "nope")], "element 0: there is no moving joint 'nope'"),
    "ball joint": ("fixed", [("joint", "ball")], "joint 'ball' has 4 coordinates"),
    "wrap first": ("spatial", [("sphere", "drum", 0.1), ("site", "tip")], "element 0 wraps: a site must precede it"),
    "wrap last": ("spatial", [("site", "tip"), ("sphere", "drum", 0.1)], "a site must follow"),
    "two wraps": ("spatial", [("site", "tip"), ("sphere", "drum", 0.1), ("sphere", "hub", 0.1), ("site", "mast")], "element 2"),
    "radius 0": ("spatial", [("site", "tip"), ("sphere", "drum", 0), ("site", "mast")], "element 1: value is 0"),
    "divisor": ("spatial", [("site", "tip"), ("site", "mast"), ("pulley", None, -1), ("site", "tip"), ("site", "mast")],
                "element 2: value is -1"),
    "infinite": ("fixed", [("joint", "hinge", math.inf)], "element 0: value is inf"),
    "nan": ("fixed", [("joint", "hinge", math.nan)], "element 0: value is -?nan"),
    "pulley with a name": ("spatial", [("pulley", "tip", 2), ("site", "tip"), ("site", "mast")], "element 0: a pulley has no"),
    "site without a name": ("spatial", [("site",), ("site", "tip")], "element 0: it has no name"),
    "site with a side": ("spatial", [("site", "tip", 1, "mast"), ("site", "mast")], "element 0: only spheres and cylinders"),
    "unknown type": ("spatial", [("site", "tip"), ("cube", "drum")], "tendon 'z': element 1: type is 'cube'"),
    "name of no text": ("spatial", [("site", 3), ("site", "tip")], "element 0: name is 3, but must be a string"),
}  # fmt: skip
BAD_VALUES = [
    ({"type": "round"}, "type is 'round'"), ({"stiffness": -1}, "stiffness is -1"),
    ({"stiffness": math.nan}, "stiffness is -?nan"),
    ({"damping": -1}, "damping is -1"), ({"friction": -0.5}, "friction is -0.5"), ({"armature": math.inf}, "armature is inf"),
    ({"rest": (1, 0)}, r"rest is \[1, 0\]"), ({"rest": (math.nan, 1)}, "rest is"), ({"rest": (0, math.inf)}, "rest is"),
    ({"range": (1, 0)}, r"range is \[1, 0\]"), ({"range": (math.inf, math.inf)}, "range is"),
    ({"range": (math.nan, 1)}, "range is"),
]  # fmt: skip


def test_what_is_refused():
    """Every message names the tendon and the element; the builder stays as it was."""
    b = built({}, {"first": [("hinge", 1.0)]})
    before = b.finish().image()
    for what, (type, wrong, message) in BAD_ELEMENTS.items():
        with pytest.raises(dyn.Error, match=message) as caught:
            b.add_tendon("z", wrong, type=type)
        assert "tendon 'z'" in str(caught.value), what
    for values, message in BAD_VALUES:
        with pytest.raises(dyn.Error, match=message):
            b.add_tendon("z", [("joint", "hinge")], **values)
    for name, message in (("", "tendon has no name"), ("first", "tendon 'first' is there already"), ("a\0b", "zero character")):
        with pytest.raises(dyn.Error, match=message):
            b.add_tendon(name, [("joint", "hinge")])
    for arguments, message in ((("k", "first", "first"), "that is one tendon"), (("k", "nope"), "there is no tendon 'nope'"),
                               (("k", "first", "nope"), "there is no tendon 'nope'"), (("", "first"), "has no name"),
                               (("k", "first", None, (0, 1, math.nan, 0, 0)), "coefficient is -?nan")):  # fmt: skip
        with pytest.raises(dyn.Error, match=message):
            b.couple_tendons(*arguments)
    with pytest.raises(dyn.SizeError, match="coefficients"):
        b.couple_tendons("k", "first", None, (0, 1))
    b.couple_tendons("k", "first")
    with pytest.raises(dyn.Error, match="'k' is there already"):
        b.couple_tendons("k", "first")
    assert built({}, {"first": [("hinge", 1.0)]}).finish().image() == before


BAD_ACTUATORS = [
    ("sum", {"transmission": "tendon", "type": "muscle", "muscle": dyn.Muscle(**values)}, message)
    for values, message in (({"force": 0}, "force is 0"), ({"force": -1}, "force is -1"), ({"vmax": 0}, "vmax is 0"),
                            ({"t_act": 0}, "t_act is 0"), ({"t_deact": math.inf}, "t_deact is inf"),
                            ({"fpmax": -1}, "fpmax is -1"), ({"fvmax": 0.5}, "fvmax is 0.5"),
                            ({"smoothing": -1}, "smoothing is -1"), ({"lmin": 1.5}, "lmin and lmax"),
                            ({"lmax": 0.5}, "lmin and lmax"), ({"range": (1, 1)}, "two different ends"),
                            ({"length_range": (2, 1)}, "length_range is"), ({"length_range": (0, 0)}, "two different ends"))
] + [
    ("nope", {"transmission": "tendon"}, "there is no tendon 'nope'"),
    ("nope", {"transmission": "site"}, "there is no .*'nope'"),
    ("tip", {"transmission": "site", "reference": "nope"}, "there is no .*'nope'"),
    ("tip", {"transmission": "site", "gear": 2}, "gear is 2"),
    ("tip", {"transmission": "site", "wrench": (0, 0, math.nan, 0, 0, 0)}, "wrench is -?nan"),
    ("hinge", {"reference": "tip"}, "a reference frame needs the transmission"),
    ("hinge", {"transmission": "screw"}, "transmission is 'screw'"),
    ("sum", {"transmission": "tendon", "type": "muscle", "time_constant": 0.1}, "own time constants"),
    ("sum", {"transmission": "tendon", "type": "muscle", "integrates": True}, "own time constants"),
    ("ball", {"type": "muscle"}, "joint 'ball' has none"),
]  # fmt: skip


def test_what_is_refused_of_actuators():
    b = built()
    for target, values, message in BAD_ACTUATORS:
        with pytest.raises(dyn.Error, match=message) as caught:
            b.add_actuator("z", target, **values)
        assert "transmission" in values and "screw" in values.values() or "actuator 'z'" in str(caught.value)
    assert b.finish().nactuators == 0


def whole():
    """All kinds of what names tendons and frames."""
    b = built(SPATIAL, stiffness=20.0, damping=0.5, range=(-3, 9))
    b.couple_tendons("together", "sum", "one", (0.1, 2, 0.3, 0, 0)).couple_tendons("alone", "straight")
    b.add_actuator("pull", "pulleys", transmission="tendon", gear=-2)
    b.add_actuator("muscle", "across", type="muscle", transmission="tendon", muscle=dyn.Muscle(30, (0.8, 1.1), (0.3, 4)))
    b.add_actuator("of_a_joint", "hinge", type="muscle", muscle=dyn.Muscle(5, length_range=(-2, 2)))
    b.add_actuator("thrust", "tip", transmission="site", wrench=(1, 2, 3, 0.1, 0.2, 0.3))
    b.add_actuator("servo", "tip", type="position", kp=9, kv=1, transmission="site", wrench=(1, 0, 0, 0, 0, 0), reference="mast")
    return b


def described(m):
    tendons = {name: m.tendon(name) for name in m.tendon_names}
    return tendons, {name: m.actuator(name) for name in m.actuator_names}


def moved(m, steps=20):
    """State after some steps from a random one, which tendons, couplings and actuators change."""
    d = m.data()
    d.set_state(m.random(3), 0.3 * np.random.default_rng(4).standard_normal(m.nv))
    d.set_control(np.linspace(0.2, 0.6, m.nu))
    for _ in range(steps):
        d.step(1e-3, "semi_implicit_euler")
    return np.concatenate([d.q, d.v])


def test_copies_are_the_model():
    m = whole().finish()
    for other in (dyn.Builder.from_model(m).finish(), dyn.Model.from_image(m.image()), dyn.Builder("empty").attach(m).finish()):
        assert described(other) == described(m)
        np.testing.assert_array_equal(moved(other), moved(m))


def test_a_file_keeps_all(tmp_path):
    m = whole().finish()
    m.save(tmp_path / "m.dynb", strict=True)
    back = dyn.load(tmp_path / "m.dynb")
    assert described(back) == described(m)
    np.testing.assert_array_equal(moved(back), moved(m))


def test_attached_twice():
    m = whole().finish()
    both = dyn.Builder("two").attach(m, "a_").attach(m, "b_", joint="lift", type="prismatic").finish()
    assert both.tendon_names == [p + name for p in ("a_", "b_") for name in m.tendon_names]
    for prefix in ("a_", "b_"):
        for name in m.tendon_names:
            for e, f in zip(both.tendon(prefix + name).elements, m.tendon(name).elements):
                assert (e.type, e.value) == (f.type, f.value)
                assert (e.name, e.side) == (f.name and prefix + f.name, f.side and prefix + f.side)
        for name in m.actuator_names:
            x, y = both.actuator(prefix + name), m.actuator(name)
            assert (x.transmission, x.muscle, x.wrench) == (y.transmission, y.muscle, y.wrench)
            assert x.tendon < 0 or both.tendon_names[x.tendon] == prefix + m.tendon_names[y.tendon]
            assert x.frame < 0 or both.frame_name(x.frame) == prefix + m.frame_name(y.frame)
            assert x.reference < 0 or both.frame_name(x.reference) == prefix + m.frame_name(y.reference)
    knot = dyn.Builder("knot").add_joint("j", "revolute").add_body("b", "j", 1.0, (1, 0, 0))
    knot = knot.add_tendon("a_sum", [("joint", "j")]).finish()
    with pytest.raises(dyn.Error, match="'a_sum' is there already"):
        dyn.Builder("two").attach(knot).attach(m, "a_")
    check_rates(both, 2)


def test_a_locked_joint_leaves_the_paths():
    """A sum goes with a joint that it needs, and what names the sum goes, too."""
    m = whole().finish()
    q = m.random(5)
    locked = dyn.Builder.from_model(m).lock("hinge", q).finish()
    assert locked.tendon_names == list(SPATIAL) and locked.actuator_names == ["pull", "muscle", "thrust", "servo"]
    rest, held = m.random(6), m.joint("hinge").idx_q
    rest[held] = q[held]
    np.testing.assert_allclose(locked.data().tendons(np.delete(rest, held)).length,
                               m.data().tendons(rest).length[: len(SPATIAL)], rtol=1e-12)


def test_subtrees_take_their_tendons():
    m = whole().finish()
    without = dyn.Builder.from_model(m).remove_subtree("rail").finish()
    assert without.tendon_names == ["straight"] and without.actuator_names == ["thrust"]
    arm = dyn.Builder.from_model(m).keep_subtree("ball").finish()
    assert arm.tendon_names == []
    cart = dyn.Builder.from_model(built({"cord": ["mast", "drum", "pole_top"]}, {"one": [("hinge", 1)]}).finish())
    cart = cart.keep_subtree("rail").finish()
    assert cart.tendon_names == ["cord", "one"]
    check_rates(cart, 3)


def sealed(image):
    """The image with its check sum made anew: see dynb_checksum."""
    out, total = bytearray(image), 0xCBF29CE484222325
    for (word,) in struct.iter_unpack("<Q", image[40:]):
        total = (total ^ word) * 0x100000001B3 % 2**64
        total ^= total >> 32
    out[32:40] = struct.pack("<Q", total ^ struct.unpack_from("<Q", image, 16)[0])
    return bytes(out)


def test_damaged_files_are_refused_or_sound():
    """Numbers of a .dynb changed one by one, as large and small as they can be: what loads computes without a crash."""
    m = built({"cord": ["corner", ("drum", "drum_side"), "pole_top", 2, "mast", "tip"]}, {"sum": SUMS["sum"]}, stiffness=1.0)
    m.couple_tendons("k", "sum").add_actuator("pull", "cord", type="muscle", transmission="tendon")
    m = m.add_actuator("push", "tip", transmission="site", reference="mast").finish()
    image, q = m.image(), m.random(1)
    assert sealed(image) == image
    random, refused, read = np.random.default_rng(6), 0, 0
    for _ in range(1500):
        damaged, at = bytearray(image), 4 * int(random.integers(16, len(image) // 4))
        damaged[at : at + 4] = random.choice([-1, 2**31 - 1, 0, 1, -(2**31), int(random.integers(64))]).astype("<i4").tobytes()
        try:
            found = dyn.Model.from_image(sealed(damaged))
            read += 1
            d = found.data()
            d.tendons(q if found.nq == m.nq else None)
            for k in range(found.ntendons):
                found.tendon(k)
                d.tendon_path(k)
            for k in range(found.nactuators):
                found.actuator(k)
            d.step(1e-3)
        except (dyn.Error, ValueError):  # a number that is no member of an enumeration
            refused += 1
    assert refused > 100 and read > 100
