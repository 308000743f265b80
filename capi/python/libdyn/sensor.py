"""Sensors of a model: what they measure, and their values."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import byref
from typing import TYPE_CHECKING, NamedTuple, Optional, Tuple

import numpy as np

from . import abi
from .arrays import address
from .choices import member, size, string, text
from .enums import Quantity, Reduction, ShapeType, Side
from .fields import Fields
from .handles import ModelHandle
from .library import check, lib

if TYPE_CHECKING:
    from .arrays import Numbers
    from .enums import QuantityLike, ReductionLike, ShapeTypeLike, SideLike

_IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


class Sensor(NamedTuple):
    """A sensor of a model. See dynSensor in dyn.h."""

    quantity: QuantityLike = Quantity.JOINTPOS
    cutoff: float = 0.0
    """> 0: values are clamped to [-cutoff, cutoff]."""
    noise: float = 0.0
    """Standard deviation, for Data.noisy_sensors."""
    placement: Sequence[float] = _IDENTITY
    """12 numbers: the sensor's in its frame, rotation by columns, then translation."""
    reference_placement: Sequence[float] = _IDENTITY
    """The same in the reference frame."""
    shape: ShapeTypeLike = ShapeType.SPHERE
    """touch, insidesite: of the zone."""
    extent: Tuple[float, float, float] = (0.005, 0.005, 0.005)
    """m: its sizes, as of shapes."""
    field: Tuple[float, float, float] = (0.0, -0.5, 0.0)
    """magnetometer: the magnetic field, world axes."""
    name: Optional[str] = None
    """Of a model's sensor, as all that follows."""
    object: int = -1
    """Id of its joint, tendon, actuator or frame; -1: none."""
    reference: int = -1
    """Id of its reference frame; -1: none."""
    idx: int = 0
    """Place among the values of all sensors."""
    size: int = 0
    """How many values it has."""
    order: int = 0
    """0 reads q, 1 reads v too, 2 acceleration or forces too."""
    delay: float = 0.0
    """s, for Model.delayed_sensors and rollouts."""
    side: SideLike = Side.ANY
    """distance, normal, fromto, contact: what `object` names."""
    other_side: SideLike = Side.ANY
    """And what `reference` names."""
    values: int = 0
    """rangefinder, contact: a sum of dyn.Value; 0: distance, found."""
    reduction: ReductionLike = Reduction.NONE
    """contact: which of more than `count`."""
    count: int = 1
    """contact: contacts; user: values."""
    of_values: int = 0
    """contact: how many values each has."""

    def structure(self) -> abi.Sensor:
        """As the library takes it."""
        out = abi.initialized(abi.Sensor, member(Quantity, self.quantity, "quantity"))
        out.cutoff, out.noise, out.shape = self.cutoff, self.noise, member(ShapeType, self.shape, "shape")
        out.placement[:], out.reference_placement[:] = self.placement, self.reference_placement
        out.extent[:], out.field[:], out.delay = self.extent, self.field, self.delay
        out.side, out.other_side = member(Side, self.side, "side"), member(Side, self.other_side, "other_side")
        out.values, out.count = int(self.values), self.count
        out.reduction = member(Reduction, self.reduction, "reduction")
        return out


class ModelSensors(ModelHandle):
    """The part of Model that knows its sensors."""

    @property
    def nsensors(self) -> int:
        return size(lib.dyn_model_nsensors(self._m))

    @property
    def nsensordata(self) -> int:
        return size(lib.dyn_model_nsensordata(self._m))

    @property
    def sensor_names(self) -> list[str]:
        return [string(lib.dyn_model_sensor_name(self._m, k)) for k in range(self.nsensors)]

    @property
    def sensors(self) -> list[Sensor]:
        return [self.sensor(k) for k in range(self.nsensors)]

    def sensor_id(self, name: str) -> int:
        """Number of a sensor of the model."""
        return self._id(lib.dyn_model_sensor_id(self._m, text(name, "sensor")))

    def sensor(self, sensor: str | int) -> Sensor:
        """One of the model's, by name or number."""
        id = self.sensor_id(sensor) if isinstance(sensor, str) else self._index(sensor, self.nsensors, "sensor")
        x = abi.Sensor()
        check(lib.dyn_model_sensor_info(self._m, id, byref(x)))
        return Sensor(Quantity(x.quantity), x.cutoff, x.noise, tuple(x.placement), tuple(x.reference_placement),
                      ShapeType(x.shape), tuple(x.extent), tuple(x.field), string(lib.dyn_model_sensor_name(self._m, id)),
                      x.object, x.reference, x.idx, x.size, x.order, x.delay, Side(x.side), Side(x.other_side), x.values,
                      Reduction(x.reduction), x.count, x.of_values)

    def delayed_sensors(self, times: Numbers, readings: Numbers, time: float) -> Numbers:
        """Values at `time` with the sensors' delays, from readings (n, nsensordata) at times (n,) that ascend."""
        t, rows = np.ascontiguousarray(times, float), np.ascontiguousarray(readings, float)
        if t.ndim != 1 or rows.shape != (len(t), self.nsensordata):
            raise ValueError(f"times and readings have the shapes {t.shape} and {rows.shape}, but (n,) and "
                             f"(n, {self.nsensordata}) are needed")
        out = np.empty(self.nsensordata)
        check(lib.dyn_sensor_delay(self._m, address(t), address(rows), len(t), time, address(out)))
        return out


class SensorCalls(Fields):
    """The part of Data that reads sensors."""

    def sensors(self, q: Numbers | None = None, v: Numbers | None = None, a: Numbers | None = None) -> Numbers:
        """Values of all sensors of the model at q, v and the acceleration a; contacts are those of the last step."""
        m = self.model
        given = [None if x is None else np.ascontiguousarray(x, float) for x in (q, v, a)]
        for x, n, what in zip(given, (m.nq, m.nv, m.nv), "qva"):
            if x is not None and x.shape != (n,):
                raise ValueError(f"{what} has the shape {x.shape}, but ({n},) is needed")
        out = np.empty(m.nsensordata)
        check(lib.dyn_sensors(self._m, self._d, *(None if x is None else address(x) for x in given), address(out)))
        return out

    def sensor(self, sensor: str | int) -> Numbers:
        """Values of one sensor, as sensors() has computed them."""
        s = self.model.sensor(sensor)
        return np.array(self.field("sensor_data")[s.idx : s.idx + s.size])

    def noisy_sensors(self, seed: int, count: int) -> Numbers:
        """The values that sensors() has computed, with noise that depends on seed and the number of the reading alone."""
        out = np.array(self.field("sensor_data"))
        check(lib.dyn_sensor_noise(self._m, seed, count, address(out)))
        return out
