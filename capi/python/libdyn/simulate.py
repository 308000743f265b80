"""A model that plays: Simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, NamedTuple

import numpy as np

from .errors import ArgumentError

if TYPE_CHECKING:
    from .arrays import Numbers
    from .data import Data
    from .enums import EffectLike, IntegratorLike
    from .model import Model

Controller = Callable[["Simulation"], Any]
"""Called before each control period: it returns controls (nu,), or torques (nv,) where the model has no actuators, or calls methods
of simulation.data."""


class Trajectory(NamedTuple):
    """Records of Simulation.run, the beginning included."""

    t: Numbers
    """(R,), s."""
    q: Numbers
    """(R, nq)."""
    v: Numbers
    """(R, nv)."""


class Simulation:
    """A data that goes on in time: the loop that one would write oneself.

        sim = dyn.Simulation(model)
        trajectory = sim.run(2.0, lambda sim: kp * (target - sim.q) - kd * sim.v)

    q: where it begins, or the name of a configuration of the model, with the velocity, controls, activations and time that it
    states; by default as new data, where an MJCF file draws it.
    dt, integrator, effects: by default those of the model's file, or 1e-3 s, "semi_implicit_euler" and all effects.
    stepping: more of Data.set_step_options. `data` is a Data like any other.
    """

    def __init__(
        self,
        model: Model,
        q: Any = None,
        v: Any = None,
        *,
        dt: float | None = None,
        integrator: IntegratorLike | None = None,
        effects: EffectLike | None = None,
        **stepping: Any,
    ):
        self.model = model
        self.data: Data = model.data()
        self.data.set_step_options(integrator, dt, **stepping)
        self.dt: float = self.data.step_options.dt
        if effects is not None:
            self.data.set_effects(effects)
        self._set(q, v)
        self._begin = self.data.save_state()

    def __repr__(self) -> str:
        return f"<dyn.Simulation of {self.model.name!r}: t {self.time:g} s, dt {self.dt:g} s>"

    @property
    def time(self) -> float:
        """s."""
        return float(self.data.field("time"))

    @property
    def q(self) -> Numbers:
        """(nq,): a view of what is."""
        return self.data.q

    @property
    def v(self) -> Numbers:
        """(nv,): a view of what is."""
        return self.data.v

    def reset(self, q: Any = None, v: Any = None) -> None:
        """Back to the beginning, with q or v in place of what was there, or to the state of a named configuration."""
        self.data.restore_state(self._begin)
        self._set(q, v)

    def _set(self, q: Any, v: Any) -> None:
        if isinstance(q, str):
            self.data.reset(q)
            q = None
        self.data.set_state(q, v)

    def step(self, steps: int = 1, control: Any = None, *, tau: Any = None) -> None:
        """Some steps, under controls (nu,) and torques tau (nv,), or those that are held."""
        if control is not None:
            self.data.set_control(control)
        if tau is not None:
            self.data.set_state(tau=tau)
        for _ in range(steps):
            self.data.step()

    def run(self, duration: float, controller: Controller | None = None, *, every: int = 1) -> Trajectory:
        """Runs duration seconds, a whole number of steps; controls and records are `every` steps apart."""
        steps = round(duration / self.dt)
        if every < 1 or steps < 1 or steps % every or abs(steps * self.dt - duration) > 1e-9 * duration:
            raise ArgumentError(f"duration is {duration} s, but must be a multiple of every * dt, {every} * {self.dt} s.")
        t, q, v = np.empty(steps // every + 1), np.empty((steps // every + 1,
                                                          self.model.nq)), np.empty((steps // every + 1, self.model.nv))
        t[0], q[0], v[0] = self.time, self.q, self.v
        name = "control" if self.model.nu else "tau"
        for k in range(1, len(t)):
            self.step(every, **{name: None if controller is None else controller(self)})
            t[k], q[k], v[k] = self.time, self.q, self.v
        return Trajectory(t, q, v)
