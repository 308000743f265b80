#!/usr/bin/env python3
"""Measure libdyn and write its tables into README.md and capi/pages (pages.py), and the plot.

Usage:  report.py [--sections speed,levels,instructions,scaling,python] [--dyn EXE] [--pinocchio EXE ...] [--python PY]
                  [--runs N] [--seconds S] [--json FILE]

  speed         time of every algorithm over that of the fastest build of Pinocchio (compare.py), and its plot (plot.py)
  levels        the same for each instruction set that the library carries, over Pinocchio compiled for it; on aarch64
                instructions under an emulator (aarch64.py); and what lanes bring to a batch (lanes.py)
  instructions  instructions of a call, by single steps (dyn_bench --count), beside time and operations counted from the
                formulas (flops.py)
  scaling       cost per joint on chains of up to 10,000 joints, beside that of moving the same bytes (dyn_stream); derivatives
                of RNEA on chains and trees of up to 1,999 joints: time over the sum of depths
  python        what Python adds to a call, and what a second thread brings to a batch (python_overhead.py)

  --dyn EXE        libdyn's bench program (default build/release/bin/dyn_bench)
  --pinocchio EXE  those made by bench/peers/build_pinocchio.py (default build/peers-bin/pinocchio_bench_*)
  --python PY      Python with Pinocchio, numpy and matplotlib (default build/peers/bin/python)
  --runs, --seconds  interleaved runs and seconds per row of one of them, for speed (default 3, 0.03)
  --json FILE      the figures as well

Takes eight minutes on an idle machine. Under load: chrt -f 50 python3 bench/report.py
"""
import argparse
import json
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import aarch64
import compare
import pages

PROJECT = Path(__file__).resolve().parent.parent
PLOT = PROJECT / "bench/speed.svg"
COMMAND = "python3 bench/peers/build_pinocchio.py && python3 bench/report.py"
NAMES = {"panda": "arm with mimic", "panda_no_mimic": "arm", "go2": "quadruped", "humanoid": "humanoid",
         "chain100": "chain of 100"}
MODELS = ["models/robots/panda.urdf:fixed", "models/robots/go2.urdf:floating", "models/robots/humanoid.urdf:floating",
          "chain:100"]
COUNTED = ["forward_kinematics", "rnea", "aba", "crba", "rnea_derivatives"]
# an instruction set of libdyn (DYN_LEVEL), and the names of Pinocchio's builds for it
LEVELS = [("x86-64-v4", "*-native"), ("x86-64-v3", "*-v3"), ("plain", "*_O3")]
AARCH64, AARCH64_BAR = "aarch64, instructions", 0.55  # geometric mean
LISTED = ["forward_kinematics", "rnea", "aba", "crba", "minv", "rnea_derivatives", "aba_derivatives"]
SHAPES = [("chain of 100", ("chain", "100")), ("chain of 1,000", ("chain", "1000")), ("star of 100", ("star", "100")),
          ("star of 1,000", ("star", "1000")), ("binary tree of 1,000 leaves", ("tree", "1999", "--branching", "2"))]
LENGTHS = [100, 1000, 10000]
RECURSIONS = ["forward_kinematics", "rnea", "aba"]


def die(text):
    sys.exit("report: " + text)


def run(command, what, env=None):
    try:
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True, env=env, timeout=900)
    except (OSError, subprocess.TimeoutExpired) as e:
        raise RuntimeError(f"{what}: {e}")
    if done.returncode:
        raise RuntimeError(f"{what}: exit status {done.returncode}: {done.stderr.strip()[-600:]}")
    return done.stdout


def number(x):
    return f"{x:,.0f}" if x >= 100 else f"{x:.3g}"


def geometric_mean(values):
    return math.exp(statistics.fmean(map(math.log, values))) if values else None


def bar(row):
    return 0.4 if row in ("forward_kinematics", "rnea") else 0.6


