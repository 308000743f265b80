#!/usr/bin/env python3
"""What of a folder's MJCF and URDF files loads and runs as it is written, beside MuJoCo and Pinocchio.

Usage:  coverage.py FOLDER... [--only PATTERN] [--duration S] [--page FILE.md] [--csv FILE] [--write TABLE] [--check FILE]

  --only PATTERN   files whose path matches this regular expression
  --duration S     of the motion that is compared, s; default 0.25
  --page FILE.md   write the table with every file to this page
  --csv FILE       write every file with what became of it
  --write TABLE    put the summary, and the files that differ, in the place of this name (pages.py)
  --check FILE     exit with 1 if a file that FILE (a CSV of --csv) has as good is worse now

Every file is tried in a process of its own. MJCF: sizes, timestep, initial configuration, M, bias, passive and actuator forces at
random states, and the motion of the simulation under held controls, against MuJoCo (beside_mujoco.py). A motion that differs is
compared with that of MuJoCo's rigid contacts, too. URDF: nv and kinetic energies against Pinocchio. Needs the package mujoco for
MJCF, and pin for URDF. Without them a file is only loaded.
"""

import argparse
import collections
import csv
import json
import re
import subprocess
import sys
import warnings
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(PROJECT / "capi" / "python"), str(PROJECT / "bench")]

import numpy as np  # noqa: E402

MOTION = "moves itself energy contacts rigid until own start".split()
FIELDS = [*"file format peer result sizes timestep begins forces".split(), *MOTION, "unsupported", "reason"]
ENERGIES, CONTACTS = 0.1, 0.7  # where motion amplifies: relative difference of energies, share of pairs that touch in both
MOVES = 0.06  # rad or m
RIGID = "as the rigid peer"
GOOD = ("as the peer", "as the peer, with warnings", RIGID, RIGID + ", with warnings")
NOT_COMPARED = ("loaded here alone", "refused by both")


def kind_of(path):
    """"MJCF" or "URDF", or None for parts and other files."""
    text = re.sub(r"<!--.*?-->|<\?.*?\?>", "", path.read_text(encoding="utf-8", errors="replace"), flags=re.S)
    if re.match(r"\s*<mujoco\b", text):
        return "MJCF"
    return "URDF" if path.suffix == ".urdf" and re.search(r"<robot\b", text) else None


def files(folders, only):
    for folder in folders:
        for path in sorted(p for p in Path(folder).rglob("*") if p.suffix in (".xml", ".mjcf", ".urdf") and p.is_file()):
            if (not only or re.search(only, str(path))) and (kind := kind_of(path)):
                yield kind, path


# ---------------------------------------------------------------------------------------------------- MJCF
def load_here(row, peer, path, **options):
    """The model and its warnings, which the row takes; the row has its result where there is nothing to compare."""
    import libdyn as dyn

    try:
        m = dyn.load(path, **options)
    except dyn.Error as error:
        row.update(result="refused" if peer else "refused by both", reason=str(error).splitlines()[0])
        return None, []
    said = [e.message for e in m.report if e.level == dyn.ReportLevel.DROPPED]
    row["unsupported"] = "; ".join(said[:3])
    if peer is None:
        row["result"] = "loaded here alone"
    return m, said


def mjcf(path, duration):
    import beside_mujoco as peer
    import mujoco

    import libdyn as dyn

    row = {}
    try:
        mm = mujoco.MjModel.from_xml_path(str(path))
        row["peer"] = "yes"
    except Exception as error:
        mm, row["peer"], row["reason"] = None, "no", str(error).strip().splitlines()[0][:200]
    m, said = load_here(row, mm, path)
    if "result" in row:
        return row
    row["sizes"] = "same" if (m.nq, m.nv, m.nu) == (mm.nq, mm.nv, mm.nu) else f"{m.nq} {m.nv} {m.nu}, not {mm.nq} {mm.nv} {mm.nu}"
    if row["sizes"] != "same":
        return row | {"result": "differs" + (", with warnings" if said else ""), "reason": reason_of(([], 0), {}, said)}
    beside, sim = peer.Beside(mm, m), dyn.Simulation(m)
    row["timestep"] = "same" if sim.dt == mm.opt.timestep else f"{sim.dt}, not {mm.opt.timestep}"
    begins = beside.apart(mm.qpos0, beside.qpos(sim.q))
    row["begins"] = "same" if begins < 1e-12 else f"{begins:.1e} off"
    try:
        forces = peer.forces(beside) if mm.nv else {}
        moves = peer.motion(beside, duration)
    except dyn.Error as error:
        return row | {"result": "fails", "reason": str(error).splitlines()[0]}
    off = [f"{part} {x:.0e}" for part, x in forces.items() if x > peer.FORCES]
    row["forces"] = ", ".join(off) or f"{max(forces.values(), default=0):.0e}"
    row |= {what: f"{moves[what]:.2g}" for what in ("moves", "itself", "energy", "contacts") if what in moves}
    result = "differs"
    if row["sizes"] == row["timestep"] == row["begins"] == "same" and not off:
        result = as_moved(moves, row) or as_rigid(peer.rigid_motion(beside, duration), row) or "differs"
    if result == "differs":
        row["reason"] = reason_of(peer.beginning(mm), moves, said)
    return row | {"result": result + (", with warnings" if said else "")}


