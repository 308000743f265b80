#!/usr/bin/env python3
"""What of a folder's MJCF and URDF files loads and runs as it is written, beside MuJoCo and Pinocchio.

Usage:  coverage.py FOLDER... [--only PATTERN] [--duration S] [--page FILE.md] [--csv FILE] [--write] [--check FILE]

  --only PATTERN   files whose path matches this regular expression
  --duration S     of the motion that is compared, s; default 0.25
  --page FILE.md   write the table with every file to this page
  --csv FILE       write every file with what became of it
  --write          put the summary in its place (pages.py)
  --check FILE     exit with 1 if a file that FILE (a CSV of --csv) has as good is worse now

Every file is tried in a process of its own. MJCF: sizes, timestep, initial configuration, M and bias at random states, and the motion of the simulation without
controls, against MuJoCo. URDF: nv and kinetic energies against Pinocchio. Needs the package mujoco for MJCF, and pin for URDF. Without them a file is only loaded.
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
sys.path.insert(0, str(PROJECT / "capi" / "python"))

import numpy as np  # noqa: E402

FIELDS = "file format peer result sizes timestep begins forces moves unsupported reason".split()
MOVES = 0.06  # rad or m: within the peer's contact model
GOOD = ("as the peer", "as the peer, with warnings")


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
def q_of(mm, qpos):
    """qpos with quaternions (x, y, z, w)."""
    q = np.array(qpos)
    for j in range(mm.njnt):
        if mm.jnt_type[j] < 2:
            k = mm.jnt_qposadr[j] + (3 if mm.jnt_type[j] == 0 else 0)
            q[k : k + 4] = np.roll(q[k : k + 4], -1)
    return q


def velocity_map(mm, qpos):
    """T with v = T qvel: the linear velocity of a free joint in the body's axes."""
    import mujoco

    T = np.eye(mm.nv)
    for j in range(mm.njnt):
        if mm.jnt_type[j] == 0:
            R, k = np.empty(9), mm.jnt_dofadr[j]
            mujoco.mju_quat2Mat(R, qpos[mm.jnt_qposadr[j] + 3 :][:4])
            T[k : k + 3, k : k + 3] = R.reshape(3, 3).T
    return T


def apart(mm, a, b):
    """Largest difference of two configurations, m or rad."""
    import mujoco

    d = np.zeros(mm.nv)
    mujoco.mj_differentiatePos(mm, d, 1.0, a, b)
    return float(np.abs(d).max(initial=0))


def forces_of(mm, m, dyn, states=5):
    """Largest relative difference of M and bias at random states."""
    import mujoco

    md, d, random, worst = mujoco.MjData(mm), m.data(), np.random.default_rng(1), 0.0
    d.set_effects(dyn.Effect.ARMATURE)
    full = np.empty((mm.nv, mm.nv))
    for _ in range(states):
        mujoco.mj_resetData(mm, md)
        mujoco.mj_integratePos(mm, md.qpos, random.uniform(-1, 1, mm.nv), 0.5)
        md.qvel[:] = random.uniform(-1, 1, mm.nv)
        mujoco.mj_forward(mm, md)
        mujoco.mj_fullM(mm, md, full)
        T, q = velocity_map(mm, md.qpos), q_of(mm, md.qpos)
        v, zero = T @ md.qvel, np.zeros(mm.nv)
        for j in range(mm.njnt):  # MuJoCo's zero acceleration, in the body's axes
            if mm.jnt_type[j] == 0:
                k = mm.jnt_dofadr[j]
                zero[k : k + 3] = -np.cross(v[k + 3 : k + 6], v[k : k + 3])
        ours = T.T @ d.crba(q) @ T
        worst = max(worst, np.abs(ours - full).max() / np.abs(full).max())
        bias = T.T @ d.rnea(q, v, zero)
        worst = max(worst, np.abs(bias - md.qfrc_bias).max() / max(1e-3, np.abs(md.qfrc_bias).max()))
    return float(worst)


