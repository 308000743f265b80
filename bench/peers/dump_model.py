#!/usr/bin/env python3
"""Write a robot model as the text dump that pinocchio_bench reads.

Usage:  dump_model.py ROBOT.urdf [--fixed|--floating] [--no-mimic] [--name NAME] [-o FILE]
        dump_model.py chain N [-o FILE]

  ROBOT.urdf   parsed by Pinocchio (Python module 'pinocchio', wheel 'pin'), so that joints, axes,
               merged fixed links and inertias are the ones Pinocchio itself uses
  --floating   free-flyer root joint (default: --fixed)
  --no-mimic   treat mimic joints as ordinary joints. Default: keep them, where the URDF has some;
               Pinocchio does not support all algorithms then (see pinocchio_bench.cpp)
  chain N      N revolute joints, axes cycling x, y, z, 0.1 m apart along z, varied inertias
               (needs no Pinocchio)
  -o FILE      default: standard output

Format, one line per item, numbers with 17 digits:
  dyn-bench-model 1
  name NAME
  gravity X Y Z
  universe INERTIA                     bodies welded to the world
  joint NAME PARENT TYPE AXIS R P ARMATURE [MIMIC-DATA] INERTIA
  contact NAME point|frame JOINT R P   feet on the ground: faces of links ..._sole, else
                                         points of ..._foot; of a chain points at its end and half-way
Joints are numbered from 1 in the order of the file, 0 is the universe. TYPE: RX RY RZ RU
(revolute), PX PY PZ PU (prismatic), RUBX RUBY RUBZ RUBU (unbounded, cos/sin), SPHERICAL, PLANAR,
FREE or MIMIC; AXIS: 3 numbers; R: 9 numbers, by rows, and P: 3, placement in the parent joint;
MIMIC-DATA, for MIMIC only: underlying TYPE, number of the mimicked joint, scaling, offset;
INERTIA: mass, centre of mass (3), xx xy xz yy yz zz about the centre of mass.
"""
import argparse
import math
import re
import sys
from pathlib import Path

TYPES = {
    "JointModelRX": "RX", "JointModelRY": "RY", "JointModelRZ": "RZ",
    "JointModelRevoluteUnaligned": "RU",
    "JointModelPX": "PX", "JointModelPY": "PY", "JointModelPZ": "PZ",
    "JointModelPrismaticUnaligned": "PU",
    "JointModelRUBX": "RUBX", "JointModelRUBY": "RUBY", "JointModelRUBZ": "RUBZ",
    "JointModelRevoluteUnboundedUnaligned": "RUBU",
    "JointModelSpherical": "SPHERICAL", "JointModelPlanar": "PLANAR",
    "JointModelFreeFlyer": "FREE",
}
UNIT = {"X": (1, 0, 0), "Y": (0, 1, 0), "Z": (0, 0, 1)}


def die(text):
    sys.exit("dump_model: " + text)


def numbers(values):
    return " ".join(repr(float(x)) if math.isfinite(x) else die("a number is not finite")
                    for x in values)


def word(name):
    return re.sub(r"\s+", "_", name) or "_"


def chain(n):
    if n < 1:
        die("a chain needs at least one joint")
    lines = ["dyn-bench-model 1", f"name chain{n}", "gravity 0 0 -9.81",
             "universe 0 0 0 0 0 0 0 0 0 0"]
    for i in range(n):
        k = "XYZ"[i % 3]
        m = 1.0 + 0.05 * (i % 7)
        com = (0.003 * (i % 3 - 1), 0.002 * (i % 5 - 2), 0.05)
        # a solid box; off-diagonal terms small enough to keep it a physical inertia
        a, b, c = 0.04 + 0.002 * (i % 4), 0.05 + 0.003 * (i % 3), 0.1
        inertia = (m / 12 * (b * b + c * c), 2e-6 * (i % 3 - 1), 3e-6 * (i % 2),
                   m / 12 * (a * a + c * c), -1e-6 * (i % 4), m / 12 * (a * a + b * b))
        placement = (1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0.1 if i else 0)
        lines.append(f"joint joint{i + 1} {i} R{k} {numbers(UNIT[k])} {numbers(placement)} 0 "
                     f"{numbers((m, *com, *inertia))}")
    return lines


