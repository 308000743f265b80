#!/usr/bin/env python3
"""Time libdyn and Pinocchio on the same models in one go and print the ratios.

Usage:  compare.py [--dyn EXE] [--pinocchio EXE ...] [--python PY] [--models SPEC ...]
                   [--runs N] [--seconds S] [--rounds R] [--rows a,b,c] [--peers-only]
                   [--markdown FILE] [--json FILE] [--quiet] [--timeout S]

  --dyn EXE        libdyn's bench program (default build/release/bin/dyn_bench), called as
                     EXE MODEL.urdf --fixed|--floating --json --joint NAME --seconds S --rounds R
                   It prints, as JSON, {"library","version","compiler","flags","model","nq","nv",
                   "rows":[{"name","ns_median","ns_min"}]}; null for rows it does not have.
  --pinocchio EXE  executables made by bench/peers/build_pinocchio.py
                   (default build/peers-bin/pinocchio_bench_*)
  --python PY      Python that has Pinocchio, to parse the URDFs (default build/peers/bin/python)
  --models SPEC    PATH.urdf[:fixed|:floating], or chain:N (made by models/generate.py). Default:
                   models/robots/{panda,go2,humanoid}.urdf, chain:12 chain:100 chain:1000. A URDF
                   with mimic joints is measured twice: as it is (Pinocchio has no ABA, Cholesky,
                   ... for mimic joints) and with the mimic tags removed, for both libraries.
  --runs N         interleaved runs of every program on every model (default 5)
  --seconds S      time per row of one run of a program (default 0.1), in R rounds over all rows
  --rounds R       (default 3)
  --rows a,b,c     only these rows
  --peers-only     only Pinocchio; prints times instead of ratios

Method: for each model the programs run one after the other, N times, in alternating direction
(A B C ... C B A ...), so that a drift of the machine's speed hits all alike. Per row the fastest
Pinocchio build, by the median over the runs, is the one compared; where Pinocchio offers variants
(ABA and CRBA in two conventions, centre of mass with or without the subtrees') the fastest counts.
The ratio is the median over the runs of libdyn's time over that build's time in the same run:
below 1, libdyn is faster.
"""
import argparse
import glob
import json
import math
import os
import platform
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent
DUMP = PROJECT / "bench/peers/dump_model.py"
GENERATE = PROJECT / "models/generate.py"
ROWS = ["forward_kinematics", "forward_kinematics_q_v", "forward_kinematics_q_v_a", "joint_jacobians",
        "joint_jacobians_time_variation", "frame_jacobian", "com", "com_qva", "jcom",
        "rnea", "nle", "gravity_torque", "static_torque", "coriolis_matrix", "aba", "crba", "cholesky", "cholesky_solve",
        "minv", "all_terms", "kinetic_energy", "potential_energy",
        "rnea_derivatives", "aba_derivatives", "gravity_torque_derivatives", "static_torque_derivatives",
        "vcom_derivatives", "frame_velocity_derivatives", "frame_acceleration_derivatives",
        "frame_kinematic_hessian", "rnea_second_order_derivatives", "rnea_second_order_product",
        "centroidal_map", "centroidal_map_time_variation", "centroidal_momentum", "centroidal_momentum_time_variation",
        "centroidal_derivatives", "joint_body_regressor", "joint_torque_regressor", "static_regressor",
        "kinetic_energy_regressor", "potential_energy_regressor",
        "integrate", "difference", "interpolate", "configuration_distance", "integrate_jacobians",
        "difference_jacobians",
        "constrained_dynamics", "constrained_dynamics_derivatives", "delassus"]
VARIANTS = {"aba": ["aba", "aba_local", "aba_world"], "crba": ["crba", "crba_local", "crba_world"],
            "com": ["com", "com_subtrees"], "jcom": ["jcom", "jcom_subtrees"],
            "frame_velocity_derivatives": ["frame_velocity_derivatives", "frame_velocity_derivatives_dj"],
            "delassus": ["delassus", "delassus_cholesky", "delassus_efpa"]}
DEFAULT_MODELS = ["models/robots/panda.urdf:fixed", "models/robots/go2.urdf:floating",
                  "models/robots/humanoid.urdf:floating", "chain:12", "chain:100", "chain:1000"]


def die(text):
    sys.exit("compare: " + text)


def call(command, timeout, what):
    try:
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True,
                              timeout=timeout)
    except subprocess.TimeoutExpired:
        raise RuntimeError(f"{what}: no end after {timeout:g} s")
    except OSError as e:
        raise RuntimeError(f"{what}: {e}")
    if done.returncode:
        raise RuntimeError(f"{what}: exit status {done.returncode}: {done.stderr.strip()[-500:]}")
    return done.stdout


