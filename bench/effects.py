#!/usr/bin/env python3
"""Instructions of a step, scene by scene, beside MuJoCo's of the same files: what is absent, far or switched off should take
none.

    python bench/effects.py [--count build/release/bin/dyn_count_steps] [--write]

Needs the package mujoco and a C++ compiler. Instructions are counted one by one (ptrace) in the sixth step from the start. Prints
the table; --write puts it in its place (pages.py).
"""

import argparse
import subprocess
import tempfile
from pathlib import Path

import mujoco
import pages

BENCH = Path(__file__).resolve().parent


def mujoco_counts(files, folder):
    package = Path(mujoco.__file__).parent
    library = next(package.glob("libmujoco.so*"))
    program = folder / "count_mujoco"
    command = ["g++", "-O2", "-std=c++20", f"-I{package}/include", f"-I{BENCH}", BENCH / "effects/count_mujoco.cpp",
               BENCH / "count.cpp", library, f"-Wl,-rpath,{package}", "-o", program]
    subprocess.run([str(c) for c in command], check=True)
    out = subprocess.run([str(program), *map(str, files)], check=True, capture_output=True, text=True).stdout
    return [int(line) for line in out.split()]


def table(count):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        out = subprocess.run([str(count), str(folder)], check=True, capture_output=True, text=True).stdout
        rows = [line.split("\t") for line in out.splitlines()]
        theirs = mujoco_counts([folder / f"{k}.xml" for k in range(len(rows))], folder)
    lines = ["| scene | libdyn | forward dynamics and integration alone | MuJoCo | ratio |", "|---|---|---|---|---|"]
    for (scene, step, bare), other in zip(rows, theirs):
        lines.append(f"| {scene} | {int(step):,} | {int(bare):,} | {other:,} | {int(step) / other:.2f} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=Path, default=BENCH.parent / "build/release/bin/dyn_count_steps")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    text = f"Instructions of a step (`python bench/effects.py`; MuJoCo {mujoco.__version__} with its options as they are by default).\n\n{table(options.count)}\n"
    print(text)
    if options.write:
        pages.write("effects", text)


if __name__ == "__main__":
    main()