def speed(args, tmp):
    out = tmp / "speed.json"
    command = [sys.executable, PROJECT / "bench/compare.py", "--dyn", args.dyn, "--python", args.python, "--models", *MODELS,
               "--runs", args.runs, "--seconds", args.seconds, "--rounds", 2, "--quiet", "--json", out]
    run(command + (["--pinocchio", *args.pinocchio] if args.pinocchio else []), "compare.py")
    report = json.loads(out.read_text())
    models = [n for n in NAMES if n in report["results"]]
    ratios = {row: {n: report["results"][n][row]["ratio"] for n in models} for row in compare.ROWS}
    ratios = {row: r for row, r in ratios.items() if any(r.values())}
    cell = lambda row, x: "" if x is None else f"**{x:.2f}**" if x > bar(row) else f"{x:.2f}"
    lines = [[f"`{row}`"] + [cell(row, r[n]) for n in models] for row, r in ratios.items()]
    means = [geometric_mean([r[n] for r in ratios.values() if r[n]]) for n in models]
    every = geometric_mean([x for r in ratios.values() for x in r.values() if x])
    lines.append(["**geometric mean**"] + [f"{x:.2f}" for x in means])
    sizes = [f"{NAMES[n]} ({report['models'][n]['nq']}/{report['models'][n]['nv']})" for n in models]
    (tmp / "plot.json").write_text(json.dumps({"ratios": ratios, "models": {n: NAMES[n] for n in models}, "mean": every}))
    run([args.python, PROJECT / "bench/plot.py", tmp / "plot.json", PLOT], "plot.py")
    builds = {f"{h['compiler'].strip()} `{h['flags']}`" for n, h in report["programs"].items() if n != "libdyn"}
    fastest = [e["pinocchio_build"] for n in models for e in report["results"][n].values() if e["ratio"]]
    head = report["programs"]["libdyn"]
    version = next(h["version"] for n, h in report["programs"].items() if n != "libdyn")
    above = sum(x > bar(row) for row, r in ratios.items() for x in r.values() if x)
    text = (f"Time of libdyn ({head['compiler']}) through its C interface, over that of the fastest of {len(builds)} builds of "
            f"Pinocchio {version}. The builds are {', '.join(sorted(builds))}. Figures are medians of {report['runs']} "
            f"interleaved runs on an {report['machine']}, {report['date']}. Below 1 libdyn is faster. Sizes are nq/nv. A cell "
            "is empty where Pinocchio has no such algorithm for the model. The bar is 0.6, and 0.4 for FK and RNEA; figures "
            f"above it are bold ({above} of {len(fastest)}). The geometric mean of all is **{every:.2f}**.\n\n![Ratios of "
            f"times](../../{PLOT.relative_to(PROJECT)})\n\n"
            + compare.table(["algorithm"] + sizes, lines))
    summary(version, len(builds), sizes[1:], [line[:1] + line[2:] for line in lines])
    return text, {"report": report, "mean": every}


def summary(version, builds, sizes, lines):
    """README's rows of the table, without the arm with mimic, of which Pinocchio has few algorithms."""
    rows = [f"`{name}`" for name in ("rnea", "aba", "crba", "rnea_derivatives", "aba_derivatives")] + ["**geometric mean**"]
    text = (f"Time of libdyn through its C interface over that of the fastest of {builds} builds of Pinocchio {version}. Below "
            "1 libdyn is faster.\n\n"
            + compare.table(["algorithm"] + sizes, [line for line in lines if line[0] in rows]))
    pages.write("summary", f"{text}\n\n```\n{COMMAND}\n```")


def level(args, tmp, name, builds):
    """Ratios by algorithm and robot, and gains of lanes by robot and algorithm; None if this machine has not the level."""
    env = {**os.environ, "DYN_LEVEL": name, "PYTHONPATH": str(PROJECT / "capi/python"),
           "DYN_LIBRARY": str(args.dyn.resolve().parent.parent / "lib")}
    lanes = json.loads(run([args.python, PROJECT / "bench/lanes.py", "--json"], "lanes.py", env))
    if name not in lanes["build"] and name != "plain":
        return None
    peers = [p for p in args.pinocchio or sorted((PROJECT / "build/peers-bin").glob("pinocchio_bench_*")) if p.match(builds)]
    if not peers:
        raise RuntimeError(f"no build of Pinocchio for {name}")
    out = tmp / f"{name}.json"
    run([sys.executable, PROJECT / "bench/compare.py", "--dyn", args.dyn, "--python", args.python, "--models", *MODELS, "--runs",
         args.runs, "--seconds", args.seconds, "--rounds", 2, "--quiet", "--json", out, "--pinocchio", *peers], "compare.py", env)
    results = json.loads(out.read_text())["results"]
    ratios = {row: {n: e[row]["ratio"] for n, e in results.items() if e[row]["ratio"]} for row in compare.ROWS}
    return {"ratios": {row: r for row, r in ratios.items() if r}, "gains": lanes["gains"]}


