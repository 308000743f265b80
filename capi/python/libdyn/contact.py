"""Contact points, rays, closest points, swept tests, and the broad phase."""

from __future__ import annotations

import ctypes
from ctypes import addressof, byref, c_int, c_uint32, c_void_p
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import abi
from .arrays import Owner, address, checked
from .arrays import placement as twelve
from .collision import _geometry
from .enums import SweepStatus
from .handles import DataHandle
from .library import check, lib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Integers, Numbers

_MOST = 8  # contacts of a pair
_pair = abi.outputs_of(abi.GeometryPair)


class Contact(NamedTuple):
    """A contact point between shapes A and B, in axes of the world."""

    pair: int
    """Index in Model.pairs; -1 between shapes by themselves."""
    shape_a: int
    shape_b: int
    feature: int
    """Which corner, edge or inside of A and of B: the same contact has the same in the next step."""
    distance: float
    """m, along the normal; below zero it is minus the depth."""
    position: Numbers
    """(3,): half way between the shapes."""
    normal: Numbers
    """(3,): unit, from A to B."""


class RayHit(NamedTuple):
    """The first point of a ray on a shape; None stands for no hit."""

    t: float
    """In lengths of the direction; 0: the origin lies inside."""
    position: Numbers
    normal: Numbers
    """(3,): outward unit normal."""


class Rays(NamedTuple):
    """Hits of rays, one row each."""

    t: Numbers
    """(N,): in lengths of the direction, infinite where nothing is hit."""
    shapes: Integers
    """(N,): of Model.shapes; -1 where nothing is hit."""
    normals: Numbers
    """(N, 3): outward unit normals, zero where nothing is hit."""


class SmoothDistances(NamedTuple):
    """Distances of pairs without kinks where faces or edges lie along each other."""

    distances: Numbers
    """(npairs,), m; infinite where a pair is not tested."""
    gradients: Numbers
    """(npairs, nv): derivatives by q on the tangent space."""
    points: Integers
    """(npairs,): how many contact points count: 1: the plain distance, more: it is smoothed, 0: not tested."""


class ClosestPoint(NamedTuple):
    distance: float
    """m; below zero inside."""
    point: Numbers
    """(3,): on the surface."""
    normal: Numbers
    """(3,): outward unit normal there: the given point is point + distance * normal."""
    unique: bool


class Impact(NamedTuple):
    """Result of a swept test."""

    status: SweepStatus
    time: float
    """s."""
    distance: float
    """m, at that time."""
    normal: Numbers
    point_a: Numbers
    point_b: Numbers


def to_contact(c: abi.Contact) -> Contact:
    return Contact(c.pair, c.shape_a, c.shape_b, c.feature, c.distance, np.array(c.position), np.array(c.normal))


def _shape(x: tuple[Any, ...], what: str) -> abi.Geometry:
    return _geometry(*x, *(0.0,) * (3 - len(x)), what)


def geometry_contacts(
    a: tuple[Any, ...], placement_a: Any, b: tuple[Any, ...], placement_b: Any, margin: float = 0.0, tolerance: float = 0.0
) -> list[Contact]:
    """Contact points, at most eight, at a distance of at most margin (m); shapes as in dyn.geometry_distance."""
    A, B = _shape(a, "a"), _shape(b, "b")
    X_a, X_b = twelve(placement_a, "placement_a"), twelve(placement_b, "placement_b")
    out, count = (abi.Contact * _MOST)(), c_int()
    pair = _pair(addressof(A), addressof(B), address(X_a), address(X_b))
    check(lib.dyn_geometry_contacts(pair, margin, tolerance, out, byref(count)))
    return [to_contact(c) for c in out[: count.value]]


def geometry_ray(shape: tuple[Any, ...], placement: Any, origin: ArrayLike, direction: ArrayLike) -> RayHit | None:
    """Returns the first hit of the ray origin + t direction on a solid."""
    S, X = _shape(shape, "shape"), twelve(placement, "placement")
    o, d, out = checked(origin, (3,), "origin"), checked(direction, (3,), "direction"), abi.RayHit()
    check(lib.dyn_geometry_ray(byref(S), address(X), address(o), address(d), byref(out)))
    return None if out.shape < 0 else RayHit(out.t, np.array(out.position), np.array(out.normal))


def geometry_closest_point(shape: tuple[Any, ...], placement: Any, point: ArrayLike) -> ClosestPoint:
    """The point of a shape's surface that is closest to a point."""
    S, X, p, out = _shape(shape, "shape"), twelve(placement, "placement"), checked(point, (3,), "point"), abi.ClosestPoint()
    check(lib.dyn_geometry_closest_point(byref(S), address(X), address(p), byref(out)))
    return ClosestPoint(out.distance, np.array(out.point), np.array(out.normal), bool(out.unique))


def geometry_sweep(
    a: tuple[Any, ...],
    placement_a: Any,
    motion_a: ArrayLike | None,
    b: tuple[Any, ...],
    placement_b: Any,
    motion_b: ArrayLike | None,
    duration: float,
    margin: float = 0.0,
) -> Impact:
    """When two moving shapes come within margin; motions are [linear; angular] (6,) of their frames, in axes of the world, None:
    at rest."""
    A, B = _shape(a, "a"), _shape(b, "b")
    X_a, X_b = twelve(placement_a, "placement_a"), twelve(placement_b, "placement_b")
    V_a, V_b = (None if v is None else checked(v, (6,), name) for v, name in ((motion_a, "motion_a"), (motion_b, "motion_b")))
    out = abi.Impact()
    pair = _pair(addressof(A), addressof(B), address(X_a), address(X_b), address(V_a), address(V_b))
    check(lib.dyn_geometry_sweep(pair, duration, margin, byref(out)))
    vectors = (np.array(x) for x in (out.normal, out.point_a, out.point_b))
    return Impact(SweepStatus(out.status), out.time, out.distance, *vectors)


