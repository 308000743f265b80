"""Effects of joints: armature, damping, springs, dry friction."""

import numpy as np
import pytest

import libdyn as dyn
from libdyn import Effect


@pytest.fixture
def pendulum():
    b = dyn.Builder("pendulum").add_joint(
        "hinge", "revolute", axis=(0, 1, 0), lower=-9, upper=9, armature=0.1, damping=0.2, friction=0.3, stiffness=4,
        spring_reference=0.5
    )
    return b.add_body("rod", "hinge", 1, (0, 0, -0.5), np.eye(3)).finish()


def test_they_are_switched_on(pendulum):
    assert pendulum.stiffness == 4 and pendulum.spring_reference == 0.5
    d = pendulum.data()
    assert d.effects("hinge") == Effect.DEFAULT
    assert d.effects() == Effect.ARMATURE | Effect.DAMPING | Effect.SPRINGS | Effect.FRICTION | Effect.LIMITS  # in steps
    bare = d.rnea([0.2], [1.0], [2.0]).copy()
    for effects, added in ((("damping",), 0.2), ("springs", 4 * (0.2 - 0.5)), (Effect.FRICTION, 0.3)):
        d.set_effects(effects, joint="hinge")
        assert d.rnea() == pytest.approx(bare - 0.1 * 2 + added, abs=1e-14)
    d.set_effects("all")
    tau = d.rnea().copy()
    assert d.aba(tau=tau) == pytest.approx(2)
    assert d.effects() == Effect.ARMATURE | Effect.DAMPING | Effect.SPRINGS | Effect.FRICTION | Effect.LIMITS | Effect.SLEEPING
    energy = d.energy().potential
    d.set_effects(())
    assert energy - d.energy().potential == pytest.approx(0.5 * 4 * 0.3**2)


def test_every_effect_is_planned(pendulum):
    effects = {e.name.lower() for e in Effect} - {"default", "all", "as_stated"}
    assert effects <= set(pendulum.data().plan())


def test_results_are_stale_afterwards(pendulum):
    d = pendulum.data()
    d.crba()
    d.set_effects("all")
    with pytest.raises(dyn.StaleError):
        d.M  # noqa: B018


@pytest.mark.parametrize("effects", ["wind", 1 << max(int(e).bit_length() for e in Effect), -1, 1.5, None])
def test_what_is_no_effect(pendulum, effects):
    with pytest.raises(dyn.ArgumentError):
        pendulum.data().set_effects(effects)


def test_of_a_batch(pendulum):
    d, b = pendulum.data(), pendulum.batch(threads=2)
    q, v, a = np.random.default_rng(0).uniform(-1, 1, (3, 10, 1))
    d.set_effects("all")
    b.set_effects("all")
    assert np.array_equal(b.rnea(q, v, a), [d.rnea(*x) for x in zip(q, v, a)])
    assert np.array_equal(b.crba(q), [d.crba(x) for x in q]) and b.energy(q, v).kinetic.shape == (10,)
