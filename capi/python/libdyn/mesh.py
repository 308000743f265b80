"""Triangle meshes: files or arrays, what they bound, and their convex hulls."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Sequence
from ctypes import byref, c_char_p, c_void_p
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from . import abi
from .arrays import Owner, address, numbers
from .enums import Status
from .errors import ArgumentError, SizeError
from .library import check, lib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Integers, Numbers


class MeshInfo(NamedTuple):
    vertices: int
    triangles: int
    welded: int
    """Vertices that were made one with another."""
    degenerate: int
    """Triangles without area that were dropped."""
    duplicates: int
    """Triangles there before that were dropped."""
    skipped: int
    """Points and lines of the file."""
    lower: Numbers
    """(3,), m: the bounding box's lowest corner."""
    upper: Numbers
    area: float
    """m^2"""
    components: int
    """Parts that share no edge."""
    open_edges: int
    flipped_edges: int
    """That two triangles pass the same way: one of the two is inside out."""
    nonmanifold_edges: int
    closed: bool
    """The triangles bound a solid."""
    orientation: int
    """1: counter-clockwise seen from outside, -1: inside out; 0: not closed, or no volume."""
    volume: float
    """m^3; NaN where orientation is 0, as are com and inertia."""
    com: Numbers
    """(3,), m"""
    inertia: Numbers
    """(3, 3), kg m^2 at density 1 kg/m^3, about com."""
    hull_status: Status
    """OK, or why there is no hull."""
    hull_volume: float
    hull_volume_ratio: float
    """hull_volume / volume."""
    hull_depth: float
    """m: the largest depth of a triangle's middle under the hull's faces."""
    convex: bool | None
    """None: without the module of hulls nobody can tell."""


def _view(start: int | None, shape: tuple[int, ...], kind: type, owner: Owner) -> Numbers:
    """Read-only view of the mesh's memory that keeps the mesh alive."""
    count = int(np.prod(shape))
    memory = (kind * count).from_address(start) if count else (kind * 0)()
    memory._owner = owner
    array = np.frombuffer(memory, kind).reshape(shape)
    array.flags.writeable = False
    return array


