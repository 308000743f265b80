"""Placements, velocities, accelerations and Jacobians of frames and of the centre of mass."""

from __future__ import annotations

from ctypes import byref, c_double
from typing import Any, NamedTuple

import numpy as np

from .arrays import Placement, address, to_placement
from .choices import member
from .enums import Reference
from .fields import ID
from .library import check, fail, lib

_REFERENCES: dict[Any, int] = {key: int(r) for r in Reference for key in (r, r.name, r.name.lower())}

# Bound once: an attribute of the CDLL costs a look-up in every call.
_center_of_mass = lib.dyn_com
_center_of_mass_jacobian = lib.dyn_jcom
_forward_kinematics = lib.dyn_forward_kinematics
_frame_acceleration = lib.dyn_frame_acceleration
_frame_classical_acceleration = lib.dyn_frame_classical_acceleration
_frame_jacobian = lib.dyn_frame_jacobian
_frame_jacobian_time_variation = lib.dyn_frame_jacobian_time_variation
_frame_placement = lib.dyn_frame_placement
_frame_velocity = lib.dyn_frame_velocity
_joint_jacobians = lib.dyn_joint_jacobians
_joint_jacobians_time_variation = lib.dyn_joint_jacobians_time_variation


class FrameVelocityDerivatives(NamedTuple):
    """On the tangent space, (6, nv) each."""

    dv_dq: np.ndarray
    dv_dv: np.ndarray


class FrameAccelerationDerivatives(NamedTuple):
    """On the tangent space, (6, nv) each."""

    da_dq: np.ndarray
    da_dv: np.ndarray
    da_da: np.ndarray


class CenterOfMassVelocityDerivatives(NamedTuple):
    """On the tangent space, (3, nv) each."""

    dvcom_dq: np.ndarray
    dvcom_dv: np.ndarray


