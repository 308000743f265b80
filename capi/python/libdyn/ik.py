"""Inverse kinematics: what q shall do (tasks), and what came out.

    from libdyn import ik
    result = data.ik([ik.pose("hand", X), ik.posture(q0, priority=1)], q=q0)
    result.q, result.converged, result.reason

Weights multiply the error: the cost is the sum of (weight * weights[k] * error[k])^2 / 2. Tasks of priority 0 are to be met;
those of priority 1 as far as they leave room.
"""

from __future__ import annotations

from ctypes import addressof, byref
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import abi
from .arrays import Placement, address, checked, numbers
from .enums import IkReason, IkTaskType
from .errors import ArgumentError, SizeError
from .handles import DataHandle
from .library import fail, lib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Numbers


class Task(NamedTuple):
    """One of the things that q shall do: made by pose, position, orientation, com and posture."""

    type: IkTaskType
    frame: int | str
    target: Numbers | None
    """12 numbers: rotation by columns, then translation."""
    posture: Any
    weight: float
    weights: Any
    priority: int


class Result(NamedTuple):
    """Result of Data.ik."""

    q: Numbers
    """The solution, or the best configuration that was found."""
    reason: IkReason
    residuals: Numbers
    """(tasks, 2): the error of each task, m and rad."""
    iterations: int
    restarts: int
    joint: str | None
    """The joint whose limit holds the tasks back (reason LIMITS)."""
    cost: float
    optimality: float
    """Largest |gradient| of the cost over coordinates that are not pressed against a limit."""

    @property
    def converged(self) -> bool:
        return self.reason == IkReason.CONVERGED


def _rotation(x: Any, name: str) -> Numbers:
    """(3, 3) from itself or from a quaternion (x, y, z, w)."""
    a = numbers(x, name)
    if a.shape == (3, 3):
        return a
    if a.shape != (4,):
        raise SizeError(f"{name} has shape {a.shape}, but must be a rotation matrix (3, 3) or a quaternion (x, y, z, w).")
    n = np.linalg.norm(a)
    if not n > 0:
        raise ArgumentError(f"{name} is a zero quaternion.")
    x, y, z, w = a / n
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _target(rotation: Any = None, translation: Any = None) -> Numbers:
    out = np.array([1.0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0])
    if rotation is not None:
        out[:9] = _rotation(rotation, "rotation").T.ravel()
    if translation is not None:
        out[9:] = checked(translation, (3,), "translation")
    return out


def pose(frame: int | str, placement: Any, *, weight: float = 1.0, weights: ArrayLike | None = None, priority: int = 0) -> Task:
    """A frame at a placement: dyn.Placement, (rotation, translation), or a homogeneous matrix (4, 4). The rotation may be a
    quaternion (x, y, z, w). weights: 6, [linear; angular] in the frame's axes."""
    if isinstance(placement, (tuple, list)) and len(placement) == 2:  # a Placement, too
        rotation, translation = placement
    else:
        X = checked(placement, (4, 4), "placement")
        rotation, translation = X[:3, :3], X[:3, 3]
    return Task(IkTaskType.POSE, frame, _target(rotation, translation), None, weight, weights, priority)


def position(frame: int | str, point: ArrayLike, *, weight: float = 1.0, weights: ArrayLike | None = None,
             priority: int = 0) -> Task:
    """A frame's origin at a point of the world, m. weights: 3, axes of the world."""
    return Task(IkTaskType.POSITION, frame, _target(translation=point), None, weight, weights, priority)


def orientation(frame: int | str, rotation: ArrayLike, *, weight: float = 1.0, weights: ArrayLike | None = None,
                priority: int = 0) -> Task:
    """A frame's axes along a rotation matrix (3, 3) or quaternion (x, y, z, w). weights: 3, the frame's axes."""
    return Task(IkTaskType.ORIENTATION, frame, _target(rotation), None, weight, weights, priority)


def com(point: ArrayLike, *, weight: float = 1.0, weights: ArrayLike | None = None, priority: int = 0) -> Task:
    """The centre of mass at a point of the world, m. weights: 3, axes of the world."""
    return Task(IkTaskType.COM, 0, _target(translation=point), None, weight, weights, priority)


