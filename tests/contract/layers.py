#!/usr/bin/env python3
"""Refuses an include that runs against the order of the modules, and headers that include one another in a circle."""
import re
import sys
from pathlib import Path

# A module may include itself and the modules of the lines above.
ORDER = """
base
table
spatial
joint shape constraint effect
model
algorithm
collision
solver integrator
simulation
plan
mesh
load
"""
# model/data_fields.def lists what every module declares.
COMPOSED = "model/data_fields.def"
PUBLIC = {"dyn.h"}


def ranks():
    return {module: rank for rank, line in enumerate(ORDER.split("\n")) for module in line.split()}


def includes(path):
    """(line, target) of each quoted include."""
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if found := re.match(r'\s*#\s*include\s+"([^"]+)"', line):
            yield number, found[1]


def circles(graph):
    """Headers that include one another, each circle once."""
    done, found = set(), []

    def visit(node, trail):
        if node in trail:
            found.append(trail[trail.index(node):] + [node])
            return
        if node in done:
            return
        for target in graph.get(node, ()):
            visit(target, trail + [node])
        done.add(node)

    for node in sorted(graph):
        visit(node, [])
    return found


def check(src):
    rank, faults, graph = ranks(), [], {}
    for path in sorted(src.rglob("*")):
        if path.suffix not in (".hpp", ".cpp", ".def"):
            continue
        name = path.relative_to(src).as_posix()
        module = name.split("/")[0]
        if module not in rank:
            faults.append(f"src/{name}: module '{module}' is not in the order: add it to ORDER of tests/contract/layers.py")
            continue
        for line, target in includes(path):
            if target in PUBLIC or target.endswith(".inc"):
                continue
            if (path.parent / target).is_file():
                target = (path.parent / target).relative_to(src).as_posix()
            other = target.split("/")[0]
            graph.setdefault(name, []).append(target)
            if other not in rank:
                faults.append(f"src/{name}:{line}: includes \"{target}\", which is in no module of src")
            elif other != module and rank[other] >= rank[module] and not (name == COMPOSED and target.endswith("/fields.def")):
                faults.append(f"src/{name}:{line}: includes \"{target}\": {module} lies below {other}, or beside it")
    faults += ["src/" + " -> ".join(circle) + ": a circle" for circle in circles(graph)]
    return faults


def main():
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[2]
    faults = check(root / "src")
    print("\n".join(faults) if faults else "includes follow the order of the modules")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
