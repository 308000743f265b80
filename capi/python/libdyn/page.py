"""Pages of models and recordings: the command dyn draws the model, and what was recorded is put into its page."""

from __future__ import annotations

import base64
import html
import json
import os
import re
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .describe import coordinate_names
from .enums import Part
from .errors import Error, UnsupportedError
from .files import command
from .placement import Placement

if TYPE_CHECKING:
    from .arrays import Numbers
    from .model import Model
    from .recording import Recording

_HEAD = re.compile(r'(<script type="application/json" id="dyn-head">)(.*?)(</script>)', re.S)
_NUMBERS = re.compile(r'(<script type="text/plain" id="dyn-numbers">)(.*?)(</script>)', re.S)
MOST = 4_000_000
"""Bytes of a recording in a page; a longer one is thinned."""


def still(model: Model, q: ArrayLike | None = None) -> str:
    """The page of a model at a configuration, with joints to be moved."""
    with tempfile.TemporaryDirectory() as folder:
        file, state, out = (os.path.join(folder, name) for name in (f"{_plain(model.name)}.dynb", "state.json", "page.html"))
        model.save(file)
        words = [command(), "view", file, "--html", out]
        if q is not None:
            with open(state, "w", encoding="utf-8") as text:
                json.dump({"q": np.asarray(q).tolist()}, text)
            words += ["--state", state]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode:
            raise UnsupportedError(f"the command dyn made no page: {done.stderr.strip().removeprefix('dyn: ')}")
        return Path(out).read_text(encoding="utf-8")


def _plain(name: str) -> str:
    return re.sub(r"[^\w-]", "_", name)[:60] or "model"


class Pack:
    """Numbers of a page, one array behind another: see tools/cli/page/pack.hpp."""

    def __init__(self, begin: bytes = b""):
        self._parts, self._size = [begin], len(begin)

    def _append(self, x: np.ndarray, kind: str) -> dict[str, Any]:
        fill = -self._size % 4
        self._parts += [b"\0" * fill, x.tobytes()]
        at = self._size + fill
        self._size = at + x.nbytes
        return {"at": at, "n": int(x.size), "as": kind}

    def f32(self, x: ArrayLike) -> dict[str, Any]:
        return self._append(np.ascontiguousarray(x, "<f4"), "f32")

    def q16(self, x: ArrayLike, columns: int) -> dict[str, Any]:
        """Rows of so many columns in 16 bits between the least and the largest number of each; constant columns are left out."""
        rows = np.asarray(x, np.float64).reshape(-1, columns)
        rows = np.where(np.isfinite(rows), rows, 0.0)
        lower, upper = (rows.min(0), rows.max(0)) if len(rows) else np.zeros((2, columns))
        step = (upper - lower) / 65535
        moves = step > 0
        made = self._append(np.rint((rows[:, moves] - lower[moves]) / step[moves]).astype("<u2"), "q16")
        return {**made, "n": int(rows.size), "lower": lower.tolist(), "step": step.tolist()}

    def indices(self, x: ArrayLike) -> dict[str, Any]:
        a = np.asarray(x, np.int64)
        short = a.size == 0 or a.max() <= 65535
        return self._append(a.astype("<u2" if short else "<u4"), "u16" if short else "u32")

    def base64(self) -> str:
        return base64.b64encode(b"".join(self._parts)).decode()


def read(page: str) -> tuple[dict[str, Any], bytes]:
    """The head of a page and its numbers."""
    head, numbers = _HEAD.search(page), _NUMBERS.search(page)
    if head is None or numbers is None:
        raise UnsupportedError("the command dyn made a page of another version: update it.")
    return json.loads(head[2]), base64.b64decode(numbers[2])


def filled(page: str, head: dict[str, Any], numbers: str) -> str:
    """The page with another head and other numbers."""
    text = json.dumps(head).replace("<", "\\u003c")
    page = _HEAD.sub(lambda found: found[1] + text + found[3], page, count=1)
    return _NUMBERS.sub(lambda found: found[1] + numbers + found[3], page, count=1)


def beside(first: str, second: str, labels: tuple[str, str]) -> str:
    """One page of two that play recordings: two robots and one time line."""
    (head, numbers), (other, others) = read(first), read(second)
    fill = -len(numbers) % 4
    head["beside"] = {"head": other, "at": len(numbers) + fill, "labels": list(labels)}
    return filled(first, head, base64.b64encode(numbers + b"\0" * fill + others).decode())


