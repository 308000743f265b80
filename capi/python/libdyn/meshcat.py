"""Robots in a browser by Meshcat (package meshcat): a thin display.

    from libdyn.meshcat import Display
    display = Display(model)              # prints the address to open
    display(q)
    display.play(trajectory.q, dt=0.01)
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import meshcat
import numpy as np
from meshcat import geometry as g

from .arrays import Placement
from .choices import member
from .enums import Part, ShapeRole, ShapeType
from .triangles import mesh_of, primitive

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Numbers
    from .describe import ShapeInfo
    from .enums import ShapeRoleLike
    from .model import Model

_Y_TO_Z = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])  # Meshcat's cylinders lie along y
_NO_COLOUR = 0.7


def _at(z: float) -> Numbers:
    X = np.eye(4)
    X[2, 3] = z
    return X


def _corners(corners: Numbers, colours: Numbers | None = None) -> g.Geometry:
    """Triangles that share no corners, (n, 3, 3); their colours, (n, 3)."""
    colours = None if colours is None else np.repeat(colours, 3, axis=0)
    return g.TriangularMeshGeometry(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), colours)


def pieces(model: Model, shape: ShapeInfo) -> list[tuple[g.Geometry, Numbers]]:
    """Geometries of a shape, and their placements in its own frame."""
    x, y, z = (float(s) for s in shape.size)
    kind, here = shape.type, np.eye(4)
    if kind == ShapeType.BOX:
        return [(g.Box([x, y, z]), here)]
    if kind == ShapeType.SPHERE:
        return [(g.Sphere(x), here)]
    if kind == ShapeType.ELLIPSOID:
        return [(g.Ellipsoid([x, y, z]), here)]
    if kind == ShapeType.CYLINDER:
        return [(g.Cylinder(y, x), _Y_TO_Z)]
    if kind == ShapeType.CAPSULE:
        return [(g.Cylinder(y, x), _Y_TO_Z), (g.Sphere(x), _at(y / 2)), (g.Sphere(x), _at(-y / 2))]
    if kind == ShapeType.HALF_SPACE:
        return [(g.Box([20.0, 20.0, 0.01]), _at(-0.005))]
    found = primitive(shape)
    if found is not None:
        return [(_corners(found[0]), here)]
    mesh = mesh_of(model, shape)
    if shape.rgba is None and not np.isnan(mesh.colours).all():  # colours are of triangles, and Meshcat's of corners
        colours = np.where(np.isnan(mesh.colours), _NO_COLOUR, mesh.colours)
        return [(_corners(mesh.vertices[mesh.triangles], colours), here)]
    return [(g.TriangularMeshGeometry(np.array(mesh.vertices), np.array(mesh.triangles)), here)]


def _looks(shape: ShapeInfo, geometry: g.Geometry, color: int) -> g.Material:
    """The shape's own colour, or those of its mesh file, or `color`."""
    if shape.rgba is not None:
        red, green, blue = (round(255 * x) for x in shape.rgba[:3])
        return g.MeshLambertMaterial(color=red << 16 | green << 8 | blue, opacity=shape.rgba[3])
    if getattr(geometry, "color", None) is not None:
        return g.MeshLambertMaterial(vertexColors=True)
    return g.MeshLambertMaterial(color=0x606468 if shape.type == ShapeType.HALF_SPACE else color)


class Display:
    """A model's shapes in a Meshcat window, in the colours of their files.

    visualizer  a meshcat.Visualizer to draw in; None: a new one
    role        "visual", "collision"; a robot without visual shapes shows its collision shapes
    root        name below which everything is drawn
    color       of what has none, 0xRRGGBB
    """

    def __init__(self, model: Model, visualizer: Any = None, role: ShapeRoleLike = "visual", root: str = "robot",
                 color: int = 0xB0B8C8):
        self.model = model
        self.visualizer: Any = meshcat.Visualizer() if visualizer is None else visualizer
        self._window = self.visualizer[root]
        self._data = model.data(Part.FRAMES)
        wanted = member(ShapeRole, role, "role")
        shapes = [s for s in model.shapes if s.role == wanted] or [s for s in model.shapes if s.role == ShapeRole.COLLISION]
        shapes += [s for s in model.shapes if s.type == ShapeType.HALF_SPACE and s not in shapes]
        self._shapes = [(f"{s.id}", s.frame, Placement(*s.placement).matrix) for s in shapes]
        for s in shapes:
            for k, (geometry, X) in enumerate(pieces(model, s)):
                piece = self._window[f"{s.id}/{k}"]
                piece.set_object(geometry, _looks(s, geometry, color))
                piece.set_transform(X)
        self(model.neutral())

    def __call__(self, q: ArrayLike) -> None:
        """Shows a configuration, (nq,)."""
        self._data.forward_kinematics(q)
        X = self._data.frame_placements().matrix
        for name, frame, at in self._shapes:
            self._window[name].set_transform(X[frame] @ at)

    def play(self, q: ArrayLike, dt: float, speed: float = 1.0) -> None:
        """Shows rows of q, (R, nq), dt seconds apart."""
        begin = time.monotonic()
        for k, row in enumerate(np.asarray(q)):
            self(row)
            time.sleep(max(0.0, begin + (k + 1) * dt / speed - time.monotonic()))

    def _repr_html_(self) -> str:
        return self.visualizer.render_static()._repr_html_()
