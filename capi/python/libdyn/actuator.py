"""Actuators, controls, and forces from outside: what drives steps."""

from __future__ import annotations

from ctypes import byref
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple, Tuple

from numpy.typing import ArrayLike

from . import abi
from .arrays import address, checked
from .choices import member
from .enums import ActuatorType, Reference, Transmission
from .errors import SizeError
from .handles import DataHandle, ModelHandle
from .library import check, lib

if TYPE_CHECKING:
    from .enums import ActuatorTypeLike, ReferenceLike, TransmissionLike


class Muscle(NamedTuple):
    """A muscle: its force by activation, length and rate. See dynMuscle in dyn.h."""

    force: float = 1.0
    """N, at optimum length."""
    range: Tuple[float, float] = (0.75, 1.05)
    """Normalised lengths at both ends of length_range."""
    length_range: Tuple[float, float] = (0.0, 1.0)
    """m."""
    lmin: float = 0.5
    """Normalised length below which it does not pull."""
    lmax: float = 1.6
    """Normalised length above which activation has no effect."""
    vmax: float = 1.5
    """Optimum lengths a second at which a muscle that shortens has no force."""
    fpmax: float = 1.3
    """Passive force at lmax, by force."""
    fvmax: float = 1.2
    """Active force of a muscle that lengthens fast, by force."""
    t_act: float = 0.01
    """s."""
    t_deact: float = 0.04
    """s."""
    smoothing: float = 0.0
    """Range of u - w over which the two time constants blend."""

    def structure(self) -> abi.Muscle:
        """As the library takes it."""
        return abi.Muscle(self.force, tuple(self.range), tuple(self.length_range), *self[3:])

    @classmethod
    def of(cls, x: Any) -> Muscle:
        """From the library's structure."""
        return cls(x.force, tuple(x.range), tuple(x.length_range), *(getattr(x, name) for name in cls._fields[3:]))


class DcMotor(NamedTuple):
    """A DC motor with its driver. See dynDcMotor in dyn.h."""

    resistance: float = 1.0
    """Ohm."""
    constant: float = 1.0
    """N m/A, V s/rad."""
    temperature_coefficient: float = 0.0
    """1/K."""
    reference: float = 0.0
    """Degrees C at which the resistance is as given."""
    ambient: float = 0.0
    """Degrees C."""
    thermal_resistance: float = 0.0
    """K/W; 0: the temperature is ambient."""
    heat_capacity: float = 0.0
    """J/K."""
    time_constant: float = 0.0
    """s, of the current; 0: it follows at once."""
    rate: float = 0.0
    """A/s, of the current; 0: no bound."""
    kp: float = 0.0
    kd: float = 0.0
    voltage_limit: float = 0.0
    """V, of the controller; 0: none."""
    bristle_stiffness: float = 0.0
    """N m/rad; 0: no friction."""
    bristle_damping: float = 0.0
    """N m s/rad."""
    coulomb: float = 0.0
    """N m."""
    breakaway: float = 0.0
    """N m."""
    stribeck: float = 0.0
    """rad/s."""
    cogging: Tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Amplitude (N m), periods a radian, phase (rad)."""

    def structure(self) -> abi.DcMotor:
        """As the library takes it."""
        return abi.DcMotor(*self[:-1], tuple(self.cogging))

    @classmethod
    def of(cls, x: Any) -> DcMotor:
        """From the library's structure."""
        return cls(*(getattr(x, name) for name in cls._fields[:-1]), tuple(x.cogging))


class ForceLimit(NamedTuple):
    """A limit of the sum of the actuators on a joint or a tendon."""

    joint: int
    """Its id; -1: it is of a tendon."""
    tendon: int
    """Its id; -1: it is of a joint."""
    range: Tuple[float, float]
    """N m or N."""
    with_weight: bool
    """What gravity compensation gives the joint is part of the sum."""


