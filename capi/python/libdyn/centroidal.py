"""Momentum about the centre of mass."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .fields import ID
from .library import check, lib

_centroidal_derivatives = lib.dyn_centroidal_derivatives
_centroidal_map = lib.dyn_centroidal_map
_centroidal_map_time_variation = lib.dyn_centroidal_map_time_variation
_centroidal_momentum = lib.dyn_centroidal_momentum
_centroidal_momentum_rate = lib.dyn_centroidal_momentum_time_variation


class Centroidal(NamedTuple):
    """About the centre of mass, axes of the world."""

    Ag: np.ndarray
    """(6, nv): hg = Ag v."""
    dAg: np.ndarray
    """(6, nv): dhg = Ag a + dAg v."""
    hg: np.ndarray
    """Momentum, (6,)."""
    dhg: np.ndarray
    """Its time derivative, (6,)."""
    Ig: np.ndarray
    """Inertia of the whole, (6, 6): [m 1, 0; 0, I]."""


class CentroidalDerivatives(NamedTuple):
    """On the tangent space, (6, nv) each."""

    dh_dq: np.ndarray
    dhdot_dq: np.ndarray
    dhdot_dv: np.ndarray
    dhdot_da: np.ndarray


class CentroidalDynamics:
    """The part of Data about the centre of mass."""

    def centroidal_map(self, q: Any = None, v: Any = None) -> np.ndarray:
        """Ag, (6, nv): hg = Ag v, the momentum about the centre of mass, axes of the world; also the fields Ig and hg."""
        return self._result(_centroidal_map(self._m, self._d, self._q(q), self._v(v), None, None, None), ID["Ag"])

    def centroidal_map_time_variation(self, q: Any = None, v: Any = None) -> np.ndarray:
        """dAg, (6, nv): dhg = Ag a + dAg v; also the fields Ag, Ig and hg."""
        return self._result(_centroidal_map_time_variation(self._m, self._d, self._q(q), self._v(v), None), ID["dAg"])

    def centroidal_momentum(self, q: Any = None, v: Any = None) -> np.ndarray:
        """hg, (6,), without Ag."""
        return self._result(_centroidal_momentum(self._m, self._d, self._q(q), self._v(v), None), ID["hg"])

    def centroidal_momentum_time_variation(self, q: Any = None, v: Any = None, a: Any = None) -> np.ndarray:
        """dhg, (6,), the time derivative of hg for the acceleration a; also the field hg."""
        status = _centroidal_momentum_rate(self._m, self._d, self._q(q), self._v(v), self._a(a), None)
        return self._result(status, ID["dhg"])

    def centroidal(self, q: Any = None, v: Any = None, a: Any = None) -> Centroidal:
        """(Ag, dAg, hg, dhg, Ig)."""
        dAg = self.centroidal_map_time_variation(q, v)
        dhg = self.centroidal_momentum_time_variation(a=a)
        return Centroidal(self.Ag.copy("F"), dAg, self.hg.copy(), dhg, self.Ig.copy("F"))

    def centroidal_derivatives(self, q: Any = None, v: Any = None, a: Any = None) -> CentroidalDerivatives:
        """Derivatives (dh_dq, dhdot_dq, dhdot_dv, dhdot_da) of hg and dhg; also the fields Ag, Ig, hg and dhg."""
        check(_centroidal_derivatives(self._m, self._d, self._q(q), self._v(v), self._a(a), None, None, None, None))
        return CentroidalDerivatives(*(x.copy("F") for x in (self.dh_dq, self.dhdot_dq, self.dhdot_dv, self.Ag)))
