#!/usr/bin/env python3
"""Compare distance and contact queries with Coal, MuJoCo and libccd in one run, and write the tables (pages.py).

Usage:  collision.py [--python PY] [--library FILE] [--out DIR] [--adversarial N] [--json FILE] [--pair PART]

  --python PY       Python with the wheels coal (with headers) and mujoco; both are installed into it when missing (default
                    build/peers/bin/python)
  --library FILE    archive to link (default build/release/lib/libdyn_internal*.a, of the best level)
  --out DIR         where the program goes (default build/peers-bin)
  --adversarial N   poses of each adversarial kind and pair (default 60)
  --pair PART       pairs whose name holds PART alone; the table is left as it is
  --json FILE       the figures as well

The program (bench/peers/collision) is built with g++ -O3 -march=native; libccd is the system's (libccd-dev). Under load:
chrt -f 50 python3 bench/collision.py
"""
import argparse
import datetime
import json
import math
import os
import statistics
import subprocess
import sys
from pathlib import Path

import compare
import pages

PROJECT = Path(__file__).resolve().parent.parent
SOURCES = sorted((PROJECT / "bench/peers/collision").glob("*.cpp"))
PEERS = ["Coal", "MuJoCo"]
CLASSES = ["apart", "near", "penetrating"]
CONTACTS = [*CLASSES, "at rest"]


def die(text):
    sys.exit("collision: " + text)


def run(command, what):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        die(f"{what}: exit status {done.returncode}: {done.stderr.strip()[-2000:]}")
    return done.stdout


def packages(python):
    """Where the wheels are, and their versions."""
    probe = ("import importlib.metadata as m, mujoco, pathlib; p = pathlib.Path(mujoco.__file__).parent; "
             "print(p, next(p.glob('libmujoco.so*')), p.parent / 'cmeel.prefix', m.version('coal'), m.version('mujoco'))")
    if subprocess.run([python, "-c", "import coal, mujoco"], capture_output=True).returncode:
        run([python, "-m", "pip", "install", "--quiet", "coal", "mujoco"], "pip install coal mujoco")
    return run([python, "-c", probe], "coal and mujoco").split()


def build(args, mujoco, library, coal):
    program = args.out / "collision_bench"
    args.out.mkdir(parents=True, exist_ok=True)
    flags = ["-O3", "-march=native", "-std=c++20", "-ffp-contract=fast", "-fno-math-errno", "-fno-trapping-math", "-Wno-psabi"]
    folders = [PROJECT / "tests", PROJECT / "bench/collision", PROJECT / "include", PROJECT / "src", PROJECT / "capi",
               args.library.parent.parent / "tables"]  # those that the build makes
    system = ["/usr/include/eigen3", f"{coal}/include", f"{mujoco}/include"]
    libraries = [args.library, f"-L{coal}/lib", "-lcoal", f"-Wl,-rpath,{coal}/lib", library, f"-Wl,-rpath,{mujoco}", "-lccd",
                 "-lurdfdom_model", "-ltinyxml2", "-lconsole_bridge"]
    run([os.environ.get("GXX", "g++"), *flags, *(f"-I{f}" for f in folders), *(x for f in system for x in ("-isystem", f)),
         *SOURCES, *libraries, "-o", program], "building")
    return program


def bold(ratio):
    return f"**{ratio:.2f}**" if ratio > 0.8 else f"{ratio:.2f}"


def contact_table(rows):
    at = {(r["pair"], r["poses"]): r for r in rows if r["poses"].startswith("contacts ")}
    lines, ratios = [], []
    for pair in dict.fromkeys(p for p, _ in at):
        cells = [pair.replace("_", " ")]
        for c in CONTACTS:
            r = at[pair, "contacts " + c]
            ratios.append(r["libdyn"]["ns"] / min(r[p]["ns"] for p in PEERS if p in r))
            cells += [f"{r['libdyn']['ns']:.0f}", *(f"{r[p]['ns']:.0f}" if p in r else "" for p in PEERS), bold(ratios[-1])]
        lines.append(cells)
    return compare.table(["pair"] + [f"{c}: {n}" for c in CONTACTS for n in ["libdyn", *PEERS, "ratio"]], lines), ratios


def mean_of(ratios):
    return math.exp(statistics.fmean(map(math.log, ratios))) if ratios else math.nan


def mesh_table(rows):
    at = {(r["pair"], r["poses"]): r for r in rows if "triangles" in r["pair"]}
    lines = []
    for pair in dict.fromkeys(p for p, _ in at):
        cells = [pair.replace("_", " ")]
        for c in CLASSES:
            ns = [at[pair, c][e]["ns"] for e in ("libdyn", "Coal") if e in at[pair, c]]
            cells += [*(f"{t / 1e3:.1f}" for t in ns), bold(ns[0] / ns[1])] if ns else ["", "", ""]
        worst = [max(at[pair, c][e]["error"] for c in CLASSES[:2]) for e in ("libdyn", "Coal")]
        lines.append([*cells, *(f"{w:.0e}" for w in worst)])
    return compare.table(["pair", *(f"{c}: {n}" for c in CLASSES for n in ["libdyn", "Coal", "ratio"]), "libdyn: error",
                          "Coal: error"], lines)


