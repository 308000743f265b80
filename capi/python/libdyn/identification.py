"""Regressors: torques, energies and the centre of mass, linear in the inertial parameters."""

from __future__ import annotations

from typing import Any

import numpy as np

from .arrays import address
from .fields import ID
from .library import check, lib

_joint_torque_regressor = lib.dyn_joint_torque_regressor
_kinetic_energy_regressor = lib.dyn_kinetic_energy_regressor
_potential_energy_regressor = lib.dyn_potential_energy_regressor
_static_regressor = lib.dyn_static_regressor


class Regressors:
    """The part of Data for identification."""

    # pi: the inertial parameters of all joints' bodies, Model.inertial_parameters(), (10 (njoints - 1),).

    def joint_torque_regressor(self, q: Any = None, v: Any = None, a: Any = None) -> np.ndarray:
        """Y, (nv, 10 (njoints - 1)): rnea = Y pi + armature * a."""
        status = _joint_torque_regressor(self._m, self._d, self._q(q), self._v(v), self._a(a), None)
        return self._result(status, ID["regressor"])

    def compute_static_regressor(self, q: Any = None) -> np.ndarray:
        """Y, (3, 10 (njoints - 1)): com = Y pi."""
        return self._result(_static_regressor(self._m, self._d, self._q(q), None), ID["static_regressor"])

    def compute_kinetic_energy_regressor(self, q: Any = None, v: Any = None) -> np.ndarray:
        """y, (10 (njoints - 1),): the kinetic energy without that of the armature is y @ pi."""
        status = _kinetic_energy_regressor(self._m, self._d, self._q(q), self._v(v), None)
        return self._result(status, ID["kinetic_energy_regressor"])

    def compute_potential_energy_regressor(self, q: Any = None) -> np.ndarray:
        """y, (10 (njoints - 1),): the potential energy is y @ pi."""
        status = _potential_energy_regressor(self._m, self._d, self._q(q), None)
        return self._result(status, ID["potential_energy_regressor"])

    def joint_body_regressor(self, joint: int | str) -> np.ndarray:
        """Y, (6, 10): Y pi is the force that moves a joint's body, in the joint's frame. Needs forward_kinematics of q, v, a."""
        Y = np.empty((6, 10), order="F")
        check(lib.dyn_joint_body_regressor(self._m, self._d, self.model._joint(joint), address(Y)))
        return Y

    def frame_body_regressor(self, frame: int | str) -> np.ndarray:
        """The same of a body that moves with a frame, its pi and the force in that frame: a link's own, merged or not."""
        Y = np.empty((6, 10), order="F")
        check(lib.dyn_frame_body_regressor(self._m, self._d, self.model._frame(frame), address(Y)))
        return Y