class BroadPhase:
    """Which of many boxes overlap. One thread at a time."""

    def __init__(self, capacity: int, pair_capacity: int | None = None, margin: float = 0.0):
        """capacity: room for boxes; pair_capacity: for overlaps of boxes made larger by margin (m), by default 64 for each
        box."""
        out = c_void_p()
        check(lib.dyn_broad_phase_new(capacity, 64 * capacity if pair_capacity is None else pair_capacity, margin, byref(out)))
        self._owner = Owner(out.value, lib.dyn_broad_phase_free)
        self._b, self._capacity = out.value, capacity

    def insert(self, lower: ArrayLike, upper: ArrayLike) -> int:
        """The new box's number: the smallest that is free."""
        a, b, id = checked(lower, (3,), "lower"), checked(upper, (3,), "upper"), c_int()
        check(lib.dyn_broad_phase_insert(self._b, address(a), address(b), byref(id)))
        return id.value

    def update(self, id: int, lower: ArrayLike, upper: ArrayLike) -> None:
        a, b = checked(lower, (3,), "lower"), checked(upper, (3,), "upper")
        check(lib.dyn_broad_phase_update(self._b, id, address(a), address(b)))

    def remove(self, id: int) -> None:
        check(lib.dyn_broad_phase_remove(self._b, id))

    def pairs(self) -> Integers:
        """(N, 2): numbers of boxes that overlap or touch, ascending."""
        count = ctypes.c_int64()
        check(lib.dyn_broad_phase_pairs(self._b, None, 0, byref(count)))
        out = np.empty((count.value, 2), np.int32)
        check(lib.dyn_broad_phase_pairs(self._b, address(out), len(out), byref(count)))
        return out

    def query(self, lower: ArrayLike, upper: ArrayLike) -> Integers:
        """Numbers of the boxes that overlap a box, ascending."""
        a, b = checked(lower, (3,), "lower"), checked(upper, (3,), "upper")
        return self._ids(lambda out, n, count: lib.dyn_broad_phase_query(self._b, address(a), address(b), out, n, count))

    def ray(self, origin: ArrayLike, direction: ArrayLike, max_t: float = np.inf) -> Integers:
        """Numbers of the boxes that the ray origin + t direction meets at a t from 0 to max_t, ascending."""
        o, d = checked(origin, (3,), "origin"), checked(direction, (3,), "direction")
        return self._ids(lambda out, n, count: lib.dyn_broad_phase_ray(self._b, address(o), address(d), max_t, out, n, count))

    def _ids(self, call: Any) -> Numbers:
        out, count = np.empty(self._capacity, np.int32), c_int()
        check(call(address(out), out.size, byref(count)))
        return out[: count.value].copy()


class ContactQueries(DataHandle):
    """The part of Data about contacts, rays, and groups of shapes."""

    def contacts(self, q: Any = None, margin: float = 0.0) -> list[Contact]:
        """Contact points of all tested pairs at a distance of at most margin (m), by pairs."""
        room, count, held = 64, c_int(), self._q(q)
        while True:
            out = (abi.Contact * room)()
            check(lib.dyn_contacts(self._m, self._d, held, margin, out, room, byref(count)))
            if count.value <= room:
                return [to_contact(c) for c in out[: count.value]]
            room = count.value

    def smooth_distances(self, smoothing: float, q: Any = None) -> SmoothDistances:
        """Soft minima of the gaps of contact points, s = smoothing (m): below the distance by at most s log 8."""
        n = self.model.npairs
        d, g, p = np.empty(n), np.empty((n, self.model.nv), order="F"), np.empty(n, np.int32)
        check(lib.dyn_smooth_distances(self._m, self._d, self._q(q), smoothing, address(d), address(g), address(p)))
        return SmoothDistances(d, g, p)

    def rays(
        self, origins: ArrayLike, directions: ArrayLike, q: Any = None, max_t: float = np.inf, mask: int = 0xFFFFFFFF
    ) -> Rays:
        """Returns the first hits of rays, (N, 3) each, on collision shapes in a group of mask."""
        o = np.ascontiguousarray(origins, np.float64)
        o = checked(o.T, (3, len(o)), "origins (transposed)")
        d = checked(np.asarray(directions, np.float64).T, o.shape, "directions (transposed)")
        n = o.shape[1]
        t, shapes, normals = np.empty(n), np.empty(n, np.int32), np.empty((3, n), order="F")
        rays = abi.initialized(abi.Rays)
        rays.count, rays.origins, rays.directions, rays.max_t, rays.mask = n, address(o), address(d), max_t, mask
        check(lib.dyn_rays(self._m, self._d, self._q(q), byref(rays), address(t), address(shapes), address(normals)))
        return Rays(t, shapes, normals.T)

    def set_shape_masks(self, shape: int | None, contype: int, conaffinity: int) -> None:
        """Groups that a collision shape, or with None all, is in and collides with, a bit each."""
        check(lib.dyn_data_set_shape_masks(self._m, self._d, -1 if shape is None else shape, contype, conaffinity))

    def shape_masks(self, shape: int) -> tuple[int, int]:
        """The groups that a collision shape is in, and those it collides with."""
        a, b = c_uint32(), c_uint32()
        check(lib.dyn_data_shape_masks(self._m, self._d, shape, byref(a), byref(b)))
        return a.value, b.value
