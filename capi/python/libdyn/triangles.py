"""Triangles of a model's shapes, with normals and colours, for pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .enums import ShapeRole, ShapeType
from .errors import Error
from .mesh import load_mesh
from .placement import Placement

if TYPE_CHECKING:
    from .arrays import Numbers
    from .describe import ShapeInfo
    from .mesh import Mesh
    from .model import Model

PALETTE = np.array([[0x8F, 0xA3, 0xB8], [0x5B, 0x7F, 0xA6], [0xB0, 0xBA, 0xC6], [0x6D, 0x8F, 0x8A], [0x9A, 0x8F, 0xB0],
                    [0x7D, 0x93, 0xA8]]) / 255  # of joints, as in the viewer
_CORD, _SLACK, _PULLS = (np.array(x) / 255 for x in ([0x7A, 0x52, 0x30], [0x3B, 0x5B, 0xC0], [0xD1, 0x49, 0x5B]))
_WORLD = np.array([0.72, 0.72, 0.71])
_MOST = 20_000  # triangles of a mesh
_CREASE = 0.8  # cosine between a face and a vertex normal below which the face keeps its own
_AROUND = 24


class Surface(NamedTuple):
    """Triangles, in the axes of one frame."""

    corners: Numbers
    """(n, 3, 3), m."""
    normals: Numbers
    """(n, 3, 3), one for each corner."""
    colours: Numbers
    """(n, 3), red, green, blue, 0 to 1."""


def _flat(corners: Numbers) -> Numbers:
    n = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(n, axis=1, keepdims=True)
    return n / np.where(length > 0, length, 1)


def _box(half: Numbers) -> tuple[Numbers, Numbers]:
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    corners = (signs * half)[np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])]
    return corners, np.repeat(_flat(corners)[:, None], 3, axis=1)


def _revolved(profile: Numbers) -> tuple[Numbers, Numbers]:
    """A profile about z: rows r, z of both ends of a segment and of the normals there, (n, 8), from below to above."""
    angle = np.linspace(0, 2 * np.pi, _AROUND + 1)
    c, s = np.cos(angle), np.sin(angle)
    at = lambda r, z, k: np.stack([np.outer(r, c[k]), np.outer(r, s[k]), np.outer(z, np.ones(_AROUND))], axis=-1)
    ends = [[at(profile[:, i], profile[:, i + 1], k) for k in (slice(0, -1), slice(1, None))] for i in (0, 2, 4, 6)]
    out = []
    for low, high in ((ends[0], ends[1]), (ends[2], ends[3])):  # places, normals
        first = np.stack([low[0], low[1], high[1]], axis=-2)
        second = np.stack([low[0], high[1], high[0]], axis=-2)
        out.append(np.concatenate([first.reshape(-1, 3, 3), second.reshape(-1, 3, 3)]))
    corners, normals = out
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    real = area > 1e-12 * max(area.max(), 1e-300)  # the axis has none
    return corners[real], normals[real]


def _arc(radius: float, z: float, begin: float, end: float, n: int) -> Numbers:
    """Segments of a profile: a circle about (0, z), from an elevation to another."""
    angle = np.linspace(begin, end, n + 1)
    c, s = np.cos(angle), np.sin(angle)
    c[np.abs(c) < 1e-12] = 0
    return np.stack([radius * c[:-1], z + radius * s[:-1], radius * c[1:], z + radius * s[1:], c[:-1], s[:-1], c[1:], s[1:]],
                    axis=1)


def _thinned(vertices: Numbers, triangles: Numbers) -> Numbers:
    """Which vertex stands for each, and with that which triangles are left: vertices of a cell become one."""
    lower, extent = vertices.min(0), max(float(np.ptp(vertices, axis=0).max()), 1e-300)
    cells = 160
    while True:
        cell = np.floor((vertices - lower) / (extent / cells)).astype(np.int64)
        _, first, which = np.unique(cell @ [1, 1024, 1 << 20], return_index=True, return_inverse=True)
        stands = first[which.reshape(-1)]
        t = stands[triangles]
        kept = (t[:, 0] != t[:, 1]) & (t[:, 1] != t[:, 2]) & (t[:, 2] != t[:, 0])
        if kept.sum() <= _MOST or cells <= 8:
            return np.where(kept[:, None], t, -1)
        cells //= 2


def _of_mesh(mesh: Mesh) -> tuple[Numbers, Numbers, Numbers]:
    """Corners, normals, and the colours of the file."""
    vertices, triangles, colours = np.array(mesh.vertices), np.array(mesh.triangles), np.array(mesh.colours)
    if len(triangles) > _MOST:
        triangles = _thinned(vertices, triangles)
        kept = triangles[:, 0] >= 0
        triangles, colours = triangles[kept], colours[kept]
    corners = vertices[triangles]
    flat = _flat(corners)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    sums = np.stack([np.bincount(triangles.ravel(), np.repeat(flat[:, k] * area, 3), len(vertices)) for k in range(3)], axis=1)
    sums /= np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-300)
    normals = sums[triangles]
    sharp = np.einsum("nij,nj->ni", normals, flat) < _CREASE
    return corners, np.where(sharp[..., None], flat[:, None], normals), colours


def primitive(shape: ShapeInfo) -> tuple[Numbers, Numbers] | None:
    """Corners and normals of a shape that numbers describe; None for others."""
    x, y, _ = (float(s) for s in shape.size)
    r, kind = shape.radius, shape.type
    right = np.pi / 2
    if kind == ShapeType.BOX:
        return _box(np.asarray(shape.size) / 2 + r)
    if kind == ShapeType.SPHERE:
        return _revolved(_arc(x + r, 0, -right, right, 14))
    if kind == ShapeType.ELLIPSOID:
        corners, normals = _revolved(_arc(1, 0, -right, right, 14))
        size = np.asarray(shape.size) + r
        normals = normals / size
        return corners * size, normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    if kind == ShapeType.CAPSULE:
        side = [[x + r, -y / 2, x + r, y / 2, 1, 0, 1, 0]]
        return _revolved(np.concatenate([_arc(x + r, -y / 2, -right, 0, 7), side, _arc(x + r, y / 2, 0, right, 7)]))
    if kind == ShapeType.CYLINDER:
        a, h = x + r, y / 2 + r
        return _revolved(np.array([[0, -h, a, -h, 0, -1, 0, -1], [a, -h, a, h, 1, 0, 1, 0], [a, h, 0, h, 0, 1, 0, 1]], float))
    if kind == ShapeType.CONE:
        n = np.array([y, x]) / np.hypot(x, y)
        return _revolved(np.array([[0, -y / 2, x, -y / 2, 0, -1, 0, -1], [x, -y / 2, 0, y / 2, *n, *n]]))
    return None


def mesh_of(model: Model, shape: ShapeInfo) -> Mesh:
    """Of a shape that is no primitive."""
    return load_mesh(shape.mesh, scale=shape.size) if shape.type == ShapeType.MESH else model.shape_mesh(shape.id)


def _geometry(model: Model, shape: ShapeInfo) -> tuple[Numbers, Numbers, Numbers | None]:
    found = primitive(shape)
    return _of_mesh(mesh_of(model, shape)) if found is None else (*found, None)


def tubes(pieces: Numbers, radius: float) -> Surface:
    """Tendons: six sides about each piece (n, 7), in world axes. Of muscles the colour goes from blue to red."""
    a, b, act = pieces[:, :3], pieces[:, 3:6], pieces[:, 6]
    along = b - a
    length = np.linalg.norm(along, axis=1, keepdims=True)
    a, b, act, along = (x[length[:, 0] > 0] for x in (a, b, act, along / np.where(length > 0, length, 1)))
    side = np.cross(along, np.eye(3)[np.argmin(np.abs(along), axis=1)])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    other, corners, normals = np.cross(along, side), [], []
    angle = np.linspace(0, 2 * np.pi, 7)
    for u, v in zip(angle[:-1], angle[1:]):
        n, m = (np.cos(x) * side + np.sin(x) * other for x in (u, v))
        corners += [np.stack(x, axis=1) for x in ((a + radius * n, a + radius * m, b + radius * m),
                                                  (a + radius * n, b + radius * m, b + radius * n))]
        normals += [np.stack(x, axis=1) for x in ((n, m, m), (n, m, n))]
    pulls = np.clip(act, 0, 1)[:, None]
    colours = np.where(act[:, None] < 0, _CORD, _SLACK + pulls * (_PULLS - _SLACK))
    return Surface(np.concatenate(corners), np.concatenate(normals), np.tile(colours, (12, 1)))


def drawn(model: Model, role: ShapeRole) -> list[ShapeInfo]:
    """Shapes of a role but half-spaces; where there are none, collision shapes. What surrounds the robot is collision shapes,
    too: of the world, where it has no visual ones."""
    solid = [s for s in model.shapes if s.type != ShapeType.HALF_SPACE and (s.rgba is None or s.rgba[3] > 0.05)]
    found = [s for s in solid if s.role == role] or [s for s in solid if s.role == ShapeRole.COLLISION]
    fixed = lambda s: model.frames[s.frame].joint == 0
    if not any(map(fixed, found)):
        found += [s for s in solid if fixed(s)]
    return found


def surfaces(model: Model, role: ShapeRole) -> tuple[list[tuple[int, Surface]], list[str]]:
    """Surfaces with the frames that carry them, and notes on meshes that cannot be read."""
    out, notes = [], []
    for shape in drawn(model, role):
        try:
            corners, normals, own = _geometry(model, shape)
        except Error as error:
            notes.append(str(error))
            continue
        X = Placement(*shape.placement)
        joint = model.frames[shape.frame].joint
        colour = (np.array(shape.rgba[:3]) if shape.rgba is not None else
                  PALETTE[joint % len(PALETTE)] if joint else _WORLD)
        colours = np.tile(colour, (len(corners), 1))
        if own is not None and shape.rgba is None:
            colours = np.where(np.isnan(own), colours, own)
        out.append((shape.frame, Surface(corners @ X.rotation.T + X.translation, normals @ X.rotation.T, colours)))
    return out, notes
