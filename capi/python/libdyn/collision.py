"""Collision and distance: between two shapes, and between the parts of a robot."""

from __future__ import annotations

from ctypes import byref, c_int
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import abi
from .arrays import address, checked, numbers
from .arrays import placement as twelve
from .choices import member
from .enums import DistanceMethod, DistanceStatus, PairReason, ShapeType
from .handles import DataHandle
from .library import check, lib
from .mesh import Mesh

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Integers, Numbers
    from .enums import DistanceMethodLike


class Distance(NamedTuple):
    """Distance of two shapes A and B, in axes of the world."""

    status: DistanceStatus
    distance: float
    """m; below zero they overlap, and it is minus the depth."""
    normal: Numbers
    """(3,): unit, from A to B."""
    point_a: Numbers
    """(3,): the witness point on A; point_b - point_a = distance * normal."""
    point_b: Numbers
    residual: float
    """m: bounds the error of the distance."""
    unique: bool
    """False: other points or another normal are as good, so that the distance has no gradient there."""
    iterations: int
    method: DistanceMethod = DistanceMethod.GJK
    """Method that found it."""


def _distance(d: abi.Distance) -> Distance:
    vectors = (np.array(x) for x in (d.normal, d.point_a, d.point_b))
    return Distance(DistanceStatus(d.status), d.distance, *vectors, d.residual, bool(d.unique), d.iterations,
                    DistanceMethod(d.method))


def _geometry(type: Any, size: ArrayLike | Mesh, radius: float, what: str) -> abi.Geometry:
    out = abi.initialized(abi.Geometry)
    out.type, out.radius = member(ShapeType, type, f"{what}: type"), radius
    if out.type == ShapeType.CONVEX and not isinstance(size, Mesh):
        size = Mesh.from_arrays(size).hull()
    if isinstance(size, Mesh):
        out.surface, out.mesh = size._owner.address, size  # kept alive
        return out
    given = np.atleast_1d(numbers(size, f"{what}: size")).tolist()
    out.size[: len(given)] = checked(given, (min(len(given), 3),), f"{what}: size").tolist()
    return out


def geometry_distance(
    a: tuple[Any, ...], placement_a: Any, b: tuple[Any, ...], placement_b: Any, tolerance: float = 0.0,
    method: DistanceMethodLike = DistanceMethod.GJK
) -> Distance:
    """Distance between two shapes, each (type, size) or (type, size, rounding radius), as ("box", (1, 2, 3)) or ("sphere", 0.5);
    sizes as in dyn.ShapeInfo. ("convex", points) is the hull of points (n, 3), or of a dyn.Mesh that is a hull; ("triangles",
    mesh) and ("height_field", mesh) take a dyn.Mesh. tolerance: of the distance, relative to the size of the smaller shape; 0:
    the default.
    method: the one tried first. "ccd" (libccd) is for overlapping convex shapes without a closed form; its result is verified
    before use."""
    A, B = (_geometry(*x, *(0.0,) * (3 - len(x)), what) for x, what in ((a, "a"), (b, "b")))
    X_a, X_b = twelve(placement_a, "placement_a"), twelve(placement_b, "placement_b")
    out = abi.Distance()
    options = abi.initialized(abi.DistanceOptions)
    options.tolerance, options.method = tolerance, member(DistanceMethod, method, "method")
    check(lib.dyn_geometry_distance(byref(A), address(X_a), byref(B), address(X_b), byref(options), byref(out)))
    return _distance(out)


class CollisionQueries(DataHandle):
    """The part of Data that asks how far the collision shapes of a robot are from each other."""

    def compute_distances(self, q: Any = None) -> Numbers:
        """(npairs,), m: signed distance of each pair of Model.pairs, infinite where a pair is not tested."""
        out = np.empty(self.model.npairs)
        check(lib.dyn_distances(self._m, self._d, self._q(q), address(out)))
        return out

    def pair_distance(self, pair: int) -> Distance:
        """Returns the distance of a pair. Needs compute_distances of q."""
        out = abi.Distance()
        check(lib.dyn_pair_distance(self._m, self._d, self.model._index(pair, self.model.npairs, "pair"), byref(out)))
        return _distance(out)

    def distance_gradients(self) -> Numbers:
        """(npairs, nv): derivatives of distances by q on the tangent space; zero where a pair is not tested or its distance has
        none.
        Needs compute_distances of q."""
        out = np.empty((self.model.npairs, self.model.nv), order="F")
        check(lib.dyn_distance_gradients(self._m, self._d, address(out)))
        return out

    def collisions(self, q: Any = None, margin: float = 0.0) -> Integers:
        """Pairs at a distance of at most margin: their numbers, ascending."""
        out, count = np.empty(self.model.npairs, np.int32), c_int()
        check(lib.dyn_collisions(self._m, self._d, self._q(q), margin, address(out), out.size, byref(count)))
        return out[: count.value].copy()

    def set_pair(self, pair: int | None, tested: bool) -> None:
        """Switches a pair, or with None all pairs without meshes, on or off."""
        id = -1 if pair is None else self.model._index(pair, self.model.npairs, "pair")
        check(lib.dyn_data_set_pair(self._m, self._d, id, bool(tested)))

    def pair_reason(self, pair: int) -> PairReason:
        """Returns whether a pair is tested, or the reason why not."""
        out = c_int()
        check(lib.dyn_data_pair(self._m, self._d, self.model._index(pair, self.model.npairs, "pair"), byref(out)))
        return PairReason(out.value)