def as_moved(moves, row):
    """The result where the motions agree, with the reason in the row, or None."""
    if moves["moves"] > MOVES:
        if moves["itself"] <= MOVES or moves["energy"] >= ENERGIES or moves["contacts"] <= CONTACTS:
            return None
        row["reason"] = "motion amplifies: energy and contacts agree"
    return "as the peer"


def as_rigid(moves, row):
    """The same beside MuJoCo's limit of rigid contacts. There is no excuse for what amplifies."""
    row |= {what: x if what == "start" else f"{x:.2g}" for what, x in moves.items()}
    if not moves.get("rigid", MOVES) < MOVES:
        return None
    row["reason"] = "MuJoCo's contacts are soft, and it moves as here where they are rigid"
    return RIGID


def first_of(said):
    """The first message, without names of files, and how many more there are."""
    message = re.sub(r"^\S+:\d+: | \('[^']*'\)", "", said[0]).split(": it keeps")[0]
    return message + (f" (and {len(said) - 1} more)" if said[1:] else "")


def reason_of(beginning, moves, said):
    """What is known to part the motions, the first that holds."""
    beyond, deep = beginning
    reasons = ["not supported: " + first_of(said)] if said else []
    if beyond:
        reasons.append(f"drawn beyond the limits of {len(beyond)} joints ({beyond[0]})")
    if deep:
        reasons.append(f"drawn with {deep} contacts deeper than 1 mm")
    if moves.get("itself", 0) > MOVES:
        reasons.append("MuJoCo's motion depends as much on timestep and stiffness")
    return "; ".join(reasons)


# ---------------------------------------------------------------------------------------------------- URDF
def urdf(path, folder):
    import pinocchio as pin

    import libdyn as dyn

    row = {}
    try:
        pm = pin.buildModelFromUrdf(str(path), mimic=True)
        row["peer"] = "yes"
    except Exception as error:
        pm, row["peer"], row["reason"] = None, "no", str(error).strip().splitlines()[0][:200]
    m, said = load_here(row, pm, path, base="fixed", package_dirs=folder)
    if "result" in row:
        return row
    row["sizes"] = "same" if m.nv == pm.nv else f"nv {m.nv}, not {pm.nv}"
    if m.nv != pm.nv:
        return row | {"result": "differs, with warnings" if said else "differs"}
    layout, pd, d, worst = dyn.StateLayout.of_pinocchio(pm), pm.createData(), m.data(), 0.0
    for seed in range(5):
        q = m.random(seed)
        v = np.random.default_rng(seed).uniform(-1, 1, m.nv)
        there = m.to_peer(layout, q=q, v=v)
        worst = max(worst, abs(d.energy(q, v).kinetic - pin.computeKineticEnergy(pm, pd, there.q, there.v)))
    row["forces"] = f"{worst:.1e}"
    good = row["sizes"] == "same" and worst < 1e-9 * (1 + m.total_mass)
    return row | {"result": ("as the peer, with warnings" if said else "as the peer") if good else "differs"}


def one(kind, path, folder, duration):
    warnings.simplefilter("ignore")
    row = mjcf(Path(path), duration) if kind == "MJCF" else urdf(Path(path), folder)
    print(json.dumps(row))