def on_aarch64(args, tmp):
    """The column's name, its ratios (none without the programs that it takes), and the sentence about it."""
    if missing := aarch64.missing():
        return {}, f"There is no column of aarch64: this machine has no {' and no '.join(missing)}."
    ratios = aarch64.ratios(MODELS, tmp, args.python, args.dyn.resolve().parent / "dyn")
    mean = geometric_mean([x for r in ratios.values() for x in r.values()])
    return {AARCH64: ratios}, (
        "The column of aarch64 has instructions of a call, counted under qemu-user. They are no times. Pinocchio's are those of the "
        "build that takes fewer, by g++ or clang++ with `-O3` (`bench/peers/build_pinocchio.py --aarch64`). The column's bar is a mean "
        f"of {AARCH64_BAR}; figures above it are bold. The mean is {mean:.2f}{'' if mean <= AARCH64_BAR else ', above the bar'}.")


def levels(args, tmp):
    figures = {name: found for name, builds in LEVELS if (found := level(args, tmp, name, builds))}
    board, said = on_aarch64(args, tmp)
    columns = {**{name: f["ratios"] for name, f in figures.items()}, **board}
    every = {name: [(x, row, n) for row, r in f.items() for n, x in r.items()] for name, f in columns.items()}
    mean = lambda values: f"{geometric_mean(list(values)):.2f}"
    cell = lambda name, x: f"**{x}**" if name == AARCH64 and float(x) > AARCH64_BAR else x
    ratios = [[f"`{row}`"] + [cell(name, mean(f[row].values())) for name, f in columns.items()] for row in LISTED]
    ratios.append(["**all algorithms**"] + [f"**{mean(x for x, _, _ in e)}**" for e in every.values()])
    ratios.append(["largest"] + [f"{x:.2f} (`{row}`, {NAMES[n]})" for x, row, n in map(max, every.values())])
    ratios.append(["above 1"] + [f"{sum(x > 1 for x, _, _ in e)} of {len(e)}" for e in every.values()])
    algorithms = list(next(iter(next(iter(figures.values()))["gains"].values())))
    gains = [[f"`{a}`"] + [", ".join(f"{f['gains'][r][a]:.2f}" for r in f["gains"]) for f in figures.values()]
             for a in algorithms]
    text = ("The library carries a build for each instruction set and takes the best that the processor has "
            "(`DYN_LEVEL` chooses another). Time of libdyn over that of the faster of g++'s and clang++'s build of Pinocchio for "
            "the same instruction set; plain is SSE2. Geometric means over the robots of the table of "
            f"[algorithms](measured_speed.md). {said}\n\n" + compare.table(["algorithm", *columns], ratios)
            + "\n\nHow many times as fast a batch of 1,000 states is on one thread in lanes as one by one (`exact=True`): arm, "
            "quadruped, humanoid. 1.00: it is not done in lanes, because its results take longer to write.\n\n"
            + compare.table(["algorithm", *figures], gains))
    return text, {**figures, **board}


def dyn_bench(args, urdf, base, *more):
    return json.loads(run([args.dyn, urdf, base, "--json", *more], f"dyn_bench on {urdf.stem}"))


