"""Actuators, controls, and forces from outside: what drives steps."""

from __future__ import annotations

from ctypes import byref
from math import inf
from typing import TYPE_CHECKING, NamedTuple, Tuple

from numpy.typing import ArrayLike

from . import abi
from .arrays import address, checked
from .choices import member
from .enums import ActuatorType, Reference
from .handles import DataHandle, ModelHandle
from .library import check, lib

if TYPE_CHECKING:
    from .enums import ActuatorTypeLike, ReferenceLike


class Actuator(NamedTuple):
    """force = gain . controls + bias . (1, length, its rate), within force_range; length = gear q. See dynActuator in dyn.h."""

    type: ActuatorTypeLike = ActuatorType.MOTOR
    gear: float = 1.0
    kp: float = 0.0
    """position, pd: N m/rad or N/m."""
    kv: float = 0.0
    """position, velocity, pd: N m s/rad or N s/m."""
    gain: float = 0.0
    """affine."""
    bias: Tuple[float, float, float] = (0.0, 0.0, 0.0)
    """affine."""
    time_constant: float = 0.0
    """s, of a filter of the first control; 0: none."""
    control_range: Tuple[float, float] = (-inf, inf)
    force_range: Tuple[float, float] = (-inf, inf)
    component: int = 0
    """Index among the joint's degrees of freedom."""
    joint: int = 0
    """Id of the joint; set for a model's actuator."""
    idx_u: int = 0
    """Index of the first control; set for a model's actuator."""
    controls: int = 1
    """Number of controls; set for a model's actuator."""
    act_range: Tuple[float, float] = (-inf, inf)
    """Range of the filtered or integrated control."""
    integrates: bool = False
    """The first control is the rate of what drives; time_constant is then 0."""
    idx_act: int = -1
    """Index in Data.act of the filtered or integrated control; -1: none."""

    def structure(self) -> abi.Actuator:
        """As the library takes it."""
        out = abi.initialized(abi.Actuator, member(ActuatorType, self.type, "type"))
        out.component, out.gear, out.kp, out.kv, out.gain = self.component, self.gear, self.kp, self.kv, self.gain
        out.bias[:], out.control_range[:], out.force_range[:] = self.bias, self.control_range, self.force_range
        out.act_range[:], out.integrates = self.act_range, self.integrates
        out.time_constant = self.time_constant
        return out


class ModelActuators(ModelHandle):
    """The part of Model that knows its actuators."""

    @property
    def nactuators(self) -> int:
        return lib.dyn_model_nactuators(self._m)

    @property
    def nu(self) -> int:
        """Controls of all actuators."""
        return lib.dyn_model_nu(self._m)

    @property
    def actuator_names(self) -> list[str]:
        return [lib.dyn_model_actuator_name(self._m, k).decode() for k in range(self.nactuators)]

    def actuator_id(self, name: str) -> int:
        """Number of an actuator of the model."""
        return self._id(lib.dyn_model_actuator_id(self._m, name.encode()))

    def actuator(self, actuator: str | int) -> Actuator:
        """One of the model's, by name or number."""
        x = abi.Actuator()
        check(lib.dyn_model_actuator_info(self._m, self.actuator_id(actuator) if isinstance(actuator, str) else actuator,
                                          byref(x)))
        return Actuator(
            ActuatorType(x.type), x.gear, x.kp, x.kv, x.gain, tuple(x.bias), x.time_constant,
            tuple(x.control_range), tuple(x.force_range), x.component, x.joint, x.idx_u, x.controls,
            tuple(x.act_range), bool(x.integrates), x.idx_act,
        )  # fmt: skip


class Actuation(DataHandle):
    """The part of Data that acts on it in steps."""

    def set_control(self, u: ArrayLike) -> None:
        """Controls of the actuators, (nu,), until others are set."""
        check(lib.dyn_data_set_control(self._m, self._d, address(checked(u, (self.model.nu,), "u"))))

    def apply_wrench(
        self,
        frame: int | str,
        wrench: ArrayLike,
        point: ArrayLike | None = None,
        reference: ReferenceLike = Reference.LOCAL_WORLD_ALIGNED,
    ) -> None:
        """Adds [force; moment], (6,), that acts in steps until clear_wrenches, at point (3,) of a frame (None: its origin).
        "local": in the frame's axes, turning with it; "local_world_aligned": world axes; "world": world axes, moment about the
        world's origin."""
        at = None if point is None else checked(point, (3,), "point")
        kind = member(Reference, reference, "reference")
        w = checked(wrench, (6,), "wrench")
        check(lib.dyn_data_apply_wrench(self._m, self._d, self.model._frame(frame), address(at), address(w), kind))

    def clear_wrenches(self) -> None:
        """Ends what apply_wrench began."""
        check(lib.dyn_data_clear_wrenches(self._m, self._d))

    def set_gravity(self, gravity: ArrayLike) -> None:
        """Gravity in this data, (3,), m/s^2, world axes; the field world_gravity reads it."""
        check(lib.dyn_data_set_gravity(self._m, self._d, address(checked(gravity, (3,), "gravity"))))
