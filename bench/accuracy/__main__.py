#!/usr/bin/env python3
"""What accuracy costs, beside MuJoCo and Drake: work and precision of every integrator of each on the same models.

    python bench/accuracy [--problems NAME,...] [--limit S] [--json FILE] [--svg FILE] [--write]

The same MJCF file, state and duration for all (problems.py). Errors are the largest distance of a marker from where it should be,
at ten times; the reference is a closed form, or libdyn's `reference`, which scipy's DOP853 at 2e-14 on MuJoCo's accelerations
confirms (the table says how far the two are apart). Time is the CPU's, of stepping alone: a tenth of the duration is one call
(dyn_advance, mj_step with nstep, Simulator.AdvanceTo); the median of up to five runs. Steps and accuracies become finer until a
run takes --limit seconds. Needs packages mujoco, drake, scipy, mpmath, matplotlib, and the package dyn with the library and the
command of a release build (DYN_LIBRARY, DYN_CLI).
"""

import argparse
import json
import logging
import os
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

import common
import numpy as np
import plot
import problems
import run_drake
import run_dyn
import run_mujoco

PROJECT = Path(__file__).resolve().parents[2]
sys.path.append(str(PROJECT / "bench"))

import pages  # noqa: E402

ENGINES = [run_dyn, run_mujoco, run_drake]
LEVELS = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10]
COUNTS = 0.1  # m: larger errors are no results


def cheapest(points, level):
    return min((p for p in points if p.error is not None and p.error <= level), key=lambda p: p.seconds, default=None)


def solve(problem):
    """What one problem gives: the points of each engine, and how well the reference is known."""
    known = 0.0
    if problem.kind != "contact" and not problem.exact:
        reference, known = run_dyn.reference(problem)
    if problem.exact:
        reference = np.array([problem.exact(t) for t in problem.times])
    if problem.kind == "smooth":
        known = max(known, float(np.abs(run_mujoco.confirmation(problem) - reference).max()))
    out = {"title": problem.title, "kind": problem.kind, "known_to": known,
           "reference": "closed form" if problem.exact else "libdyn, order 8 to rounding", "points": {}}
    for engine in ENGINES:
        print(f"{problem.name}: {engine.NAME}", file=sys.stderr, flush=True)
        out["points"][engine.NAME] = engine.points(problem, reference)
    return out


def number(x):
    return f"{x:.2g}" if x < 100 else f"{x:.0f}"


def cell(points, level):
    """ms of libdyn, and its ratio to the better of the others."""
    mine = cheapest(points[run_dyn.NAME], level)
    others = [p for engine in ENGINES[1:] if (p := cheapest(points[engine.NAME], level))]
    if not mine:
        return "**no**" if others else ""
    ms = number(1e3 * mine.seconds)
    if not others:
        return f"{ms}, alone"
    ratio = mine.seconds / min(p.seconds for p in others)
    return f"{ms}, {ratio:.2g}" if ratio < 1 else f"**{ms}, {ratio:.2g}**"


def table(answers):
    lines = ["| problem | reference known to, m |" + "".join(f" error {level:g} m |" for level in LEVELS),
             "|---|---|" + "---|" * len(LEVELS)]
    for a in answers.values():
        known = f"{a['known_to']:.0e}" if a["known_to"] else "closed form"
        lines.append(f"| {a['title']} | {known} | " + " | ".join(cell(a["points"], level) if level > 3 * a["known_to"] else ""
                                                                 for level in LEVELS) + " |")
    return "\n".join(lines)


def verdict(answers):
    """Errors that another engine reaches in less time, or alone."""
    lost = []
    for name, a in answers.items():
        for engine in ENGINES[1:]:
            for p in a["points"][engine.NAME]:
                if p.error is None or p.error > COUNTS or p.error < 3 * a["known_to"]:
                    continue
                mine = cheapest(a["points"][run_dyn.NAME], p.error)
                if not mine or mine.seconds >= p.seconds:
                    lost.append(f"{name}: {engine.NAME} {p.method} {p.value:g}: {p.error:.2g} m in {1e3 * p.seconds:.3g} ms, "
                                "libdyn " + (f"{1e3 * mine.seconds:.3g} ms" if mine else "not at all"))
    return lost


def detail(answers):
    """The cheapest setting of each engine at each level."""
    lines = []
    for name, a in answers.items():
        for level in LEVELS:
            for engine in ENGINES:
                if p := cheapest(a["points"][engine.NAME], level):
                    lines.append(f"{name:16} {level:6g} {engine.NAME:8} {1e3 * p.seconds:10.4g} ms  {p.method} {p.value:.3g} "
                                 f"(error {p.error:.2g})")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--problems", help="names, by commas")
    parser.add_argument("--limit", type=float, default=common.LIMIT,
                        help="seconds of one run, beyond which no finer setting is tried")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--svg", type=Path)
    parser.add_argument("--write", action="store_true", help="puts the table in its place (bench/pages.py)")
    options = parser.parse_args()
    common.LIMIT = options.limit
    logging.getLogger("drake").setLevel(logging.ERROR)
    command = os.environ.get("DYN_CLI", PROJECT / "build/release/bin/dyn")
    answers = {}
    with tempfile.TemporaryDirectory() as folder:
        every = problems.every(command, PROJECT / "models", Path(folder))
        asked = options.problems.split(",") if options.problems else [p.name for p in every]
        if unknown := set(asked) - {p.name for p in every}:
            parser.error(f"no problem {', '.join(sorted(unknown))}; there are {', '.join(p.name for p in every)}")
        for problem in every:
            if problem.name in asked:
                answers[problem.name] = solve(problem)
    if options.json:
        plain = {name: {**a, "points": {engine: [asdict(p) for p in points] for engine, points in a["points"].items()}}
                 for name, a in answers.items()}
        options.json.write_text(json.dumps({"versions": {e.NAME: e.VERSION for e in ENGINES}, "problems": plain}, indent=1)
                                + "\n")
    if options.svg:
        plot.draw(answers, [e.NAME for e in ENGINES], options.svg)
    lost = verdict(answers)
    text = (f"Milliseconds of libdyn for an error, and their ratio to those of the faster of {run_mujoco.NAME} "
            f"{run_mujoco.VERSION} and {run_drake.NAME} {run_drake.VERSION} (alone: neither gets there; bold: libdyn is slower, "
            f"or does not).\n\n{table(answers)}\n")
    print(detail(answers) + "\n\n" + text)
    print("\n".join(["libdyn is not cheaper there:", *lost]
                    if lost else ["at every error that another reaches, libdyn is cheaper"]))
    if options.write:
        pages.write("accuracy", text)


if __name__ == "__main__":
    main()
