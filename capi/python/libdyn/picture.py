"""Pictures of a model, by numpy alone: no screen, no graphics card, no other package."""

from __future__ import annotations

import os
import struct
import zlib
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .choices import member, whole
from .enums import JointType, Part, ShapeRole, ShapeType
from .errors import ArgumentError, SizeError
from .placement import Placement
from .raster import raster
from .tendon_lines import TendonLines
from .triangles import surfaces, tubes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .arrays import Integers, Numbers
    from .enums import ShapeRoleLike
    from .model import Model

    Image = NDArray[np.uint8]

_SUN = np.array([-0.8, 1.2, -2.4]) / np.linalg.norm([-0.8, 1.2, -2.4])  # where its light goes, as in the viewer
_SKY, _HORIZON = np.array([0.80, 0.86, 0.93]), np.array([0.95, 0.96, 0.97])
_FLOOR = np.array([[0.86, 0.87, 0.89], [0.78, 0.80, 0.83]])
_SHADOW = 512  # pixels of a side of the sun's depth buffer


class Camera(NamedTuple):
    """Where a picture is taken from. None: by what the model is."""

    target: ArrayLike | None = None
    """(3,), m: what it looks at; default: the middle of what moves."""
    distance: float | None = None
    """m, from the target; default: what moves fills the picture."""
    azimuth: float = -51.0
    """Degrees about z; 0: the camera stands on the side of +x, 90: of +y."""
    elevation: float = 25.0
    """Degrees above the horizon."""
    fov: float = 42.0
    """Degrees, of the picture's height."""
    follow: int | str | None = None
    """Frame whose motion the target takes part in; default: the floating base, if there is one."""


