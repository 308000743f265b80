"""Cost of accuracy on a scene: the sweep of the command `dyn accuracy`, as a dict, and its diagram by matplotlib; and why two
simulations differ, by `dyn compare`.

    result = dyn.accuracy.sweep("double_pendulum.urdf", base="fixed", q=[1.2, 0.4], target="1e-6m", budget="10s")
    result["points"], result["recommended"]
    dyn.accuracy.plot(result, "double_pendulum.svg")          # .png, .pdf: whatever matplotlib writes
    dyn.accuracy.compare("before.xml", "after.xml", duration=2)["causes"][0]["name"]
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np

from .errors import ArgumentError, Error, FileError
from .files import command

_MARKS = "osD^v<>ph*"


def _words(key: str, x: Any) -> list[str]:
    """An option of the command from a keyword: q=[1, 2] is --q 1,2; ground=True is --ground."""
    option = "--" + key.replace("_", "-")
    if x is None or x is False:
        return []
    if x is True:
        return [option]
    if isinstance(x, (str, os.PathLike)):
        return [option, os.fspath(x)]
    if np.ndim(x):
        return [option, ",".join(e if isinstance(e, str) else repr(float(e)) for e in x)]
    return [option, repr(x)]


def sweep(file: str | os.PathLike[str], base: str | None = None, **options: Any) -> dict[str, Any]:
    """Runs `dyn accuracy` on a robot or scene. Returns its JSON as a dict. Options are the command's own: q, v, tau, ctrl
    (numbers), configuration, duration, target="1e-6m", budget="30s", ground=True, without="limits", solver, reference, resume,
    csv, html and so on."""
    return _answer("accuracy", [file], base, options)


def compare(a: str | os.PathLike[str], b: str | os.PathLike[str], base: str | None = None, **options: Any) -> dict[str, Any]:
    """Runs `dyn compare` on two robot files, a log and a robot file, or two logs. Returns its JSON as a dict: when the
    divergence begins, both errors of integration, and the causes, that which explains most first. Options are the command's
    own: duration, dt, dt_b, q, q_b, model, layout_a, svg and so on."""
    return _answer("compare", [a, b], base, options)


def _answer(subcommand: str, files: list[Any], base: str | None, options: dict[str, Any]) -> dict[str, Any]:
    """The JSON of a subcommand of `dyn`."""
    if base not in (None, "fixed", "floating"):
        raise ArgumentError(f'base is {base!r}, but must be "fixed" or "floating".')
    words = [command(), subcommand, *map(os.fspath, files), "--json", *([f"--{base}"] if base else [])]
    for key, x in options.items():
        words += _words(key, x)
    done = subprocess.run(words, capture_output=True, encoding="utf-8")
    if done.returncode:
        said = done.stderr.strip().removeprefix("dyn: ")
        raise (ArgumentError if done.returncode == 2 else Error)(said or f"{words[0]} ended with status {done.returncode}")
    return json.loads(done.stdout)


def _read(result: Any) -> dict[str, Any]:
    if isinstance(result, (str, os.PathLike)):
        try:
            result = json.loads(Path(result).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise FileError(f"{os.fspath(result)}: {error}") from None
    if not isinstance(result, dict) or not isinstance(result.get("points"), list):
        raise ArgumentError("result has no points: it is what dyn.accuracy.sweep or `dyn accuracy --json` gives, or the name of "
                            "a file with that.")
    return result


def methods(result: Any) -> dict[str, list[dict[str, Any]]]:
    """The points of each line of the diagram: integrators in steps, and for an accuracy, from the coarsest setting on."""
    out: dict[str, list[dict[str, Any]]] = {}
    for p in _read(result)["points"]:
        out.setdefault(p["integrator"] + (", accuracy" if p["accuracy"] is not None else ""), []).append(p)
    for points in out.values():
        points.sort(key=lambda p: -(p["accuracy"] if p["accuracy"] is not None else p["dt"]))
    return out


def plot(result: Any, path: str | os.PathLike[str] | None = None, error: str = "m") -> Any:
    """The work-precision diagram of a sweep (a dict, or a file of it): error to the right, time upwards, both logarithmic; beside
    it the same over evaluations of forward dynamics. One line a method, one mark a setting; what nothing is both cheaper and
    nearer than has a ring; what failed stands at the right edge. error: which one, "m", "rad", "J" or "kg m/s". Writes path if
    given. Returns the figure. Needs matplotlib."""
    result = _read(result)
    if error not in ("m", "rad", "J", "kg m/s"):
        raise ArgumentError(f'error is {error!r}, but must be "m", "rad", "J" or "kg m/s".')
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise ImportError("dyn.accuracy.plot needs matplotlib: pip install matplotlib") from None
    least = np.finfo(float).eps  # errors of 0 are drawn there
    figure = Figure(figsize=(10, 5))
    FigureCanvasAgg(figure)
    for ax, work, label in zip(figure.subplots(1, 2), ("wall_s", "evaluations"), ("time, s", "evaluations of forward dynamics")):
        ax.set_xscale("log"), ax.set_yscale("log")
        for k, (name, points) in enumerate(methods(result).items()):
            good = [p for p in points if not p["failed"]]
            x, y = [max(p["errors"][error], least) for p in good], [p[work] for p in good]
            (line,) = ax.plot(x, y, marker=_MARKS[k % len(_MARKS)], ms=4, lw=1.2, label=name)
            failed = [p[work] for p in points if p["failed"] and p[work] > 0]
            ax.plot([1] * len(failed), failed, "x", color=line.get_color(), transform=ax.get_yaxis_transform(), clip_on=False)
        front = sorted((max(p["errors"][error], least), p[work]) for p in result["points"] if p["pareto"])
        ax.plot([p[0] for p in front], [p[1] for p in front], "o", ms=9, mfc="none", mec="0.35", mew=0.8, label="cheapest",
                zorder=1)
        if front:
            ax.set_xlim(right=10 * max(max(p["errors"][error], least) for p in result["points"] if not p["failed"]))
        ax.set_xlabel(f"error, {error}"), ax.set_ylabel(label)
        ax.grid(color="0.9", lw=0.6)
    figure.suptitle(f"{result.get('name', '')}: {result.get('duration', '')} s")
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="lower center", ncols=5, frameon=False, fontsize=8)
    figure.subplots_adjust(0.08, 0.22, 0.98, 0.92, 0.22)
    if path is not None:
        figure.savefig(os.fspath(path))
    return figure