def instructions(args, tmp):
    models = [m for m in compare.make_models(MODELS, tmp, args.python, 300) if m.name in NAMES and m.name != "panda"]
    only = ",".join(COUNTED)
    lines, figures = [], {}
    for m in models:
        counted = dyn_bench(args, m.urdf, m.base, "--count", "--only", only)
        count = {r["name"]: r["instructions"] for r in counted["rows"]}
        ns = {r["name"]: r["ns_median"] for r in dyn_bench(args, m.urdf, m.base, "--seconds", "0.2", "--only", only)["rows"]}
        flops = {name: f["mul"] + f["add"] for name, f in json.loads(
            run([args.python, PROJECT / "bench/flops.py", m.urdf, m.base, "--json"], "flops.py")).items()}
        figures[m.name] = {name: {"ns": ns[name], "instructions": count[name], "flops": flops[name]} for name in COUNTED}
        lines += [[NAMES[m.name] if name == COUNTED[0] else "", f"`{name}`", number(ns[name]), number(count[name]),
                   number(flops[name]), number(flops[name] / counted["nv"]), f"{count[name] / flops[name]:.2f}",
                   f"{flops[name] / ns[name]:.1f}"] for name in COUNTED]
    text = (f"Instructions of a call, counted one by one in the timed build ({counted['compiler']}). valgrind would count the "
            "same, but does not know all of its instructions. Operations are the multiplications and additions of the textbook "
            "recursion. `bench/flops.py` counts them by running it on each robot, and compares the result with Pinocchio's. One "
            "four-lane instruction can do eight operations.\n\n"
            + compare.table(["robot", "algorithm", "ns", "instructions", "operations", "per degree of freedom",
                             "instructions per operation", "operations per ns"], lines))
    return text, figures


def depths(urdf):
    """Of each joint that moves: its number of moving joints up to the root, itself included."""
    joints = re.findall(r'<joint name="[^"]*" type="(\w+)">.*?<parent link="([^"]*)"/>.*?<child link="([^"]*)"/>',
                        urdf.read_text(), re.S)
    depth = {}
    for kind, parent, child in joints:
        depth[child] = depth.get(parent, 0) + (kind != "fixed")
    return list(depth.values())


def generated(tmp, shape):
    urdf = tmp / ("_".join(shape).replace("--", "") + ".urdf")
    urdf.write_text(run([sys.executable, compare.GENERATE, *shape], "generate.py"))
    return urdf


def cost_per_joint(args, tmp):
    """{recursion: {"bytes": a joint, "ns": {length: (recursion, its bytes moved)}}}"""
    figures = {}
    for n in LENGTHS:
        urdf = generated(tmp, ("chain", str(n)))
        rows = {r["name"]: r["ns_median"] for r in dyn_bench(args, urdf, "--fixed", "--only", ",".join(RECURSIONS), "--seconds",
                                                             "0.2")["rows"]}
        for r in json.loads(run([args.dyn.parent / "dyn_stream", n], "dyn_stream"))["rows"]:
            f = figures.setdefault(r["name"], {"bytes": r["bytes"], "ns": {}})
            f["ns"][n] = rows[r["name"]] / n, r["ns"] / n
    body = [[f"`{name}`", number(f["bytes"])] + [f"{ns[0]:.1f} ({ns[1]:.1f})" for ns in f["ns"].values()]
            for name, f in figures.items()]
    text = ("Nanoseconds a joint, in a chain. In brackets is the time of reading and writing once the bytes that the recursion "
            "keeps for each joint, without computing (`dyn_stream`). The work is the same for every joint. When all bytes no "
            "longer fit into the core's own cache (2 MB here), moving them takes the time.\n\n"
            + compare.table(["recursion", "bytes a joint"] + [f"{n:,} joints" for n in LENGTHS], body))
    return text, figures


