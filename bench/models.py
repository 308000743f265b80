#!/usr/bin/env python3
"""Tries every robot file of some packages: all URDFs of example-robot-data, all MJCF files of mujoco and of unpacked wheels.

Usage:  models.py [--more DIR]... [--write] [--csv FILE]

  --more DIR       a folder of unpacked wheels (dm_control, gymnasium_robotics, robosuite ...): each folder in it is a package
  --write          puts the table in its place (pages.py)
  --csv FILE       every file with what became of it

Needs packages example-robot-data and mujoco, and pin to say what else loads a refused URDF. Parts that other files include are
left out.
"""

import argparse
import collections
import csv
import re
import sys
import textwrap
import warnings
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(PROJECT / "capi" / "python"))

import libdyn as dyn  # noqa: E402
import pages  # noqa: E402


def packages(more):
    """(package, kind, file, folder for package://) of everything there is."""
    import mujoco
    import pinocchio

    prefix = next(p for p in Path(pinocchio.__file__).resolve().parents if p.name == "lib").parent
    share = prefix / "share"
    for file in sorted((share / "example-robot-data" / "robots").rglob("*.urdf")):
        yield "example-robot-data", "URDF", file, share
    folders = [("mujoco", Path(mujoco.__file__).parent)]
    for folder in more:
        folders += [(p.name, p) for p in sorted(Path(folder).iterdir()) if p.is_dir() and not p.name.endswith(".dist-info")]
    for name, folder in folders:
        for file in sorted([*folder.rglob("*.xml"), *folder.rglob("*.mjcf")]):
            text = file.read_text(encoding="utf-8", errors="replace")
            if re.match(r"\s*(<\?.*?\?>)?\s*(<!--.*?-->\s*)*<mujoco\b", text, re.S):
                yield name, "MJCF", file, folder


def load(kind, file, folder):
    if kind == "MJCF":
        return dyn.load(file)
    try:
        return dyn.load(file, "floating", package_dirs=folder)
    except dyn.BaseChoiceError:  # tied to the world, or with a free joint of its own
        return dyn.load(file, "fixed", package_dirs=folder)


def peer_loads(kind, file):
    try:
        if kind == "MJCF":
            import mujoco

            mujoco.MjModel.from_xml_path(str(file))
        else:
            import pinocchio

            pinocchio.buildModelFromUrdf(str(file))
        return True
    except Exception:
        return False


def try_all(more):
    rows = []
    for package, kind, file, folder in packages(more):
        row = {"package": package, "format": kind, "file": file.name, "path": str(file.relative_to(folder)), "result": "loaded",
               "reason": "", "peer": ""}
        try:
            said = [e for e in load(kind, file, folder).report if e.level == dyn.ReportLevel.DROPPED]
            if said:
                row["result"], row["reason"] = "with a report", "; ".join(e.message for e in said[:3])
        except dyn.Error as e:
            row["result"], row["reason"] = "refused", re.sub(r"^\S*?/?([^/\s]+?\.(?:xml|urdf|mjcf)):", r"\1:",
                                                             str(e).splitlines()[0])
            row["peer"] = "yes" if peer_loads(kind, file) else "no"
        rows.append(row)
    return rows


def without_paths(text):
    return re.sub(r"(/[^\s/':]+)+/", "", text)


def table(rows):
    counts = collections.defaultdict(collections.Counter)
    for r in rows:
        counts[r["package"], r["format"]][r["result"]] += 1
    lines = ["| package | files | loaded | loaded, with warnings in the report | refused | of these loaded by pin or mujoco |",
             "|---|---|---|---|---|---|"]
    for (package, kind), c in counts.items():
        peer = sum(r["peer"] == "yes" for r in rows if r["package"] == package and r["format"] == kind)
        lines.append(f"| {package} | {sum(c.values())} {kind} | {c['loaded']} | {c['with a report']} | {c['refused']} | {peer} |")
    refused = collections.defaultdict(list)
    for r in rows:
        if r["result"] == "refused":
            reason = re.sub(r"^[^:]+:(\d+:)? ", "", without_paths(r["reason"]))
            key = re.sub(r"'[^']*'", "'...'", re.sub(r"-?\d[\d.e+-]*", "#", reason))  # alike but for names and numbers
            refused[key].append((r, reason))
    if refused:
        lines += ["", "<details><summary>Refused, and why</summary>", ""]
        for same in sorted(refused.values(), key=lambda s: -len(s)):
            names = [f"{r['file']}{' (mujoco or pin loads it)' if r['peer'] == 'yes' else ''}" for r, _ in same[:6]]
            lines.append(f"- {', '.join(names)}{f' and {len(same) - 6} more' if len(same) > 6 else ''}: "
                         f"{textwrap.shorten(same[0][1], 170, placeholder=' ...')}")
        lines += ["", "</details>"]
    return "\n".join(lines)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--more", action="append", default=[])
    p.add_argument("--write", action="store_true")
    p.add_argument("--csv", type=Path)
    args = p.parse_args()
    warnings.simplefilter("ignore")
    rows = try_all(args.more)
    text = table(rows)
    print(text)
    if args.csv:
        with args.csv.open("w", newline="", encoding="utf-8") as f:
            writer = csv.DictWriter(f, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)
    if args.write:
        command = "python3 bench/models.py --write" + " --more DIR" * bool(args.more)
        pages.write("models", f"{text}\n\n```\n{command}\n```")


if __name__ == "__main__":
    main()
