#!/usr/bin/env python3
"""Error bars (dyn_data_error_bar) beside the errors, on scenes drawn from seeds: chains, falling chains and bodies.

    python bench/error_bars.py [--scenes 100] [--first 0] [--write]

capi/python/tests/error_scenes.py draws the scenes. The error is the distance from steps for an accuracy of 1e-6.

--write  puts the table in its place (pages.py)
"""

import argparse
import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
if (ROOT / "build/release/lib").is_dir():
    os.environ.setdefault("DYN_LIBRARY", str(ROOT / "build/release/lib"))
sys.path[:0] = [str(ROOT / "capi/python"), str(ROOT / "capi/python/tests")]
import error_scenes as scenes  # noqa: E402
import numpy as np  # noqa: E402
import pages  # noqa: E402

ROUNDING = 1e-10  # smaller errors are not compared


def row(name, runs):
    known = [x for x in runs if not x.bar.lost and x.error > ROUNDING]
    held = np.mean([x.error <= x.bar.q for x in known])
    ratios = np.array([x.bar.q / x.error for x in known])
    return (f"| {name} | {len(runs)} | {100 * held:.1f} % | {np.median(ratios):.1f} | {np.quantile(ratios, 0.95):.0f} | "
            f"{np.max(1 / ratios):.1f} | {sum(x.bar.lost for x in runs)} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    runs = [x for x in map(scenes.run, range(options.first, options.first + options.scenes)) if x]
    smooth, contact = ([x for x in runs if (x.kind == "chain") == c] for c in (True, False))
    lines = [f"{options.scenes} scenes were drawn. Of {len(runs)} the error is known to a fiftieth.", "",
             "| scenes | number | error below the bar | bar over error: median | 95 % | error over bar: largest | lost |",
             "|---|---:|---:|---:|---:|---:|---:|", row("without contact", smooth), row("with contact", contact)]
    lines += [row(f"with contact, {name.replace('_', ' ')}", [x for x in contact if x.method == name]) for name in scenes.METHODS]
    text = "\n".join([*lines, row("**all**", runs)])
    print(text)
    if options.write:
        pages.write("error_bars", text)


if __name__ == "__main__":
    main()