class Renderer:
    """Makes pictures of a model.

    >>> import libdyn as dyn
    >>> m = dyn.load("models/robots/go2.urdf", base="floating")
    >>> picture = dyn.Renderer(m, 320, 240, dyn.Camera(azimuth=30)).render(m.neutral())
    >>> picture.shape, picture.dtype.name
    ((240, 320, 3), 'uint8')

    width, height  pixels
    camera         see Camera
    role           "visual", or "collision"; a model without visual shapes shows its collision shapes
    smooth         each pixel is the mean of four
    shadows        the sun's

    Shapes have the colours of their files, else one for each joint. Half-spaces are floors. Opacity and textures are not drawn.
    """

    model: Model
    width: int
    height: int
    smooth: bool
    shadows: bool

    def __init__(self, model: Model, width: int = 640, height: int = 480, camera: Camera | None = None, *,
                 role: ShapeRoleLike = "visual", smooth: bool = True, shadows: bool = True):
        self.model, self.width, self.height = model, whole(width, "width", 1), whole(height, "height", 1)
        if self.width * self.height > 1 << 24:
            raise ArgumentError(f"a picture of {width} x {height} pixels is too large: 2^24 are the most.")
        self.smooth, self.shadows = smooth, shadows
        self.notes: list[str]
        """What could not be drawn."""
        found, self.notes = surfaces(model, ShapeRole(member(ShapeRole, role, "role")))
        self._data = model.data(Part.FRAMES)
        parts = [s for _, s in found]
        self._frame = np.repeat([frame for frame, _ in found], [len(s.corners) for s in parts]).astype(np.int64)
        self._corners, self._normals, self._colours = (
            np.concatenate([getattr(s, name) for s in parts]) if parts else np.empty(shape)
            for name, shape in (("corners", (0, 3, 3)), ("normals", (0, 3, 3)), ("colours", (0, 3))))
        self._moves = np.array([f.joint != 0 for f in model.frames])[self._frame]
        self._floors = [(s.frame, Placement(*s.placement)) for s in model.shapes if s.type == ShapeType.HALF_SPACE]
        self._tendons = TendonLines(model) if model.ntendons else None
        self._set_camera(camera or Camera())

    def __repr__(self) -> str:
        return f"<dyn.Renderer of {self.model.name!r}: {self.width} x {self.height}, {len(self._corners)} triangles>"

    @property
    def camera(self) -> Camera:
        """As it was set."""
        return self._camera

    @camera.setter
    def camera(self, camera: Camera) -> None:
        self._set_camera(camera)

    def _set_camera(self, camera: Camera) -> None:
        self._camera, self._target, self._sky = camera, None, None
        if not 1 <= camera.fov <= 170:
            raise ArgumentError(f"fov is {camera.fov}, but must be from 1 to 170 degrees.")
        if camera.distance is not None and not camera.distance > 0:
            raise ArgumentError(f"distance is {camera.distance}, but must be larger than 0.")
        if camera.target is not None and np.shape(camera.target) != (3,):
            raise SizeError(f"target has shape {np.shape(camera.target)}, but must have shape (3,).")
        free = [j for j in self.model.joints if j.type == JointType.FREE_FLYER]
        if camera.follow is not None:
            self._follow: int | None = self.model._frame(camera.follow)
        elif len(free) == 1:
            self._follow = next((f.id for f in self.model.frames if f.joint == free[0].id), None)
        else:
            self._follow = None

    def _place_camera(self, corners: Numbers, frames: Placement) -> None:
        """Once, at the first picture: what it looks at, from how far."""
        shown = corners[self._moves] if self._moves.any() else corners
        lower, upper = (shown.min((0, 1)), shown.max((0, 1))) if len(shown) else (np.full(3, -0.5), np.full(3, 0.5))
        camera = self._camera
        self._target = (lower + upper) / 2 if camera.target is None else np.asarray(camera.target, float)
        self._size = max(float(np.linalg.norm(upper - lower)), 0.05)
        self._distance = camera.distance or 0.62 * self._size / np.tan(np.deg2rad(camera.fov) / 2)
        self._from = None if self._follow is None else frames.translation[self._follow].copy()

    def render(self, q: ArrayLike, act: ArrayLike | None = None) -> Image:
        """A picture of a configuration: (height, width, 3), red, green, blue, 0 to 255. The first one places a camera that was
        not told where to look. act: activations, which colour the tendons of muscles; default 0."""
        self._data.forward_kinematics(q)
        frames = self._data.frame_placements()
        R = frames.rotation[self._frame]
        corners = self._corners @ np.swapaxes(R, 1, 2) + frames.translation[self._frame][:, None]
        normals = self._normals @ np.swapaxes(R, 1, 2)
        if self._target is None:
            self._place_camera(corners, frames)
        colours = self._colours
        if self._tendons is not None:
            lines = tubes(self._tendons(q, act), 0.006 * self._size)
            corners, normals, colours = (np.concatenate(x) for x in zip((corners, normals, colours), lines))
        target = self._target
        if self._from is not None:
            target = target + frames.translation[self._follow] - self._from
        view = _View(self._camera, target, self._distance)
        sun = self._sun(corners, target) if self.shadows and len(corners) else None
        floors = [Placement(frames.rotation[frame], frames.translation[frame]) @ X for frame, X in self._floors]
        picture = self._behind(view, floors, sun)
        fine = 2 if self.smooth else 1
        pixel, triangle, point, normal = view.visible(corners, normals, fine * self.width, fine * self.height)
        above = np.ones(len(pixel), bool)
        for X in floors:
            n = X.rotation[:, 2]
            if (view.eye - X.translation) @ n > 0:
                above &= (point - X.translation) @ n >= 0
        pixel, triangle, point, normal = pixel[above], triangle[above], point[above], normal[above]
        back = np.einsum("ij,ij->i", normal, point - view.eye) > 0  # seen from inside, or a file's wrong order
        normal = np.where(back[:, None], -normal, normal)
        lit = np.maximum(-(normal @ _SUN), 0) * (1.0 if sun is None else sun(point))
        colour = colours[triangle] * (0.50 + 0.14 * normal[:, 2] + 0.58 * lit)[:, None]
        row, column = np.divmod(pixel, fine * self.width)
        coarse = row // fine * self.width + column // fine
        covered = np.bincount(coarse, minlength=len(picture))
        shown = np.flatnonzero(covered)
        for k in range(3):
            sums = np.bincount(coarse, np.minimum(colour[:, k], 1), len(picture))[shown]
            picture[shown, k] += (sums - covered[shown] * picture[shown, k]) / fine**2
        out: Image = np.rint(255 * picture).astype(np.uint8).reshape(self.height, self.width, 3)
        return out

    def _behind(self, view: _View, floors: list[Placement], sun: _Sun | None) -> Numbers:
        """The sky, and floors: squares that vanish in the distance, (height * width, 3)."""
        if self._sky is None:
            self._rays = view.rays(self.width, self.height)
            up = np.clip(2.5 * self._rays[:, 2:] / np.linalg.norm(self._rays, axis=1, keepdims=True), 0, 1)
            self._sky = _HORIZON * (1 - up) + _SKY * up
        picture, nearest = self._sky.copy(), np.full(len(self._sky), 60 * self._size + 20 * self._distance)
        cell = 10.0 ** np.round(np.log10(self._size / 2))
        for X in floors:
            height = (view.eye - X.translation) @ X.rotation[:, 2]
            if height <= 0:
                continue
            down = -(self._rays @ X.rotation[:, 2])
            hit = np.flatnonzero(down * nearest > height)
            t = height / down[hit]
            nearest[hit] = t
            point = view.eye + t[:, None] * self._rays[hit]
            squares = np.floor((point - X.translation) @ X.rotation[:, :2] / cell).astype(np.int64).sum(1) & 1
            fade = np.clip(t / (8 * self._distance + 4 * self._size), 0, 1)[:, None]
            colour = _FLOOR[squares] * (1 - fade) + _HORIZON * fade
            picture[hit] = colour if sun is None else colour * (0.72 + 0.28 * sun(point))[:, None]
        return picture

    def _sun(self, corners: Numbers, target: Numbers) -> _Sun:
        return _Sun(corners, target, 0.75 * self._size)


