"""Rollouts: simulations are what Data's steps give, bit for bit; shapes follow from arrays; sensors, contacts, failures, progress, interrupts."""

import pickle

import numpy as np
import pytest
from conftest import MODELS

import libdyn as dyn
from libdyn.batch import rollout


@pytest.fixture(scope="session")
def scene():
    """A quadruped above a floor."""
    bare = dyn.load(MODELS / "robots" / "go2.urdf", base="floating")
    return dyn.Builder.from_model(bare).add_shape("universe", "half_space", name="floor").finish()


@pytest.fixture(scope="session")
def task(scene):
    """Four simulations that fall onto their feet under random torques."""
    legs = ("FL", "FR", "RL", "RR")
    bent = {f"{leg}_thigh_joint": 0.8 for leg in legs} | {f"{leg}_calf_joint": -1.5 for leg in legs}
    q0 = np.tile(scene.normalize(bent), (4, 1))
    q0[:, 2] = [0.28, 0.29, 0.3, 0.32]
    tau = 3 * np.random.default_rng(2).normal(size=(4, 10, scene.nv))
    tau[..., :6] = 0
    return {"q0": q0, "tau": tau, "every": 8}


def by_steps(m, q0, tau, every, dt=1e-3, integrator=None):
    d = m.data()
    d.set_state(q=q0)
    d.set_step_options(integrator, dt)
    rows = []
    for row in tau:
        d.set_state(tau=row)
        for _ in range(every):
            d.step()
        rows.append((d.q.copy(), d.v.copy(), len(d.step_contacts())))
    return rows


@pytest.mark.parametrize("options", [{}, {"dt": 5e-4, "integrator": "implicit_fast"}])
def test_it_is_what_steps_are(scene, task, options):
    r = rollout(scene, **task, **options, contacts=4, threads=3)
    assert r.q.shape == (4, 10, scene.nq) and not r.status.any() and r.contact_count.any()
    for k in range(4):
        for i, (q, v, contacts) in enumerate(by_steps(scene, task["q0"][k], task["tau"][k], 8, **options)):
            assert np.array_equal(r.q[k, i], q) and np.array_equal(r.v[k, i], v) and r.contact_count[k, i] == contacts


def test_threads_neighbours_and_copies_of_the_model_change_no_bit(scene, task):
    r = rollout(scene, **task, threads=1)
    assert np.array_equal(r.q, rollout(scene, **task, threads=4).q)
    alone = rollout(scene, task["q0"][2:3], tau=task["tau"][2:3], every=8)
    assert np.array_equal(alone.q[0], r.q[2])
    again = pickle.loads(pickle.dumps(scene))
    assert np.array_equal(rollout(again, **task).q, r.q)


def test_going_on(scene, task):
    whole = rollout(scene, **task, keep_states=True)
    batch = scene.batch(threads=2)
    first = batch.rollout(task["q0"], tau=task["tau"][:, :5], every=8, keep_states=True)
    rest = batch.rollout(states=first.states, tau=task["tau"][:, 5:], every=8, keep_states=True)
    assert np.array_equal(rest.q, whole.q[:, 5:]) and np.array_equal(rest.states, whole.states)


def test_one_row_for_all_and_sizes_that_are_said(scene, task):
    q0 = task["q0"][0]
    r = rollout(scene, q0, tau=task["tau"][1], every=8, n=3)
    assert np.array_equal(r.q[0], r.q[1]) and np.array_equal(r.q[0], r.q[2])
    assert rollout(scene, steps=6, every=2).q.shape == (1, 3, scene.nq)
    listed = rollout(scene, q0.tolist(), tau=task["tau"][1].astype(np.float32).tolist(), every=8)  # lists are arrays
    assert listed.q.shape == (1, 10, scene.nq)
    turned = np.asfortranarray(task["tau"])  # not contiguous
    assert np.array_equal(rollout(scene, task["q0"], tau=turned, every=8).q, rollout(scene, **task).q)


def test_sensors_and_contacts(scene, task):
    names = {"imu": ("imu", "base"), "foot": ("placement", "FL_foot"), "com": "com", "energy": dyn.SensorType.ENERGY}
    names |= {f: ("force", f) for f in ("FL_foot", "FR_foot", "RL_foot", "RR_foot")}
    r = rollout(scene, **task, sensors=names, contacts=32, keep_states=True)
    assert [r.sensors[n].shape[-1] for n in names] == [6, 7, 6, 2, 6, 6, 6, 6] and list(r.sensors) == list(names)
    d = scene.data()
    for k, i in ((0, 0), (3, 9)):
        d.forward_kinematics(r.q[k, i], r.v[k, i])
        np.testing.assert_allclose(r.sensors["foot"][k, i, :3], d.frame_placement("FL_foot").translation, atol=1e-15)
        np.testing.assert_allclose(r.sensors["com"][k, i, :3], d.compute_com(), atol=1e-13)
        np.testing.assert_allclose(r.sensors["energy"][k, i], d.energy(), atol=1e-12)
    # each foot's force is the sum of those of its contacts
    frames, pressed = np.array([s.frame for s in scene.shapes]), 0
    for foot in ("FL_foot", "FR_foot", "RL_foot", "RR_foot"):
        link = scene.frame_id(foot, "body")
        for k, i in np.ndindex(r.contact_count.shape):
            c = r.contacts[k, i, : r.contact_count[k, i]]
            force = sum(((frames[c["shape_b"]] == link) * 1.0 - (frames[c["shape_a"]] == link))[:, None] * c["force_on_b"],
                        np.zeros(3))
            np.testing.assert_allclose(r.sensors[foot][k, i, :3], force, atol=1e-9)
            pressed += force[2] > 1
    assert pressed > 10


