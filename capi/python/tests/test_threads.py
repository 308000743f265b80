"""One model, many threads, a data each: results bit-equal to one thread, and the GIL released."""

import threading
import time

import numpy as np
import pytest

import libdyn as dyn


def work(model, seed, out):
    d, random = model.data(), np.random.default_rng(seed)
    sums = np.zeros(model.nv)
    for i in range(50):
        q, v, a = model.random(100 * seed + i), random.standard_normal(model.nv), random.standard_normal(model.nv)
        sums += d.rnea(q, v, a) + d.crba(q)[0] + model.difference(model.neutral(), model.integrate(q, v))
    out[seed] = sums


def test_bit_equal_to_one_thread(go2):
    alone, together = {}, {}
    for seed in range(4):
        work(go2, seed, alone)
    threads = [threading.Thread(target=work, args=(go2, seed, together)) for seed in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    for seed in range(4):
        np.testing.assert_array_equal(alone[seed], together[seed])


@pytest.mark.parametrize("threads", [2, 4])
def test_two_threads_on_one_data_are_refused(go2, threads):
    """Calls of all kinds on one data: each is right, or a BusyError."""
    d = go2.data()
    random = np.random.default_rng(0)
    states = [(go2.random(k), *random.standard_normal((2, go2.nv))) for k in range(threads)]
    expected = [go2.data().rnea(*s) for s in states]
    of_gravity = [go2.data().gravity_torque(s[0]) for s in states]
    distances = [go2.data().compute_distances(s[0]) for s in states]
    wrong, busy = [0], [0] * threads

    def work(k):
        for i in range(3000):
            try:
                if i % 3 == 0:
                    right = np.array_equal(d.rnea(*states[k]), expected[k])
                elif i % 3 == 1:
                    right = np.array_equal(d.gravity_torque(states[k][0]), of_gravity[k])
                else:
                    right = np.array_equal(d.compute_distances(states[k][0]), distances[k])
                wrong[0] += not right
            except dyn.BusyError as error:
                assert "copy.copy(data)" in str(error)
                busy[k] += 1

    workers = [threading.Thread(target=work, args=(k,)) for k in range(threads)]
    for t in workers:
        t.start()
    for t in workers:
        t.join()
    assert wrong[0] == 0
    assert np.array_equal(d.rnea(*states[0]), expected[0]), "afterwards one thread goes on"


def test_a_data_may_be_handed_on(go2, state):
    """One thread after another is no error; nor are calls within calls, or after a call that failed."""
    d = go2.data()
    with pytest.raises(dyn.SizeError):
        d.rnea([1.0])
    with pytest.raises(dyn.NonFiniteError):
        d.set_state(np.full(go2.nq, np.nan))
    with pytest.raises(dyn.Error):
        d.set_gravity([1.0])
    out = []
    t = threading.Thread(target=lambda: out.append(d.rnea(*state[:3])))
    t.start()
    t.join()
    assert np.array_equal(out[0], d.rnea(*state[:3])) and d.centroidal(*state[:3]).hg.shape == (6,)


def test_a_call_that_waits_holds_the_data():
    """While a long call runs, another thread is refused, whatever it calls."""
    m = dyn.Builder("p").add_joint("j", "revolute").add_body("b", "j", 1, (0, 0, 1), inertia=np.eye(3)).finish()
    d, seen = m.data(), []
    d.set_step_options(dt=1e-5)
    t = threading.Thread(target=d.advance, args=(5.0,))
    t.start()
    while t.is_alive():
        for call in (lambda: d.q, d.rnea, d.step, lambda: d.set_state(v=[0.0]), lambda: d.step_report, d.save_state):
            try:
                call()
            except dyn.BusyError:
                seen.append(call)
        if len(seen) > 50:
            break
    t.join()
    assert len(seen) > 5


def test_errors_belong_to_their_thread(go2):
    seen = []

    def fail(name):
        for _ in range(50):
            with pytest.raises(dyn.UnknownNameError) as caught:
                go2.joint_id(name)
            seen.append(name in str(caught.value))

    threads = [threading.Thread(target=fail, args=(f"joint_{i}_of_nobody",)) for i in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert len(seen) == 200 and all(seen)


def test_calls_release_the_gil():
    b = dyn.Builder("chain")
    parent = None
    for i in range(400):
        b.add_joint(f"j{i}", "revolute", parent, (0.1, 0, 0),
                    axis=(0, i % 2, 1 - i % 2)).add_body(f"b{i}", f"j{i}", 1, inertia=np.eye(3))
        parent = f"j{i}"
    m = b.finish()
    d = m.data(dyn.Part.CHOLESKY)
    d.crba(np.zeros(m.nq))
    d.cholesky()
    ticks, stop = [0], threading.Event()

    def tick():
        while not stop.is_set():
            ticks[0] += 1
            time.sleep(1e-3)

    ticker = threading.Thread(target=tick)
    ticker.start()
    try:
        columns, seconds, during = 500, 0.0, 0
        while seconds < 0.1:
            columns *= 2
            b = np.ones((m.nv, columns), order="F")
            start, before = time.perf_counter(), ticks[0]
            d.cholesky_solve(b)
            seconds, during = time.perf_counter() - start, ticks[0] - before
    finally:
        stop.set()
        ticker.join()
    assert during >= 5
