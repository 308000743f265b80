#!/usr/bin/env python3
"""Write an artificial URDF robot of any size to standard output.

  generate.py chain N                 N joints in a row
  generate.py tree N --branching B    N joints, each link carrying B children (breadth first)
  generate.py star N                  N one-joint branches at the root

The root link is a massless `world`; joint k (1..N) is `joint_k` and moves `link_k`. Without --seed every
link is the same uniform rod of 1 kg along the link, and the joint axes cycle through x, y, z. With --seed
masses, centres of mass, inertias, placements and axes vary; the same seed gives the same robot.
"""

from __future__ import annotations

import argparse
import math
import os
import random
import sys
from typing import Any, Iterable, TextIO

TYPES = ("revolute", "continuous", "prismatic", "planar", "floating")
AXES = ("1 0 0", "0 1 0", "0 0 1")
ROD_MASS = 1.0
ROD_RADIUS = 0.02


def number(value: float) -> str:
    return "%.9g" % value


def triple(values: Iterable[float]) -> str:
    return " ".join(number(v) for v in values)


def direction(rng: random.Random) -> tuple[float, float, float]:
    """A unit vector, uniform on the sphere."""
    z = rng.uniform(-1.0, 1.0)
    angle = rng.uniform(-math.pi, math.pi)
    r = math.sqrt(1.0 - z * z)
    return (r * math.cos(angle), r * math.sin(angle), z)


def angles(rng: random.Random) -> tuple[float, ...]:
    return tuple(rng.uniform(-math.pi, math.pi) for _ in range(3))


def parent_of(shape: str, k: int, branching: int) -> int:
    """Index of the link carrying joint k; 0 is the root."""
    if shape == "chain":
        return k - 1
    if shape == "star":
        return 0
    return (k - 1) // branching


def origin(shape: str, k: int, parent: int, n: int, length: float, branching: int,
           rng: random.Random | None) -> tuple[tuple[float, ...], tuple[float, ...] | None]:
    """Placement of joint k in its parent link: (xyz, rpy)."""
    if rng is not None:
        d = direction(rng)
        return tuple(length * c for c in d), angles(rng)
    if shape == "chain":
        return ((0.0, 0.0, length) if parent else (0.0, 0.0, 0.0)), None
    # Children of one link fan out around its end; the star's around the root.
    slots, slot = (n, k - 1) if shape == "star" else (branching, (k - 1) % branching)
    turn = 2.0 * math.pi * slot / slots
    z = length if parent else 0.0
    if slots == 1:
        return (0.0, 0.0, z), None
    return (0.5 * length * math.cos(turn), 0.5 * length * math.sin(turn), z), None


def inertial(length: float, rng: random.Random | None) -> tuple[Any, ...]:
    """(mass, com, rpy or None, (ixx, iyy, izz)) of one link."""
    if rng is None:
        transverse = ROD_MASS * (3.0 * ROD_RADIUS ** 2 + length ** 2) / 12.0
        axial = 0.5 * ROD_MASS * ROD_RADIUS ** 2
        return ROD_MASS, (0.0, 0.0, 0.5 * length), None, (transverse, transverse, axial)
    mass = rng.uniform(0.5, 2.0)
    com = tuple(rng.uniform(-0.5, 0.5) * length for _ in range(3))
    # A uniform box of random sides, turned: always a valid inertia.
    x, y, z = (rng.uniform(0.3, 1.2) * length for _ in range(3))
    moments = tuple(mass / 12.0 * s for s in (y * y + z * z, x * x + z * z, x * x + y * y))
    return mass, com, angles(rng), moments