def test_actuators_take_controls():
    b = dyn.Builder("pendulum")
    b.add_joint("hinge", "revolute", axis=(0, 1, 0)).add_body("rod", "hinge", mass=1, com=(0, 0, -0.5),
                                                              inertia=np.diag([0.1, 0.1, 0.01]))
    m = b.add_actuator("motor", "hinge", type="motor", gear=2.0).finish()
    u = np.random.default_rng(1).normal(size=(3, 5, 1))
    driven = rollout(m, control=u, every=4)
    assert np.abs(driven.q - rollout(m, tau=2 * u, every=4).q).max() < 1e-15 and np.abs(driven.q).max() > 1e-5


def test_one_that_fails(scene, task):
    tau = task["tau"].copy()
    tau[1, 3, 7] = np.nan
    with pytest.raises(dyn.NonFiniteError, match="simulation 1: .*tau.*1 of 4 simulations"):
        rollout(scene, task["q0"], tau=tau, every=8)
    r = rollout(scene, task["q0"], tau=tau, every=8, strict=False)
    assert r.status.tolist() == [0, dyn.Status.ERROR_NONFINITE, 0, 0]
    assert np.isnan(r.q[1, 3:]).all() and np.isfinite(r.q[1, :3]).all() and np.isfinite(r.q[[0, 2, 3]]).all()


def test_progress_cancelling_and_interrupts(scene, task):
    told = []
    rollout(scene, **task, progress=lambda made, of: told.append((made, of)))
    assert told[-1] == (4 * 80, 4 * 80) and [t[0] for t in told] == sorted(t[0] for t in told)
    with pytest.raises(dyn.CancelledError, match="cancelled after"):
        rollout(scene, **task, threads=1, progress=lambda made, of: False)

    def interrupt(made, of):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        rollout(scene, **task, threads=1, progress=interrupt)


def test_refusals(scene, task):
    q0, tau = task["q0"], task["tau"]
    m = scene
    for words, error, call in [
        ("steps is needed", dyn.ArgumentError, lambda: rollout(m, q0)),
        (r"q0 has shape \(4, 18\).*\(4, 19\)", dyn.SizeError, lambda: rollout(m, q0[:, :18], steps=1)),
        ("n is 4, but the shape of tau says 3", dyn.SizeError, lambda: rollout(m, q0, tau=tau[:3])),
        ("steps is 10, but the 10 records of tau says 80", dyn.SizeError, lambda: rollout(m, q0, tau=tau, every=8, steps=10)),
        (r"tau has shape \(18,\)", dyn.SizeError, lambda: rollout(m, q0, tau=tau[0, 0])),
        ("every is 0", dyn.ArgumentError, lambda: rollout(m, steps=1, every=0)),
        ("multiple of every", dyn.ArgumentError, lambda: rollout(m, steps=3, every=2)),
        ("tau must hold real numbers, but its dtype is complex128", dyn.ArgumentError, lambda: rollout(m, tau=tau + 1j)),
        ("q0 must hold real numbers, but its dtype is <U", dyn.ArgumentError, lambda: rollout(m, ["a"], steps=1)),
        ("sensors\\['x'\\] is 'radar'", dyn.ArgumentError, lambda: rollout(m, steps=1, sensors={"x": "radar"})),
        ("sensors\\['x'\\] needs a frame", dyn.ArgumentError, lambda: rollout(m, steps=1, sensors={"x": "imu"})),
        ("nobody", dyn.UnknownNameError, lambda: rollout(m, steps=1, sensors={"x": ("imu", "nobody")})),
        ("contacts is -1", dyn.ArgumentError, lambda: rollout(m, steps=1, contacts=-1)),
        ("states must be", dyn.SizeError, lambda: rollout(m, steps=1, states=np.zeros((1, 3), np.uint8))),
        ("holds no state", dyn.ArgumentError, lambda: rollout(m, steps=1,
                                                              states=np.zeros((1, dyn.library.lib.dyn_model_state_size(m._m)),
                                                                              np.uint8))),
        ("engine is 'gpu'", dyn.ArgumentError, lambda: rollout(m, steps=1, engine="gpu")),
        ("dt", dyn.ArgumentError, lambda: rollout(m, steps=1, dt=-1)),
        ("tolerance is 'x'", dyn.ArgumentError, lambda: rollout(m, steps=1, tolerance="x")),
    ]:
        with pytest.raises(error, match=words):
            call()


def test_models_of_their_own(scene, task):
    models = [dyn.vary(scene, k, mass=0.3, contact_friction=(0.5, 1.2)) for k in range(4)]
    r = rollout(scene, **task, models=models, keep_states=True)
    for k, m in enumerate(models):
        for i, (q, v, _) in enumerate(by_steps(m, task["q0"][k], task["tau"][k], task["every"])):
            assert np.array_equal(r.q[k, i], q) and np.array_equal(r.v[k, i], v)
    assert (r.q[:, -1] != rollout(scene, **task).q[:, -1]).any(-1).all()
    on = rollout(scene, tau=task["tau"], every=task["every"], states=r.states, models=models)
    whole = rollout(scene, task["q0"], tau=np.tile(task["tau"], (1, 2, 1)), every=task["every"], models=models)
    assert np.array_equal(on.q, whole.q[:, 10:])
    for wrong, error in ((models[:3], dyn.SizeError), ([*models[:3], dyn.load(MODELS / "robots/panda.urdf", base="fixed")], dyn.ModelError)):
        with pytest.raises(error, match="models"):
            rollout(scene, **task, models=wrong)
