"""What a simulation did: arrays, a table, a page."""

from __future__ import annotations

import csv
import json
import os
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import page
from .describe import coordinate_names
from .enums import FrameType, Part
from .errors import ArgumentError, UnsupportedError
from .library import version
from .picture import Camera, Renderer
from .tendon_lines import TendonLines

if TYPE_CHECKING:
    from .arrays import Numbers
    from .model import Model
    from .simulate import Simulation
    from .simulation import ContactForce


class _Moment(NamedTuple):
    t: float
    q: Numbers
    v: Numbers
    tau: Numbers
    ctrl: Numbers
    actuator_force: Numbers
    energy: tuple[float, float]
    solver: tuple[float, float, int]
    sensors: Numbers
    contacts: list[ContactForce]
    act: Numbers


class Recording:
    """Moments of a simulation. From Simulation.record; len() counts them.

    >>> import libdyn as dyn
    >>> sim = dyn.Simulation("models/scenes/go2_stands.xml", "standing")
    >>> with sim.record(every=10) as recording:
    ...     motion = sim.run(0.5)
    >>> recording.q.shape == (len(recording.t), sim.model.nq)
    True

    Arrays have a row for each moment: t, q, v, tau, ctrl, actuator_force, energy; sensors is {name: rows}, contacts a list for
    each. to_html writes a page, to_mp4 a video, to_csv and to_parquet tables, to_mcap a log. A notebook shows the page.
    """

    def __init__(self, simulation: Simulation, every: int):
        self.model: Model = simulation.model
        self.every = every
        """Steps between moments."""
        self._stepped = 0
        self._moments: list[_Moment] = []
        self._simulation: Simulation | None = simulation
        self.note(simulation)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_simulation": None}

    def __repr__(self) -> str:
        times = f", {self.t[0]:g} to {self.t[-1]:g} s" if len(self) else ""
        return f"<dyn.Recording of {self.model.name!r}: {len(self)} moments{times}>"

    def _repr_html_(self) -> str:
        return page.in_notebook(self._page) or f"<b>{repr(self)[1:-1]}</b>"

    def __len__(self) -> int:
        return len(self._moments)

    def __enter__(self) -> Recording:
        return self

    def __exit__(self, *_: Any) -> None:
        self.stop()

    def stop(self) -> None:
        """Records no more."""
        if self._simulation is not None:
            self._simulation._recordings = [r for r in self._simulation._recordings if r is not self]
            self._simulation = None

    def stepped(self, simulation: Simulation) -> None:
        """Called after each step."""
        self._stepped += 1
        if self._stepped % self.every == 0:
            self.note(simulation)

    def note(self, simulation: Simulation) -> None:
        """Adds the moment that is."""
        d, m = simulation.data, self.model
        report, energy = d.step_report, d.energy()
        sensors = np.array(simulation.sensors.values_of_all()) if m.nsensordata else np.empty(0)
        self._moments.append(_Moment(
            simulation.time, d.q.copy(), d.v.copy(), d.tau_applied.copy(), d.field("ctrl").copy(),
            d.field("actuator_force").copy(), (energy.kinetic, energy.potential),
            (report.residual, report.penetration, report.iterations), sensors, d.step_contacts(), d.field("act").copy(),
        ))  # fmt: skip

    def _rows(self, name: str) -> Numbers:
        k = _Moment._fields.index(name)
        return np.array([moment[k] for moment in self._moments])

    @property
    def t(self) -> Numbers:
        """(R,), s."""
        return self._rows("t")

    @property
    def q(self) -> Numbers:
        """(R, nq)."""
        return self._rows("q")

    @property
    def v(self) -> Numbers:
        """(R, nv)."""
        return self._rows("v")

    @property
    def tau(self) -> Numbers:
        """(R, nv): torques that were held."""
        return self._rows("tau")

    @property
    def ctrl(self) -> Numbers:
        """(R, nu): controls that were held."""
        return self._rows("ctrl")

    @property
    def actuator_force(self) -> Numbers:
        """(R, nactuators)."""
        return self._rows("actuator_force")

    @property
    def energy(self) -> Numbers:
        """(R, 2), J: kinetic, potential."""
        return self._rows("energy")

    @property
    def sensors(self) -> dict[str, Numbers]:
        """(R, size) of each sensor, by name."""
        rows = self._rows("sensors").reshape(len(self), -1)
        return {str(s.name): rows[:, s.idx : s.idx + s.size] for s in self.model.sensors}

    @property
    def contacts(self) -> list[list[ContactForce]]:
        """Contact points of each moment."""
        return [moment.contacts for moment in self._moments]

    def table(self) -> dict[str, Numbers]:
        """Columns by name: t, q.<coordinate>, v., tau., ctrl.<actuator>, force.<actuator>, kinetic, potential, contacts,
        sensor.<name>."""
        m, out = self.model, {"t": self.t}
        controls = [f"{name}[{k}]" if a.controls > 1 else name for name in m.actuator_names for a in [m.actuator(name)]
                    for k in range(a.controls)]
        for name, columns, rows in (
            ("q", coordinate_names(m, True), self.q), ("v", coordinate_names(m, False), self.v),
            ("tau", coordinate_names(m, False), self.tau), ("ctrl", controls, self.ctrl),
            ("force", m.actuator_names, self.actuator_force),
        ):  # fmt: skip
            out.update((f"{name}.{column}", rows[:, k]) for k, column in enumerate(columns))
        out["kinetic"], out["potential"] = self.energy.T
        out["contacts"] = np.array([len(c) for c in self.contacts])
        for name, rows in self.sensors.items():
            size = rows.shape[1]
            out.update((f"sensor.{name}[{k}]" if size > 1 else f"sensor.{name}", rows[:, k]) for k in range(size))
        return out

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes table(): a row for each moment, with all digits."""
        table = self.table()
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(table)
            writer.writerows(zip(*(column.tolist() for column in table.values())))

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Writes table() as Parquet (package pyarrow)."""
        try:
            import pyarrow  # type: ignore[import-not-found, unused-ignore]
            import pyarrow.parquet as parquet  # type: ignore[import-not-found, unused-ignore]
        except ImportError:
            raise UnsupportedError("to_parquet needs pyarrow: pip install pyarrow.") from None
        parquet.write_table(pyarrow.table(self.table()), os.fspath(path))

    def to_mcap(self, path: str | os.PathLike[str]) -> None:
        """Writes a log that Foxglove and Rerun open (package mcap): /moment, the rows of table() as JSON, and /tf, the
        placements of links."""
        try:
            from mcap.writer import Writer  # type: ignore[import-not-found, unused-ignore]
        except ImportError:
            raise UnsupportedError("to_mcap needs mcap: pip install mcap.") from None
        table, data = self.table(), self.model.data(Part.FRAMES)
        links = [f for f in self.model.frames if f.type == FrameType.BODY]
        with open(path, "wb") as file:
            log = Writer(file)
            log.start(library=f"libdyn {version}")
            channels = {}
            for topic, name in (("/moment", "libdyn.Moment"), ("/tf", "foxglove.FrameTransforms")):
                schema = log.register_schema(name=name, encoding="jsonschema", data=b'{"type": "object"}')
                channels[topic] = log.register_channel(schema_id=schema, topic=topic, message_encoding="json")
            for k, moment in enumerate(self._moments):
                ns = round(1e9 * moment.t)
                data.forward_kinematics(moment.q)
                every = data.frame_placements()
                quaternions = every.quaternion
                stamp = {"sec": ns // 10**9, "nsec": ns % 10**9}
                transforms = [
                    {"timestamp": stamp, "parent_frame_id": "world", "child_frame_id": f.name,
                     "translation": dict(zip("xyz", every.translation[f.id].tolist())),
                     "rotation": dict(zip("xyzw", quaternions[f.id].tolist()))}
                    for f in links
                ]  # fmt: skip
                row = {name: column[k].item() for name, column in table.items()}
                for topic, message in (("/moment", row), ("/tf", {"transforms": transforms})):
                    log.add_message(channel_id=channels[topic], log_time=ns, publish_time=ns, data=json.dumps(message).encode())
            log.finish()

    def to_mp4(self, path: str | os.PathLike[str], width: int = 640, height: int = 480, *, camera: Camera | None = None,
               fps: float = 30.0, speed: float = 1.0, **drawing: Any) -> None:
        """Writes a video by ffmpeg, of the system or of the package imageio-ffmpeg. speed: 0.5 is slow motion; between moments
        configurations are interpolated; drawing: more of dyn.Renderer."""
        from .video import Video  # not before: most programs write none

        if not len(self):
            raise ArgumentError("the recording has no moments.")
        if not 0 < speed < np.inf:
            raise ArgumentError(f"speed is {speed}, but must be more than 0.")
        renderer, t, q = Renderer(self.model, width, height, camera, **drawing), self.t, self.q
        with Video(path, width, height, fps) as video:
            for k in range(int((t[-1] - t[0]) * fps / speed + 1e-9) + 1):
                video.add(renderer.render(self._between(t, q, t[0] + k * speed / fps)))

    def _between(self, t: Numbers, q: Numbers, at: float) -> Numbers:
        """q at a time, interpolated."""
        k = int(np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 1))
        if k == len(t) - 1 or at <= t[k]:
            return q[k]
        return self.model.interpolate(q[k], q[k + 1], (at - t[k]) / (t[k + 1] - t[k]))

    def to_html(self, path: str | os.PathLike[str], beside: Recording | None = None,
                labels: tuple[str, str] = ("first", "second")) -> None:
        """Writes a page that plays the recording and needs nothing else. Needs the command dyn.

        beside: another recording, of this model or another one, on the same time line. Its robot stands beside this one or over it,
        and plots have the curves of both, under these labels.
        """
        text = self._page()
        if beside is not None:
            text = page.beside(text, beside._page(), labels)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def _page(self) -> str:
        if not len(self):
            raise ArgumentError("the recording has no moments.")
        return page.recorded(self.model, self)

    def tendon_pieces(self) -> list[Numbers]:
        """Straight pieces of the paths of tendons at each moment, (n, 7): both ends, and the activation of a muscle, else -1."""
        if not self.model.ntendons:
            return []
        lines = TendonLines(self.model)
        return [lines(moment.q, moment.act) for moment in self._moments]