def tried(kind, path, folder, duration):
    command = [sys.executable, __file__, "--one", kind, str(path), str(folder), str(duration)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    except subprocess.TimeoutExpired:
        return {"result": "fails", "reason": "more than 300 s"}
    if done.returncode:
        return {"result": "fails", "reason": (done.stderr.strip().splitlines() or [f"status {done.returncode}"])[-1][:300]}
    return json.loads(done.stdout.splitlines()[-1])


def without_paths(text):
    return re.sub(r"(/[^\s/':]+)+/", "", text)


def summary(rows):
    counts = collections.defaultdict(collections.Counter)
    for r in rows:
        counts[r["folder"], r["format"]][r["result"]] += 1
    kinds = [*GOOD, "differs, with warnings", "differs", "fails", "refused"]
    lines = ["| folder | files | " + " | ".join(kinds) + " | others |", "|---|---" + "|---" * (len(kinds) + 1) + "|"]
    for (folder, kind), c in counts.items():
        total = sum(c.values())
        others = total - sum(c[k] for k in kinds)
        lines.append(f"| {folder} | {total} {kind} | " + " | ".join(str(c[k]) for k in kinds) + f" | {others} |")
    return "\n".join(lines)


ALL = [*"file result sizes timestep begins forces".split(), *MOTION, "unsupported", "reason"]


def table(rows, head=ALL):
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for r in rows:
        cells = [r["file"] if k == "file" else without_paths(str(r.get(k, ""))) for k in head]
        lines.append("| " + " | ".join(cell.replace("|", "/")[:160].replace("<", "&lt;") for cell in cells) + " |")
    return "\n".join(lines)


def publish(rows, args):
    import pages

    named = " ".join(folder.resolve().name for folder in args.folder)
    only = f" --only '{args.only}'" if args.only else ""
    command = f"python3 bench/coverage.py {named}{only} --duration {args.duration} --write {args.write}"
    short = [r | {"file": " ".join(Path(r["file"]).parts[-2:])} for r in rows]
    text = [summary(rows)]
    if soft := [r for r in short if r["result"].startswith(RIGID)]:
        text += ["Files as the rigid peer:", table(soft, "file moves rigid start".split())]
    if differ := [r for r in short if r["result"] not in (*GOOD, *NOT_COMPARED)]:
        text += ["Files that differ:", table(differ, ["file", "forces", *MOTION, "reason"])]
    pages.write(args.write, "\n\n".join([*text, f"```\n{command}\n```"]))


def worse(rows, file):
    """Files that were good there and are not now."""
    now = {(r["folder"], r["file"]): r["result"] for r in rows}
    with open(file, newline="", encoding="utf-8") as f:
        before = [r for r in csv.DictReader(f) if r["result"] in GOOD]
    return [f"{r['folder']}/{r['file']}: {r['result']}, now {now[r['folder'], r['file']]}" for r in before
            if (r["folder"], r["file"]) in now and now[r["folder"], r["file"]] not in GOOD]


def main():
    if sys.argv[1:2] == ["--one"]:
        return one(sys.argv[2], sys.argv[3], sys.argv[4], float(sys.argv[5]))
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("folder", nargs="+", type=Path)
    p.add_argument("--only")
    p.add_argument("--duration", type=float, default=0.25)
    p.add_argument("--page", type=Path)
    p.add_argument("--csv", type=Path)
    p.add_argument("--write")
    p.add_argument("--check", type=Path)
    args = p.parse_args()
    rows = []
    for folder in args.folder:
        for kind, path in files([folder], args.only):
            named = {"folder": folder.resolve().name, "file": str(path.relative_to(folder)), "format": kind}
            rows.append(row := named | tried(kind, path, folder, args.duration))
            reason = without_paths(row.get("reason", ""))[:120]
            print(f"{row['result']:28} {row['file']}  {row.get('moves', '')} {reason}", flush=True)
    text = summary(rows)
    print("\n" + text)
    if args.csv:
        with args.csv.open("w", newline="", encoding="utf-8") as f:
            writer = csv.DictWriter(f, ["folder", *FIELDS], extrasaction="ignore", lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    if args.page:
        args.page.write_text(f"# Coverage\n\n{text}\n\n{table(rows)}\n", encoding="utf-8")
    if args.write:
        publish(rows, args)
    if args.check:
        for line in (found := worse(rows, args.check)):
            print("worse: " + line)
        return int(bool(found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