class Model:
    def __init__(self, name, urdf, base):
        self.name, self.urdf, self.base = name, urdf, base
        self.dump = self.last = None  # the dump, and the name of its last joint


def make_models(specs, tmp, python, timeout):
    models = []
    for spec in specs:
        if m := re.fullmatch(r"chain[: ]?(\d+)", spec):
            if not GENERATE.is_file():
                die(f"{GENERATE} is missing, needed for {spec}")
            urdf = tmp / f"chain{m[1]}.urdf"
            urdf.write_text(call([sys.executable, GENERATE, "chain", m[1]], timeout, spec))
            models.append(Model(f"chain{m[1]}", urdf, "--fixed"))
            continue
        path, _, base = spec.rpartition(":") if re.search(r":(fixed|floating)$", spec) \
            else (spec, "", "fixed")
        urdf = Path(path)
        if not urdf.is_absolute() and not urdf.is_file():
            urdf = PROJECT / path
        if not urdf.is_file():
            die(f"no such model: {path}")
        models.append(Model(urdf.stem, urdf, "--" + base))
        text = urdf.read_text(encoding="utf-8")
        bare = re.sub(r"<!--.*?-->", "", text, flags=re.S)
        if re.search(r"<mimic\b", bare):
            plain = tmp / f"{urdf.stem}_no_mimic.urdf"
            plain.write_text(re.sub(r"<mimic\b[^>]*?/>|<mimic\b[^>]*>.*?</mimic\s*>", "", bare,
                                    flags=re.S), encoding="utf-8")
            models.append(Model(plain.stem, plain, "--" + base))
    names = [m.name for m in models]
    for i, m in enumerate(models):
        if names.count(m.name) > 1:
            m.name = f"{m.name}_{i + 1}"
        m.dump = tmp / f"{m.name}.txt"
        try:
            call([python, DUMP, m.urdf, m.base, "--name", m.name, "-o", m.dump], timeout,
                 f"dump of {m.urdf}")
        except RuntimeError as e:
            if f"{m.name}_no_mimic" not in names:
                raise
            # e.g. a mimic of a mimic, which Pinocchio does not accept
            print(f"compare: {m.name} is left out, only its variant without mimic joints is "
                  f"measured: {e}", file=sys.stderr)
            m.dump = None
    # Mimic tags that Pinocchio ignores (e.g. on fixed joints): both variants are the same model.
    same = {f"{m.name}_no_mimic" for m in models if m.dump and " MIMIC " not in m.dump.read_text()}
    models = [m for m in models if m.dump and m.name not in same]
    for m in models:
        m.last = [line.split()[1] for line in m.dump.read_text().splitlines()
                  if line.startswith("joint ")][-1]
    return models


def parse(text, what, figure="ns_median"):
    start = text.find("{")
    try:
        out = json.loads(text[start:] if start >= 0 else text)
        rows = {r["name"]: r for r in out["rows"]}
    except (ValueError, KeyError, TypeError) as e:
        raise RuntimeError(f"{what}: no valid JSON report ({e})")
    best = {}
    for row in ROWS:
        found = [(rows[n][figure], rows[n].get("ns_min"), n)
                 for n in VARIANTS.get(row, [row])
                 if n in rows and isinstance(rows[n].get(figure), (int, float))
                 and rows[n][figure] > 0]
        best[row] = min(found) if found else None
    return out, best


def measure(programs, model, args):
    """{program: {row: [(ns_median, ns_min, variant) or None per run]}}, {program: report head}"""
    data = {p: {row: [] for row in ROWS} for p in programs}
    heads, failed = {}, {}
    only = []
    if args.rows:
        only = ["--only", ",".join(v for r in args.rows.split(",") for v in VARIANTS.get(r, [r]))]
    for run in range(args.runs):
        for name in list(programs) if run % 2 == 0 else list(programs)[::-1]:
            if name in failed:
                continue
            what = f"{name} on {model.name}"
            if not args.quiet:
                print(f"\r{what}, run {run + 1}/{args.runs}" + " " * 20, end="", file=sys.stderr,
                      flush=True)
            if name == "libdyn":
                command = [programs[name], model.urdf, model.base, "--json", "--joint", model.last]
            else:
                command = [programs[name], model.dump]
            command += ["--seconds", args.seconds, "--rounds", args.rounds] + only
            try:
                head, best = parse(call(command, args.timeout, what), what)
            except RuntimeError as e:
                print(f"\ncompare: {e}", file=sys.stderr)
                failed[name] = str(e)
                continue
            heads[name] = {k: head.get(k) for k in
                           ("library", "version", "eigen", "compiler", "flags", "nq", "nv")}
            for row in ROWS:
                data[name][row].append(best[row])
    for name in failed:
        data.pop(name, None)
        heads.pop(name, None)
    return data, heads, failed