class _Sun:
    """What the sun sees first, about a place."""

    def __init__(self, corners: Numbers, target: Numbers, reach: float):
        u = np.cross([0.0, 0.0, 1.0], _SUN)
        u /= np.linalg.norm(u)
        self.axes, self.target, self.reach, self.cell = np.stack([u, np.cross(_SUN, u), _SUN]), target, reach, 2 * reach / _SHADOW
        at = (corners - target) @ self.axes.T
        pixel, triangle, share = raster((at[..., :2] + reach) / self.cell, -at[..., 2], _SHADOW, _SHADOW)
        self.first = np.full(_SHADOW * _SHADOW, np.inf)
        self.first[pixel] = np.einsum("ij,ij->i", share, at[triangle, :, 2])

    def __call__(self, point: Numbers) -> Numbers:
        """Share of its light that comes to places (n, 3)."""
        here = (point - self.target) @ self.axes.T
        column, row = (here[:, :2].T + self.reach) / self.cell
        inside = np.flatnonzero((column > 1) & (column < _SHADOW - 2) & (row > 1) & (row < _SHADOW - 2))
        column, row, depth = column[inside], row[inside], here[inside, 2] - 3 * self.cell
        light = np.zeros(len(inside))
        for dx, dy in ((-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)):
            light += self.first[(row + dy).astype(np.int64) * _SHADOW + (column + dx).astype(np.int64)] > depth
        out = np.ones(len(point))
        out[inside] = light / 4
        return out


class _View:
    """A camera at its place."""

    def __init__(self, camera: Camera, target: Numbers, distance: float):
        a, e = np.deg2rad([camera.azimuth, camera.elevation])
        out = np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        self.eye = target + distance * out
        self.axes = np.stack([right, np.cross(right, out), -out])  # right, down, ahead
        self.focus = 0.5 / np.tan(np.deg2rad(camera.fov) / 2)  # in heights of the picture
        self.near = distance / 1000

    def rays(self, width: int, height: int) -> Numbers:
        """(height * width, 3): one metre ahead along each pixel's ray."""
        x, y = ((np.arange(n) + 0.5 - n / 2) / (self.focus * height) for n in (width, height))
        u, v = np.meshgrid(x, y)
        return np.stack([u.ravel(), v.ravel(), np.ones(u.size)], axis=1) @ self.axes

    def visible(
        self, corners: Numbers, normals: Numbers, width: int, height: int
    ) -> tuple[Integers, Integers, Numbers, Numbers]:
        """Pixels with their triangles, the places that they show, and the normals there."""
        at = (corners - self.eye) @ self.axes.T
        ahead = np.flatnonzero((at[..., 2] > self.near).all(1))
        at = at[ahead]
        w = 1 / at[..., 2]
        xy = at[..., :2] * (self.focus * height * w[..., None]) + [width / 2, height / 2]
        pixel, triangle, share = raster(xy, w, width, height)
        share = share * w[triangle]  # from shares of the picture to those of the triangle
        share /= share.sum(1, keepdims=True)
        which = ahead[triangle]
        point = np.einsum("ni,nij->nj", share, corners[which])
        normal = np.einsum("ni,nij->nj", share, normals[which])
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        return pixel, which, point, normal / np.where(length > 0, length, 1)


def png(picture: Image) -> bytes:
    """A picture (h, w, 3) as a PNG file."""
    h, w, _ = picture.shape
    rows = np.zeros((h, 1 + 3 * w), np.uint8)
    rows[:, 1:] = picture.reshape(h, -1)
    rows[:, 1:] -= np.pad(rows[:, 1:-3], ((0, 0), (3, 0)))  # less the pixel on the left (PNG's filter 1)
    rows[:, 0] = 1

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", w, h, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)) + chunk(b"IEND", b"")


def write_png(picture: Image, path: str | os.PathLike[str]) -> None:
    """Writes a picture as a PNG file."""
    with open(path, "wb") as file:
        file.write(png(picture))
