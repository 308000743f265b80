"""What a robot is: Model."""

from __future__ import annotations

import weakref
from collections.abc import Mapping, Sequence
from ctypes import c_char_p
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from .actuator import ModelActuators
from .arrays import Owner, address, numbers, view
from .choices import mask, member, size, string, text
from .configuration import Configurations, Scratch
from .constraint import ModelConstraints
from .describe import ModelParts
from .enums import Direction, ModelArray, Part
from .errors import ArgumentError, SizeError
from .library import check, fail, last_error, lib
from .saving import Saving

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .batch import Batch
    from .convert import State, StateLayout
    from .data import Data


class Model(ModelParts, Configurations, ModelConstraints, ModelActuators, Saving):
    """What the robot is: immutable, and safe to share between threads. From dyn.load, dyn.load_string or dyn.Builder.

    q has nq numbers, v, a and tau have nv; they differ on manifolds: use integrate and difference, never q + v.
    Wherever q, v, a or tau is expected, a dict {joint name: numbers} is accepted, too: joints that it does not name
    are neutral or zero.
    """

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
        self.npairs: int = size(lib.dyn_model_npairs(handle))
        self.name: str = string(lib.dyn_model_name(handle))
        self._frame_ids: dict[str, int] = {}
        self._scratch = Scratch(weakref.ref(self), self.nq, self.nv)

    def __repr__(self) -> str:
        return f"<dyn.Model {self.name!r}: nq {self.nq}, nv {self.nv}, {self.njoints} joints, {self.nframes} frames>"

    def _repr_html_(self) -> str:
        from .html import model

        return model(self)

    def __reduce__(self):
        from .loading import from_image

        return from_image, (self.image(),)

    @property
    def size(self) -> int:
        """Bytes of the compiled model."""
        return lib.dyn_model_size(self._m)

    @property
    def total_mass(self) -> float:
        """kg."""
        return lib.dyn_model_total_mass(self._m)

    # ------------------------------------------------------------------------------------------- numbers of the model

    def array(self, which: str | ModelArray) -> np.ndarray:
        """Read-only view of the model's numbers: limits, armature, damping, friction, springs, gravity."""
        which = member(ModelArray, which, "which")
        start = lib.dyn_model_array(self._m, which)
        of_q = (ModelArray.LOWER_LIMIT, ModelArray.UPPER_LIMIT, ModelArray.SPRING_REFERENCE)
        n = 3 if which == ModelArray.GRAVITY else self.nq if which in of_q else self.nv
        if start is None and n:
            fail(2)
        return view(start, n, None, (1, 0), self._owner)

    @cached_property
    def lower_limit(self) -> np.ndarray:
        """(nq,), rad or m; -inf where there is none."""
        return self.array(ModelArray.LOWER_LIMIT)

    @cached_property
    def upper_limit(self) -> np.ndarray:
        """(nq,), rad or m; inf where there is none."""
        return self.array(ModelArray.UPPER_LIMIT)

    @cached_property
    def velocity_limit(self) -> np.ndarray:
        """(nv,), rad/s or m/s; inf where there is none."""
        return self.array(ModelArray.VELOCITY_LIMIT)

    @cached_property
    def effort_limit(self) -> np.ndarray:
        """(nv,), N m or N; inf where there is none."""
        return self.array(ModelArray.EFFORT_LIMIT)

    @cached_property
    def armature(self) -> np.ndarray:
        """(nv,), kg m^2 or kg: added to the diagonal of M."""
        return self.array(ModelArray.ARMATURE)

    @cached_property
    def damping(self) -> np.ndarray:
        """(nv,), N m s/rad or N s/m."""
        return self.array(ModelArray.DAMPING)

    @cached_property
    def friction(self) -> np.ndarray:
        """(nv,), N m or N: dry friction."""
        return self.array(ModelArray.FRICTION)

    @cached_property
    def stiffness(self) -> np.ndarray:
        """(nv,), N m/rad or N/m: springs."""
        return self.array(ModelArray.STIFFNESS)

    @cached_property
    def spring_reference(self) -> np.ndarray:
        """(nq,), rad or m: the configuration where springs are at rest."""
        return self.array(ModelArray.SPRING_REFERENCE)

    @cached_property
    def gravity(self) -> np.ndarray:
        """(3,), m/s^2, world axes."""
        return self.array(ModelArray.GRAVITY)

    @property
    def configuration_names(self) -> tuple[str, ...]:
        """Names of the stored configurations; the first is "neutral"."""
        count = size(lib.dyn_model_nconfigurations(self._m))
        return tuple(string(lib.dyn_model_configuration_name(self._m, i)) for i in range(count))

    def configuration(self, name: str) -> np.ndarray:
        """A named configuration: q, (nq,)."""
        q = np.empty(self.nq)
        check(lib.dyn_model_configuration(self._m, text(name, "name"), address(q)))
        return q

    @property
    def configurations(self) -> dict[str, np.ndarray]:
        """Every named configuration: {name: q}."""
        return {name: self.configuration(name) for name in self.configuration_names}

    def q_permutation(self, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
        """(idx_q, idx_v): the first index in q and in v of each named joint, in the order of names."""
        if isinstance(names, str):
            raise ArgumentError("names is a string, but must be a sequence of joint names.")
        encoded = [text(n, "name") for n in names]
        idx_q, idx_v = np.empty(len(encoded), np.int32), np.empty(len(encoded), np.int32)
        pointers = (c_char_p * len(encoded))(*encoded)
        check(lib.dyn_model_q_permutation(self._m, pointers, len(encoded), address(idx_q), address(idx_v)))
        return idx_q, idx_v

    # ------------------------------------------------------------------------------------------- states

    def _named(self, values: Mapping[str, Any], what: str) -> np.ndarray:
        """A vector from {joint name: numbers}; what is not named is neutral or zero."""
        position = what not in ("v", "a", "tau")
        out = self.neutral() if position else np.zeros(self.nv)
        for name, value in values.items():
            info = self.joint(name)
            first, n = (info.idx_q, info.nq) if position else (info.idx_v, info.nv)
            if info.mimic_leader >= 0:
                leader = self.joint_name(info.mimic_leader)
                raise ArgumentError(f"{what}: joint {name!r} follows {leader!r} and has no numbers of its own: set {leader!r}.")
            given = np.atleast_1d(numbers(value, f"{what}[{name!r}]"))
            if given.shape != (n,):
                raise SizeError(f"{what}[{name!r}] has shape {given.shape}, but must have shape ({n},).")
            out[first : first + n] = given
        return out

    def to_peer(
        self, layout: StateLayout | str, q: ArrayLike, v: ArrayLike | None = None, a: ArrayLike | None = None, tau: ArrayLike | None = None
    ) -> State:
        """A state as another library stores it: (q, v, a, tau) of the layout's sizes; a needs v.

        layout  a dyn.StateLayout, or "pinocchio", "mujoco", "drake" or "ros" for all joints in the model's order
        """
        from .convert import convert_state

        return convert_state(self, layout, Direction.TO_PEER, q, v, a, tau)

    def from_peer(
        self, layout: StateLayout | str, q: ArrayLike, v: ArrayLike | None = None, a: ArrayLike | None = None, tau: ArrayLike | None = None
    ) -> State:
        """The inverse of to_peer. A follower's force is added to its leader's; its own q, v, a are not read."""
        from .convert import convert_state

        return convert_state(self, layout, Direction.FROM_PEER, q, v, a, tau)

    def data_size(self, parts: Any = Part.ALL) -> int:
        """Bytes that a data of these parts needs."""
        size = lib.dyn_data_size(self._m, mask(Part, parts, "parts"))
        if size == 0:
            raise ArgumentError(last_error())
        return size

    def data(self, parts: Any = Part.ALL, memory: Any = None) -> Data:
        """New data at the neutral configuration and rest: one for each thread.

        parts   a dyn.Part, or several, or their names: groups of buffers; a call that needs an absent one says so
        memory  a writable buffer of at least data_size(parts) bytes to place the data in, instead of the heap
        """
        from .data import Data

        return Data(self, parts, memory)

    def batch(self, threads: int | None = None, parts: Any = Part.ALL) -> Batch:
        """Every algorithm over arrays of states, with several threads (None: as many as this process has processors)."""
        from .batch import Batch

        return Batch(self, threads, parts)

    def inertial_parameters(self) -> np.ndarray:
        """pi of all joints' bodies, (10 (njoints - 1),): ten a body, [m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz] in the joint's frame."""
        pi = np.empty(10 * (self.njoints - 1))
        check(lib.dyn_model_inertial_parameters(self._m, address(pi)))
        return pi
