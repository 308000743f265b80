"""A simulation in a browser while it runs: the page of dyn view --live, with the steps and the controller in this process.

The server listens on the loopback interface alone, its address has 128 random bits, and pages of other origins are refused.
"""

from __future__ import annotations

import base64
import json
import os
import secrets
import sys
import threading
import time
from collections import deque
from typing import TYPE_CHECKING, Any

import numpy as np

from . import page, sliders
from .errors import ArgumentError, Error
from .tendon_lines import TendonLines

if TYPE_CHECKING:
    from .server import Handler
    from .simulate import Controller, Simulation

_FRAME = 1 / 60
_GONE = 3.0  # s without a page after which a viewer is closed: a page that is loaded anew is back sooner


class Viewer:
    """A live page of a simulation. From Simulation.view or dyn.view.

        with sim.view(controller) as viewer:       # controller: as in Simulation.run
            viewer.run()                           # in real time, until the page is closed

        with sim.view() as viewer:                 # or a loop of one's own
            while viewer.is_running():
                sim.step(tau=...)
                viewer.sync()

    The page pauses, makes single steps, resets and changes the speed. The mouse pulls links while Shift is held. Sliders hold
    controls of actuators (torques, of a model without them) over what the controller or the loop says, until they are released.
    What the page asks for is done in the thread that calls run or sync.
    """

    simulation: Simulation
    controller: Controller | None
    every: int
    returns: str | None
    paused: bool
    speed: float

    def __init__(self, simulation: Simulation, controller: Controller | None = None, *, every: int = 1,
                 returns: str | None = None, open: bool = True, port: int = 0):
        self.simulation, self.controller, self.every, self.returns = simulation, controller, every, returns
        self.word: str = secrets.token_hex(16)
        self.paused, self.speed = False, 1.0
        self.held: dict[int, float] = {}
        """Controls that the page's sliders hold, by index."""
        self._granted = False  # a single step of the pause
        self._poses = page.Poses(simulation.model)
        self._tendons = TendonLines(simulation.model) if simulation.model.ntendons else None
        self._pages: list[Handler] = []
        self._commands: deque[dict[str, Any]] = deque()
        self._lock = threading.Lock()
        self._sent, self._told, self._rate, self._step_s = -1.0, -1.0, 0.0, 0.0
        self._before = self._wall = 0.0  # of the pace: simulated and wall time where it was set
        self._gone_since: float | None = None
        self._closed = False
        still = page.still(simulation.model, simulation.q)
        head, numbers = page.read(still)
        self._controls = sliders.of(simulation.model)
        head.update(kind="live", effects=[], dt=simulation.dt, controls=self._controls.described)
        self.text: str = page.filled(still, head, base64.b64encode(numbers).decode())
        from .server import serve  # not before: it takes 20 ms

        self._server = serve(self, port)
        self.port: int = self._server.server_address[1]
        self.address: str = f"http://127.0.0.1:{self.port}/{self.word}/"
        """What a browser of this machine opens."""
        show(self.address, open)

    def __repr__(self) -> str:
        return f"<dyn.Viewer of {self.simulation.model.name!r}: {'closed' if self._closed else self.address}>"

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def close(self) -> None:
        """Ends the server; the page says so."""
        if self._closed:
            return
        self._closed = True
        self._send(b"", 8)
        self._server.shutdown()
        self._server.server_close()

    def is_running(self) -> bool:
        """False once the viewer was closed, or its page was."""
        gone = self._gone_since is not None and time.monotonic() - self._gone_since > _GONE
        return not (self._closed or gone)

    # threads of pages ---------------------------------------------------------------------------------------------------

    def _came(self, handler: Handler) -> None:
        with self._lock:
            self._pages.append(handler)
            self._gone_since = None

    def _left(self, handler: Handler) -> None:
        with self._lock:
            self._pages = [p for p in self._pages if p is not handler]
            if not self._pages:
                self._gone_since = time.monotonic()
        self._commands.append({"do": "push", "point": [0, 0, 0], "force": [0, 0, 0]})  # a hand that is gone pushes no more

    def _heard(self, payload: bytes) -> None:
        try:
            command = json.loads(payload)
        except ValueError:
            command = None
        self._commands.append(command if isinstance(command, dict) else {})

    def _send(self, payload: bytes, opcode: int) -> None:
        with self._lock:
            pages = list(self._pages)
        for p in pages:
            try:
                p.send(payload, opcode)
            except OSError:
                self._left(p)

    # the thread of the simulation ---------------------------------------------------------------------------------------

    def _obey(self, command: dict[str, Any]) -> None:
        sim, what = self.simulation, command.get("do")
        try:
            if what == "pause":
                self.paused = bool(command["on"])
            elif what == "step":
                self.paused = self._granted = True
            elif what == "control":
                index, value = int(command["index"]), float(command["value"])
                if not 0 <= index < len(self._controls) or not np.isfinite(value):
                    raise ArgumentError(f"there is no control {index} with value {value}")
                self.held[index] = value
                self._controls.hold(sim, self.held)
            elif what == "release":
                self._controls.release(sim, self.held)
                self.held = {}
            elif what == "reset":
                self.held = {}
                sim.reset()
            elif what == "speed":
                self.speed = min(max(float(command["factor"]), 0.01), 100.0)
            elif what == "push":
                sim.data.clear_wrenches()
                force = np.array([float(x) for x in command["force"]])
                if force.any():
                    sim.data.apply_wrench(int(command["frame"]), np.r_[force, 0, 0, 0], command["point"])
            else:
                raise ArgumentError(f"there is no command {what!r}")
        except (Error, KeyError, TypeError, ValueError) as error:
            self._send(json.dumps({"error": str(error)}).encode(), 1)
        self._set_pace()

    def _set_pace(self) -> None:
        self._before, self._wall = self.simulation.time, time.monotonic()

    def _state(self) -> bytes:
        sim, d = self.simulation, self.simulation.data
        report, contacts, energy = d.step_report, d.step_contacts(), d.energy()
        positions, turns, com = self._poses(sim.q)
        parts: list[Any] = [
            [sim.time, self.paused, self.speed, self._rate, *energy, report.residual, report.penetration, 1e6 * self._step_s,
             len(contacts)],
            positions.ravel(), turns.ravel(), com, sim.q, sim.v,
        ]  # fmt: skip
        for c in contacts:
            parts += [c.contact.position, c.force_on_b, [c.contact.distance, c.contact.shape_a, c.contact.shape_b]]
        if self._tendons is not None:
            parts.append(self._tendons(sim.q, d.field("act")).ravel())
        return np.concatenate([np.asarray(x, np.float64) for x in parts]).astype("<f4").tobytes()

    def sync(self) -> None:
        """Does what the page asked for, and shows the state, at most 60 times a second. While the page pauses, it waits."""
        self._granted = False
        while True:
            while self._commands:
                self._obey(self._commands.popleft())
            now = time.monotonic()
            if self._pages and now - self._sent >= _FRAME:
                self._sent = now
                self._send(self._state(), 2)
                if len(self._controls) and now - self._told >= 0.1:
                    self._told = now
                    said = {"controls": self._controls.values(self.simulation), "held": list(self.held)}
                    self._send(json.dumps(said).encode(), 1)
            if self.held:
                self._controls.hold(self.simulation, self.held)
            if not self.paused or self._granted or not self.is_running():
                return
            time.sleep(_FRAME)

    def run(self, duration: float | None = None) -> None:
        """Steps in real time by the page's speed, with the controller, from when a page looks on until it is closed, duration
        seconds are simulated, or Ctrl-C."""
        sim = self.simulation
        while not self._pages and self.is_running():
            time.sleep(0.02)
        end = np.inf if duration is None else sim.time + duration
        self._set_pace()
        try:
            while self.is_running() and sim.time < end - 0.5 * sim.dt:
                began = time.monotonic()
                if self.controller is not None:
                    sim._give(self.controller(sim), self.returns)
                    if self.held:
                        self._controls.hold(sim, self.held)
                sim.step(self.every)
                self._step_s = (time.monotonic() - began) / self.every
                self.sync()
                ahead = (sim.time - self._before) / self.speed - (time.monotonic() - self._wall)
                self._rate = (sim.time - self._before) / max(time.monotonic() - self._wall, 1e-9)
                if ahead > 0:
                    time.sleep(min(ahead, 0.1))
                elif ahead < -0.1:
                    self._set_pace()  # what cannot be kept up with is not made up for
        except KeyboardInterrupt:
            pass
        except Error as error:
            self._send(json.dumps({"error": str(error)}).encode(), 1)
            raise


def show(address: str, open: bool) -> None:
    """Opens an address in a browser, or says that one is to be opened."""
    import webbrowser

    screen = sys.platform in ("darwin", "win32") or any(os.environ.get(x) for x in ("BROWSER", "DISPLAY", "WAYLAND_DISPLAY"))
    if not (open and screen and webbrowser.open(address)):
        print(f"libdyn: open {address}", file=sys.stderr)
