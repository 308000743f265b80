"""Batches: arrays in, arrays out, row by row what Data computes."""

import threading

import numpy as np
import pytest

import libdyn as dyn

N = 40


@pytest.fixture(scope="module")
def states(go2):
    random = np.random.default_rng(3)
    x = {name: random.standard_normal((N, go2.nv)) for name in ("v", "a", "tau", "b")}
    x["q"] = np.array([go2.random(k) for k in range(N)])
    x["fext"] = random.standard_normal((N, 6, go2.njoints))
    x["q1"] = np.array([go2.random(k + N) for k in range(N)])
    return x | {"frame": "FL_foot", "joint": 3, "reference": "world", "dt": 1e-3, "integrator": "rk4"}


@pytest.fixture(scope="module")
def batch(go2):
    return go2.batch(threads=2)


def single(model, algorithm, x):
    """What a new data says of one state: as a batch returns it, without the axis N."""
    d, q, v, a = model.data(), x["q"], x["v"], x["a"]
    inputs = [x[name] for name in algorithm.inputs if name not in ("q", "v", "a")
              or not algorithm.name.startswith(("frame", "joint_body", "subtree"))]
    if algorithm.name == "integrate":
        return model.integrate(q, v)
    if algorithm.name == "difference":
        return model.difference(q, x["q1"])
    if algorithm.name == "step":
        d.set_state(q, v, tau=x["tau"])
        d.step(x["dt"], x["integrator"])
        return d.q, d.v
    if algorithm.name == "rnea_second_order_product":
        return d.rnea_second_order_product(x["b"], q, v, a, x["fext"])
    if algorithm.name.startswith(("frame", "joint_body")):
        d.forward_kinematics(q, v if "v" in algorithm.inputs else None, a if "a" in algorithm.inputs else None)
    if algorithm.name.startswith("subtree"):
        d.compute_com(q)
    if algorithm.name == "cholesky_solve":
        d.crba(q), d.cholesky()
        return d.cholesky_solve(x["b"])
    result = getattr(d, f"compute_{algorithm.name}" if algorithm.name in dyn.FIELDS else algorithm.name)(*inputs)
    if algorithm.name == "com":
        return d.com, d.vcom, d.acom
    if algorithm.name == "rnea_derivatives":
        return result[:2]
    if algorithm.name == "centroidal_map":
        return d.Ag, d.Ig, d.hg
    if algorithm.name == "centroidal_map_time_variation":
        return d.dAg
    return result


@pytest.mark.parametrize("name", dyn.ALGORITHMS)
def test_rows_are_those_of_data(go2, batch, states, name):
    algorithm = dyn.ALGORITHMS[name]
    inputs = {i: states[i] for i in algorithm.inputs}
    results, lanes = getattr(batch, name)(**inputs, exact=True), getattr(batch, name)(**inputs)
    results, lanes = (x if isinstance(x, tuple) else (x,) for x in (results, lanes))
    for x, y in zip(results, lanes):
        np.testing.assert_allclose(y, x, rtol=0, atol=1e-9 * abs(np.asarray(x)).max(initial=0))
    for k in (0, 7, N - 1):
        expected = single(go2, algorithm, {i: x[k] if isinstance(x, np.ndarray) else x for i, x in states.items()})
        expected = expected if isinstance(expected, tuple) else (expected,)
        assert 0 < len(results) <= len(expected)  # Data.rnea_derivatives has M, too
        for row, one in zip(results, expected):
            assert len(row) == N
            np.testing.assert_array_equal(row[k], one)


def test_arguments_in_every_form(go2, batch, states):
    q, v, a = states["q"], states["v"], states["a"]
    tau = batch.rnea(q, v, a)
    strided = np.asfortranarray(q)
    read_only = v.copy()
    read_only.flags.writeable = False
    np.testing.assert_array_equal(batch.rnea(strided, read_only, a.tolist()), tau)
    np.testing.assert_array_equal(batch.rnea(q, v=v, a=a, fext=np.zeros((N, 6, go2.njoints))), tau)
    np.testing.assert_array_equal(batch.rnea(q, a=np.zeros_like(a)), batch.gravity_torque(q))
    np.testing.assert_array_equal(batch.rnea(q[::2], v[::2], a[::2]), tau[::2])
    assert batch.rnea(q[:0]).shape == (0, go2.nv) and batch.crba(q[:0]).shape == (0, go2.nv, go2.nv)


