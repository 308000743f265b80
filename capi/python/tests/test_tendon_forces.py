"""Steps with tendons, and actuators that act through tendons and on frames: forces, activations and motion beside MuJoCo's."""

import math

import libdyn as dyn
import numpy as np
import pytest
from test_tendons import INSIDE, PATHS, SPATIAL, SUMS, TREES, built, elements, written

mujoco = pytest.importorskip("mujoco")

MUSCLE = {"force": 40.0, "range": (0.7, 1.2), "length_range": (0.5, 3.0), "lmin": 0.6, "lmax": 1.7, "vmax": 2.0, "fpmax": 1.4,
          "fvmax": 1.3, "t_act": 0.02, "t_deact": 0.05}


def in_mjcf(values, smoothing=0.0):
    two = {"range": "range", "length_range": "lengthrange"}
    words = [f'{two[k]}="{v[0]} {v[1]}"' if k in two else f'{k}="{v}"'
             for k, v in values.items() if k not in ("t_act", "t_deact")]  # fmt: skip
    return " ".join(words) + f' timeconst="{values["t_act"]} {values["t_deact"]}" tausmooth="{smoothing}"'


ACTUATORS = f"""<actuator>
<motor name="motor" tendon="pulleys" gear="1.5"/><position name="position" tendon="across" kp="30" kv="2" forcerange="-8 20"/>
<velocity name="velocity" tendon="sum" kv="3" gear="-0.5"/>
<general name="affine" tendon="around_sphere" gainprm="3" biastype="affine" biasprm="1 -20 -1" dyntype="filter" dynprm="0.05"/>
<muscle name="muscle" tendon="straight" {in_mjcf(MUSCLE)}/>
<muscle name="smooth" joint="hinge" {in_mjcf({**MUSCLE, "length_range": (-2, 2)}, 0.3)}/>
<motor name="thrust" site="tip" gear="1 2 3 .1 .2 .3"/>
<general name="between" site="tip" refsite="mast" gear="1 -.5 0 0 .3 .4" gainprm="9" biastype="affine" biasprm="0 -9 -1"/>
<motor name="same_tree" site="tip" refsite="base_top" gear="0 1 0 2 0 0"/>
</actuator>"""


def driven():
    b = built()
    t, site = {"transmission": "tendon"}, {"transmission": "site"}
    b.add_actuator("motor", "pulleys", gear=1.5, **t)
    b.add_actuator("position", "across", type="position", kp=30, kv=2, force_range=(-8, 20), **t)
    b.add_actuator("velocity", "sum", type="velocity", kv=3, gear=-0.5, **t)
    b.add_actuator("affine", "around_sphere", type="affine", gain=3, bias=(1, -20, -1), time_constant=0.05, **t)
    b.add_actuator("muscle", "straight", type="muscle", muscle=dyn.Muscle(**MUSCLE), **t)
    b.add_actuator("smooth", "hinge", type="muscle", muscle=dyn.Muscle(**{**MUSCLE, "length_range": (-2, 2)}, smoothing=0.3))
    b.add_actuator("thrust", "tip", wrench=(1, 2, 3, 0.1, 0.2, 0.3), **site)
    b.add_actuator("between", "tip", type="affine", gain=9, bias=(0, -9, -1), reference="mast",
                   wrench=(1, -0.5, 0, 0, 0.3, 0.4), **site)
    b.add_actuator("same_tree", "tip", reference="base_top", wrench=(0, 1, 0, 2, 0, 0), **site)
    return b.finish()


def beside(m, text, seed, speed=1.0):
    """Both at the same random state near the drawn configuration, with the same controls."""
    theirs = mujoco.MjModel.from_xml_string(text)
    state, layout, random = mujoco.MjData(theirs), dyn.StateLayout.of_mujoco(theirs), np.random.default_rng(seed)
    d, start = m.data(), m.configuration(m.initial_configuration)
    q, v = m.integrate(start, 0.3 * random.standard_normal(m.nv)), speed * random.standard_normal(m.nv)
    d.set_state(q, v)
    state.qpos[:], state.qvel[:] = m.to_peer(layout, q, v)[:2]
    if m.nu:
        u = random.uniform(-0.2, 1.2, m.nu)
        d.set_control(u)
        state.ctrl[:] = u
    return d, theirs, state, layout