class Poses:
    """Placements of a model's joints and its centre of mass, as pages take them."""

    model: Model

    def __init__(self, model: Model):
        self.model, self._data = model, model.data(Part.ALL)
        first = {f.joint: f for f in reversed(model.frames)}
        self._frames = [first[j].id for j in range(1, model.njoints)]
        local = [first[j].placement for j in range(1, model.njoints)]
        self._local = Placement(np.array([x.rotation for x in local]).reshape(-1, 3, 3),
                                np.array([x.translation for x in local]).reshape(-1, 3)).inverse()

    def __call__(self, q: ArrayLike) -> tuple[Numbers, Numbers, Numbers]:
        """Positions (njoints - 1, 3), quaternions (njoints - 1, 4), centre of mass (3,)."""
        com = self._data.compute_com(q)
        self._data.forward_kinematics(q)
        world = self._data.frame_placements()
        X = Placement(world.rotation[self._frames], world.translation[self._frames]) @ self._local
        return X.translation, X.quaternion, com


def recorded(model: Model, recording: Recording) -> str:
    """The page that plays a recording."""
    page = still(model, recording.q[0])
    head, numbers = read(page)
    keep, notes = _kept(recording, head["notes"])
    pack = Pack(numbers)
    poses = Poses(model)
    q, v, energy = recording.q[keep], recording.v[keep], recording.energy[keep]
    contacts = [recording._moments[k].contacts for k in keep]
    positions, turns, com = (np.array(x) for x in zip(*map(poses, q)))
    out: dict[str, Any] = {
        "moments": len(keep), "time": pack.f32(recording.t[keep]), "positions": pack.q16(positions, 3 * (model.njoints - 1)),
        "turns": pack.q16(turns, 4 * (model.njoints - 1)), "com": pack.q16(com, 3), "plots": [],
    }  # fmt: skip

    def plot(title: str, unit: str, names: list[str], values: Numbers) -> None:
        if names:
            out["plots"].append({"title": title, "unit": unit, "names": names, "values": pack.q16(values, len(names))})

    solver = np.array([recording._moments[k].solver for k in keep])
    plot("energy", "J", ["kinetic", "potential", "mechanical"], np.column_stack([energy, energy.sum(1)]))
    plot("q", "rad, m", coordinate_names(model, True), q)
    plot("v", "rad/s, m/s", coordinate_names(model, False), v)
    plot("tau", "N m, N", coordinate_names(model, False), recording.tau[keep])
    plot("actuators", "N m, N", model.actuator_names, recording.actuator_force[keep])
    for name, rows in recording.sensors.items():
        size = rows.shape[1]
        plot(f"sensor {name}", "", [f"{name}[{k}]" if size > 1 else name for k in range(size)], rows[keep])
    plot("residual", "of the contact solver", ["residual"], solver[:, 0])
    plot("penetration", "m", ["penetration"], solver[:, 1])
    plot("contacts", "points; iterations of the solver", ["contacts", "iterations"],
         np.column_stack([[len(c) for c in contacts], solver[:, 2]]))
    flat = [c for each in contacts for c in each]
    out["contacts"] = {
        "first": pack.indices(np.cumsum([0, *map(len, contacts)])),
        "position": pack.q16([c.contact.position for c in flat], 3), "force": pack.f32([c.force_on_b for c in flat]),
        "distance": pack.q16([c.contact.distance for c in flat], 1),
        "shapes": pack.indices([(c.contact.shape_a, c.contact.shape_b) for c in flat]),
    }  # fmt: skip
    pieces = recording.tendon_pieces()
    if pieces:
        pieces = [pieces[k] for k in keep]
        out["tendons"] = {"first": pack.indices(np.cumsum([0, *map(len, pieces)])), "pieces": pack.q16(np.concatenate(pieces), 7)}
    return filled(page, {**head, "kind": "simulation", "recording": out, "notes": notes}, pack.base64())


def _kept(recording: Recording, notes: list[str]) -> tuple[list[int], list[str]]:
    """Moments that a page shows: about 60 a second, and at most MOST bytes of them."""
    m, keep, last = recording.model, [], -np.inf
    for k, now in enumerate(recording.t):
        if now - last >= 0.9 / 60:
            keep.append(k)
            last = now
    each = 2 * (7 * m.njoints + 2 * m.nq + 2 * m.nv + m.nactuators + m.nsensordata + 12)
    size = each * len(keep) + 24 * sum(len(recording._moments[k].contacts) for k in keep)
    thinner = max(1, -(-size // MOST))
    if thinner > 1:
        notes = [*notes, f"the recording is thinned to every {thinner}th moment, for the page's size"]
    return keep[::thinner], notes


def in_notebook(make: Callable[[], str], height: int = 600) -> str:
    """A page as a notebook's cell shows it; "" where the command or its page is not there."""
    try:
        page = make()
    except Error:
        return ""
    return (f'<iframe srcdoc="{html.escape(page, quote=True)}" sandbox="allow-scripts" width="100%" height="{height}" '
            'style="border:0"></iframe>')


def write(text: str, path: str | os.PathLike[str] | None) -> str:
    """Writes a page to a file, by default one of the temporary folder that is left there."""
    if path is None:
        handle, path = tempfile.mkstemp(".html", "dyn-view-")
        os.close(handle)
    Path(path).write_text(text, encoding="utf-8")
    return os.fspath(path)
