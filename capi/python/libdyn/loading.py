"""A model from a file, a text, a buffer."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from ctypes import byref, c_char_p, c_void_p
from typing import TYPE_CHECKING, Any

from . import abi
from .arrays import checked
from .choices import member, text, whole
from .enums import Base, MeshUse, ReportLevel
from .errors import ArgumentError, LoadWarning
from .library import check, lib
from .model import Model

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .enums import BaseLike, MeshUseLike


def _options(base: Any, strict: bool, cos_sin: bool, package_dirs: Any, gravity: Any, srdf: Any, meshes: Any, slots: Any,
             contacts: Any, confined: bool, limits: dict[str, Any]):
    options = abi.initialized(abi.LoadOptions)
    if base is not None:
        options.base = member(Base, base, "base")
    options.strict, options.cos_sin = bool(strict), bool(cos_sin)
    if isinstance(package_dirs, (str, bytes, os.PathLike)):
        package_dirs = [package_dirs]
    folders = [os.fsencode(p) for p in package_dirs]
    if folders:
        options.package_dirs = (c_char_p * len(folders))(*folders)
        options.package_dirs_count = len(folders)
    if gravity is not None:
        options.gravity[:] = checked(gravity, (3,), "gravity").tolist()
    if srdf is not None:
        options.srdf = os.fsencode(srdf)
    options.meshes = member(MeshUse, meshes, "meshes")
    options.constraint_slots, options.contact_capacity = whole(slots, "constraint_slots"), whole(contacts, "contact_capacity")
    options.confined = bool(confined)
    for name, given in limits.items():
        if name == "max_seconds":
            options.max_seconds = float(checked(given, (), name))
        else:
            setattr(options, name, whole(given, name, bits=63 if name == "max_bytes" else 31))
    return options


def _made(handle: Any, name: str) -> Model:
    """The model of a handle; what it lacks of the file becomes one warning of Python."""
    model = Model(handle)
    missing = [r for r in model.report if r.level is ReportLevel.DROPPED]
    if missing:
        first = (f"line {missing[0].line}: " if missing[0].line else "") + missing[0].message
        more = f" (and {len(missing) - 1} more in Model.report)" if len(missing) > 1 else ""
        warnings.warn(f"{name}: {first}{more}", LoadWarning, stacklevel=3)
    return model


def load(
    path: str | os.PathLike[str],
    base: BaseLike | None = None,
    *,
    strict: bool = False,
    cos_sin: bool = False,
    package_dirs: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] = (),
    gravity: ArrayLike | None = None,
    srdf: str | os.PathLike[str] | None = None,
    meshes: MeshUseLike = MeshUse.AUTO,
    constraint_slots: int = 8,
    contact_capacity: int = 0,
    confined: bool = False,
    max_bodies: int = 0,
    max_shapes: int = 0,
    max_constraint_rows: int = 0,
    max_keys: int = 0,
    max_bytes: int = 0,
    max_seconds: float = 0,
) -> Model:
    """Reads a robot from a URDF file, or a model from an MJCF file.

    base          "fixed": the root link is welded to the world; "floating": a free flyer carries it. A root link with
                  mass needs one of them.
    strict        physics that would be dropped is an error
    cos_sin       continuous joints store (cos, sin)
    package_dirs  where package://NAME/... is looked up
    gravity       (3,), m/s^2, world axes; default (0, 0, -9.81), of an MJCF model the file's
    meshes        what stands for collision meshes: "auto", the convex hull of each mesh that can be read, and a warning for each
                  other one; "hull", their convex hulls (report says which are not convex); "triangles"; "none", their names alone. With
                  "hull" and "triangles" a mesh that cannot be read is an error
    constraint_slots  spare slots for constraints that a data of the model has
    contact_capacity  contact points that a step has room for, the deepest; 0: what the shapes need
    confined      for files that are not trusted: included files and meshes outside of the file's folder and package_dirs are errors
    max_bodies, max_shapes, max_constraint_rows, max_keys, max_bytes, max_seconds  limits: a file that asks for more is a dyn.LimitError
                  before it is expanded. 0: the default, of 200,000 links and as many joints, 200,000 shapes, 6,000 rows of constraints,
                  10,000 named configurations, 2^30 bytes of memory (estimated), and no limit of processor time
    srdf          an SRDF file for this robot: its states become named configurations, its pairs Model.disabled_pairs

    Physics of the file that the model lacks (ReportLevel.DROPPED) is shown once a model, as a dyn.LoadWarning. Model.report has all lines.
    """
    name = os.fsencode(path)
    if b"\0" in name:
        raise ArgumentError(f"path holds a zero character: {path!r}.")
    out = c_void_p()
    options = _options(base, strict, cos_sin, package_dirs, gravity, srdf, meshes, constraint_slots, contact_capacity, confined,
                       {"max_bodies": max_bodies, "max_shapes": max_shapes, "max_constraint_rows": max_constraint_rows,
                        "max_keys": max_keys, "max_bytes": max_bytes, "max_seconds": max_seconds})
    check(lib.dyn_model_load(name, byref(options), byref(out)))
    return _made(out.value, os.fsdecode(name))


def load_string(
    urdf: str,
    base: BaseLike | None = None,
    *,
    strict: bool = False,
    cos_sin: bool = False,
    package_dirs: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] = (),
    gravity: ArrayLike | None = None,
    srdf: str | os.PathLike[str] | None = None,
    meshes: MeshUseLike = MeshUse.AUTO,
    constraint_slots: int = 8,
    contact_capacity: int = 0,
    confined: bool = False,
    max_bodies: int = 0,
    max_shapes: int = 0,
    max_constraint_rows: int = 0,
    max_keys: int = 0,
    max_bytes: int = 0,
    max_seconds: float = 0,
) -> Model:
    """Reads a robot from the text of a URDF or MJCF; otherwise as dyn.load."""
    out = c_void_p()
    options = _options(base, strict, cos_sin, package_dirs, gravity, srdf, meshes, constraint_slots, contact_capacity, confined,
                       {"max_bodies": max_bodies, "max_shapes": max_shapes, "max_constraint_rows": max_constraint_rows,
                        "max_keys": max_keys, "max_bytes": max_bytes, "max_seconds": max_seconds})
    check(lib.dyn_model_load_string(text(urdf, "urdf"), byref(options), byref(out)))
    return _made(out.value, "the text")