@pytest.mark.parametrize("seed", range(5))
def test_actuators_move_it_as_mujocos(seed):
    m = driven()
    d, theirs, state, layout = beside(m, TREES.format(written(PATHS, SUMS) + ACTUATORS), seed)
    for _ in range(200):
        d.step(1e-3, "rk4")
        mujoco.mj_step(theirs, state)
    q, v = m.to_peer(layout, d.q, d.v)[:2]
    np.testing.assert_allclose(q, state.qpos, atol=1e-8)
    np.testing.assert_allclose(v, state.qvel, atol=1e-6)
    np.testing.assert_allclose(d.act, state.act, atol=1e-10)
    state.qpos[:], state.qvel[:], state.act[:] = q, v, d.act
    mujoco.mj_forward(theirs, state)
    np.testing.assert_allclose(d.actuator_force, state.actuator_force, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("smoothing", [0, 0.3, 1.5])
def test_muscles_have_mujocos_curves(smoothing):
    muscle = dyn.Muscle(**{**MUSCLE, "length_range": (-1.5, 2.0)}, smoothing=smoothing)
    b = dyn.Builder("slide").set_gravity((0, 0, 0)).add_joint("j", "prismatic", axis=(1, 0, 0)).add_body("b", "j", 1e6)
    b.add_frame("a", None, (-5, 0, 0)).add_frame("s", "b").add_tendon("t", [("joint", "j", 1.0)])
    b.add_actuator("m", "t", type="muscle", transmission="tendon", muscle=muscle)
    d = b.finish().data()
    prm = np.array([*muscle.range, muscle.force, 200, muscle.lmin, muscle.lmax, muscle.vmax, muscle.fpmax, muscle.fvmax])
    lengths, times = np.array(muscle.length_range), np.array([muscle.t_act, muscle.t_deact, smoothing])
    random, w = np.random.default_rng(7), 0.0
    for _ in range(2000):
        u, h = random.uniform(-0.3, 1.3), 10 ** random.uniform(-4, -2)
        d.set_state([random.uniform(-5, 6)], [random.uniform(-15, 15)])
        d.set_control([u])
        d.step(h, "rk4")
        rate = lambda w: mujoco.mju_muscleDynamics(u, w, times)  # noqa: E731
        k1 = rate(w)
        k2 = rate(w + h / 2 * k1)
        k3 = rate(w + h / 2 * k2)
        w += h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(w + h * k3))
        assert d.act[0] == pytest.approx(w, rel=1e-12, abs=1e-14)
        length, speed = d.q[0], d.v[0]
        force = (mujoco.mju_muscleGain(length, speed, lengths, 1, prm) * w + mujoco.mju_muscleBias(length, lengths, 1, prm))
        assert d.actuator_force[0] == pytest.approx(force, rel=1e-9, abs=1e-9)
        w = d.act[0]


SPRINGS = 'stiffness="40" damping="1.5" springlength="0.4 0.9"'


@pytest.mark.parametrize("seed", range(3))
def test_springs_and_dampers_move_it_as_mujocos(seed):
    m = built(stiffness=40, damping=1.5, rest=(0.4, 0.9)).finish()
    d, theirs, state, layout = beside(m, TREES.format(written(PATHS, SUMS, SPRINGS)), seed)
    for _ in range(200):
        d.step(1e-3, "rk4")
        mujoco.mj_step(theirs, state)
    q, v = m.to_peer(layout, d.q, d.v)[:2]
    np.testing.assert_allclose(q, state.qpos, atol=1e-7)
    np.testing.assert_allclose(v, state.qvel, atol=1e-5)


def pendulum(tendon, **values):
    """A pendulum of 1 kg and 1 m, with a cord from a hook beside its hinge to its bob."""
    b = dyn.Builder("pendulum").add_joint("hinge", "revolute", axis=(0, 1, 0))
    b.add_body("bob", "hinge", 1.0, (0, 0, -1), 1e-3 * np.eye(3))
    b.add_frame("tip", "bob", (0, 0, -1)).add_frame("hook", None, (0.8, 0, 0))
    kinds = {"sum": [("joint", "hinge", 1.0)], "cord": [("site", "hook"), ("site", "tip")]}
    return b.add_tendon("t", kinds[tendon], type="fixed" if tendon == "sum" else "spatial", **values)


@pytest.mark.parametrize("integrator", ["rk4", "implicit_midpoint", "reference", "rk45"])
@pytest.mark.parametrize("tendon", ["sum", "cord"])
def test_springs_keep_energy(tendon, integrator):
    d = pendulum(tendon, stiffness=30, rest=(0.5, 0.5)).finish().data()
    d.set_effects("all")
    d.set_state([0.7], [0])
    before = d.energy()
    for _ in range(2000):
        d.step(1e-3, integrator)
    after = d.energy()
    assert abs(d.v[0]) > 1e-3 or abs(d.q[0] - 0.7) > 1e-3
    assert sum(after) == pytest.approx(sum(before), abs=1e-4 if integrator == "implicit_midpoint" else 1e-8)