def from_urdf(args):
    path = Path(args.model[0])
    if not path.is_file():
        die(f"no such file: {path}")
    try:
        import pinocchio as pin
    except ImportError as e:
        die(f"the Python module pinocchio is missing ({e}); use the Python of the environment that "
            "build_pinocchio.py makes")

    def load(mimic):
        if args.floating:
            return pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer(), mimic)
        return pin.buildModelFromUrdf(str(path), mimic)

    plain = load(False)
    try:
        model = plain if args.no_mimic else load(True)
    except Exception as e:  # e.g. a mimic joint placed before the joint it mimics
        die(f"{path}: {e}; try --no-mimic")
    mimicked = dict(zip((int(i) for i in model.mimicking_joints),
                        (int(i) for i in model.mimicked_joints)))

    def describe(joint):
        short = joint.shortname()
        if short not in TYPES:
            die(f"{path}: joint type {short} is not handled")
        kind = TYPES[short]
        if kind[-1] in UNIT and kind[0] in "RP":
            return kind, UNIT[kind[-1]]
        inner = joint.extract() if hasattr(joint, "extract") else joint
        return kind, tuple(inner.axis) if kind.endswith("U") else (0, 0, 0)

    def inertia(y):
        i = y.inertia
        return numbers((y.mass, *y.lever, i[0, 0], i[0, 1], i[0, 2], i[1, 1], i[1, 2], i[2, 2]))

    lines = ["dyn-bench-model 1", f"name {word(args.name or path.stem)}",
             f"gravity {numbers(model.gravity.linear)}", f"universe {inertia(model.inertias[0])}"]
    for i in range(1, model.njoints):
        joint, name = model.joints[i], model.names[i]
        mimic, armature = "", 0.0
        if i in mimicked:
            # Python does not show the underlying joint: the same URDF without mimic does.
            base, axis = describe(plain.joints[plain.getJointId(name)])
            inner = joint.extract()
            kind = "MIMIC"
            mimic = f"{base} {mimicked[i]} {numbers((inner.scaling, inner.offset))} "
        else:
            kind, axis = describe(joint)
            values = set(model.armature[joint.idx_v:joint.idx_v + joint.nv])
            if len(values) > 1:
                die(f"{path}: joint {name} has different armatures along its axes")
            armature = values.pop()
        place = model.jointPlacements[i]
        lines.append(f"joint {word(name)} {model.parents[i]} {kind} {numbers(axis)} "
                     f"{numbers(place.rotation.flatten())} {numbers(place.translation)} "
                     f"{numbers((armature,))} {mimic}{inertia(model.inertias[i])}")
    links = [f for f in model.frames if f.type == pin.FrameType.BODY]
    soles = [f for f in links if f.name.endswith("_sole")]
    for f in soles or [f for f in links if f.name.endswith("_foot")]:
        lines.append(f"contact {word(f.name)} {'frame' if soles else 'point'} {f.parentJoint} "
                     f"{numbers(f.placement.rotation.flatten())} {numbers(f.placement.translation)}")
    if model.name.startswith("chain"):
        lines += [f"contact point_{j} point {j} 1 0 0 0 1 0 0 0 1 0 0 0" for j in (model.njoints - 1, (model.njoints - 1) // 2)]
    return lines


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    p.add_argument("model", nargs="+", metavar="ROBOT.urdf | chain N")
    base = p.add_mutually_exclusive_group()
    base.add_argument("--fixed", action="store_true")
    base.add_argument("--floating", action="store_true")
    p.add_argument("--no-mimic", action="store_true")
    p.add_argument("--name")
    p.add_argument("-o", "--output", type=Path)
    args = p.parse_args()
    if args.model[0] == "chain" and len(args.model) == 2:
        if not args.model[1].isdigit():
            die("chain N: N must be a number")
        if args.floating:
            die("chains have a fixed base")
        lines = chain(int(args.model[1]))
        if args.name:
            lines[1] = "name " + word(args.name)
    elif len(args.model) == 1:
        lines = from_urdf(args)
    else:
        p.error("one URDF file, or: chain N")
    text = "\n".join(lines) + "\n"
    if args.output:
        args.output.write_text(text)
    else:
        sys.stdout.write(text)


if __name__ == "__main__":
    main()
