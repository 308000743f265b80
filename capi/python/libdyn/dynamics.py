"""Forces and accelerations: RNEA, ABA, CRBA, energies, and all terms at once."""

from __future__ import annotations

from ctypes import byref, c_double, c_uint32
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .arrays import address, checked, numbers
from .choices import mask
from .enums import Term
from .fields import ID
from .library import check, lib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

# Bound once: an attribute of the CDLL costs a look-up in every call.
_aba = lib.dyn_aba
_coriolis_matrix = lib.dyn_coriolis_matrix
_crba = lib.dyn_crba
_gravity = lib.dyn_gravity_torque
_minverse = lib.dyn_minv
_nonlinear_effects = lib.dyn_nle
_rnea = lib.dyn_rnea
_static_torque = lib.dyn_static_torque


class Energy(NamedTuple):
    """Joules; potential is zero at the world's origin."""

    kinetic: float
    potential: float

    @property
    def mechanical(self) -> float:
        return self.kinetic + self.potential


class Dynamics:
    """The part of Data that computes forces, accelerations and energies."""

    # fext: external forces [force; moment] on each joint's body, in the joint's frame, (6, njoints); column 0 is ignored.

    def rnea(self, q: Any = None, v: Any = None, a: Any = None, fext: ArrayLike | None = None) -> np.ndarray:
        """Inverse dynamics tau = M a + nle - J^T fext, (nv,), N m or N."""
        return self._result(_rnea(self._m, self._d, self._q(q), self._v(v), self._a(a), self._fext(fext), None), ID["tau"])

    def compute_nle(self, q: Any = None, v: Any = None) -> np.ndarray:
        """nle = tau at a = 0: Coriolis, centrifugal, gravity, (nv,)."""
        return self._result(_nonlinear_effects(self._m, self._d, self._q(q), self._v(v), None), ID["nle"])

    def gravity_torque(self, q: Any = None) -> np.ndarray:
        """g = tau at v = a = 0, (nv,)."""
        return self._result(_gravity(self._m, self._d, self._q(q), None), ID["g"])

    def compute_static_torque(self, q: Any = None, fext: ArrayLike | None = None) -> np.ndarray:
        """tau that holds q at rest: g - J^T fext, (nv,)."""
        return self._result(_static_torque(self._m, self._d, self._q(q), self._fext(fext), None), ID["static_torque"])

    def coriolis_matrix(self, q: Any = None, v: Any = None) -> np.ndarray:
        """C, (nv, nv): C v + g = nle, and dM/dt - 2 C is skew-symmetric."""
        return self._result(_coriolis_matrix(self._m, self._d, self._q(q), self._v(v), None), ID["coriolis"])

    def aba(self, q: Any = None, v: Any = None, tau: Any = None, fext: ArrayLike | None = None) -> np.ndarray:
        """Forward dynamics ddq = M^-1 (tau - nle + J^T fext), (nv,)."""
        return self._result(_aba(self._m, self._d, self._q(q), self._v(v), self._tau(tau), self._fext(fext), None), ID["ddq"])

    def crba(self, q: Any = None) -> np.ndarray:
        """M, (nv, nv), full and symmetric."""
        return self._result(_crba(self._m, self._d, self._q(q), None), ID["M"])

    def cholesky(self) -> None:
        """Sparse factor of the current M: what cholesky_solve needs."""
        check(lib.dyn_cholesky(self._m, self._d))

    def cholesky_solve(self, b: ArrayLike) -> np.ndarray:
        """x = M^-1 b for b (nv,) or (nv, n). Needs cholesky."""
        b = numbers(b, "b")
        many = b.shape if b.ndim == 2 else (self.model.nv,)
        b = checked(b, (self.model.nv, *many[1:]), "b")
        x = np.empty(b.shape, order="F")
        check(lib.dyn_cholesky_solve(self._m, self._d, address(b), b.shape[1] if b.ndim == 2 else 1, address(x)))
        return x

    def minv(self, q: Any = None) -> np.ndarray:
        """M^-1, (nv, nv), full and symmetric."""
        return self._result(_minverse(self._m, self._d, self._q(q), None), ID["Minv"])

    def energy(self, q: Any = None, v: Any = None) -> Energy:
        """Kinetic and potential energy, J."""
        kinetic, potential = c_double(), c_double()
        check(lib.dyn_energy(self._m, self._d, self._q(q), self._v(v), byref(kinetic), byref(potential)))
        return Energy(kinetic.value, potential.value)

    def kinetic_energy(self, q: Any = None, v: Any = None) -> float:
        """v' M v / 2, armature included, J."""
        out = c_double()
        check(lib.dyn_kinetic_energy(self._m, self._d, self._q(q), self._v(v), byref(out)))
        return out.value

    def potential_energy(self, q: Any = None) -> float:
        """Zero at the world's origin, J."""
        out = c_double()
        check(lib.dyn_potential_energy(self._m, self._d, self._q(q), byref(out)))
        return out.value

    def all_terms(self, terms: Any = Term.ALL, q: Any = None, v: Any = None) -> Term:
        """Everything in a mask of dyn.Term, passes shared; answers what is now in data."""
        filled = c_uint32()
        check(lib.dyn_all_terms(self._m, self._d, mask(Term, terms, "terms"), self._q(q), self._v(v), byref(filled)))
        return Term(filled.value)
