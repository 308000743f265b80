"""A model that plays: Simulation."""

from __future__ import annotations

import copy
import math
import os
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Callable, NamedTuple, Union

import numpy as np

from . import page
from .choices import whole
from .data import adopted
from .enums import JointType
from .errors import ArgumentError, SizeError, StaleError, UnknownNameError
from .live import Viewer
from .loading import load
from .model import Model
from .picture import Camera, Renderer
from .recording import Recording

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Numbers
    from .data import Data
    from .enums import BaseLike, EffectLike, IntegratorLike
    from .picture import Image
    from .simulation import ContactForce

Controller = Callable[["Simulation"], Any]
"""Called before each control period. Returns torques (nv,) or controls (nu,), {"tau": torques, "ctrl": controls} with one or both
of them, or None: those that are held."""
ByName = Union["ArrayLike", Mapping[str, Any]]


class Trajectory(NamedTuple):
    """Records of Simulation.run, the beginning included."""

    t: Numbers
    """(R,), s."""
    q: Numbers
    """(R, nq)."""
    v: Numbers
    """(R, nv)."""


class Sensors(Mapping[str, Any]):
    """Values of a simulation's sensors by name, at its state. Accelerations are the mean ones of the last step."""

    def __init__(self, simulation: Simulation):
        self._simulation = simulation
        sensors = simulation.model.sensors
        self._places = {s.name or "": slice(s.idx, s.idx + s.size) for s in sensors}
        self._of_steps = {s.name or "" for s in sensors if s.order == 2}

    def __getitem__(self, name: str) -> Numbers:
        place = self._places.get(name)
        if place is None:
            raise UnknownNameError(f"there is no sensor {name!r}: model {self._simulation.model.name!r} has "
                                   f"{', '.join(self) or 'none'}.")
        if name in self._of_steps and self._simulation._accelerated != self._simulation.time:
            raise StaleError(f"sensor {name!r} reads the acceleration of the simulation's last step, and the data has stepped since "
                             "by itself: call Simulation.step.")
        return np.array(self.values_of_all()[place])

    def __contains__(self, name: object) -> bool:
        return name in self._places

    def get(self, name: str, default: Any = None) -> Any:
        return self[name] if name in self else default

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)

    def __repr__(self) -> str:
        return f"<sensors: {', '.join(self._places)}>"

    def values_of_all(self) -> Numbers:
        """(nsensordata,): a view."""
        data = self._simulation.data
        try:
            data.field("sensor_data")
        except StaleError:
            data.sensors(a=self._simulation._acceleration)
        values: Numbers = data.field("sensor_data")
        return values


