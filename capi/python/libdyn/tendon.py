"""Tendons: lengths that springs, limits, couplings and actuators act on, and their paths in space."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import byref
from math import inf, nan
from typing import TYPE_CHECKING, Any, NamedTuple, Optional, Tuple, Union

import numpy as np

from . import abi
from .arrays import address
from .choices import member, size, string, text
from .enums import TendonElementType, TendonType
from .fields import Fields
from .handles import ModelHandle
from .library import check, lib

if TYPE_CHECKING:
    from .arrays import Integers, Numbers
    from .enums import TendonElementTypeLike, TendonTypeLike


class TendonElement(NamedTuple):
    """An element of a tendon. A plain tuple in the same order will do, as ("sphere", "ball", 0.05)."""

    type: TendonElementTypeLike
    name: Optional[str] = None
    """Of the joint or frame; a pulley has none."""
    value: float = 1.0
    """joint: its coefficient; sphere, cylinder: the radius (m); pulley: the divisor."""
    side: Optional[str] = None
    """sphere, cylinder: a frame on the side that the path prefers; inside the surface: the path passes through the inside."""
    id: int = -1
    """Of the joint or frame; set for a model's element."""
    side_id: int = -1
    """Of the side's frame; set for a model's element."""

    def structure(self, where: str) -> abi.TendonElement:
        """As the library takes it. where: what messages begin with."""
        out = abi.initialized(abi.TendonElement, member(TendonElementType, self.type, f"{where}: type"))
        out.value = self.value
        out.name = None if self.name is None else text(self.name, f"{where}: name")
        out.side = None if self.side is None else text(self.side, f"{where}: side")
        return out


class Tendon(NamedTuple):
    """A tendon of length L. Units are those of L: m, or rad where a fixed tendon adds angles. See dynTendon in dyn.h."""

    type: TendonTypeLike = TendonType.FIXED
    elements: Sequence[Union[TendonElement, Tuple[Any, ...]]] = ()
    stiffness: float = 0.0
    """N/m, of a spring that rests where L is within `rest`."""
    rest: Tuple[float, float] = (nan, nan)
    """m; nan: L in the configuration where joint springs rest."""
    damping: float = 0.0
    """N s/m."""
    friction: float = 0.0
    """N: dry friction, exact in steps."""
    armature: float = 0.0
    """kg: inertia of what moves with L."""
    range: Tuple[float, float] = (-inf, inf)
    """m: L stays within it."""

    def structure(self) -> abi.Tendon:
        """As the library takes it; the elements go beside it."""
        out = abi.initialized(abi.Tendon, member(TendonType, self.type, "type"))
        out.stiffness, out.damping, out.friction, out.armature = self.stiffness, self.damping, self.friction, self.armature
        out.rest[:], out.range[:] = self.rest, self.range
        return out


class TendonPath(NamedTuple):
    """The path of a spatial tendon, in world axes."""

    points: Numbers
    """(n, 3): m; points of arcs among them."""
    begins: Integers
    """(n,): 1 where a branch begins, else 0."""


class ModelTendons(ModelHandle):
    """The part of Model that knows its tendons."""

    @property
    def ntendons(self) -> int:
        return size(lib.dyn_model_ntendons(self._m))

    @property
    def tendon_names(self) -> list[str]:
        return [string(lib.dyn_model_tendon_name(self._m, k)) for k in range(self.ntendons)]

    def tendon_id(self, name: str) -> int:
        """Number of a tendon of the model."""
        return self._id(lib.dyn_model_tendon_id(self._m, text(name, "tendon")))

    def _tendon(self, tendon: int | str) -> int:
        return self.tendon_id(tendon) if isinstance(tendon, str) else self._index(tendon, self.ntendons, "tendon")

    def tendon(self, tendon: str | int) -> Tendon:
        """One of the model's with its elements, by name or number."""
        id, x, e, elements = self._tendon(tendon), abi.Tendon(), abi.TendonElement(), []
        check(lib.dyn_model_tendon_info(self._m, id, byref(x)))
        for k in range(x.elements):
            check(lib.dyn_model_tendon_element(self._m, id, k, byref(e)))
            names = [None if s is None else string(s) for s in (e.name, e.side)]
            elements.append(TendonElement(TendonElementType(e.type), names[0], e.value, names[1], e.id, e.side_id))
        return Tendon(TendonType(x.type), tuple(elements), x.stiffness, tuple(x.rest), x.damping, x.friction, x.armature,
                      tuple(x.range))


class TendonCalls(Fields):
    """The part of Data that knows the paths of tendons."""

    def tendon_path(self, tendon: str | int) -> TendonPath:
        """Points of the path of a spatial tendon at the configuration of tendons(), with points on its arcs; of a fixed tendon
        none."""
        id = self.model._tendon(tendon)
        self.field("tendon_length")  # refused where it is stale
        n = size(lib.dyn_tendon_path(self._m, self._d, id, 0, None, None))
        points, begins = np.empty((n, 3)), np.empty(n, np.int32)
        size(lib.dyn_tendon_path(self._m, self._d, id, n, address(points), address(begins)))
        return TendonPath(points, begins)