def test_potential_has_the_spring():
    d = pendulum("cord", stiffness=30, rest=(0.5, 0.6)).finish().data()
    plain = pendulum("cord").finish().data()
    d.set_effects("all")
    length = d.tendons([0.4]).length[0]
    assert d.potential_energy([0.4]) - plain.potential_energy([0.4]) == pytest.approx(15 * (length - 0.6) ** 2, rel=1e-12)


@pytest.mark.parametrize("dt", [1e-4, 1e-2])
@pytest.mark.parametrize("tendon", ["sum", "cord"])
def test_stiff_springs_rest_where_forces_balance(tendon, dt):
    """Any stiffness and damping for any step."""
    for stiffness in (1e2, 1e6, 1e10):
        d = pendulum(tendon, stiffness=stiffness, damping=stiffness / 10, rest=(0.5, 0.5)).finish().data()
        d.set_step_options(tolerance=1e-12)
        for _ in range(int(20 / dt) if dt > 1e-3 else 2000):
            d.step(dt)
        length, _, J = d.tendons()
        if dt > 1e-3:
            assert J[0, 0] * -stiffness * (length[0] - 0.5) == pytest.approx(d.gravity_torque()[0], rel=1e-5, abs=1e-6)
        assert np.isfinite(d.v).all() and abs(d.v[0]) < 10


@pytest.mark.parametrize("tendon", ["sum", "cord"])
def test_lengths_stay_within_their_range(tendon):
    d = pendulum(tendon, range=(0.5, 1.0) if tendon == "cord" else (-0.4, 0.2)).finish().data()
    low, high = (0.5, 1.0) if tendon == "cord" else (-0.4, 0.2)
    d.set_state([-0.8 if tendon == "cord" else 0.0], [3.0])
    d.tendons()
    seen = []
    for _ in range(3000):
        d.step(1e-3)
        seen.append(d.tendons().length[0])
    assert min(seen[1000:]) > low - 1e-4 and max(seen[1000:]) < high + 1e-4
    assert abs(d.v[0]) < 2


def test_dry_friction_holds_and_brakes():
    """Below the friction's bound it stays; above it the rest accelerates it."""
    held = pendulum("sum", friction=10.0).finish().data()
    held.set_state([math.pi / 2 - 1.0])
    for _ in range(500):
        held.step(1e-3)
    assert abs(held.v[0]) < 1e-9 and held.q[0] == pytest.approx(math.pi / 2 - 1.0, abs=1e-12)
    b = dyn.Builder("slide").set_gravity((0, 0, 0)).add_joint("j", "prismatic", axis=(1, 0, 0)).add_body("b", "j", 2.0)
    d = b.add_tendon("t", [("joint", "j", 3.0)], friction=4.0).finish().data()
    d.set_state([0], [1.0], tau=[20.0])
    for _ in range(100):
        d.step(1e-3)
    assert d.v[0] == pytest.approx(1 + 0.1 * (20 - 12) / 2, rel=1e-9)


def test_armature_is_inertia_along_the_tendon():
    b = dyn.Builder("slide").set_gravity((0, 0, 0)).add_joint("j", "prismatic", axis=(1, 0, 0)).add_body("b", "j", 2.0)
    d = b.add_tendon("t", [("joint", "j", 3.0)], armature=0.5).finish().data()
    d.set_state(tau=[13.0])
    for _ in range(100):
        d.step(1e-3)
    assert d.v[0] == pytest.approx(0.1 * 13 / (2 + 0.5 * 9), rel=1e-9)


UNDAMPED = TREES.replace(' damping=".1"', "")