class Actuator(NamedTuple):
    """force = gain . controls + bias . (1, length, its rate), within force_range. See dynActuator in dyn.h."""

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
    transmission: TransmissionLike = Transmission.JOINT
    """What it acts through: length = gear q of a joint, gear L of a tendon; site: see wrench."""
    wrench: Tuple[float, float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """site: [force; moment] on the frame for each N of force."""
    muscle: Muscle = Muscle()
    """muscle."""
    tendon: int = -1
    """tendon: its id; set for a model's actuator."""
    frame: int = -1
    """site: its id; set for a model's actuator."""
    reference: int = -1
    """site: id of the reference frame, -1: none; set for a model's actuator."""
    gain_slope: Tuple[float, float] = (0.0, 0.0)
    """affine: what the gain gains by length and by rate."""
    rod: float = 0.0
    """slider_crank: m."""
    ki: float = 0.0
    """pid, dc_motor: of the integral of the position error."""
    integral_limit: float = 0.0
    """pid, dc_motor: bound of that integral; 0: none."""
    slew: float = 0.0
    """pid, dc_motor: largest rate of the position control; 0: none."""
    velocity_range: Tuple[float, float] = (-inf, inf)
    """pid, dc_motor: of the velocity control."""
    feedforward_range: Tuple[float, float] = (-inf, inf)
    """pid, dc_motor: of the force control."""
    inputs: int | None = None
    """pid, dc_motor: a sum of dyn.Input; None: POSITION, of a dc_motor VOLTAGE."""
    in_parent: bool = False
    """axes: moments are in the axes of the parent."""
    late: bool = False
    """Euler steps take the activation at their beginning, as MuJoCo without actearly."""
    activations: int = 0
    """Numbers of it in Data.act; set for a model's actuator."""
    motor: DcMotor = DcMotor()
    """dc_motor."""

    def structure(self) -> abi.Actuator:
        """As the library takes it."""
        out = abi.initialized(abi.Actuator, member(ActuatorType, self.type, "type"))
        out.component, out.gear, out.kp, out.kv, out.gain = self.component, self.gear, self.kp, self.kv, self.gain
        out.bias[:], out.control_range[:], out.force_range[:] = self.bias, self.control_range, self.force_range
        out.act_range[:], out.integrates = self.act_range, self.integrates
        out.time_constant = self.time_constant
        out.transmission, out.wrench[:] = member(Transmission, self.transmission, "transmission"), self.wrench
        out.muscle, out.motor = self.muscle.structure(), self.motor.structure()
        out.gain_slope[:], out.rod, out.in_parent, out.late = self.gain_slope, self.rod, self.in_parent, self.late
        out.ki, out.integral_limit, out.slew = self.ki, self.integral_limit, self.slew
        out.velocity_range[:], out.feedforward_range[:] = self.velocity_range, self.feedforward_range
        if self.inputs is not None:
            out.inputs = self.inputs
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
            tuple(x.act_range), bool(x.integrates), x.idx_act, Transmission(x.transmission), tuple(x.wrench),
            Muscle.of(x.muscle), x.tendon, x.frame, x.reference, tuple(x.gain_slope), x.rod, x.ki, x.integral_limit,
            x.slew, tuple(x.velocity_range), tuple(x.feedforward_range), x.inputs, bool(x.in_parent), bool(x.late),
            x.activations, DcMotor.of(x.motor),
        )  # fmt: skip

    @property
    def force_limits(self) -> list[ForceLimit]:
        """Limits of the sum of the actuators on joints and tendons."""
        out = []
        for k in range(lib.dyn_model_nforce_limits(self._m)):
            x = abi.ForceLimit()
            check(lib.dyn_model_force_limit_info(self._m, k, byref(x)))
            out.append(ForceLimit(x.joint, x.tendon, tuple(x.range), bool(x.with_weight)))
        return out


class Actuation(DataHandle):
    """The part of Data that acts on it in steps."""

    def set_control(self, u: ArrayLike) -> None:
        """Controls of the actuators, (nu,), until others are set."""
        if not self.model.nu:
            raise SizeError(f"model {self.model.name!r} has no actuators, and so no controls: torques of its joints are set by "
                            "data.tau_applied = x or Simulation.step(tau=x).")
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
        kind, id = member(Reference, reference, "reference"), self.model._frame(frame)
        w = checked(wrench, (6,), "wrench")
        check(lib.dyn_data_apply_wrench(self._m, self._d, id, address(at), address(w), kind))
        key = (id, None if at is None else at.tobytes(), int(kind))
        self._wrenches[key] = self._wrenches.get(key, 0.0) + w

    def clear_wrenches(self) -> None:
        """Ends what apply_wrench began."""
        check(lib.dyn_data_clear_wrenches(self._m, self._d))
        self._wrenches.clear()

    def set_gravity(self, gravity: ArrayLike) -> None:
        """Gravity in this data, (3,), m/s^2, world axes; the field world_gravity reads it."""
        check(lib.dyn_data_set_gravity(self._m, self._d, address(checked(gravity, (3,), "gravity"))))