def load_here(row, peer, path, **options):
    """The model and its warnings, which the row takes; the row has its result where there is nothing to compare."""
    import libdyn as dyn

    try:
        m = dyn.load(path, **options)
    except dyn.Error as error:
        row.update(result="refused" if peer else "refused by both", reason=str(error).splitlines()[0])
        return None, []
    said = [e.message for e in m.report if e.level == dyn.ReportLevel.WARNING]
    row["unsupported"] = "; ".join(said[:3])
    if peer is None:
        row["result"] = "loaded here alone"
    return m, said


def mjcf(path, duration):
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
    if (m.nq, m.nv) != (mm.nq, mm.nv):
        return row | {"result": "differs"}
    sim, md = dyn.Simulation(m), mujoco.MjData(mm)
    row["timestep"] = "same" if sim.dt == mm.opt.timestep else f"{sim.dt}, not {mm.opt.timestep}"
    begins = float(np.abs(sim.q - q_of(mm, md.qpos)).max(initial=0))
    row["begins"] = "same" if begins < 1e-12 else f"{begins:.1e} off"
    forces = forces_of(mm, m, dyn) if mm.nv else 0.0
    row["forces"] = f"{forces:.1e}"
    try:
        steps = round(duration / mm.opt.timestep)
        worst = 0.0
        back = [(mm.jnt_qposadr[j] + (3 if mm.jnt_type[j] == 0 else 0)) for j in range(mm.njnt) if mm.jnt_type[j] < 2]
        for _ in range(max(steps, 1)):
            mujoco.mj_step(mm, md)
            sim.step()
            qpos = sim.q.copy()
            for k in back:
                qpos[k : k + 4] = np.roll(qpos[k : k + 4], 1)
            worst = max(worst, apart(mm, md.qpos, qpos))
        row["moves"] = f"{worst:.3g}"
    except dyn.Error as error:
        return row | {"result": "fails", "reason": str(error).splitlines()[0]}
    as_peer = row["sizes"] == row["timestep"] == row["begins"] == "same" and worst <= MOVES
    return row | {"result": ("as the peer, with warnings" if said else "as the peer") if as_peer else "differs, with warnings" if said else "differs"}


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
    kinds = ["as the peer", "as the peer, with warnings", "differs, with warnings", "differs", "fails", "refused"]
    lines = ["| folder | files | " + " | ".join(kinds) + " | others |", "|---|---" + "|---" * (len(kinds) + 1) + "|"]
    for (folder, kind), c in counts.items():
        lines.append(f"| {folder} | {sum(c.values())} {kind} | " + " | ".join(str(c[k]) for k in kinds) + f" | {sum(c.values()) - sum(c[k] for k in kinds)} |")
    return "\n".join(lines)


def table(rows):
    head = "file result sizes timestep begins forces moves unsupported reason".split()
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for r in rows:
        lines.append("| " + " | ".join(without_paths(str(r.get(k, ""))).replace("|", "/")[:160] for k in head) + " |")
    return "\n".join(lines)


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
    p.add_argument("--write", action="store_true")
    p.add_argument("--check", type=Path)
    args = p.parse_args()
    rows = []
    for folder in args.folder:
        for kind, path in files([folder], args.only):
            row = {"folder": folder.resolve().name, "file": str(path.relative_to(folder)), "format": kind} | tried(kind, path, folder, args.duration)
            rows.append(row)
            print(f"{row['result']:28} {row['file']}  {row.get('moves', '')} {without_paths(row.get('reason', ''))[:120]}", flush=True)
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
        import pages

        pages.write("coverage", f"{text}\n\n```\npython3 bench/coverage.py --write FOLDER...\n```")
    if args.check:
        for line in (found := worse(rows, args.check)):
            print("worse: " + line)
        return int(bool(found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
