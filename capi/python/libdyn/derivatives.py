"""Derivatives of inverse and forward dynamics, first and second."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .arrays import address, checked
from .fields import ID
from .library import check, lib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

_aba_derivatives = lib.dyn_aba_derivatives
_rnea_derivatives = lib.dyn_rnea_derivatives


class InverseDerivatives(NamedTuple):
    """Of tau on the tangent space, (nv, nv) each; dtau_da is M."""

    dtau_dq: np.ndarray
    dtau_dv: np.ndarray
    dtau_da: np.ndarray


class ForwardDerivatives(NamedTuple):
    """Of ddq on the tangent space, (nv, nv) each; ddq_dtau is M^-1."""

    ddq_dq: np.ndarray
    ddq_dv: np.ndarray
    ddq_dtau: np.ndarray


class SecondOrderProduct(NamedTuple):
    """Second derivatives of lambda . tau on the tangent space, (nv, nv) each: rows by the first variable, columns by the second."""

    dqdq: np.ndarray
    dvdv: np.ndarray
    dqdv: np.ndarray
    dadq: np.ndarray


class SecondOrderDerivatives(NamedTuple):
    """On the tangent space, (nv, nv, nv) each: [i, j, k] of tau_i by the first variable's j, then the second one's k."""

    d2tau_dqdq: np.ndarray
    d2tau_dvdv: np.ndarray
    d2tau_dqdv: np.ndarray
    d2tau_dadq: np.ndarray


class Derivatives:
    """The part of Data that differentiates dynamics. fext as in Dynamics."""

    def rnea_derivatives(self, q: Any = None, v: Any = None, a: Any = None, fext: ArrayLike | None = None) -> InverseDerivatives:
        """Derivatives (dtau_dq, dtau_dv, dtau_da) of inverse dynamics; also the fields tau and M. fext is constant in the joints' frames."""
        check(_rnea_derivatives(self._m, self._d, self._q(q), self._v(v), self._a(a), self._fext(fext), None, None))
        return InverseDerivatives(*(x.copy("F") for x in (self.dtau_dq, self.dtau_dv, self.M)))

    def aba_derivatives(self, q: Any = None, v: Any = None, tau: Any = None, fext: ArrayLike | None = None) -> ForwardDerivatives:
        """Derivatives (ddq_dq, ddq_dv, ddq_dtau) of forward dynamics; also the fields ddq and Minv."""
        check(_aba_derivatives(self._m, self._d, self._q(q), self._v(v), self._tau(tau), self._fext(fext), None, None, None))
        return ForwardDerivatives(*(x.copy("F") for x in (self.ddq_dq, self.ddq_dv, self.Minv)))

    def gravity_torque_derivatives(self, q: Any = None) -> np.ndarray:
        """dg/dq, (nv, nv), on the tangent space."""
        return self._result(lib.dyn_gravity_torque_derivatives(self._m, self._d, self._q(q), None), ID["dg_dq"])

    def static_torque_derivatives(self, q: Any = None, fext: ArrayLike | None = None) -> np.ndarray:
        """Derivative of static_torque by q, (nv, nv), on the tangent space; fext is constant in the joints' frames."""
        status = lib.dyn_static_torque_derivatives(self._m, self._d, self._q(q), self._fext(fext), None)
        return self._result(status, ID["dstatic_torque_dq"])

    def rnea_second_order_product(
        self, lam: ArrayLike, q: Any = None, v: Any = None, a: Any = None, fext: ArrayLike | None = None
    ) -> SecondOrderProduct:
        """Second derivatives of lam . rnea, lam (nv,), in about the time of two rnea_derivatives."""
        lam = checked(lam, (self.model.nv,), "lam")
        none = [None] * 4
        call = lib.dyn_rnea_second_order_product
        check(call(self._m, self._d, self._q(q), self._v(v), self._a(a), self._fext(fext), address(lam), *none))
        return SecondOrderProduct(*(self.field(f"lambda_d2tau_{x}").copy("F") for x in SecondOrderProduct._fields))

    def rnea_second_order_derivatives(
        self, q: Any = None, v: Any = None, a: Any = None, fext: ArrayLike | None = None
    ) -> SecondOrderDerivatives:
        """Second derivatives of rnea, (nv, nv, nv) each. Where two rotations of one spherical or free-flyer joint do not commute,
        d2tau_dqdq[i, j, k] differs from d2tau_dqdq[i, k, j]."""
        out = [np.empty((self.model.nv,) * 3) for _ in SecondOrderDerivatives._fields]
        call = lib.dyn_rnea_second_order_derivatives
        check(call(self._m, self._d, self._q(q), self._v(v), self._a(a), self._fext(fext), *map(address, out)))
        return SecondOrderDerivatives(*(x.transpose(0, 2, 1) for x in out))
