"""Instructions of libdyn's calls over Pinocchio's on aarch64, under qemu-user: report.py's column of measured_levels.md.

Both are cross-compiled: libdyn as tools/boards compiles it for its worst cases (build/aarch64_release), Pinocchio by
bench/peers/build_pinocchio.py --aarch64. A robot reaches libdyn as a .dynb.
"""
import shutil
import subprocess
from pathlib import Path

import compare

PROJECT = Path(__file__).resolve().parent.parent
BUILD = PROJECT / "build/aarch64_release"
EMULATOR = ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"]


def peers():
    return sorted((PROJECT / "build/peers-bin/aarch64").glob("pinocchio_bench_*"))


def missing():
    """What this machine lacks."""
    lacks = [p for p in ("qemu-aarch64", "aarch64-linux-gnu-g++") if not shutil.which(p)]
    return lacks if peers() else [*lacks, "Pinocchio for aarch64 (`bench/peers/build_pinocchio.py --aarch64`)"]


def run(command, what):
    return compare.call(command, 3600, what)


def libdyn():
    """Its bench program for aarch64, and the emulator's command with the plugin that counts."""
    generator = [] if (BUILD / "CMakeCache.txt").is_file() else ["-G", "Ninja"]
    run(["cmake", *generator, "-S", PROJECT, "-B", BUILD, "-DCMAKE_BUILD_TYPE=Release", "-DDYN_CORE_ONLY=ON", "-DDYN_TESTS=ON",
         "-DDYN_TOGETHER=ON", "-DDYN_BOARD_TESTS=", f"-DCMAKE_TOOLCHAIN_FILE={PROJECT}/tools/cmake/toolchains/aarch64.cmake"], "cmake for aarch64")
    run(["cmake", "--build", BUILD, "--target", "dyn_bench", "--parallel", "2"], "libdyn for aarch64")
    plugin = BUILD / "instructions.so"
    run(["cc", "-shared", "-fPIC", "-O2", PROJECT / "tests/boards/linux/instructions.c", "-o", plugin], "the plugin")
    return BUILD / "bin/dyn_bench", [*EMULATOR, "-plugin", plugin]


def ratios(specs, tmp, python, dyn):
    """{row: {model: instructions of libdyn over those of the build of Pinocchio with the fewest}}; dyn is this PC's command."""
    program, counted = libdyn()
    found = {row: {} for row in compare.ROWS}
    for m in compare.make_models(specs, tmp, python, 300):
        image = tmp / f"{m.name}.dynb"
        run([dyn, "convert", m.urdf, m.base, image], f"dyn convert of {m.name}")
        count = lambda command, what: compare.parse(run(counted + command, what), what, "instructions")[1]
        ours = count([program, image, m.last, *compare.ROWS], f"libdyn on {m.name}")
        theirs = [count([p, m.dump, "--count"], f"{p.name} on {m.name}") for p in peers()]
        for row in compare.ROWS:
            least = min((t[row][0] for t in theirs if t[row]), default=None)
            if ours[row] and least:
                found[row][m.name] = ours[row][0] / least
    return {row: r for row, r in found.items() if r}
