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
