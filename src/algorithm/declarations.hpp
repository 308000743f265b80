// The algorithms in one place, and compiled once: src/algorithm instantiates them for double.
// (The definitions are in the headers of the same names; tests instantiate them for other scalars.)
#pragma once

#include "model/data.hpp"

namespace dyn {

// kinematics.hpp
template <int level, class T> void forward_kinematics(const Model&, Data<T>&);
template <class T> void ensure_position(const Model&, Data<T>&);
template <class T> void ensure_velocity(const Model&, Data<T>&);
template <class T> void ensure_acceleration(const Model&, Data<T>&);
// rnea.hpp, aba.hpp, forward_dynamics.hpp, crba.hpp, cholesky.hpp, coriolis.hpp
template <class T> void rigid_inverse_dynamics(const Model&, Data<T>&, const T* v, const T* a, const T* fext, T* tau);
template <class T> void inverse_dynamics(const Model&, Data<T>&, const T* v, const T* a, const T* fext, T* tau);
template <class T> Index forward_dynamics(const Model&, Data<T>&, const T* v, const T* tau, const T* fext, T* ddq);
template <class T> void crba(const Model&, Data<T>&);
template <class T> Index factorize(const Model&, Data<T>&);
template <class T> bool solve(const Model&, const Data<T>&, const T* b, T* x, T* before);
template <class T> void invert(const Model&, Data<T>&);
template <class T> void coriolis_matrix(const Model&, Data<T>&);
// rnea_derivatives.hpp
template <class T> void rnea_derivatives(const Model&, Data<T>&, const T* v, const T* a, const T* fext);
// aba_derivatives.hpp
template <class T> Index minverse(const Model&, Data<T>&);
template <class T> Index aba_derivatives(const Model&, Data<T>&, const T* v, const T* tau, const T* fext);
// gravity_derivatives.hpp, center_of_mass_derivatives.hpp
template <class T> void gravity_derivatives(const Model&, Data<T>&, const T* fext, T* out);
template <class T> void static_torque_derivatives(const Model&, Data<T>&, const T* fext, T* out);
template <class T> void center_of_mass_velocity_derivatives(const Model&, Data<T>&);
// second_order.hpp, second_order_tensors.hpp
template <class X>
struct SecondOrder {
  // nv x nv each, any may be nullptr: rows by the first variable, columns by the second, that of the outer derivative
  X dqdq, dvdv, dqdv, dadq;
};
template <class T> void second_order_columns(const Model&, Data<T>&, const T* v, const T* a, const T* fext);
template <class T> T second_order_size(const Model&, const Data<T>&);
template <class T> void second_order_product(const Model&, Data<T>&, const T* lambda, const SecondOrder<T*>& out);
template <class T> void second_order_derivatives(const Model&, Data<T>&, const SecondOrder<T*>& out);
// frame_derivatives.hpp
template <class T> void frame_velocity_derivatives(const Model&, const Data<T>&, Index frame, dynReference, T* dv_dq, T* dv_dv);
template <class T>
void frame_acceleration_derivatives(const Model&, const Data<T>&, Index frame, dynReference, bool classical, T* da_dq, T* da_dv,
                                    T* da_da);
template <class T> void frame_kinematic_hessian(const Model&, Data<T>&, Index frame, dynReference, T* H);
// jacobian.hpp
template <class T> void joint_jacobians(const Model&, Data<T>&);
template <class T> void joint_jacobians_time_variation(const Model&, Data<T>&);
template <class T> void frame_jacobian(const Model&, const Data<T>&, Index frame, dynReference, T* J);
template <class T> void frame_jacobian_time_variation(const Model&, const Data<T>&, Index frame, dynReference, T* dJ);
template <class T> void frame_placement(const Model&, const Data<T>&, Index frame, T* X);
template <class T> void frame_velocity(const Model&, const Data<T>&, Index frame, dynReference, T* velocity);
template <class T>
void frame_acceleration(const Model&, const Data<T>&, Index frame, dynReference, bool classical, T* acceleration);
// center_of_mass.hpp, energy.hpp
template <class T> void center_of_mass(const Model&, Data<T>&, int level);
template <class T> void center_of_mass_jacobian(const Model&, const Data<T>&, Index body, T* Jcom);
template <class T> void kinetic_energy(const Model&, Data<T>&);
template <class T> void potential_energy(const Model&, Data<T>&);
// centroidal.hpp
template <bool rate, class T> void centroidal_map(const Model&, Data<T>&);
template <bool rate, class T> void centroidal_momentum(const Model&, Data<T>&);
template <class T> void centroidal_derivatives(const Model&, Data<T>&);
// regressor.hpp, torque_regressor.hpp
template <class T> T joint_torque_regressor(const Model&, Data<T>&);
template <class T> void static_regressor(const Model&, Data<T>&);
template <class T> void kinetic_energy_regressor(const Model&, Data<T>&);
template <class T> void potential_energy_regressor(const Model&, Data<T>&);
template <class T> void inertial_parameters(const Model&, T* pi);
// ik.hpp
struct IkTasks;
template <class T> bool inverse_kinematics(const Model&, Data<T>&, const IkTasks&, const dynIkOptions&, dynIkResult&);
// configuration.hpp
template <class T> void integrate(const Model&, const T* q, const T* v, T* out);
template <class T> void difference(const Model&, const T* q0, const T* q1, T* v);
template <class T> void interpolate(const Model&, const T* q0, const T* q1, T u, T* out);
template <class T> T distance(const Model&, const T* q0, const T* q1);
void random_configuration(const Model&, std::uint64_t seed, const double* lower, const double* upper, double* q);
template <class T> void normalize(const Model&, T* q);
template <class T> T norm_error(const Model&, const T* q);
template <class T> Index zero_norm_joint(const Model&, const T* q);
template <class T> void integrate_jacobians(const Model&, const T* q, const T* v, T* dq, T* dv);
template <class T> void difference_jacobians(const Model&, const T* q0, const T* q1, T* d0, T* d1);

}  // namespace dyn
