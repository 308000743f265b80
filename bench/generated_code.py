#!/usr/bin/env python3
"""Times libdyn beside C code that CasADi generates for the robot.

Usage:  generated_code.py [--dyn DIR] [--robots a,b,c] [--rounds N] [--keep DIR] [--write]

  --dyn DIR     build with bin and lib (default build/release)
  --robots      of the robots below (default all)
  --rounds N    rounds of the timing; a time is the median over them (default 41)
  --keep DIR    folder for generated and compiled code; what is compiled there is not compiled again
  --write       puts the table in its place (pages.py)

Needs casadi, and example-robot-data for two of the robots. The functions are written for CasADi as its users write them by hand:
the forms of generated_functions.py. Results are the entries that are not zero by structure, of symmetric matrices those of one
triangle. Checks for missing arguments are taken out of CasADi's C. gcc and clang compile it with -O3 -march=native (clang with
-ffp-contract=fast, as gcc has it). The faster counts. Every result is compared with libdyn's before it is timed
(generated/time.cpp).
"""
import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

import pages
from compare import call, cpu_name, table
from report import geometric_mean

PROJECT = Path(__file__).resolve().parent.parent
COMMAND = "python3 bench/generated_code.py --write"
ALGORITHMS = ["rnea", "aba", "crba", "rnea_derivatives", "aba_derivatives"]
COMPILERS = {"gcc": ["gcc", "-O3", "-march=native"], "clang": ["clang", "-O3", "-march=native", "-ffp-contract=fast"]}
BAR, LARGEST = 0.95, 1.25  # of the geometric mean, of each
TOLERANCE = 1e-12  # of a result, relative to the largest entry


def example(path):
    """A file of example-robot-data, or None."""
    for folder in sys.path:
        if (found := Path(folder) / "cmeel.prefix/share/example-robot-data/robots" / path).is_file():
            return found
    return None


def robots(tmp):
    """{name: (URDF, base)}"""
    arm = tmp / "arm.urdf"
    text = re.sub(r"<mimic\b[^>]*/>", "", (PROJECT / "models/robots/panda.urdf").read_text())
    arm.write_text(text.replace('type="prismatic"', 'type="fixed"'))  # the gripper's fingers
    chain = tmp / "chain.urdf"
    chain.write_text(subprocess.run([sys.executable, PROJECT / "models/generate.py", "chain", "12"], capture_output=True, text=True,
                                    check=True).stdout)
    found = {"arm of 7": (arm, "fixed"), "UR5": (example("ur_description/urdf/ur5_robot.urdf"), "fixed"),
             "solo12": (example("solo_description/robots/solo12.urdf"), "floating"),
             "go2": (PROJECT / "models/robots/go2.urdf", "floating"),
             "humanoid": (PROJECT / "models/robots/humanoid.urdf", "floating"), "chain of 12": (chain, "fixed")}
    return {name: robot for name, robot in found.items() if robot[0]}


def c_source(f):
    """CasADi's C without its checks for missing arguments."""
    import casadi
    generator = casadi.CodeGenerator(f"{f.name()}.c")
    generator.add(f)
    text = re.sub(r"if \(res\[\d+\]!=0\) ", "", generator.dump())
    return re.sub(r"arg\[(\d+)\]\? arg\[\1\]\[(\d+)\] : 0", r"arg[\1][\2]", text)


def compile_all(model, folder, compilers):
    """FOLDER/ALGORITHM_COMPILER.so"""
    from generated_functions import function
    for algorithm in ALGORITHMS:
        objects = {c: folder / f"{algorithm}_{c}.so" for c in compilers}
        if all(o.is_file() for o in objects.values()):
            continue
        source = folder / f"{algorithm}.c"
        source.write_text(c_source(function(model, algorithm)))
        for c, target in objects.items():
            call([*COMPILERS[c], "-w", "-shared", "-fPIC", source, "-o", target, "-lm"], 3600, f"{c} on {source}")


