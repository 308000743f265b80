"""Steps in time: integrators, and steps whose lengths follow from an accuracy."""

from __future__ import annotations

from ctypes import byref
from typing import Any, NamedTuple

from . import abi
from .enums import Integrator
from .library import check, fail, lib
from .model import member

_INTEGRATORS: dict[Any, int] = {key: int(i) for i in Integrator for key in (i, i.name, i.name.lower())}
_step = lib.dyn_step


class StepReport(NamedTuple):
    """What the last step or advance did."""

    steps: int
    rejected: int
    """Steps tried whose error was too large."""
    evaluations: int
    """Of forward dynamics."""
    time: float
    """Seconds advanced."""
    smallest_dt: float
    error_estimate: float
    """Sum of the estimated errors of the steps; 0 from integrators that have none."""


class Stepping:
    """The part of Data that moves it in time."""

    def set_stepping(self, integrator: str | Integrator | None = None, dt: float | None = None, accuracy: float | None = None) -> None:
        """How step and advance go: by which integrator, in steps of dt seconds or (accuracy > 0, advance alone) of those that take
        the sum of their errors to at most accuracy. None leaves a value as it is."""
        options = self.stepping
        if integrator is not None:
            kind = _INTEGRATORS.get(integrator)
            options.integrator = member(Integrator, integrator, "integrator") if kind is None else kind
        if dt is not None:
            options.dt = dt
        if accuracy is not None:
            options.accuracy = accuracy
        check(lib.dyn_data_set_step_options(self._m, self._d, byref(options)))

    @property
    def stepping(self) -> abi.StepOptions:
        """integrator, dt and accuracy, as set_stepping left them."""
        options = abi.StepOptions()
        lib.dyn_step_options_init(byref(options))
        check(lib.dyn_data_step_options(self._m, self._d, byref(options)))
        return options

    def step(self, dt: float | None = None, integrator: str | Integrator | None = None) -> None:
        """Advances q, v and the time by one step of smooth dynamics under the held tau. dt and integrator are kept (set_stepping)."""
        if dt is not None or integrator is not None:
            self.set_stepping(integrator, dt)
        status = _step(self._m, self._d)
        if status:
            fail(status)

    def advance(self, duration: float) -> StepReport:
        """Makes the steps that duration (s) takes, and says how many."""
        check(lib.dyn_advance(self._m, self._d, duration))
        return self.step_report

    @property
    def step_report(self) -> StepReport:
        """What the last step or advance did."""
        r = abi.StepReport()
        check(lib.dyn_data_step_report(self._m, self._d, byref(r)))
        return StepReport(r.steps, r.rejected, r.evaluations, r.time, r.smallest_dt, r.error_estimate)