def test_only_and_out(batch, states):
    q, v = states["q"], states["v"]
    both = batch.rnea_derivatives(q, v)
    np.testing.assert_array_equal(batch.rnea_derivatives(q, v, only="dtau_dv"), both.dtau_dv)
    M = batch.crba(q)
    again = batch.crba(q[::-1], out=M)
    assert np.shares_memory(M, again)
    np.testing.assert_array_equal(M[::-1], batch.crba(q))
    kept = batch.rnea_derivatives(q, out=both)
    assert np.shares_memory(kept[0], both[0]) and np.shares_memory(kept[1], both[1])
    with pytest.raises(dyn.ArgumentError, match="only is 'tau'.*dtau_dq, dtau_dv"):
        batch.rnea_derivatives(q, only="tau")
    for wrong in (M[:3], M.astype(np.float32), [1], np.zeros_like(M, order="C")[:, :, ::-1], (M, M)):
        with pytest.raises(dyn.SizeError, match="out"):
            batch.crba(q, out=wrong)


def test_placements_fill_those_of_an_earlier_call(batch, states):
    q = states["q"]
    for method in (batch.frame_placements, lambda q, out=None: batch.frame_placement("FR_foot", q, out=out)):
        X = method(q)
        again = method(q[::-1], out=X)
        assert np.shares_memory(again.rotation, X.rotation) and np.shares_memory(again.translation, X.translation)
        other = method(q)
        np.testing.assert_array_equal(X.rotation[::-1], other.rotation)
        np.testing.assert_array_equal(X.translation[::-1], other.translation)
        one = dyn.Placement(np.eye(3), np.zeros(3))
        for wrong in (X[0], method(q[:3]), one, (X.rotation[::-1], X.translation[::-1]), (X.rotation, X.rotation), [1]):
            with pytest.raises(dyn.SizeError, match="out"):
                method(q, out=wrong)


def test_states_that_fail(batch, states):
    q, v, a = (states[name].copy() for name in ("q", "v", "a"))
    good = batch.rnea(q, v, a)
    q[5, 2], q[30, 3:7] = np.nan, 0
    with pytest.raises(dyn.NonFiniteError, match=r"rnea: state 5: q\[2\] is NaN.*2 of 40"):
        batch.rnea(q, v, a)
    status = np.full(N, 77, np.int32)
    tau = batch.rnea(q, v, a, status=status)
    failed = np.isin(np.arange(N), (5, 30))
    assert status[5] == dyn.Status.ERROR_NONFINITE and status[30] == dyn.Status.ERROR_QUATERNION and not status[~failed].any()
    assert np.isnan(tau[failed]).all()
    np.testing.assert_array_equal(tau[~failed], good[~failed])
    for wrong in (np.zeros(N), np.zeros(3, np.int32), True):
        with pytest.raises(dyn.SizeError, match="status"):
            batch.rnea(q, v, a, status=wrong)


def test_refusals(go2, batch, states):
    q, v = states["q"], states["v"]
    with pytest.raises(dyn.SizeError, match=r"q has shape \(19,\), but must have shape \(N, 19\)"):
        batch.rnea(q[0])
    with pytest.raises(dyn.SizeError, match=r"v has shape \(3, 18\), but must have shape \(40, 18\)"):
        batch.rnea(q, v[:3])
    with pytest.raises(dyn.SizeError, match="fext"):
        batch.rnea(q, fext=np.zeros((N, go2.njoints, 6)))
    with pytest.raises(dyn.ArgumentError, match="q is 3"):
        batch.rnea(3)
    with pytest.raises(dyn.ArgumentError, match="real numbers"):
        batch.rnea(q.astype(complex))
    with pytest.raises(dyn.ArgumentError, match="b is None"):
        batch.cholesky_solve(q, None)
    with pytest.raises(TypeError):
        batch.rnea()
    with pytest.raises(TypeError):
        batch.gravity_torque(q, v)
    with pytest.raises(dyn.UnknownNameError):
        batch.frame_velocity("nobody", q, v)
    with pytest.raises(dyn.ArgumentError, match="reference"):
        batch.frame_velocity("FL_foot", q, v, reference="moon")
    for threads in (0, -3, "two", 2.0):
        with pytest.raises(dyn.ArgumentError, match="threads"):
            go2.batch(threads=threads)
    with pytest.raises(dyn.LimitError, match="256"):
        go2.batch(threads=10**6)
    with pytest.raises(dyn.PartError, match="MASS"):
        go2.batch(1, parts="inverse").crba(q)
    assert go2.batch().threads >= 1


def test_one_thread_at_a_time(batch, states):
    q = np.tile(states["q"], (500, 1))
    busy, right = [], []

    def work():
        for _ in range(5):
            try:
                right.append(batch.crba(q)[0].sum())
            except dyn.BusyError:
                busy.append(1)

    threads = [threading.Thread(target=work) for _ in range(3)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert right and len(set(right)) == 1 and len(right) + len(busy) == 15