def tables(rows):
    pairs = list(dict.fromkeys(r["pair"] for r in rows if "triangles" not in r["pair"]))
    at = {(r["pair"], r["poses"]): r for r in rows}
    times, errors, ratios = [], [], []
    for pair in pairs:
        cells = []
        for c in CLASSES:
            r = at[pair, c]
            peers = [r[p]["ns"] for p in PEERS if p in r]
            ratio = r["libdyn"]["ns"] / min(peers)
            ratios.append(ratio)
            cells += [f"{r['libdyn']['ns']:.0f}", *(f"{r[p]['ns']:.0f}" if p in r else "" for p in PEERS), bold(ratio)]
        times.append([pair.replace("_", " "), *cells])
        plain = lambda e: max((at[pair, c][e]["error"] for c in CLASSES if e in at[pair, c]), default=None)
        hard = at.get((pair, "adversarial"), {})
        wrong = lambda e: f"{hard[e]['wrong']} of {hard[e]['asked']}" if e in hard else ""
        errors.append([pair.replace("_", " "), *("" if plain(e) is None else f"{plain(e):.0e}" for e in ["libdyn", *PEERS]),
                       *(wrong(e) for e in ["libdyn", *PEERS, "libccd"])])
    head = ["pair"] + [f"{c}: {n}" for c in CLASSES for n in ["libdyn", *PEERS, "ratio"]]
    sums = [sum(r[e]["wrong"] for r in rows if r["poses"] == "adversarial" and e in r) for e in ["libdyn", *PEERS, "libccd"]]
    errors.append(["**all**", "", "", "", *(f"**{s}**" for s in sums)])
    return (compare.table(head, times),
            compare.table(["pair", *(f"{e}: error" for e in ["libdyn", *PEERS]),
                           *(f"{e}: wrong" for e in ["libdyn", *PEERS, "libccd"])], errors), ratios)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--python", type=Path, default=PROJECT / "build/peers/bin/python")
    p.add_argument("--library", type=Path)
    p.add_argument("--out", type=Path, default=PROJECT / "build/peers-bin")
    p.add_argument("--adversarial", type=int, default=60)
    p.add_argument("--pair", default="")
    p.add_argument("--json", type=Path)
    args = p.parse_args()
    found = sorted((PROJECT / "build/release/lib").glob("libdyn_internal*.a"))
    args.library = (args.library
                    or (found[-1] if found else die("no libdyn_internal*.a in build/release/lib: build the tests (tools/test does), or give "
                                                    "--library")))
    if not os.access(args.python, os.X_OK):
        die(f"{args.python} is missing: run bench/peers/build_pinocchio.py first, or give --python")
    mujoco, library, coal, coal_version, mujoco_version = packages(args.python)
    program = build(args, mujoco, library, coal)
    rows = [json.loads(line) for line in run([program, "--adversarial", args.adversarial, *([args.pair] if args.pair else [])],
                                             "collision_bench").splitlines()]
    times, errors, ratios = tables(rows)
    contacts, contact_ratios = contact_table(rows)
    text = (f"Nanoseconds of a distance query, beside Coal {coal_version} and MuJoCo {mujoco_version} (`mj_geomDistance`). "
            "Batches have 1,000 poses. The least of nine and more interleaved passes counts. Shapes of about 1 m are apart, "
            "have a gap of 1 mm, or overlap by 5 cm. The peers have their default tolerances of 1e-6, libdyn 1e-10. The "
            f"machine is an {compare.cpu_name()}, the date {datetime.date.today()}. The ratio is to the faster of the two "
            f"peers; above 0.8 it is bold ({sum(r > 0.8 for r in ratios)} of {len(ratios)}). Geometric mean "
            f"**{mean_of(ratios):.2f}**.\n\n{times}\n\nNanoseconds of a query of contact points without margin, on the same poses "
            "and on shapes at rest on each other. Coal: `ComputeCollision`, up to 8 contacts; MuJoCo: the function of the pair that its "
            f"steps call. Above 0.8: {sum(r > 0.8 for r in contact_ratios)} of {len(contact_ratios)}. Geometric mean "
            f"**{mean_of(contact_ratios):.2f}**.\n\n{contacts}\n\n`error` is the largest on these poses, relative to the size of the smaller "
            "shape. (MuJoCo keeps the vertices of meshes in single precision.) `wrong` counts results off by more than 1e-3 of that "
            "size on adversarial poses: touching, nearly touching, aligned, coincident, sizes 10^3 to 10^6 apart, 1e-4 thin, 1 "
            "km away, deep. The truth is libdyn at 1e-15, its depths checked by brute force over all directions. libccd (MPR) "
            "has depths alone, and not the least ones.\n\n"
            + errors + "\n\nMicroseconds of a distance query of a triangle mesh, a ring, beside Coal's (`BVHModel<OBBRSS>`), at "
                       "most 200 poses each. Poses are apart by 0.1 m and "
            "more, near by up to 5 cm, or overlap by up to 5 cm. Coal computes another quantity for overlaps. MuJoCo is left "
            "out: it takes the hull.\n\n" + mesh_table(rows))
    if args.json:
        args.json.write_text(json.dumps(rows, indent=1) + "\n")
    if not args.pair:
        pages.write("collision", f"{text}\n\n```\npython3 bench/collision.py\n```")
    print(text)


if __name__ == "__main__":
    main()