def write(out: TextIO, shape: str, n: int, branching: int = 2, length: float = 0.1, seed: int | None = None,
          types: tuple[str, ...] = ("revolute",)) -> None:
    rng = None if seed is None else random.Random(seed)
    out.write('<?xml version="1.0"?>\n<robot name="%s_%d">\n  <link name="world"/>\n' % (shape, n))
    for k in range(1, n + 1):
        parent = parent_of(shape, k, branching)
        xyz, rpy = origin(shape, k, parent, n, length, branching, rng)
        # Cycle without a seed; with one, every type still appears as soon as it can.
        kind = types[(k - 1) % len(types)] if rng is None or k <= len(types) else rng.choice(types)
        if kind == "planar":
            axis = AXES[2]
        elif rng is None:
            axis = AXES[(k - 1) % 3]
        else:
            axis = triple(direction(rng))
        mass, com, turn, moments = inertial(length, rng)

        lines = ['  <joint name="joint_%d" type="%s">' % (k, kind),
                 '    <parent link="%s"/>' % ("link_%d" % parent if parent else "world"),
                 '    <child link="link_%d"/>' % k,
                 '    <origin xyz="%s"%s/>' % (triple(xyz), ' rpy="%s"' % triple(rpy) if rpy else "")]
        if kind != "floating":
            lines.append('    <axis xyz="%s"/>' % axis)
        if kind == "revolute":
            lines.append('    <limit lower="-3.14159265" upper="3.14159265" effort="100" velocity="10"/>')
        elif kind == "continuous":
            lines.append('    <limit effort="100" velocity="10"/>')
        elif kind == "prismatic":
            lines.append('    <limit lower="%s" upper="%s" effort="100" velocity="1"/>'
                         % (number(-length), number(length)))
        lines += ['  </joint>',
                  '  <link name="link_%d">' % k,
                  '    <inertial>',
                  '      <origin xyz="%s"%s/>' % (triple(com), ' rpy="%s"' % triple(turn) if turn else ""),
                  '      <mass value="%s"/>' % number(mass),
                  '      <inertia ixx="%s" ixy="0" ixz="0" iyy="%s" iyz="0" izz="%s"/>'
                  % tuple(number(m) for m in moments),
                  '    </inertial>',
                  '  </link>\n']
        out.write("\n".join(lines))
    out.write("</robot>\n")


def count(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        raise argparse.ArgumentTypeError("%r is not a whole number" % text)
    if value < 1:
        raise argparse.ArgumentTypeError("must be at least 1, got %d" % value)
    return value


def metres(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError("%r is not a number" % text)
    if not (0.0 < value < math.inf):
        raise argparse.ArgumentTypeError("must be positive and finite, got %s" % text)
    return value


def type_list(text: str) -> tuple[str, ...]:
    names = list(TYPES) if text == "all" else [t.strip() for t in text.split(",") if t.strip()]
    if not names:
        raise argparse.ArgumentTypeError("names no joint type")
    for name in names:
        if name not in TYPES:
            raise argparse.ArgumentTypeError(
                "unknown joint type %r (choose from %s, or all)" % (name, ", ".join(TYPES)))
    return tuple(names)


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    common = argparse.ArgumentParser(add_help=False)
    common.add_argument("n", metavar="N", type=count, help="number of joints, at least 1")
    common.add_argument("--length", type=metres, default=0.1, metavar="M",
                        help="distance between joints in metres (default 0.1)")
    common.add_argument("--seed", type=int, help="vary inertias, placements and axes, repeatably")
    common.add_argument("--types", type=type_list, default=("revolute",), metavar="A,B,...",
                        help="joint types to mix: %s, or all (default revolute)" % ", ".join(TYPES))
    shapes = parser.add_subparsers(dest="shape", metavar="SHAPE", required=True)
    shapes.add_parser("chain", parents=[common], help="N joints in a row")
    tree = shapes.add_parser("tree", parents=[common], help="N joints, filled breadth first")
    tree.add_argument("--branching", type=count, default=2, metavar="B", help="children per link (default 2)")
    shapes.add_parser("star", parents=[common], help="N one-joint branches at the root")
    args = parser.parse_args(argv)

    try:
        write(sys.stdout, args.shape, args.n, getattr(args, "branching", 1), args.length, args.seed, args.types)
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader has gone away (as with `| head`); keep the interpreter's own flush at exit quiet.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
