"""Copies and pickles of models, data and simulations: equal, on their own, and complete."""

import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest
from conftest import MODELS

import libdyn as dyn
from libdyn import constraint

SCENE = MODELS / "scenes" / "go2_stands.xml"


def pickled(x):
    return pickle.loads(pickle.dumps(x))


WAYS = pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, pickled, lambda x: x.copy()])


@WAYS
def test_data(way, go2, state):
    d = go2.data()
    d.set_state(*state)
    other = way(d)
    assert other._d != d._d and np.array_equal(other.q, state[0]) and np.array_equal(other.tau_applied, state[3])
    other.q = go2.random(2)
    assert np.array_equal(d.q, state[0]), "a copy is no alias"
    few = way(go2.data("inverse"))
    assert few.parts == go2.data("inverse").parts


@WAYS
def test_settings_go_along(way):
    """Everything that is set in a data and is no part of its state: the copy's steps are bit for bit the same."""
    m = dyn.load(SCENE)
    d = m.data()
    d.reset("standing")
    d.set_step_options("implicit_fast", dt=1e-3, solver="pgs", max_iterations=37)
    d.set_effects(("armature", "actuators", "limits"))
    d.set_gravity((0.5, 0, -9))
    d.set_shape_material(None, dyn.Material(friction=0.3))
    d.set_shape_material(0, dyn.Material(friction=0.9, restitution=0.2))
    d.set_pair(0, False)
    d.set_control(0.05 * np.ones(m.nu))
    d.apply_wrench("base", [1, 0, 2, 0, 0, 0])
    d.apply_wrench("base", [1, 0, 2, 0, 0, 0])
    d.apply_wrench("FL_foot", [0, 1, 0, 0, 0, 0], point=(0.01, 0, 0), reference="local")
    slot = d.add_constraint(constraint.point("base", placement2=(0, 0, 0.4)))
    d.anchor_constraint(slot)
    for _ in range(20):
        d.step()
    other, bare = way(d), m.data()
    foot = next(s.id for s in m.shapes[1:] if s.role == dyn.ShapeRole.COLLISION)
    assert other.step_options.max_iterations == 37 and other.shape_material(foot).friction == 0.3
    assert other.shape_material(0).restitution == 0.2 and other.pair_reason(0) == d.pair_reason(0) != bare.pair_reason(0)
    for x in (d, other):
        for _ in range(50):
            x.step()
    assert np.array_equal(d.q, other.q) and np.array_equal(d.v, other.v) and d.time == other.time
    other.clear_wrenches(), other.step(), d.step()
    assert not np.array_equal(d.v, other.v)


@WAYS
def test_simulations(way):
    sim = dyn.Simulation(SCENE, "standing", dt=1e-3)
    sim.step(30)
    sim.record()
    other = way(sim)
    assert other.data.model is other.model and not other._recordings
    a, b = sim.run(0.1), other.run(0.1)
    assert np.array_equal(a.q, b.q) and np.array_equal(a.t, b.t)
    other.reset()
    assert other.time == 0 and np.array_equal(other.q, sim.model.configuration("standing"))


def test_a_model_is_shared_by_copies(go2):
    assert copy.copy(go2) is go2 and copy.deepcopy(go2) is go2
    assert pickled(go2).nq == go2.nq


def test_another_process_goes_on(tmp_path):
    sim = dyn.Simulation(SCENE, "standing")
    sim.step(30)
    (tmp_path / "sim.pickle").write_bytes(pickle.dumps(sim))
    program = ("import pickle, sys, libdyn\nsim = pickle.load(open(sys.argv[1], 'rb'))\nsim.step(40)\n"
               "sys.stdout.write(sim.q.tobytes().hex())")
    done = subprocess.run([sys.executable, "-c", program, str(tmp_path / "sim.pickle")], capture_output=True, text=True,
                          check=True)
    sim.step(40)
    assert np.array_equal(np.frombuffer(bytes.fromhex(done.stdout)), sim.q)


def test_arrays_of_fields_compute_as_plain_ones(go2, state):
    d = go2.data()
    d.set_state(*state[:2])
    q = d.q
    assert type(q + 1) is type(np.sin(q)) is type(q @ q[:, None]) is np.ndarray and isinstance(q.sum(), float)
    assert repr(q) == repr(np.array(q)) and type(q.copy()) is type(copy.copy(q)) is type(pickled(q)) is np.ndarray
    part = q[3:7].copy()
    part[0] = 2
    assert q[3] != 2


def test_what_to_write_instead(go2):
    d = go2.data()
    for wrong, says in (
        (lambda: d.q.__setitem__(slice(None), 0), r"data\.q = x"),
        (lambda: d.tau_applied.__setitem__(0, 1), r"tau_applied = x, or Simulation\.step\(tau=x\)"),
        (lambda: d.tau, r"Simulation\.step\(tau=x\)"),
        (lambda: d.world_gravity.__setitem__(2, 0), r"set_gravity"),
        (lambda: d.q[3:7].__setitem__(0, 1), r"view of the library"),
        (lambda: go2.lower_limit.__setitem__(0, 1), r"Builder\.from_model"),
        (lambda: d.v.__iadd__(1), r"data\.v = x"),
    ):
        with pytest.raises(dyn.Error, match=says):
            wrong()
    d.crba()
    with pytest.raises(dyn.ArgumentError, match=r"data\.M\.copy\(\)"):
        d.M[0, 0] = 1
    d.rnea()
    with pytest.raises(dyn.ArgumentError, match="tau is the result of Data.rnea"):
        d.tau[:] = 0
    d.v = d.v + 1
    assert (d.v == 1).all()


def test_lambda_has_a_name(go2):
    d = go2.data()
    with pytest.raises(dyn.StaleError):
        d.lambda_
