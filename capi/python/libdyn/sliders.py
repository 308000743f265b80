"""Sliders of a live page: controls of actuators, or torques of joints of a model that has none."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .enums import ActuatorType, Transmission

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .actuator import Actuator
    from .arrays import Numbers
    from .model import Model
    from .simulate import Simulation

_SHARE = 0.25  # of the model's weight at its size: a torque that moves it, where its file has no limit


class Sliders(NamedTuple):
    """Numbers that a page sets."""

    described: list[dict[str, Any]]
    """Name, lower, upper of each."""
    torques: bool
    places: list[int]
    """Where each is in the controls (nu,), or in tau (nv,)."""

    def __len__(self) -> int:
        return len(self.places)

    def values(self, sim: Simulation) -> list[float]:
        """What they are now."""
        found: list[float] = np.asarray(sim.tau if self.torques else sim.ctrl)[self.places].tolist()
        return found

    def hold(self, sim: Simulation, held: Mapping[int, float]) -> None:
        """Sets those that are held, the others being as they are."""
        x = np.array(sim.tau if self.torques else sim.ctrl)
        for k, value in held.items():
            x[self.places[k]] = value
        if self.torques:
            sim.tau = x
        else:
            sim.ctrl = x

    def release(self, sim: Simulation, held: Mapping[int, float]) -> None:
        """Those that were held: none, until somebody gives others."""
        self.hold(sim, dict.fromkeys(held, 0.0))


def of(model: Model) -> Sliders:
    """Sliders of a model."""
    if model.nu:
        described, places = [], []
        for actuator, a in zip(model.actuator_names, map(model.actuator, range(model.nactuators))):
            lower, upper = _range(model, a)
            for k in range(a.controls):
                name = f"{actuator}[{k}]" if a.controls > 1 else actuator
                described.append({"name": name, "lower": lower, "upper": upper})
                places.append(a.idx_u + k)
        return Sliders(described, False, places)
    joints = [j for j in model.joints[1:] if j.nv == 1 and j.mimic_leader < 0]
    most = _SHARE * model.total_mass * max(float(np.linalg.norm(model.gravity)), 1.0)
    described = []
    for j in joints:
        effort = float(model.effort_limit[j.idx_v])
        bound = effort if 0 < effort < 1e300 else max(most, 1e-6)
        described.append({"name": f"tau {j.name}", "lower": -bound, "upper": bound})
    return Sliders(described, True, [j.idx_v for j in joints])


def _range(model: Model, a: Actuator) -> tuple[float, float]:
    """What an actuator's control may be; where nothing says so, what is of use."""
    finite = lambda bounds: all(abs(x) < 1e300 for x in bounds) and bounds[0] < bounds[1]
    bounds = tuple(float(x) for x in a.control_range)
    if finite(bounds):
        return bounds[0], bounds[1]
    if a.type == ActuatorType.MUSCLE:
        return 0.0, 1.0
    if a.type == ActuatorType.POSITION and a.transmission == Transmission.JOINT:
        j = model.joint(a.joint)
        limits = float(model.lower_limit[j.idx_q]), float(model.upper_limit[j.idx_q])
        return limits if j.nq == 1 and finite(limits) else (-np.pi, np.pi)
    force = tuple(float(x) for x in a.force_range)
    return (force[0], force[1]) if a.type == ActuatorType.MOTOR and finite(force) else (-1.0, 1.0)