class Simulation:
    """A data that goes on in time: the loop that one would write oneself.

    >>> import libdyn as dyn
    >>> sim = dyn.Simulation("models/robots/panda.urdf", base="fixed")
    >>> sim.step(tau=sim.data.gravity_torque())              # torques (nv,), held until others are given
    >>> motion = sim.run(1.0, lambda sim: sim.data.gravity_torque() - 5 * sim.v)
    >>> motion.q.shape == (1001, sim.model.nq)
    True
    >>> scene = dyn.Simulation("models/scenes/go2_stands.xml", "standing")
    >>> scene.step(500, ctrl={"FL_hip": 0.05})               # controls (nu,), or some by name
    >>> len(scene.contacts)
    4

    model: a Model, or a URDF or MJCF file; base as in dyn.load.
    q: where it begins, or the name of a configuration of the model, with the velocity, controls, activations and time that it
    states; by default as new data, where an MJCF file draws it.
    dt, integrator, effects: by default those of the model's file, or 1e-3 s, "semi_implicit_euler" and all effects.
    stepping: more of Data.set_step_options. `data` is a Data like any other.

    A simulation can be pickled and copied: copy.copy(sim) goes on by itself from the same state.
    """

    def __init__(
        self,
        model: Model | str | os.PathLike[str],
        q: Any = None,
        v: Any = None,
        *,
        base: BaseLike | None = None,
        dt: float | None = None,
        integrator: IntegratorLike | None = None,
        effects: EffectLike | None = None,
        **stepping: Any,
    ):
        if isinstance(model, (str, os.PathLike)):
            model = load(model, base)
        elif not isinstance(model, Model):
            raise ArgumentError(f"model is {model!r}, but must be a dyn.Model or the path of a URDF or MJCF file.")
        elif base is not None:
            raise ArgumentError("base is for files: a model has its base already.")
        self.model: Model = model
        self.data: Data = model.data()
        self.data.set_step_options(integrator, dt, **stepping)
        if effects is not None:
            self.data.set_effects(effects)
        self._set(q, v)
        self._begin = self.data.save_state()
        self._measures_acceleration = any(s.order == 2 for s in model.sensors)
        self._acceleration: Numbers | None = None
        self._accelerated = self.time  # s, when _acceleration was of the last step
        self._recordings: list[Recording] = []
        self._renderer: tuple[Model, Any, Renderer] | None = None

    def __repr__(self) -> str:
        return f"<dyn.Simulation of {self.model.name!r}: t {self.time:g} s, dt {self.dt:g} s>"

    def _repr_html_(self) -> str:
        return page.in_notebook(lambda: page.still(self.model, self.q)) or self.data._repr_html_()

    def copy(self) -> Simulation:
        """A simulation of its own in the same state, with the same settings. Recordings stay with this one."""
        return copy.deepcopy(self)

    def __copy__(self) -> Simulation:
        return self.copy()

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_recordings": [], "_renderer": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._begin = adopted(self._begin, self.data)

    @property
    def time(self) -> float:
        """s."""
        return float(self.data.field("time"))

    @property
    def dt(self) -> float:
        """s, length of the next step; data.set_step_options changes it."""
        return float(self.data.step_options.dt)

    @property
    def q(self) -> Numbers:
        """(nq,): a view of what is."""
        return self.data.q

    @property
    def v(self) -> Numbers:
        """(nv,): a view of what is."""
        return self.data.v

    @property
    def tau(self) -> Numbers:
        """(nv,): the torques that are held, a view."""
        return self.data.tau_applied

    @tau.setter
    def tau(self, x: Any) -> None:
        self._give_tau(x)

    @property
    def ctrl(self) -> Numbers:
        """(nu,): the controls that are held, a view."""
        found: Numbers = self.data.field("ctrl")
        return found

    @ctrl.setter
    def ctrl(self, x: Any) -> None:
        self._give_ctrl(x)

    @property
    def contacts(self) -> list[ContactForce]:
        """Contact points of the last step with their forces."""
        return self.data.step_contacts()

    @property
    def sensors(self) -> Sensors:
        """Values by name: sim.sensors["imu"]."""
        return Sensors(self)

    @property
    def configurations(self) -> tuple[str, ...]:
        """Names that reset takes."""
        return self.model.configuration_names

    def reset(self, q: Any = None, v: Any = None) -> None:
        """Back to the beginning, with q or v in place of what was there, or to the state of a named configuration. Ends
        recordings."""
        self.restore_state(self._begin)
        self._set(q, v)
        self._accelerated = self.time

    def save_state(self) -> bytes:
        """The state, for restore_state: see Data.save_state."""
        return self.data.save_state()

    def restore_state(self, state: bytes) -> None:
        """Back to a state: steps go on from it bit for bit. Ends recordings."""
        self.data.restore_state(state)
        self._recordings, self._acceleration = [], None
        self._accelerated = self.time

    def _set(self, q: Any, v: Any) -> None:
        if isinstance(q, str):
            self.data.reset(q)
            q = None
        self.data.set_state(q, v)

    def _give_tau(self, x: Any) -> None:
        m = self.model
        shape = np.shape(x) if not isinstance(x, Mapping) else (m.nv,)
        if shape != (m.nv,):
            free = sum(j.nv for j in m.joints if j.type == JointType.FREE_FLYER)
            hint = ""
            if free and shape == (m.nv - free,) and m.joints[1].type == JointType.FREE_FLYER:
                hint = f" The first {free} numbers are those of the floating base: write np.r_[np.zeros({free}), x]."
            raise SizeError(f"tau has shape {shape}, but must have shape ({m.nv},) of model {m.name!r}.{hint}")
        self.data.set_state(tau=x)

    def _give_ctrl(self, x: Any) -> None:
        if isinstance(x, Mapping):
            u = np.array(self.ctrl)
            for name, value in x.items():
                a = self.model.actuator(name)
                u[a.idx_u : a.idx_u + a.controls] = value
            x = u
        self.data.set_control(x)

    def _give(self, x: Any, returns: str | None) -> None:
        """What a controller returned."""
        m = self.model
        if x is None:
            return
        if isinstance(x, Mapping):
            if not x.keys() <= {"tau", "ctrl"}:
                raise ArgumentError(f'the controller returned a dict with {", ".join(map(repr, x))}, but its keys are "tau" and '
                                    f'"ctrl": return {{"tau": {{joint: torque}}}} for torques by name.')
            if "tau" in x:
                self._give_tau(x["tau"])
            if "ctrl" in x:
                self._give_ctrl(x["ctrl"])
            return
        if returns is None:
            shape = np.shape(x)
            if m.nu == m.nv:
                raise ArgumentError(f"the controller returned an array, but model {m.name!r} has as many controls as degrees "
                                    f'of freedom, {m.nv}: return {{"tau": x}} or {{"ctrl": x}}, or give run returns="tau" or '
                                    '"ctrl".')
            if m.nu and shape not in ((m.nu,), (m.nv,)):
                raise SizeError(f"the controller returned shape {shape}, but controls of model {m.name!r} have shape "
                                f"({m.nu},), torques ({m.nv},).")
            returns = "ctrl" if m.nu and shape == (m.nu,) else "tau"
        (self._give_ctrl if returns == "ctrl" else self._give_tau)(x)

    def step(self, steps: int = 1, ctrl: ByName | None = None, *, tau: ByName | None = None) -> None:
        """Some steps, under controls ctrl (nu,) or {actuator: control} and torques tau (nv,) or {joint: torque}, or those that
        are held."""
        if ctrl is not None:
            self._give_ctrl(ctrl)
        if tau is not None:
            self._give_tau(tau)
        if not isinstance(steps, int):
            if np.ndim(steps):
                raise ArgumentError("steps is an array: write step(tau=x) for torques, step(ctrl=x) for controls.")
            steps = whole(steps, "steps")
        if steps < 0:
            raise ArgumentError(f"steps is {steps}: time does not run backwards.")
        step = self.data.step
        if not (self._measures_acceleration or self._recordings):
            for _ in range(steps):
                step()
            return
        for k in range(steps):
            before = self.v.copy() if self._measures_acceleration and (self._recordings or k == steps - 1) else None
            step()
            if before is not None:
                self._acceleration, self._accelerated = (self.v - before) / self.dt, self.time
            for recording in self._recordings:
                recording.stepped(self)

    def run(
        self, duration: float, controller: Controller | None = None, *, every: int = 1, returns: str | None = None
    ) -> Trajectory:
        """Runs duration seconds, a whole number of steps; controls and records are `every` steps apart.

        controller  called before each period; what it returns: see Controller. The shape says whether it is torques or controls
        returns     "tau" or "ctrl": says so where there are as many controls as degrees of freedom
        """
        if returns not in (None, "tau", "ctrl"):
            raise ArgumentError(f'returns is {returns!r}, but must be "tau" or "ctrl".')
        every, dt = whole(every, "every", 1), self.dt
        steps = round(duration / dt) if math.isfinite(duration) else 0
        if steps < 1 or steps % every or abs(steps * dt - duration) > 1e-9 * duration:
            raise ArgumentError(f"duration is {duration} s, but must be a multiple of every * dt, {every} * {dt} s.")
        rows = steps // every + 1
        t, q, v = np.empty(rows), np.empty((rows, self.model.nq)), np.empty((rows, self.model.nv))
        t[0], q[0], v[0] = self.time, self.q, self.v
        for k in range(1, rows):
            if controller is not None:
                self._give(controller(self), returns)
            self.step(every)
            t[k], q[k], v[k] = self.time, self.q, self.v
        return Trajectory(t, q, v)

    def record(self, every: int | None = None) -> Recording:
        """Records from now on, until Recording.stop, the end of a `with` block, or reset.

        every   steps between moments; None: about 60 moments a second, which is what a page shows
        """
        recording = Recording(self, max(1, round(1 / 60 / self.dt)) if every is None else whole(every, "every", 1))
        self._recordings = [*self._recordings, recording]
        return recording

    def picture(self, width: int = 640, height: int = 480, camera: Camera | None = None, **drawing: Any) -> Image:
        """A picture of what is, (height, width, 3): see dyn.Renderer, whose arguments drawing are. The first one places a camera
        that was not told where to look; it stays for others of the same kind."""
        kind = width, height, camera, drawing
        if self._renderer is None or self._renderer[0] is not self.model or self._renderer[1] != kind:
            self._renderer = self.model, kind, Renderer(self.model, width, height, camera, **drawing)
        return self._renderer[2].render(self.q, self.data.field("act"))

    def view(
        self, controller: Controller | None = None, *, every: int = 1, returns: str | None = None, open: bool = True,
        port: int = 0,
    ) -> Viewer:
        """Opens a live page of this simulation: see dyn.view."""
        return Viewer(self, controller, every=every, returns=returns, open=open, port=port)
