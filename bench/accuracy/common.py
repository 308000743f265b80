"""What the engines share: a run that is timed, and repeated where it is short."""

import os
import pickle
import select
import signal
import statistics
import time
from dataclasses import dataclass

import numpy as np

LIMIT = 1.0  # s of one run, beyond which no finer setting is tried
RUNS, ENOUGH = 5, 0.3  # runs of a setting, fewer where they have taken that many seconds


@dataclass
class Point:
    method: str
    value: float  # step, s, or accuracy
    error: float | None  # m; None: it failed
    seconds: float  # of stepping, median
    evaluations: int | None = None
    failure: str = ""


class Failed(Exception):
    pass


def within(seconds, work):
    """work() in a process of its own, which is ended after so many seconds; None then, or where it dies."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        with os.fdopen(writing, "wb") as out:
            pickle.dump(work(), out)
        os._exit(0)
    os.close(writing)
    data, end = b"", time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0 and select.select([reading], [], [], left)[0]:
        part = os.read(reading, 1 << 16)
        if not part:
            break
        data += part
    else:
        os.kill(child, signal.SIGKILL)
    os.close(reading)
    os.waitpid(child, 0)
    try:
        return pickle.loads(data)
    except (EOFError, pickle.UnpicklingError):
        return None


def measured(method, value, *rest):
    point = within(4 * LIMIT + 2, lambda: measured_here(method, value, *rest))
    return point or Point(method, value, None, 4 * LIMIT + 2, None, "it took too long, or ended its process")


def measured_here(method, value, begin, move, look, reference, problem, evaluations=None):
    """begin(): the state at the start; move(k): steps to moment k + 1; look(): places of the markers, (markers, 3)."""
    seconds, error, count = [], None, None
    axes = list(problem.axes)
    try:
        while True:
            begin()
            spent, far = 0.0, 0.0
            for k, place in enumerate(reference):
                start = time.thread_time()
                move(k)
                spent += time.thread_time() - start
                if error is None:
                    far = max(far, float(np.max(np.linalg.norm((look() - place)[:, axes], axis=1))))
                if not np.isfinite(far):
                    raise Failed("not a number")
            seconds.append(spent)
            if error is None and evaluations:
                count = evaluations()
            error = far if error is None else error
            if len(seconds) >= RUNS or sum(seconds) > ENOUGH:
                return Point(method, value, error, statistics.median(seconds), count)
    except (Failed, RuntimeError, ValueError, ArithmeticError) as e:
        return Point(method, value, None, sum(seconds), None, str(e).splitlines()[0][:200] if str(e) else type(e).__name__)


def ladder(method, values, measure):
    """Points from the coarsest value on, until one takes too long."""
    out, last = [], None
    for value in values:
        growth = last and max(1.5, min(10.0, last.value / value))
        if last and last.error is not None and last.seconds * growth > LIMIT and last.seconds > 0.2:
            break
        point = measure(method, value)
        out.append(point)
        last = point
        if point.seconds > LIMIT:
            break
    return out


def steps_of(problem):
    """Steps that make up a tenth of the duration."""
    part = problem.duration / 10
    return [part / n for n in (5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000)]