def posture(q: Any, *, weight: float = 1.0, weights: ArrayLike | None = None, priority: int = 1) -> Task:
    """q near a reference configuration, (nq,) or {joint: numbers}. weights: nv."""
    return Task(IkTaskType.POSTURE, 0, None, q, weight, weights, priority)


_ik = lib.dyn_ik  # bound once: an attribute of the CDLL costs a look-up in every call
_outputs = abi.outputs_of(abi.IkOutput)
_SIZES = {IkTaskType.POSE: 6, IkTaskType.POSITION: 3, IkTaskType.ORIENTATION: 3, IkTaskType.COM: 3}


def structures(model: Any, tasks: Any) -> tuple[Any, list[Any]]:
    """The tasks as dyn.h takes them, and what must be kept alive meanwhile."""
    tasks = [tasks] if isinstance(tasks, Task) else list(tasks)
    out, keep = (abi.IkTask * len(tasks))(), []
    for k, t in enumerate(tasks):
        if not isinstance(t, Task):
            raise ArgumentError(f"tasks[{k}] is {t!r}, but must be a task of dyn.ik: pose, position, orientation, com, posture.")
        out[k] = abi.initialized(abi.IkTask)
        s = out[k]
        s.type, s.priority, s.weight = t.type, t.priority, t.weight
        if t.type in (IkTaskType.POSE, IkTaskType.POSITION, IkTaskType.ORIENTATION):
            s.frame = model._frame(t.frame)
        if t.target is not None:
            s.target[:] = t.target.tolist()
        for name, n in (("posture", model.nq), ("weights", _SIZES.get(t.type, model.nv))):
            x = getattr(t, name)
            if x is None:
                continue
            if name == "posture" and hasattr(x, "keys"):
                x = model._named(x, name)
            x = checked(x, (n,), f"{name} of tasks[{k}]")
            keep.append(x)
            setattr(s, name, address(x))
    return out, keep



class InverseKinematics(DataHandle):
    """The part of Data that finds configurations."""

    def ik(
        self,
        tasks: Any,
        q: Any = None,
        *,
        max_iterations: int | None = None,
        restarts: int | None = None,
        seed: int | None = None,
        tolerance_linear: float | None = None,
        tolerance_angular: float | None = None,
        limits: bool | None = None,
        lower: Any = None,
        upper: Any = None,
    ) -> Result:
        """q that does the tasks (of dyn.ik) within the joint limits, starting at q (None: the held one); data is there
        afterwards. Not to converge is no error: see the result's reason. restarts = 0 to follow a moving target.
        Defaults: 500 iterations a start, 20 restarts, seed 0, 1e-6 m and rad, the model's limits."""
        m = self.model
        given, keep = structures(m, tasks)
        options = abi.initialized(abi.IkOptions)
        for name, x in (
            ("max_iterations", max_iterations), ("restarts", restarts), ("seed", seed), ("tolerance_linear", tolerance_linear),
            ("tolerance_angular", tolerance_angular), ("limits", limits),
        ):  # fmt: skip
            if x is not None:
                try:
                    setattr(options, name, x)
                except TypeError:
                    raise ArgumentError(f"{name} is {x!r}, but must be a number.") from None
        for name, x in (("lower", lower), ("upper", upper)):
            if x is not None:
                keep.append(checked(x, (m.nq,), name))
                setattr(options, name, address(keep[-1]))
        solution, residuals, r = np.empty(m.nq), np.empty((len(given), 2)), abi.IkResult()
        status = _ik(self._m, self._d, self._q(q), given, len(given), byref(options),
                     _outputs(address(solution), address(residuals), addressof(r)))
        if status:
            fail(status)
        joint = m.joint_name(r.joint) if r.joint >= 0 else None
        return Result(solution, IkReason(r.reason), residuals, r.iterations, r.restarts, joint, r.cost, r.optimality)


__all__ = ["IkReason", "Placement", "Result", "Task", "com", "orientation", "pose", "position", "posture"]
