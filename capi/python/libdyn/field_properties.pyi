# Written by `python -m libdyn.stubs` from the library's tables.
from typing import Any

import numpy as np

STATE: dict[str, str]

def description(info: Any) -> str: ...

class Fields:
    @property
    def q(self) -> np.ndarray:
        """configuration (nq x 1; rad, m; frame: joint.)"""
    @q.setter
    def q(self, value: Any) -> None: ...
    @property
    def v(self) -> np.ndarray:
        """velocity (nv x 1; rad/s, m/s; frame: joint.)"""
    @v.setter
    def v(self, value: Any) -> None: ...
    @property
    def a(self) -> np.ndarray:
        """acceleration (nv x 1; rad/s^2, m/s^2; frame: joint.)"""
    @a.setter
    def a(self, value: Any) -> None: ...
    @property
    def tau_applied(self) -> np.ndarray:
        """generalised force applied in forward dynamics (nv x 1; N m, N; frame: joint.)"""
    @tau_applied.setter
    def tau_applied(self, value: Any) -> None: ...
    @property
    def time(self) -> float:
        """simulated time (1 x 1; s; frame: none.)"""
    @property
    def placements(self) -> np.ndarray:
        """placement of each frame (12 x nframes; 1, m; frame: world.) Computed by dyn_frame_placements."""
    @property
    def J(self) -> np.ndarray:
        """joint Jacobians (6 x nv; m, 1; frame: world.) Computed by dyn_joint_jacobians."""
    @property
    def dJ(self) -> np.ndarray:
        """time variation of J (6 x nv; m/s, 1/s; frame: world.) Computed by dyn_joint_jacobians_time_variation."""
    @property
    def com(self) -> np.ndarray:
        """centre of mass (3 x 1; m; frame: world.) Computed by dyn_com."""
    @property
    def vcom(self) -> np.ndarray:
        """velocity of the centre of mass (3 x 1; m/s; frame: world.) Computed by dyn_com."""
    @property
    def acom(self) -> np.ndarray:
        """acceleration of the centre of mass (3 x 1; m/s^2; frame: world.) Computed by dyn_com."""
    @property
    def Jcom(self) -> np.ndarray:
        """Jacobian of the centre of mass (3 x nv; m; frame: world.) Computed by dyn_jcom."""
    @property
    def tau(self) -> np.ndarray:
        """inverse dynamics of q, v, a (nv x 1; N m, N; frame: joint.) Computed by dyn_rnea."""
    @property
    def nle(self) -> np.ndarray:
        """Coriolis, centrifugal and gravity forces (nv x 1; N m, N; frame: joint.) Computed by dyn_nle."""
    @property
    def g(self) -> np.ndarray:
        """gravity forces (nv x 1; N m, N; frame: joint.) Computed by dyn_gravity_torque."""
    @property
    def static_torque(self) -> np.ndarray:
        """forces that hold q at rest (nv x 1; N m, N; frame: joint.) Computed by dyn_static_torque."""
    @property
    def ddq(self) -> np.ndarray:
        """forward dynamics of q, v, tau_applied (nv x 1; rad/s^2, m/s^2; frame: joint.) Computed by dyn_aba."""
    @property
    def M(self) -> np.ndarray:
        """joint-space inertia, full (nv x nv; kg m^2, kg; frame: joint.) Computed by dyn_crba."""
    @property
    def Minv(self) -> np.ndarray:
        """inverse of M, full (nv x nv; 1/(kg m^2), 1/kg; frame: joint.) Computed by dyn_minv."""
    @property
    def coriolis(self) -> np.ndarray:
        """Coriolis matrix (nv x nv; N m s, N s; frame: joint.) Computed by dyn_coriolis_matrix."""
    @property
    def kinetic(self) -> float:
        """kinetic energy (1 x 1; J; frame: none.) Computed by dyn_energy."""
    @property
    def potential(self) -> float:
        """potential energy, zero at the world's origin (1 x 1; J; frame: none.) Computed by dyn_energy."""
    @property
    def mechanical(self) -> float:
        """kinetic plus potential energy (1 x 1; J; frame: none.) Computed by dyn_energy."""
    @property
    def dtau_dq(self) -> np.ndarray:
        """derivative of tau by q on the tangent space (nv x nv; N m/rad, N/m; frame: joint.) Computed by dyn_rnea_derivatives."""
    @property
    def dtau_dv(self) -> np.ndarray:
        """derivative of tau by v (nv x nv; N m s/rad, N s/m; frame: joint.) Computed by dyn_rnea_derivatives."""
    @property
    def ddq_dq(self) -> np.ndarray:
        """derivative of ddq by q on the tangent space (nv x nv; 1/s^2; frame: joint.) Computed by dyn_aba_derivatives."""
    @property
    def ddq_dv(self) -> np.ndarray:
        """derivative of ddq by v (nv x nv; 1/s; frame: joint.) Computed by dyn_aba_derivatives."""
    @property
    def Ag(self) -> np.ndarray:
        """centroidal momentum matrix: hg = Ag v (6 x nv; kg m, kg m^2; frame: com, world axes.) Computed by dyn_centroidal_map."""
    @property
    def dAg(self) -> np.ndarray:
        """time variation of Ag (6 x nv; kg m/s, kg m^2/s; frame: com, world axes.) Computed by dyn_centroidal_map_time_variation."""
    @property
    def Ig(self) -> np.ndarray:
        """inertia of the whole about its centre of mass (6 x 6; kg, kg m^2; frame: com, world axes.) Computed by dyn_centroidal_map."""
    @property
    def hg(self) -> np.ndarray:
        """momentum about the centre of mass (6 x 1; kg m/s, kg m^2/s; frame: com, world axes.) Computed by dyn_centroidal_momentum."""
    @property
    def dhg(self) -> np.ndarray:
        """time derivative of hg (6 x 1; N, N m; frame: com, world axes.) Computed by dyn_centroidal_momentum_time_variation."""
    @property
    def dh_dq(self) -> np.ndarray:
        """derivative of hg by q (6 x nv; kg m/s, kg m^2/s; frame: com, world axes.) Computed by dyn_centroidal_derivatives."""
    @property
    def dhdot_dq(self) -> np.ndarray:
        """derivative of dhg by q (6 x nv; N, N m; frame: com, world axes.) Computed by dyn_centroidal_derivatives."""
    @property
    def dhdot_dv(self) -> np.ndarray:
        """derivative of dhg by v (6 x nv; N s, N m s; frame: com, world axes.) Computed by dyn_centroidal_derivatives."""
    @property
    def regressor(self) -> np.ndarray:
        """joint torque regressor: tau = Y pi + armature a (nv x nparameters; N m and N, by that of pi; frame: joint.) Computed by dyn_joint_torque_regressor."""
    @property
    def static_regressor(self) -> np.ndarray:
        """regressor of the centre of mass: com = Y pi (3 x nparameters; m, by that of pi; frame: world.) Computed by dyn_static_regressor."""
    @property
    def kinetic_energy_regressor(self) -> np.ndarray:
        """regressor of the kinetic energy without armature (nparameters x 1; J, by that of pi; frame: joint.) Computed by dyn_kinetic_energy_regressor."""
    @property
    def potential_energy_regressor(self) -> np.ndarray:
        """regressor of the potential energy (nparameters x 1; J, by that of pi; frame: joint.) Computed by dyn_potential_energy_regressor."""
    @property
    def dg_dq(self) -> np.ndarray:
        """derivative of g by q on the tangent space (nv x nv; N m/rad, N/m; frame: joint.) Computed by dyn_gravity_torque_derivatives."""
    @property
    def dstatic_torque_dq(self) -> np.ndarray:
        """derivative of static_torque by q on the tangent space (nv x nv; N m/rad, N/m; frame: joint.) Computed by dyn_static_torque_derivatives."""
    @property
    def dvcom_dq(self) -> np.ndarray:
        """derivative of vcom by q on the tangent space (3 x nv; 1/s, m/s; frame: world.) Computed by dyn_vcom_derivatives."""
    @property
    def lambda_d2tau_dqdq(self) -> np.ndarray:
        """second derivatives of lambda . tau by q and q (nv x nv; N m/rad^2, N/m^2; frame: joint.) Computed by dyn_rnea_second_order_product."""
    @property
    def lambda_d2tau_dvdv(self) -> np.ndarray:
        """second derivatives of lambda . tau by v and v (nv x nv; N m s^2/rad^2, N s^2/m^2; frame: joint.) Computed by dyn_rnea_second_order_product."""
    @property
    def lambda_d2tau_dqdv(self) -> np.ndarray:
        """second derivatives of lambda . tau by q and v (nv x nv; N m s/rad^2, N s/m^2; frame: joint.) Computed by dyn_rnea_second_order_product."""
    @property
    def lambda_d2tau_dadq(self) -> np.ndarray:
        """second derivatives of lambda . tau by a and q (nv x nv; kg m^2/rad, kg/m; frame: joint.) Computed by dyn_rnea_second_order_product."""
    @property
    def distances(self) -> np.ndarray:
        """signed distance of each pair of collision shapes, infinite where it is not tested (npairs x 1; m; frame: none.) Computed by dyn_distances."""
    @property
    def constrained_ddq(self) -> np.ndarray:
        """constrained forward dynamics of q, v, tau_applied (nv x 1; rad/s^2, m/s^2; frame: joint.) Computed by dyn_constrained_dynamics."""
    @property
    def world_gravity(self) -> np.ndarray:
        """gravity (3 x 1; m/s^2; frame: world.)"""
    @property
    def ctrl(self) -> np.ndarray:
        """controls (nu x 1; by actuator; frame: none.)"""
    @property
    def act(self) -> np.ndarray:
        """controls behind their filters, or integrated (na x 1; by actuator; frame: none.)"""
    @property
    def actuator_force(self) -> np.ndarray:
        """what actuators exert where the last step ended (nactuators x 1; N, N m; frame: actuator.)"""
