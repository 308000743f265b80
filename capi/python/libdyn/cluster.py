"""Rollouts on Ray (package ray): the same simulations by the workers of a cluster.

A simulation's bits depend neither on its neighbours nor on who computes it, so the results are those of engine="threads", on
processors for which the library has the same level. Ray runs the tasks of a lost worker or node again.
"""

from __future__ import annotations

import os
import re
import socket
from typing import TYPE_CHECKING, Any, Callable

import numpy as np

from . import errors
from .library import last_error
from .rollout import DIMENSIONS, Plan, Rollout, given_arrays

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .batch import Batch
    from .enums import EffectLike
    from .model import Model

STEPS_OF_A_TASK = 20_000  # a task costs a worker about 5 ms beside its steps: see capi/pages/measured_cluster.md

_made: tuple[Any, Any, Batch] | None = None  # in a worker: the last model's bytes, effects and batch


def _batch(kind: type[Model], image: np.ndarray, effects: EffectLike | None) -> Batch:
    """The image lies in the node's object store: tasks of one rollout get the same memory, and the model is used where it
    lies."""
    global _made
    key = image.ctypes.data, image.size, bytes(image[:256])
    if _made is None or _made[:2] != (key, effects):
        model = kind.from_buffer(image) if image.ctypes.data % 64 == 0 else kind.from_image(image.tobytes())
        batch = model.batch(threads=1)
        if effects is not None:
            batch.set_effects(effects)
        _made = key, effects, batch
    return _made[2]


def simulate(kind: type[Model], image: np.ndarray, effects: EffectLike | None, n: int, shared: dict[str, Any],
             own: dict[str, Any]) -> tuple[Rollout, str]:
    """A task: n simulations, and the sentence of the first that failed."""
    result = _batch(kind, image, effects).rollout(n=n, strict=False, **shared, **own)
    return result, last_error() if result.status.any() else ""


def _answers(address: str) -> None:
    """Refuses an address where nobody listens, for which Ray itself would wait some minutes."""
    host, _, port = address.rpartition(":")
    if not host or "/" in host or not port.isdigit():
        return
    try:
        socket.create_connection((host, int(port)), 10).close()
    except (OSError, OverflowError) as error:
        raise errors.ArgumentError(f"RAY_ADDRESS is {address!r}, where no cluster answers: {error}.") from None


def _joined(parts: list[Rollout]) -> Rollout:
    def join(field: str) -> Any:
        arrays = [getattr(p, field) for p in parts]
        return None if arrays[0] is None else np.concatenate(arrays)

    sensors = {name: np.concatenate([p.sensors[name] for p in parts]) for name in parts[0].sensors}
    return Rollout(**{f: join(f) for f in Rollout._fields if f != "sensors"}, sensors=sensors)


def rollout(
    model: Model,
    q0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    *,
    control: ArrayLike | None = None,
    tau: ArrayLike | None = None,
    mocap: ArrayLike | None = None,
    steps: int | None = None,
    every: int = 1,
    n: int | None = None,
    effects: EffectLike | None = None,
    strict: bool = True,
    progress: Callable[[int, int], Any] | None = None,
    chunk: int | None = None,
    retries: int = 3,
    **options: Any,
) -> Rollout:
    """Rollouts by Ray's workers: what dyn.batch.rollout(..., engine="ray") calls.

    chunk    simulations of a task; None: enough for 20,000 steps, but four tasks for each processor where there are as many
    retries  how often a task is run again whose worker or node was lost
    options  more of Batch.rollout: dt, integrator, solver, tolerance, max_iterations, sensors, contacts

    The model travels once to each node, as its image. Connects to the cluster that RAY_ADDRESS names, or starts a local one,
    unless ray.init was called.
    """
    try:
        import ray
    except ImportError:
        raise errors.ArgumentError("engine='ray' needs the package ray: pip install ray.") from None
    for name in ("states", "keep_states"):
        if options.pop(name, None) not in (None, False):
            raise errors.ArgumentError(f"{name} is not for engine='ray': a saved state belongs to the process that made it.")
    if options.pop("models", None) is not None:
        raise errors.ArgumentError("models is not for engine='ray': its workers have one model.")
    given = given_arrays(model, q0=q0, v0=v0, control=control, tau=tau, mocap=mocap)
    plan = Plan(model, given, None, n, steps, every)
    for name, x in given.items():
        plan.shaped(name, x)
    if not ray.is_initialized():
        _answers(os.environ.get("RAY_ADDRESS", ""))
        ray.init(log_to_driver=False)
    if chunk is None:
        processors = int(ray.cluster_resources().get("CPU", 1))
        chunk = max(1, min(-(-STEPS_OF_A_TASK // plan.steps), -(-plan.n // (4 * processors))))
    if chunk < 1:
        raise errors.ArgumentError(f"chunk is {chunk}, but must be a number of simulations, at least 1.")
    apart = [name for name, x in given.items() if x.ndim == DIMENSIONS[name]]
    if "mocap" in given:
        given["mocap"] = given["mocap"].reshape(*given["mocap"].shape[:-1], model.nmocaps, 12)
    own = {name: given[name] for name in apart}
    shared = {name: x for name, x in given.items() if name not in own} | options | {"steps": plan.steps, "every": every}
    image, common = ray.put(np.frombuffer(model.image(), np.uint8)), ray.put(shared)
    task = ray.remote(num_cpus=1, max_retries=retries)(simulate)
    begins = range(0, plan.n, chunk)
    pending = {
        task.remote(type(model), image, effects, min(chunk, plan.n - a), common,
                    {name: x[a : a + chunk] for name, x in own.items()}): a for a in begins
    }
    parts: dict[int, tuple[Rollout, str]] = {}
    try:
        while pending:
            done, _ = ray.wait(list(pending), num_returns=1)
            for ref in done:
                parts[pending.pop(ref)] = ray.get(ref)
            made = sum(len(p.status) for p, _ in parts.values())
            if progress is not None and progress(made * plan.steps, plan.n * plan.steps) is False:
                raise errors.CancelledError(f"rollout: cancelled after {made} of {plan.n} simulations")
    except BaseException:
        for ref in pending:
            ray.cancel(ref)
        raise
    result = _joined([parts[a][0] for a in begins])
    if strict and result.status.any():
        begin = next(a for a in begins if parts[a][1])
        sentence = re.sub(r"simulation (\d+)", lambda found: f"simulation {int(found[1]) + begin}", parts[begin][1])
        raise errors.BY_STATUS.get(int(result.status[result.status != 0][0]), errors.Error)(sentence)
    return result