def evaluate(data, rows):
    """Per row: libdyn's time, the fastest Pinocchio build and its time, and the ratio."""
    def times(values):
        return [v[0] for v in values] if values and all(values) else None

    out = {}
    for row in rows:
        r = {"libdyn_ns": None, "libdyn_ns_min": None, "pinocchio_ns": None,
             "pinocchio_ns_min": None, "pinocchio_build": None, "pinocchio_variant": None,
             "ratio": None, "ratio_min": None, "builds": {}}
        best = None
        for name, by_row in data.items():
            t = times(by_row[row])
            if t is None:
                continue
            m = statistics.median(t)
            low = min((v[1] if v[1] else v[0]) for v in by_row[row])
            if name == "libdyn":
                r["libdyn_ns"], r["libdyn_ns_min"] = m, low
                continue
            r["builds"][name] = m
            if r["pinocchio_ns_min"] is None or low < r["pinocchio_ns_min"]:
                r["pinocchio_ns_min"] = low
            if best is None or m < best[0]:
                best = (m, name, t)
        if best:
            variants = [v[2] for v in data[best[1]][row]]
            r["pinocchio_ns"], r["pinocchio_build"] = best[0], best[1]
            r["pinocchio_variant"] = max(set(variants), key=variants.count)
            if r["libdyn_ns"]:
                mine = times(data["libdyn"][row])
                r["ratio"] = statistics.median(a / b for a, b in zip(mine, best[2]))
                r["ratio_min"] = r["libdyn_ns_min"] / r["pinocchio_ns_min"]
        out[row] = r
    return out


def fmt_ns(x):
    if x is None:
        return "-"
    if x < 1000:
        return f"{x:.0f} ns"
    if x < 1e6:
        return f"{x / 1e3:.3g} us"
    return f"{x / 1e6:.3g} ms"


def table(header, lines):
    out = ["| " + " | ".join(header) + " |", "|---|" + "---:|" * (len(header) - 1)]
    return "\n".join(out + ["| " + " | ".join(line) + " |" for line in lines])


def markdown(report, rows, peers_only):
    results = report["results"]
    names = list(results)
    heading = [f"{n} ({report['models'][n]['nq']}/{report['models'][n]['nv']})" for n in names]
    parts = []
    used = [r for r in rows if any(results[n][r]["pinocchio_ns"] or results[n][r]["libdyn_ns"]
                                   for n in names)]
    heads = report["programs"]
    lines = [f"- {n}: {h['library']} {h['version']}" + (f", Eigen {h['eigen']}" if h.get("eigen")
             else "") + f", {str(h['compiler']).strip()}, `{h['flags']}`" for n, h in heads.items()]
    parts.append(f"{report['date']}, {report['machine']}, {report['runs']} interleaved runs.\n\n"
                 + "\n".join(lines))
    if not peers_only:
        body = []
        for r in used:
            cells = []
            for n in names:
                e = results[n][r]
                cells.append(f"{e['ratio']:.2f}" if e["ratio"] else
                             "not comparable" if e["libdyn_ns"] and e["pinocchio_ns"] else
                             "only libdyn" if e["libdyn_ns"] else
                             "only Pinocchio" if e["pinocchio_ns"] else "-")
            body.append([r] + cells)
        means = []
        for n in names:
            x = [math.log(results[n][r]["ratio"]) for r in used if results[n][r]["ratio"]]
            means.append(f"{math.exp(statistics.fmean(x)):.2f}" if x else "-")
        body.append(["geometric mean"] + means)
        parts.append("Ratio of times, libdyn / fastest Pinocchio build (below 1: libdyn is "
                     "faster); nq/nv in parentheses.\n\n" + table(["algorithm"] + heading, body))
    body = []
    for r in used:
        cells = []
        for n in names:
            e = results[n][r]
            peer = fmt_ns(e["pinocchio_ns"])
            if e["pinocchio_build"]:
                variant = e["pinocchio_variant"][len(r):].strip("_")
                peer += f" ({e['pinocchio_build']}{', ' + variant if variant else ''})"
            cells.append(peer if peers_only else f"{fmt_ns(e['libdyn_ns'])} / {peer}")
        body.append([r] + cells)
    parts.append(("Median times of the fastest Pinocchio build" if peers_only else
                  "Median times, libdyn / fastest Pinocchio build") + ".\n\n"
                 + table(["algorithm"] + heading, body))
    if report["failures"]:
        parts.append("Failures:\n\n" + "\n".join(f"- {f}" for f in report["failures"]))
    return "\n\n".join(parts) + "\n"


