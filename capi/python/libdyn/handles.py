"""Base of the parts of Model and Data: the library's handle, sizes, and addresses of arguments."""

from __future__ import annotations

import operator
import weakref
from typing import TYPE_CHECKING, Any, Callable

import numpy as np

from .arrays import Owner, slot
from .choices import member, size, string, text
from .enums import FrameType
from .errors import ArgumentError, UnknownNameError
from .library import last_error, lib

if TYPE_CHECKING:
    from .enums import FrameTypeLike


class ModelHandle:
    """A model's handle, sizes, and ids."""

    def __init__(self, handle: int, buffer: Any = None):
        self._owner = Owner(handle, lib.dyn_model_free, buffer)
        self._m = handle
        self.nq: int = size(lib.dyn_model_nq(handle))
        """Size of q."""
        self.nv: int = size(lib.dyn_model_nv(handle))
        """Size of v, a and tau."""
        self.njoints: int = size(lib.dyn_model_njoints(handle))
        """Joints that move, and the universe (joint 0)."""
        self.nframes: int = size(lib.dyn_model_nframes(handle))
        """Frames; frame 0 is the universe."""
        self.nbodies: int = size(lib.dyn_model_nbodies(handle))
        """Links, the universe not counted."""
        self.nshapes: int = size(lib.dyn_model_nshapes(handle))
        """Shapes, collision and visual ones."""
        self.npairs: int = size(lib.dyn_model_npairs(handle))
        """Pairs of collision shapes."""
        self.name: str = string(lib.dyn_model_name(handle))
        """The robot's name."""
        self._frame_ids: dict[str, int] = {}

    def joint_id(self, name: str) -> int:
        """Id of a joint; a name that does not exist is an error that lists near misses."""
        return self._id(lib.dyn_model_joint_id(self._m, text(name, "joint")))

    def frame_id(self, name: str, type: FrameTypeLike | None = None) -> int:
        """Id of a frame. A link and a joint may share a name: joints and user frames come first, or give the dyn.FrameType."""
        if type is None:
            return self._id(lib.dyn_model_frame_id(self._m, text(name, "frame")))
        return self._id(lib.dyn_model_frame_id_of_type(self._m, text(name, "frame"), member(FrameType, type, "type")))

    def _id(self, found: int) -> int:
        if found < 0:
            raise UnknownNameError(last_error())
        return found

    def _index(self, value: Any, count: int, what: str) -> int:
        try:
            index = operator.index(value)
        except TypeError:
            raise ArgumentError(f"{what} is {value!r}, but must be an id (0 to {count - 1}).") from None
        if not 0 <= index < count:
            raise ArgumentError(f"{what} is {index}, but ids go from 0 to {count - 1}.")
        return index

    def _joint(self, joint: int | str) -> int:
        return self.joint_id(joint) if isinstance(joint, str) else self._index(joint, self.njoints, "joint")

    def _frame(self, frame: int | str) -> int:
        if isinstance(frame, str):
            id = self._frame_ids.get(frame)
            if id is None:
                id = self._frame_ids[frame] = self.frame_id(frame)
            return id
        return self._index(frame, self.nframes, "frame")


class DataHandle:
    """A data's handle, and the addresses of what its calls are given: (q) is an address, or None where q is None."""

    def __init__(self, model: Any, handle: int, keep: Any):
        self.model = model
        """The robot."""
        self._m: int = model._m
        self._d = handle
        self._owner = Owner(handle, lib.dyn_data_free, (model._owner, keep))
        robot = weakref.ref(model)
        self._q = slot((model.nq,), "q", robot)
        self._v = slot((model.nv,), "v", robot)
        self._a = slot((model.nv,), "a", robot)
        self._tau = slot((model.nv,), "tau", robot)
        self._fext_slot: Callable[[Any], int | None] | None = None
        self._outputs: dict[str, list[tuple[Callable[..., Any], int | None]]] = {}  # of each algorithm: see data_methods
        self._kept: Any = None
        self._free = [0]  # see guard
        self._holder = 0
        self._settings: dict[tuple[str, Any], tuple[Any, ...]] = {}
        self._wrenches: dict[tuple[int, bytes | None, int], np.ndarray] = {}

    def _fext(self, fext: Any) -> int | None:
        if fext is None:
            return None
        if self._fext_slot is None:
            self._fext_slot = slot((6, self.model.njoints), "fext", weakref.ref(self.model))
        return self._fext_slot(fext)