class Mesh:
    """Triangles in metres: equal vertices made one, triangles without area dropped. From dyn.load_mesh or
    dyn.Mesh.from_arrays."""

    def __init__(self, handle: int):
        self._owner = Owner(handle, lib.dyn_mesh_free)
        self._arrays = abi.MeshArrays()
        check(lib.dyn_mesh_arrays(handle, byref(self._arrays)))

    @classmethod
    def from_arrays(cls, vertices: ArrayLike, triangles: ArrayLike = ()) -> Mesh:
        """vertices (n, 3), m; triangles (m, 3), indices of vertices, counter-clockwise seen from outside. Without triangles: a
        cloud of points for hull()."""
        points, corners = np.ascontiguousarray(numbers(vertices, "vertices")), np.asarray(triangles)
        if corners.size == 0:
            corners = np.empty((0, 3), np.int32)
        if points.ndim != 2 or points.shape[1] != 3 or corners.ndim != 2 or corners.shape[1] != 3:
            raise SizeError(f"vertices and triangles must have shape (n, 3), but have {points.shape} and {corners.shape}.")
        if corners.dtype.kind not in "iu":
            raise ArgumentError(f"triangles must hold integers, but their dtype is {corners.dtype}.")
        if corners.size and not (corners.min() >= 0 and corners.max() < 2**31):
            raise ArgumentError("triangles must hold indices of vertices, 0 or more.")
        corners = np.ascontiguousarray(corners, np.int32)
        out = c_void_p()
        check(lib.dyn_mesh_from_arrays(address(points), len(points), address(corners) if len(corners) else None, len(corners),
                                       byref(out)))
        return cls(out.value)

    @classmethod
    def height_field(cls, heights: ArrayLike, step: float | Sequence[float], bottom: float) -> Mesh:
        """Heights over a grid, (rows, columns), all above bottom, m; the point of column i has x = (i - (columns - 1) / 2) *
        step, that of a row y likewise. step: a number, or one for x and one for y."""
        h, steps = np.ascontiguousarray(numbers(heights, "heights")), numbers(step, "step")
        if h.ndim != 2 or steps.shape not in ((), (2,)):
            raise SizeError("heights must have shape (rows, columns) and step be one or two numbers, but their shapes are "
                            f"{h.shape} and {steps.shape}.")
        x, y = np.broadcast_to(steps, 2).tolist()
        out = c_void_p()
        field = abi.initialized(abi.HeightField)
        field.columns, field.rows, field.heights = h.shape[1], h.shape[0], address(h)
        field.step_x, field.step_y, field.bottom = x, y, float(bottom)
        check(lib.dyn_mesh_from_height_field(byref(field), byref(out)))
        return cls(out.value)

    def __repr__(self) -> str:
        return f"<dyn.Mesh: {len(self.vertices)} vertices, {len(self.triangles)} triangles>"

    @property
    def vertices(self) -> Numbers:
        """(n, 3), m"""
        return _view(self._arrays.vertices, (self._arrays.vertex_count, 3), ctypes.c_double, self._owner)

    @property
    def triangles(self) -> Integers:
        """(m, 3), indices of vertices."""
        return _view(self._arrays.triangles, (self._arrays.triangle_count, 3), ctypes.c_int32, self._owner)

    @cached_property
    def colours(self) -> Numbers:
        """(m, 3): red, green, blue of each triangle, 0 to 1, by the file's materials and colours of vertices; NaN where it says
        nothing."""
        rgb = np.empty((len(self.triangles), 3))
        check(lib.dyn_mesh_rgb(self._owner.address, address(rgb)))
        rgb[rgb < 0] = np.nan
        return rgb

    @property
    def planes(self) -> Numbers:
        """(faces, 4), of a hull: unit normals n and offsets, n . x <= offset."""
        return _view(self._arrays.planes, (self._arrays.face_count, 4), ctypes.c_double, self._owner)

    @property
    def faces(self) -> list[Integers]:
        """Corners of each face of a hull, counter-clockwise seen from outside."""
        return self._lists(self._arrays.face_start, self._arrays.face_corners, self._arrays.face_count)

    @property
    def neighbours(self) -> list[Integers]:
        """Vertices that share an edge with each vertex of a hull."""
        return self._lists(self._arrays.neighbour_start, self._arrays.neighbours,
                           self._arrays.vertex_count if self._arrays.face_count else 0)

    def _lists(self, starts: int | None, items: int | None, count: int) -> list[Integers]:
        if not count:
            return []
        start = _view(starts, (count + 1,), ctypes.c_int32, self._owner)
        return np.split(_view(items, (int(start[-1]),), ctypes.c_int32, self._owner), start[1:-1])

    @cached_property
    def info(self) -> MeshInfo:
        """Counts, what the triangles bound, and how that compares with its hull, which is made for it."""
        x = abi.MeshInfo()
        check(lib.dyn_mesh_info(self._owner.address, byref(x)))
        return MeshInfo(
            x.vertices, x.triangles, x.welded, x.degenerate, x.duplicates, x.skipped, np.array(x.lower), np.array(x.upper),
            x.area, x.components, x.open_edges, x.flipped_edges, x.nonmanifold_edges, bool(x.closed), x.orientation, x.volume,
            np.array(x.com), np.array(x.inertia).reshape(3, 3, order="F"), Status(x.hull_status), x.hull_volume,
            x.hull_volume_ratio, x.hull_depth, None if x.convex < 0 else bool(x.convex),
        )  # fmt: skip

    def hull(self) -> Mesh:
        """The convex hull of the vertices, with planes, faces and neighbours."""
        out = c_void_p()
        check(lib.dyn_mesh_hull(self._owner.address, byref(out)))
        return Mesh(out.value)


def load_mesh(
    path: str | os.PathLike[str],
    *,
    scale: float | Sequence[float] = 1.0,
    weld_tolerance: float = 0.0,
    up_z: bool = False,
    package_dirs: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] = (),
    relative_to: str | os.PathLike[str] | None = None,
) -> Mesh:
    """Reads an STL, OBJ, COLLADA (.dae) or glTF (.gltf, .glb) file.

    scale           a factor, or one for each axis
    weld_tolerance  m: vertices as close as this are made one; 0: equal ones only
    up_z            what the file calls up becomes z; otherwise its axes are the mesh's
    package_dirs    where package://NAME/... is looked up
    relative_to     the robot file that names the mesh
    """
    options = abi.initialized(abi.MeshOptions)
    factors = numbers(scale, "scale")
    if factors.shape not in ((), (3,)):
        raise SizeError(f"scale has shape {factors.shape}, but must be a number or have shape (3,).")
    options.scale[:] = np.broadcast_to(factors, 3).tolist()
    options.weld_tolerance, options.up_z = float(weld_tolerance), bool(up_z)
    if isinstance(package_dirs, (str, bytes, os.PathLike)):
        package_dirs = [package_dirs]
    folders = [os.fsencode(p) for p in package_dirs]
    if folders:
        options.package_dirs, options.package_dirs_count = (c_char_p * len(folders))(*folders), len(folders)
    if relative_to is not None:
        options.relative_to = os.fsencode(relative_to)
    name = os.fsencode(path)
    if b"\0" in name:
        raise ArgumentError(f"path holds a zero character: {path!r}.")
    out = c_void_p()
    check(lib.dyn_mesh_load(name, byref(options), byref(out)))
    return Mesh(out.value)