def cpu_name():
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    p.add_argument("--dyn", type=Path, default=PROJECT / "build/release/bin/dyn_bench")
    p.add_argument("--pinocchio", nargs="+", type=Path)
    p.add_argument("--python", type=Path, default=PROJECT / "build/peers/bin/python")
    p.add_argument("--models", nargs="+", default=DEFAULT_MODELS)
    p.add_argument("--runs", type=int, default=5)
    p.add_argument("--seconds", type=float, default=0.1)
    p.add_argument("--rows")
    p.add_argument("--rounds", type=int, default=3)
    p.add_argument("--peers-only", action="store_true")
    p.add_argument("--timeout", type=float, default=900, help="seconds per program run")
    p.add_argument("--markdown", type=Path)
    p.add_argument("--json", type=Path)
    p.add_argument("--quiet", action="store_true")
    args = p.parse_args()
    args.quiet = args.quiet or not sys.stderr.isatty()
    if args.runs < 1 or args.rounds < 1 or not args.seconds > 0:
        die("--runs, --rounds and --seconds must be positive")

    rows = ROWS
    if args.rows:
        rows = args.rows.split(",")
        unknown = [r for r in rows if r not in ROWS]
        if unknown:
            die(f"unknown rows: {', '.join(unknown)} (known: {', '.join(ROWS)})")
    peers = args.pinocchio or [Path(x) for x in
                               sorted(glob.glob(str(PROJECT / "build/peers-bin/pinocchio_bench_*")))]
    peers = [x for x in peers if x.is_file() and os.access(x, os.X_OK)] if not args.pinocchio \
        else peers
    if not peers:
        die("no pinocchio_bench executable: run bench/peers/build_pinocchio.py first, "
            "or give --pinocchio")
    programs = {}
    if not args.peers_only:
        if not os.access(args.dyn, os.X_OK):
            die(f"{args.dyn} is missing or not executable: build libdyn's bench program first, "
                "or give --dyn or --peers-only")
        programs["libdyn"] = args.dyn.resolve()
    for exe in peers:
        if not os.access(exe, os.X_OK):
            die(f"{exe} is missing or not executable")
        name = exe.name.replace("pinocchio_bench_", "")
        if name in programs:
            die(f"two executables named {exe.name}")
        programs[name] = exe.resolve()
    python = args.python
    if not os.access(python, os.X_OK):
        die(f"{python} is missing: run bench/peers/build_pinocchio.py first, or give --python")

    report = {"date": time.strftime("%Y-%m-%d"), "machine": cpu_name(), "runs": args.runs,
              "programs": {}, "models": {}, "results": {}, "failures": []}
    with tempfile.TemporaryDirectory(prefix="dyn-compare-") as d:
        try:
            models = make_models(args.models, Path(d), python, args.timeout)
        except RuntimeError as e:
            die(str(e))
        for model in models:
            data, heads, failed = measure(programs, model, args)
            report["failures"] += failed.values()
            for name, h in heads.items():
                report["programs"].setdefault(
                    name, {k: v for k, v in h.items() if k not in ("nq", "nv")})
            sizes = {(h["nq"], h["nv"]) for h in heads.values()}
            if not sizes:
                continue
            if len(sizes) > 1:
                report["failures"].append(f"{model.name}: the programs disagree on nq/nv: "
                                          f"{sorted(sizes)}; their times are not comparable")
            nq, nv = sorted(sizes)[0]
            report["models"][model.name] = {"nq": nq, "nv": nv, "base": model.base[2:]}
            report["results"][model.name] = evaluate(data, rows)
            if len(sizes) > 1:
                for r in report["results"][model.name].values():
                    r["ratio"] = r["ratio_min"] = None
    if not args.quiet:
        print("\r" + " " * 60 + "\r", end="", file=sys.stderr)
    if not report["results"]:
        die("nothing was measured")
    text = markdown(report, rows, args.peers_only)
    print(text)
    if args.markdown:
        args.markdown.write_text(text)
    if args.json:
        args.json.write_text(json.dumps(report, indent=1) + "\n")
    sys.exit(1 if report["failures"] else 0)


if __name__ == "__main__":
    main()