def scaling(args, tmp):
    chains, per_joint = cost_per_joint(args, tmp)
    lines, figures = [], {"per_joint": per_joint}
    for name, shape in SHAPES:
        urdf = generated(tmp, shape)
        pairs = sum(depths(urdf))
        r = dyn_bench(args, urdf, "--fixed", "--only", "rnea,rnea_derivatives", "--seconds", "0.5")
        rnea, ns = (next(x["ns_median"] for x in r["rows"] if x["name"] == row) for row in ("rnea", "rnea_derivatives"))
        figures[name] = {"n": r["nv"], "pairs": pairs, "rnea": rnea, "rnea_derivatives": ns}
        lines.append([name, number(r["nv"]), number(pairs), number(rnea / 1e3), number(ns / 1e3), f"{rnea / r['nv']:.1f}",
                      f"{ns / pairs:.2f}", f"{ns / r['nv'] ** 2:.2f}"])
    text = (chains + "\n\nDerivatives of RNEA (three matrices) grow with n times the mean depth, not with n². n times the mean "
                     "depth is the number of pairs of joints in which one "
            "supports the other. `tests/algorithm/scaling_test.cpp` counts operations instead, without a clock. In a chain of "
            "1,000 joints writing 24 MB takes the time.\n\n"
            + compare.table(["robot", "n", "n times mean depth", "RNEA, µs", "its derivatives, µs", "RNEA, ns / n",
                             "derivatives, ns / (n depth)", "derivatives, ns / n²"], lines))
    return text, figures


def python(args, tmp):
    library = args.dyn.resolve().parent.parent / "lib"
    env = {**os.environ, "PYTHONPATH": str(PROJECT / "capi/python"), "DYN_LIBRARY": str(library)}
    rows = json.loads(run([args.python, PROJECT / "bench/python_overhead.py", "--json"], "python_overhead.py", env))["rows"]
    span = lambda key, digits=1: "{:.{d}f} to {:.{d}f}".format(min(r[key] for r in rows), max(r[key] for r in rows), d=digits)
    body = [["on the data's own arrays: `d.rnea()`", span("held") + " µs"],
            ["on the caller's arrays: `d.rnea(q, v, a)`", span("given") + " µs"],
            ["a batch: `batch.rnea(q, v, a)`, any number of states", span("batch") + " µs"],
            ["a batch of 1,000 states, one thread", span("share", 2) + " %"]]
    gains = [["a batch on two threads is faster",
              f"1,000 states: {span('gain', 2)} times; 10,000 states: {span('gain_large', 2)} times"]]
    text = "The least of many runs counts. Calls are RNEA, ABA, CRBA and the centre of mass's Jacobian, on arm, quadruped and humanoid.\n\n" + compare.table(["call", "Python adds"], body + gains)
    return text, rows


SECTIONS = {"speed": speed, "levels": levels, "instructions": instructions, "scaling": scaling, "python": python}


def write(section, text):
    """The section's table, and the command that makes it."""
    only = "" if section == "speed" else f" --sections {section}"
    pages.write(section, f"{text}\n\n```\n{COMMAND}{only}\n```")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--sections", default=",".join(SECTIONS))
    p.add_argument("--dyn", type=Path, default=PROJECT / "build/release/bin/dyn_bench")
    p.add_argument("--pinocchio", nargs="+", type=Path)
    p.add_argument("--python", type=Path, default=PROJECT / "build/peers/bin/python")
    p.add_argument("--runs", type=int, default=3)
    p.add_argument("--seconds", type=float, default=0.03)
    p.add_argument("--json", type=Path)
    args = p.parse_args()
    sections = args.sections.split(",")
    if unknown := [s for s in sections if s not in SECTIONS]:
        die(f"unknown sections: {', '.join(unknown)} (known: {', '.join(SECTIONS)})")
    if args.runs < 1 or not args.seconds > 0:
        die("--runs and --seconds must be positive")
    if not os.access(args.dyn, os.X_OK):
        die(f"{args.dyn} is missing: build it (tools/run does), or give --dyn")
    if not os.access(args.python, os.X_OK):
        die(f"{args.python} is missing: run bench/peers/build_pinocchio.py first, or give --python")
    figures, failed = {}, False
    with tempfile.TemporaryDirectory(prefix="dyn-report-") as d:
        for section in sections:
            print(f"report: {section}", file=sys.stderr, flush=True)
            try:
                text, figures[section] = SECTIONS[section](args, Path(d))
                write(section, text)
                print(text + "\n", flush=True)
            except RuntimeError as e:
                print(f"report: {section} is left as it was: {e}", file=sys.stderr)
                failed = True
    if args.json:
        args.json.write_text(json.dumps(figures, indent=1) + "\n")
    sys.exit(failed)


if __name__ == "__main__":
    main()
