"""Evaluations of forward dynamics that libdyn takes for an error: counts, which depend on no clock.

    python bench/accuracy/counts.py [--write] [--problems NAME,...]

The cheapest setting for each error of each problem, with its evaluations. capi/python/tests/test_published_counts.py makes some of
them again and fails above 1.05 times what the page says. Needs the command dyn (DYN_CLI) and the package libdyn.
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path

import numpy as np
import problems
import run_dyn
from common import Failed, steps_of, within

PROJECT = Path(__file__).resolve().parents[2]
sys.path.append(str(PROJECT / "bench"))

import pages  # noqa: E402

LEVELS = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10]
HOPELESS = 10  # s: a run that takes longer is left out; all others take far less
MOST = 20000  # evaluations beyond which no finer setting of a method is tried
STAGES = {"rk4": 4, "rk45": 7, "implicit_midpoint": 5}  # evaluations of a step, else 1


def run(scene, reference, method, value):
    """Evaluations of a setting and its largest error, m; None where it fails. method: an integrator in steps of value, or
    "order 8" or "order 5", for an accuracy of value."""
    scene.set(method, value)
    scene.begin()
    far = 0.0
    axes = list(scene.problem.axes)
    try:
        for k, place in enumerate(reference):
            scene.move(k)
            far = max(far, float(np.max(np.linalg.norm((scene.look() - place)[:, axes], axis=1))))
    except Failed:
        return None
    return (scene.evaluations, far) if np.isfinite(far) else None


def reference_of(problem):
    """Where it should be, and how well that is known."""
    if problem.exact:
        return np.array([problem.exact(t) for t in problem.times]), 0.0
    return run_dyn.reference(problem)


def cheapest(problem):
    """{error: (evaluations, method, value)} of the settings with the fewest evaluations."""
    scene = run_dyn.Scene(problem)
    reference, known = reference_of(problem)
    best = {}
    for method in run_dyn.methods(problem):
        by_accuracy = method.startswith("order")
        finest = 12 if problem.kind == "smooth" else 9  # beyond, steps through contact and loops become as short as can be
        for value in [10.0**-e for e in range(finest + 1)] if by_accuracy else steps_of(problem):
            if not by_accuracy and STAGES.get(method, 1) * problem.duration / value > MOST:
                break
            found = within(HOPELESS, lambda: run(scene, reference, method, value))
            if found:
                for level in LEVELS:
                    if found[1] <= level and level > 3 * known and (level not in best or found[0] < best[level][0]):
                        best[level] = (found[0], method, value)
            if found and (found[0] > MOST or found[1] <= LEVELS[-1]):
                break
    return best


def table(results):
    lines = ["Evaluations of forward dynamics for an error, and the setting: `dt` or `accuracy` of an integrator.", "",
             "| problem |" + "".join(f" error {level:g} m |" for level in LEVELS), "|---|" + "---|" * len(LEVELS)]
    for problem, best in results:
        cells = (f"{best[level][0]}, {best[level][1]} {best[level][2]:.6g}" if level in best else "" for level in LEVELS)
        lines.append(f"| {problem.name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def published(page):
    """[(problem, error, evaluations, method, value)] of the page's table."""
    text = page.read_text(encoding="utf-8").split("<!-- bench accuracy_counts -->")[1].split("<!-- /bench -->")[0]
    out = []
    for line in text.splitlines():
        cells = [c.strip() for c in line.strip("|").split("|")]
        if len(cells) != 1 + len(LEVELS) or not line.startswith("|") or cells[0] in ("problem", "---"):
            continue
        for level, cell in zip(LEVELS, cells[1:]):
            if cell:
                count, setting = cell.split(", ", 1)
                method, value = setting.rsplit(" ", 1)
                out.append((cells[0], level, int(count), method, float(value)))
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--problems", help="names, by commas")
    parser.add_argument("--write", action="store_true", help="puts the table in its place (bench/pages.py)")
    options = parser.parse_args()
    command = os.environ.get("DYN_CLI", PROJECT / "build/release/bin/dyn")
    results = []
    with tempfile.TemporaryDirectory() as folder:
        for problem in problems.every(command, PROJECT / "models", Path(folder)):
            if not options.problems or problem.name in options.problems.split(","):
                print(problem.name, file=sys.stderr, flush=True)
                results.append((problem, cheapest(problem)))
    text = table(results)
    print(text)
    if options.write:
        pages.write("accuracy_counts", text)


if __name__ == "__main__":
    main()
