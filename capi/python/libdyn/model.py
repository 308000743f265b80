"""What a robot is: Model."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import byref, c_char_p, c_void_p
from typing import TYPE_CHECKING, Any

import numpy as np

from . import abi, html
from .actuator import ModelActuators
from .arrays import address
from .batch import Batch
from .choices import mask, size, string, text
from .constraint import ModelConstraints
from .convert import States
from .data import Data
from .enums import Part
from .errors import ArgumentError
from .library import check, last_error, lib
from .mocap import ModelMocaps
from .model_arrays import ModelArrays
from .planner import Planner
from .saving import Saving
from .sensor import ModelSensors
from .tendon import ModelTendons

if TYPE_CHECKING:
    from .arrays import Integers, Numbers
    from .enums import PartLike, PlanInputLike


class Model(
    States, ModelArrays, ModelConstraints, ModelActuators, ModelTendons, ModelMocaps, ModelSensors, Saving
):
    """What the robot is: immutable, and safe to share between threads. From dyn.load, dyn.load_string or dyn.Builder.

    q has nq numbers, v, a and tau have nv; they differ on manifolds: use integrate and difference, never q + v.
    Wherever q, v, a or tau is expected, a dict {joint name: numbers} is accepted, too: joints that it does not name
    are neutral or zero.
    """

    def __repr__(self) -> str:
        return f"<dyn.Model {self.name!r}: nq {self.nq}, nv {self.nv}, {self.njoints} joints, {self.nframes} frames>"

    def _repr_html_(self) -> str:
        return html.model(self)

    def __reduce__(self) -> tuple[Any, tuple[bytes]]:
        return Model.from_image, (self.image(),)

    def __copy__(self) -> Model:
        return self  # it never changes

    def __deepcopy__(self, memo: Any) -> Model:
        return self

    @classmethod
    def from_buffer(cls, buffer: Any) -> Model:
        """The model that lies in a buffer (numpy.memmap of a .dynb, shared memory), used where it is: nothing is copied.

        The buffer lies on a boundary of 64 bytes and must not change. The model keeps it alive.
        """
        memory, out = np.frombuffer(buffer, np.uint8), c_void_p()
        check(lib.dyn_model_from_buffer(memory.ctypes.data, memory.size, byref(out)))
        return cls(out.value or 0, memory)

    @classmethod
    def from_image(cls, image: bytes) -> Model:
        """The model of Model.image(), from bytes that lie anywhere: what unpickles a model."""
        memory = np.empty(len(image) + 64, np.uint8)
        memory = memory[-memory.ctypes.data % 64 :][: len(image)]
        memory[:] = np.frombuffer(image, np.uint8)
        return cls.from_buffer(memory)

    @property
    def size(self) -> int:
        """Bytes of the compiled model."""
        return lib.dyn_model_size(self._m)

    @property
    def total_mass(self) -> float:
        """kg."""
        return lib.dyn_model_total_mass(self._m)

    @property
    def configuration_names(self) -> tuple[str, ...]:
        """Names of the stored configurations; the first is "neutral"."""
        count = size(lib.dyn_model_nconfigurations(self._m))
        return tuple(string(lib.dyn_model_configuration_name(self._m, i)) for i in range(count))

    def configuration(self, name: str) -> Numbers:
        """A named configuration: q, (nq,)."""
        q = np.empty(self.nq)
        check(lib.dyn_model_configuration(self._m, text(name, "name"), address(q)))
        return q

    @property
    def step_options(self) -> abi.StepOptions:
        """The options of steps of new data: the defaults, with dt and integrator of the model's file if it states them."""
        options = abi.StepOptions()
        check(lib.dyn_model_step_options(self._m, byref(options)))
        return options

    @property
    def initial_configuration(self) -> str:
        """Name of the configuration where new data begins: "qpos0" of an MJCF file that draws another one than "neutral"."""
        return self.configuration_names[size(lib.dyn_model_initial_configuration(self._m))]

    @property
    def configurations(self) -> dict[str, Numbers]:
        """Every named configuration: {name: q}."""
        return {name: self.configuration(name) for name in self.configuration_names}

    def q_permutation(self, names: Sequence[str]) -> tuple[Integers, Integers]:
        """(idx_q, idx_v): the first index in q and in v of each named joint, in the order of names."""
        if isinstance(names, str):
            raise ArgumentError("names is a string, but must be a sequence of joint names.")
        encoded = [text(n, "name") for n in names]
        idx_q, idx_v = np.empty(len(encoded), np.int32), np.empty(len(encoded), np.int32)
        pointers = (c_char_p * len(encoded))(*encoded)
        check(lib.dyn_model_q_permutation(self._m, pointers, len(encoded), address(idx_q), address(idx_v)))
        return idx_q, idx_v

    def data_size(self, parts: PartLike = Part.ALL) -> int:
        """Bytes that a data of these parts needs."""
        size = lib.dyn_data_size(self._m, mask(Part, parts, "parts"))
        if size == 0:
            raise ArgumentError(last_error())
        return size

    def data(self, parts: PartLike = Part.ALL, memory: Any = None) -> Data:
        """New data at the initial configuration and rest: one for each thread. Its steps go as the file states.

        parts   a dyn.Part, or several, or their names: groups of buffers; a call that needs an absent one says so
        memory  a writable buffer of at least data_size(parts) bytes to place the data in, instead of the heap
        """
        return Data(self, parts, memory)

    def batch(self, threads: int | None = None, parts: PartLike = Part.ALL) -> Batch:
        """Every algorithm over arrays of states, with several threads (None: as many as this process has processors)."""
        return Batch(self, threads, parts)

    def planner(self, knots: int, input: PlanInputLike = "control") -> Planner:
        """A planner of inputs over `knots` steps: "control", those of actuators, or "tau"."""
        return Planner(self, knots, input)

    def inertial_parameters(self) -> Numbers:
        """pi of all joints' bodies, (10 (njoints - 1),): ten a body, [m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz] in the joint's
        frame."""
        pi = np.empty(10 * (self.njoints - 1))
        check(lib.dyn_model_inertial_parameters(self._m, address(pi)))
        return pi
