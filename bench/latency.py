#!/usr/bin/env python3
"""The longest times of calls, beside MuJoCo's and Pinocchio's: p50, p99, p99.9, p99.99 and maximum.

    python bench/latency.py [--dyn build/release/bin/dyn_latency] [--calls 1000000]

Needs the packages mujoco and pin and a C++ compiler. Each program runs alone, one call after another, on inputs that change from
call to call. The last columns say as much about the machine as about the library: the system takes the processor away from all of
them.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import mujoco
import pinocchio

BENCH = Path(__file__).resolve().parent
sys.path[:0] = [str(BENCH / "peers"), str(BENCH)]
from build_pinocchio import DEFINES  # noqa: E402
from resting import SCENES, text_of  # noqa: E402

MODELS = BENCH.parent / "models/robots"
SCENE = """<mujoco><worldbody><geom type="plane" size="5 5 1"/>{}</worldbody></mujoco>""".format("".join(
    f'<body pos="{0.11 * (k % 2)} 0 {0.06 + 0.1 * (k // 2)}"><freejoint/><geom type="box" size=".05 .05 .05"/></body>'
    for k in range(8)))  # fmt: skip


HEAPS = {"boxes": "125 boxes", "capsules": "125 capsules", "rocks": "64 rocks", "wall30": "wall of 30 boxes",
         "wall100": "wall of 100 boxes"}


def build(source, folder, *options):
    program = folder / source.removesuffix(".cpp")
    subprocess.run([str(c) for c in ("g++", "-O2", "-std=c++20", BENCH / "latency" / source, *options, "-o", program)],
                   check=True)
    return program


def run(program, calls, *files):
    out = subprocess.run([str(program), str(calls), *map(str, files)], check=True, capture_output=True, text=True).stdout
    return {line.split("\t")[0]: line.split("\t")[1:] for line in out.splitlines()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--dyn", type=Path, default=BENCH.parent / "build/release/bin/dyn_latency")
    parser.add_argument("--calls", type=int, default=1000000)
    options = parser.parse_args()
    urdfs = [MODELS / "panda.urdf", MODELS / "go2.urdf"]
    package, prefix = Path(mujoco.__file__).parent, Path(pinocchio.__file__).parents[4]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scene.xml").write_text(SCENE)
        scenes = [folder / "scene.xml"]
        for name, title in HEAPS.items():
            scenes.append(folder / f"{title}.xml")
            scenes[-1].write_text(text_of(SCENES[name][0](), 0.002))
        xmls = []
        for urdf, base in zip(urdfs, ("--fixed", "--floating")):
            xmls.append(folder / f"{urdf.stem}.xml")
            subprocess.run([str(options.dyn.parent / "dyn"), "convert", str(urdf), base, str(xmls[-1])], check=True,
                           capture_output=True)
        ours = run(options.dyn, options.calls, *urdfs, *scenes)
        theirs = run(build("mujoco.cpp", folder, f"-I{package}/include", next(package.glob("libmujoco.so*")),
                           f"-Wl,-rpath,{package}"), options.calls, *xmls, *scenes)
        pin = run(build("pinocchio.cpp", folder, f"-I{prefix}/include", "-I/usr/include/eigen3", *DEFINES, f"-L{prefix}/lib",
                        "-lpinocchio_default", "-lpinocchio_parsers", f"-Wl,-rpath,{prefix}/lib"), options.calls,
                        *urdfs)  # fmt: skip
    print(f"Microseconds: p50, p99, p99.9, p99.99, maximum of {options.calls:,} calls (MuJoCo {mujoco.__version__}, Pinocchio "
          f"{pinocchio.__version__}); a tenth as many steps in contact, a hundredth of heaps, from their fall on.\n")
    print("| call | libdyn | MuJoCo | Pinocchio |\n|---|---|---|---|")
    for call in ours:
        print("| " + " | ".join([call, *(", ".join(side[call]) if call in side else "" for side in (ours, theirs, pin))]) + " |")


if __name__ == "__main__":
    main()
