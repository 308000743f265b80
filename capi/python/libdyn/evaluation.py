"""Evaluations of a state: the algorithms, and the calls that prepare several of them."""

from __future__ import annotations

from ctypes import byref, c_uint32
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .arrays import address, checked, numbers
from .choices import mask
from .data_methods import Algorithms
from .enums import Term
from .fields import Fields
from .library import check, lib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Numbers
    from .enums import TermLike

_forward_kinematics = lib.dyn_forward_kinematics


class Centroidal(NamedTuple):
    """Momentum about the centre of mass, axes of the world."""

    Ag: Numbers
    """(6, nv): hg = Ag v."""
    dAg: Numbers
    """(6, nv): dhg = Ag a + dAg v."""
    hg: Numbers
    """Momentum, (6,)."""
    dhg: Numbers
    """Its time derivative, (6,)."""
    Ig: Numbers
    """Inertia of the whole, (6, 6): [m 1, 0; 0, I]."""


class Evaluation(Algorithms, Fields):
    """The part of Data that computes."""

    def forward_kinematics(self, q: Any = None, v: Any = None, a: Any = None) -> None:
        """Placements of all joints; with v their velocities, with a, too, their accelerations."""
        check(_forward_kinematics(self._m, self._d, self._q(q), self._v(v), self._a(a)))

    def cholesky(self) -> None:
        """Sparse Cholesky factor of the current M. Needs crba."""
        check(lib.dyn_cholesky(self._m, self._d))

    def cholesky_solve(self, b: ArrayLike) -> Numbers:
        """Returns x = M^-1 b for b (nv,) or (nv, n). Needs cholesky."""
        b = numbers(b, "b")
        many = b.shape if b.ndim == 2 else (self.model.nv,)
        b = checked(b, (self.model.nv, *many[1:]), "b")
        x = np.empty(b.shape, order="F")
        check(lib.dyn_cholesky_solve(self._m, self._d, address(b), b.shape[1] if b.ndim == 2 else 1, address(x)))
        return x

    def all_terms(self, terms: TermLike = Term.ALL, q: Any = None, v: Any = None) -> Term:
        """Computes everything in a mask of dyn.Term, passes shared. Returns what is now in data."""
        filled = c_uint32()
        check(lib.dyn_all_terms(self._m, self._d, mask(Term, terms, "terms"), self._q(q), self._v(v), byref(filled)))
        return Term(filled.value)

    def centroidal(self, q: Any = None, v: Any = None, a: Any = None) -> Centroidal:
        """Returns Ag, dAg, hg, dhg and Ig."""
        dAg = self.centroidal_map_time_variation(q, v)
        dhg = self.centroidal_momentum_time_variation(a=a)
        return Centroidal(self.Ag.copy("F"), dAg, self.hg.copy(), dhg, self.Ig.copy("F"))
