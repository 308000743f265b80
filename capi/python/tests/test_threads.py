"""One model, many threads, a data each: results bit-equal to one thread, and the GIL released."""

import threading
import time

import numpy as np
import pytest

import dyn


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
        b.joint(f"j{i}", "revolute", parent, (0.1, 0, 0), axis=(0, i % 2, 1 - i % 2)).body(f"b{i}", f"j{i}", 1, inertia=np.eye(3))
        parent = f"j{i}"
    m = b.finish()
    d, q = m.data(dyn.Part.MINV), np.zeros(m.nq)
    start = time.perf_counter()
    d.minverse(q)
    one_call = time.perf_counter() - start
    stop, worst = [], [0.0]

    def count():
        last = time.perf_counter()
        while not stop:
            now = time.perf_counter()
            worst[0] = max(worst[0], now - last)
            last = now
            time.sleep(0)

    ticker = threading.Thread(target=count)
    ticker.start()
    for _ in range(max(2, int(0.2 / one_call))):
        d.minverse(q)
    stop.append(1)
    ticker.join()
    assert ticker is not None and (one_call < 0.02 or worst[0] < one_call)