class Kinematics:
    """The part of Data that says where things are and how they move."""

    def forward_kinematics(self, q: Any = None, v: Any = None, a: Any = None) -> None:
        """Placements of all joints; with v their velocities, with a, too, their accelerations."""
        status = _forward_kinematics(self._m, self._d, self._q(q), self._v(v), self._a(a))
        if status:
            fail(status)

    def frame_placement(self, frame: int | str) -> Placement:
        """Pose X_WF of a frame: (rotation (3, 3), translation (3,), m). Needs forward_kinematics."""
        out, start = self._twelve
        status = _frame_placement(self._m, self._d, self.model._frame(frame), start)
        if status:
            fail(status)
        return to_placement(out.copy())

    def frame_placements(self) -> Placement:
        """Poses of all frames: (rotation (nframes, 3, 3), translation (nframes, 3)). Needs forward_kinematics."""
        out = np.empty((self.model.nframes, 12))
        check(lib.dyn_frame_placements(self._m, self._d, address(out)))
        return Placement(out[:, :9].reshape(-1, 3, 3).transpose(0, 2, 1), out[:, 9:])

    def _reference(self, reference: Any) -> int:
        found = _REFERENCES.get(reference)
        return member(Reference, reference, "reference") if found is None else found

    def _of_frame(self, call, frame: Any, reference: Any, result: Any) -> np.ndarray:
        out, start = result
        status = call(self._m, self._d, self.model._frame(frame), self._reference(reference), start)
        if status:
            fail(status)
        return out.copy("F")

    def frame_velocity(self, frame: int | str, reference: str | Reference = Reference.LOCAL) -> np.ndarray:
        """Spatial velocity [linear; angular] of a frame, (6,), m/s and rad/s."""
        return self._of_frame(_frame_velocity, frame, reference, self._six)

    def frame_acceleration(self, frame: int | str, reference: str | Reference = Reference.LOCAL) -> np.ndarray:
        """Spatial acceleration of a frame, (6,), m/s^2 and rad/s^2, without gravity."""
        return self._of_frame(_frame_acceleration, frame, reference, self._six)

    def frame_classical_acceleration(self, frame: int | str, reference: str | Reference = Reference.LOCAL) -> np.ndarray:
        """Second derivative of the frame origin's position, and the angular acceleration, (6,)."""
        return self._of_frame(_frame_classical_acceleration, frame, reference, self._six)

    def joint_jacobians(self, q: Any = None) -> np.ndarray:
        """J, (6, nv), in the world's reference: the column of each degree of freedom, as if it moved all."""
        return self._result(_joint_jacobians(self._m, self._d, self._q(q), None), ID["J"])

    def joint_jacobians_time_variation(self, q: Any = None, v: Any = None) -> np.ndarray:
        """dJ/dt, (6, nv), in the world's reference; includes J."""
        return self._result(_joint_jacobians_time_variation(self._m, self._d, self._q(q), self._v(v), None), ID["dJ"])

    def frame_jacobian(self, frame: int | str, reference: str | Reference = Reference.LOCAL) -> np.ndarray:
        """Jacobian of a frame, (6, nv): J v = frame_velocity. Needs forward_kinematics of q."""
        return self._of_frame(_frame_jacobian, frame, reference, self._six_nv)

    def frame_jacobian_time_variation(self, frame: int | str, reference: str | Reference = Reference.LOCAL) -> np.ndarray:
        """d/dt of frame_jacobian, (6, nv). Needs forward_kinematics of q and v."""
        return self._of_frame(_frame_jacobian_time_variation, frame, reference, self._six_nv)

    def _derivatives_of_frame(self, call, kind, frame: Any, reference: Any):
        out = kind(*(np.empty((6, self.model.nv), order="F") for _ in kind._fields))
        check(call(self._m, self._d, self.model._frame(frame), self._reference(reference), *map(address, out)))
        return out

    def frame_velocity_derivatives(
        self, frame: int | str, reference: str | Reference = Reference.LOCAL
    ) -> FrameVelocityDerivatives:
        """Derivatives (dv_dq, dv_dv) of frame_velocity. Needs forward_kinematics of q and v."""
        return self._derivatives_of_frame(lib.dyn_frame_velocity_derivatives, FrameVelocityDerivatives, frame, reference)

    def frame_acceleration_derivatives(
        self, frame: int | str, reference: str | Reference = Reference.LOCAL
    ) -> FrameAccelerationDerivatives:
        """Derivatives (da_dq, da_dv, da_da) of frame_acceleration. Needs forward_kinematics of q, v, a."""
        return self._derivatives_of_frame(lib.dyn_frame_acceleration_derivatives, FrameAccelerationDerivatives, frame, reference)

    def frame_classical_acceleration_derivatives(
        self, frame: int | str, reference: str | Reference = Reference.LOCAL
    ) -> FrameAccelerationDerivatives:
        """The same of frame_classical_acceleration."""
        call = lib.dyn_frame_classical_acceleration_derivatives
        return self._derivatives_of_frame(call, FrameAccelerationDerivatives, frame, reference)

    def frame_kinematic_hessian(self, frame: int | str, reference: str | Reference = Reference.LOCAL) -> np.ndarray:
        """H, (6, nv, nv): H[:, :, k] is the derivative of frame_jacobian by q_k. Needs forward_kinematics of q."""
        H = np.empty((6, self.model.nv, self.model.nv), order="F")
        check(lib.dyn_frame_kinematic_hessian(self._m, self._d, self.model._frame(frame), self._reference(reference), address(H)))
        return H

    # ------------------------------------------------------------------------------------------- centre of mass

    def compute_com(self, q: Any = None, v: Any = None, a: Any = None) -> np.ndarray:
        """com, (3,), m, world axes; with v and a also the fields vcom and acom."""
        status = _center_of_mass(self._m, self._d, self._q(q), self._v(v), self._a(a), None, None, None)
        return self._result(status, ID["com"])

    def jcom(self, q: Any = None) -> np.ndarray:
        """Jcom, (3, nv): Jcom v = vcom."""
        return self._result(_center_of_mass_jacobian(self._m, self._d, self._q(q), None), ID["Jcom"])

    def vcom_derivatives(self, q: Any = None, v: Any = None) -> CenterOfMassVelocityDerivatives:
        """Derivatives (dvcom_dq, dvcom_dv) of vcom; the second is Jcom."""
        check(lib.dyn_vcom_derivatives(self._m, self._d, self._q(q), self._v(v), None, None))
        return CenterOfMassVelocityDerivatives(self.dvcom_dq.copy("F"), self.Jcom.copy("F"))

    def subtree_com(self, joint: int | str) -> tuple[np.ndarray, float]:
        """(com (3,), mass) of what a joint carries. Needs compute_com."""
        (com, start), mass = self._three, c_double()
        check(lib.dyn_subtree_com(self._m, self._d, self.model._joint(joint), start, byref(mass)))
        return com.copy(), mass.value

    def subtree_jcom(self, joint: int | str) -> np.ndarray:
        """Jacobian of that point, (3, nv). Needs compute_com."""
        out, start = self._three_nv
        check(lib.dyn_subtree_jcom(self._m, self._d, self.model._joint(joint), start))
        return out.copy("F")
