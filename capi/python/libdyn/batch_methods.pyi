# Written by `python -m libdyn.stubs` from the library's tables.
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Placement

def description(algorithm: Any) -> str: ...

class Algorithms:
    def frame_placement(self, frame: int | str, q: Any, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Placement:
        """placement of N states: Data.frame_placement for each."""
    def frame_placements(self, q: Any, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Placement:
        """placements of N states: Data.frame_placements for each."""
    def frame_velocity(self, frame: int | str, q: Any, v: ArrayLike | None = None, reference: Any = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """velocity of N states: Data.frame_velocity for each."""
    def frame_acceleration(self, frame: int | str, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, reference: Any = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """acceleration of N states: Data.frame_acceleration for each."""
    def frame_classical_acceleration(self, frame: int | str, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, reference: Any = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """acceleration of N states: Data.frame_classical_acceleration for each."""
    def joint_jacobians(self, q: Any, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """J of N states: Data.joint_jacobians for each."""
    def joint_jacobians_time_variation(self, q: Any, v: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """dJ of N states: Data.joint_jacobians_time_variation for each."""
    def frame_jacobian(self, frame: int | str, q: Any, reference: Any = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """J of N states: Data.frame_jacobian for each."""
    def frame_jacobian_time_variation(self, frame: int | str, q: Any, v: ArrayLike | None = None, reference: Any = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """dJ of N states: Data.frame_jacobian_time_variation for each."""
    def com(self, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """com, vcom, acom of N states: Data.com for each."""
    def jcom(self, q: Any, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """Jcom of N states: Data.jcom for each."""
    def subtree_com(self, joint: int | str, q: Any, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """com, mass of N states: Data.subtree_com for each."""
    def subtree_jcom(self, joint: int | str, q: Any, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """J of N states: Data.subtree_jcom for each."""
    def rnea(self, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, fext: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """tau of N states: Data.rnea for each."""
    def nle(self, q: Any, v: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """nle of N states: Data.nle for each."""
    def gravity_torque(self, q: Any, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """g of N states: Data.gravity_torque for each."""
    def static_torque(self, q: Any, fext: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """tau of N states: Data.static_torque for each."""
    def coriolis_matrix(self, q: Any, v: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """C of N states: Data.coriolis_matrix for each."""
    def aba(self, q: Any, v: ArrayLike | None = None, tau: ArrayLike | None = None, fext: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """ddq of N states: Data.aba for each."""
    def crba(self, q: Any, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """M of N states: Data.crba for each."""
    def cholesky_solve(self, q: Any, b: ArrayLike, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """x of N states: Data.cholesky_solve for each."""
    def minv(self, q: Any, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """Minv of N states: Data.minv for each."""
    def rnea_derivatives(self, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, fext: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """dtau_dq, dtau_dv of N states: Data.rnea_derivatives for each."""
    def aba_derivatives(self, q: Any, v: ArrayLike | None = None, tau: ArrayLike | None = None, fext: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """ddq_dq, ddq_dv, ddq_dtau of N states: Data.aba_derivatives for each."""
    def energy(self, q: Any, v: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """kinetic, potential of N states: Data.energy for each."""
    def kinetic_energy(self, q: Any, v: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """kinetic of N states: Data.kinetic_energy for each."""
    def potential_energy(self, q: Any, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """potential of N states: Data.potential_energy for each."""
    def centroidal_map(self, q: Any, v: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """Ag, Ig, hg of N states: Data.centroidal_map for each."""
    def centroidal_map_time_variation(self, q: Any, v: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """dAg of N states: Data.centroidal_map_time_variation for each."""
    def centroidal_momentum(self, q: Any, v: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """hg of N states: Data.centroidal_momentum for each."""
    def centroidal_momentum_time_variation(self, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """dhg of N states: Data.centroidal_momentum_time_variation for each."""
    def centroidal_derivatives(self, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """dh_dq, dhdot_dq, dhdot_dv, dhdot_da of N states: Data.centroidal_derivatives for each."""
    def joint_torque_regressor(self, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """Y of N states: Data.joint_torque_regressor for each."""
    def static_regressor(self, q: Any, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """Y of N states: Data.static_regressor for each."""
    def kinetic_energy_regressor(self, q: Any, v: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """y of N states: Data.kinetic_energy_regressor for each."""
    def potential_energy_regressor(self, q: Any, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """y of N states: Data.potential_energy_regressor for each."""
    def joint_body_regressor(self, joint: int | str, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """Y of N states: Data.joint_body_regressor for each."""
    def frame_body_regressor(self, frame: int | str, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """Y of N states: Data.frame_body_regressor for each."""
    def integrate(self, q: Any, v: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """q (+) v of N states, (N, nq): Model.integrate for each."""
    def gravity_torque_derivatives(self, q: Any, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """dg_dq of N states: Data.gravity_torque_derivatives for each."""
    def static_torque_derivatives(self, q: Any, fext: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """dstatic_torque_dq of N states: Data.static_torque_derivatives for each."""
    def vcom_derivatives(self, q: Any, v: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """dvcom_dq, dvcom_dv of N states: Data.vcom_derivatives for each."""
    def frame_velocity_derivatives(self, frame: int | str, q: Any, v: ArrayLike | None = None, reference: Any = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """dv_dq, dv_dv of N states: Data.frame_velocity_derivatives for each."""
    def frame_acceleration_derivatives(self, frame: int | str, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, reference: Any = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """da_dq, da_dv, da_da of N states: Data.frame_acceleration_derivatives for each."""
    def frame_classical_acceleration_derivatives(self, frame: int | str, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, reference: Any = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """da_dq, da_dv, da_da of N states: Data.frame_classical_acceleration_derivatives for each."""
    def rnea_second_order_product(self, b: ArrayLike, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, fext: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """dqdq, dvdv, dqdv, dadq of N states: Data.rnea_second_order_product for each. b is lambda."""
    def rnea_second_order_derivatives(self, q: Any, v: ArrayLike | None = None, a: ArrayLike | None = None, fext: ArrayLike | None = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """d2tau_dqdq, d2tau_dvdv, d2tau_dqdv, d2tau_dadq of N states: Data.rnea_second_order_derivatives for each."""
    def frame_kinematic_hessian(self, frame: int | str, q: Any, reference: Any = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """H of N states: Data.frame_kinematic_hessian for each."""
    def difference(self, q: Any, q1: ArrayLike, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> np.ndarray:
        """q1 (-) q of N pairs, (N, nv): Model.difference for each."""
    def step(self, dt: float, q: Any, v: ArrayLike | None = None, tau: ArrayLike | None = None, integrator: Any = None, *, only: str | None = None, out: Any = None, status: np.ndarray | None = None) -> Any:
        """q and v of N states a step of dt seconds later, under tau."""