@pytest.mark.parametrize("name", [*PATHS, *INSIDE, "sum"])
@pytest.mark.parametrize("seed", range(3))
def test_armature_keeps_the_energy(name, seed):
    """Of trees with a free base, a ball, a rail and hinges, whose tendon passes sites, pulleys and surfaces."""
    paths, sums = ({name: SPATIAL[name]}, {}) if name in SPATIAL else ({}, SUMS)
    m = built(paths, sums, text=UNDAMPED, armature=0.4).finish()
    d, random = m.data(), np.random.default_rng(seed)
    q = m.integrate(m.configuration(m.initial_configuration), 0.2 * random.standard_normal(m.nv))
    v = random.standard_normal(m.nv)
    d.set_effects(dyn.Effect.ALL)
    d.set_state(q, v)
    before = sum(d.energy())
    drift = []
    for n in (50, 100, 200):  # of order 1: what remains of it after extrapolation is of order 3
        d.set_state(q, v)
        for _ in range(n):
            d.step(0.05 / n, "semi_implicit_euler")
        drift.append(sum(d.energy()) - before)
    assert abs(drift[0] / 3 - 2 * drift[1] + 8 / 3 * drift[2]) < 1e-5 < abs(drift[2])
    d.set_state(q, v)
    d.set_step_options(accuracy=1e-6)
    d.advance(0.05)
    assert sum(d.energy()) == pytest.approx(before, abs=1e-4)


@pytest.mark.parametrize("seed", range(3))
def test_armature_accelerates_it_as_mujocos(seed):
    """On tendons along one chain: MuJoCo's inertia has no entries between branches, so on others it loses energy."""
    paths, sums = {"straight": PATHS["straight"]}, {"one": SUMS["one"]}
    m = built(paths, sums, text=UNDAMPED, armature=0.4).finish()
    d, theirs, state, layout = beside(m, UNDAMPED.format(written(paths, sums, 'armature="0.4"')), seed, speed=4.0)
    mujoco.mj_forward(theirs, state)
    q, v = d.q.copy(), d.v.copy()
    start = m.to_peer(layout, q, v)[1]

    def acceleration(h):
        d.set_state(q, v)
        d.step(h, "semi_implicit_euler")
        return (m.to_peer(layout, d.q, d.v)[1] - start) / h

    np.testing.assert_allclose(2 * acceleration(5e-6) - acceleration(1e-5), state.qacc, rtol=1e-6, atol=1e-6)


def test_couplings_hold_and_keep_energy():
    b = dyn.Builder("two").add_joint("a", "revolute", axis=(0, 1, 0)).add_body("ba", "a", 1.0, (0, 0, -1), 0.01 * np.eye(3))
    b.add_joint("b", "revolute", placement=(1, 0, 0), axis=(0, 1, 0)).add_body("bb", "b", 0.2, (0.5, 0, -0.3), 0.02 * np.eye(3))
    b.add_tendon("ta", [("joint", "a", 1.0)]).add_tendon("tb", [("joint", "b", 1.0)])
    d = b.couple_tendons("k", "ta", "tb", (0.0, 0.5, 0.3, 0.0, 0.0)).finish().data()
    x = 0.4
    d.set_state([0.5 * x + 0.3 * x**2, x])
    before, worst = sum(d.energy()), 0.0
    for _ in range(2000):
        d.step(1e-3)
        worst = max(worst, abs(d.q[0] - 0.5 * d.q[1] - 0.3 * d.q[1] ** 2))
    assert worst < 1e-5
    assert sum(d.energy()) == pytest.approx(before, abs=2e-2)


FORCES = [{"stiffness": 30.0, "damping": 0.7}, {"friction": 2.0}, {"range": (0.5, 1.1)}, {"armature": 0.3}]


@pytest.mark.parametrize("values", FORCES, ids=lambda v: "_".join(v))
@pytest.mark.parametrize("tendon", ["sum", "cord"])
def test_the_ledger_explains_the_energy(tendon, values):
    d = pendulum(tendon, **values).finish().data()
    d.set_step_options(dt=1e-4, ledger=True)
    d.set_state([-0.3], [1.0])
    defects = []
    for _ in range(20):
        d.advance(0.05)
        defects.append(d.ledger.energy_defect)
    assert np.abs(defects).max() < 5e-3 and abs(d.q[0] + 0.3) > 1e-3


def test_tendons_switch_off():
    m = pendulum("cord", stiffness=100).finish()
    with_it, without, plain = m.data(), m.data(), pendulum("cord").finish().data()
    without.set_effects(())
    for d in (with_it, without, plain):
        d.set_state([0.5])
        for _ in range(50):
            d.step(1e-3)
    assert without.q[0] == plain.q[0] != with_it.q[0]
    assert with_it.plan()["tendons"].acting == 1 and without.plan()["tendons"].acting == 0 == plain.plan()["tendons"].acting


def test_nothing_for_models_without_tendons(arm):
    assert arm.ntendons == 0 and arm.tendon_names == []
    d = arm.data()
    length, velocity, J = d.tendons()
    assert length.shape == velocity.shape == (0,) and J.shape == (0, 2)
    assert d.plan()["tendons"] == (0, 0, 0)
    assert elements([]) == []