def timing_program(build, folder):
    program = folder / "time"
    call(["c++", "-std=c++20", "-O2", "-I", PROJECT / "include", PROJECT / "bench/generated/time.cpp", PROJECT / "bench/rows.cpp",
          f"-L{build}/lib", f"-Wl,-rpath,{build}/lib", "-ldyn", "-ldl", "-o", program], 600, "the timing program")
    return program


def rounding(model):
    """What rounding can change of M^-1 times something, relative."""
    import numpy as np
    return model.nv * np.finfo(float).eps * np.linalg.cond(model.data().crba(model.random(0)))


def measure(args, folder):
    """{robot: {algorithm: {"libdyn": ns, compiler: ns}}}"""
    import libdyn as dyn
    compilers = [c for c, command in COMPILERS.items() if shutil.which(command[0])]
    if not compilers:
        sys.exit("generated_code: neither gcc nor clang is there")
    program, figures = timing_program(args.dyn.resolve(), folder), {}
    for name, (urdf, base) in robots(folder).items():
        if args.robots and name not in args.robots.split(","):
            continue
        print(f"generated_code: {name}", file=sys.stderr, flush=True)
        own = folder / name.replace(" ", "_")
        own.mkdir(exist_ok=True)
        model = dyn.load(urdf, base, meshes="none")
        compile_all(model, own, compilers)
        command = [program, urdf, f"--{base}", args.rounds, own, *compilers, "--", *ALGORITHMS]
        found = json.loads(call(command, 600, f"time on {name}"))
        for algorithm, f in found.items():
            tolerance = max(TOLERANCE, rounding(model)) if algorithm.startswith("aba") else TOLERANCE
            if not (difference := f.pop("difference")) < tolerance:
                sys.exit(f"generated_code: {algorithm} of {name} differs by {difference:g}, more than {tolerance:g}")
        figures[name] = found
    return figures


def page(figures):
    ratios = {name: {a: f["libdyn"] / min(ns for c, ns in f.items() if c != "libdyn") for a, f in found.items()}
              for name, found in figures.items()}
    bold = lambda x, bar: f"**{x:.2f}**" if x > bar else f"{x:.2f}"
    mean = lambda values: bold(geometric_mean(list(values)), BAR)
    lines = [[f"`{a}`"] + [bold(r[a], LARGEST) for r in ratios.values()] + [mean(r[a] for r in ratios.values())] for a in ALGORITHMS]
    every = [x for r in ratios.values() for x in r.values()]
    lines.append(["geometric mean"] + [mean(r.values()) for r in ratios.values()] + [mean(every)])
    return (f"Time of libdyn's C call over that of C code that CasADi generates for the one robot, on an {cpu_name()}. Below 1 libdyn "
            "is faster. gcc and clang compile the code with `-O3 -march=native`; the faster counts. The code knows the robot's "
            "numbers, so zeros and ones cost nothing. It writes only entries that are not zero by structure. The bar is a mean of "
            f"{BAR}, with no figure above {LARGEST}. Figures above it are bold: {sum(x > LARGEST for x in every)} of {len(every)}, and "
            "means above theirs.\n\n"
            + table(["algorithm", *figures, "geometric mean"], lines) + f"\n\n```\n{COMMAND}\n```")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--dyn", type=Path, default=PROJECT / "build/release")
    p.add_argument("--robots")
    p.add_argument("--rounds", type=int, default=41)
    p.add_argument("--keep", type=Path)
    p.add_argument("--write", action="store_true")
    args = p.parse_args()
    warnings.simplefilter("ignore")  # of elements that libdyn does not use
    sys.path.insert(0, str(PROJECT / "capi/python"))
    os.environ.setdefault("DYN_LIBRARY", str(args.dyn.resolve() / "lib"))
    with tempfile.TemporaryDirectory(prefix="dyn-generated-") as d:
        folder = args.keep or Path(d)
        folder.mkdir(parents=True, exist_ok=True)
        figures = measure(args, folder)
    text = page(figures)
    print(json.dumps(figures), text, sep="\n")
    if args.write:
        pages.write("generated", text)


if __name__ == "__main__":
    main()
