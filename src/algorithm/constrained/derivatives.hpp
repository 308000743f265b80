// Derivatives of constrained dynamics and impulses on the tangent space: M ddq + nle - tau - J^T lambda = 0 and c = 0. H and D
// are the derivatives of the two at fixed ddq and lambda. The inverse of the KKT matrix (kkt_inverse.hpp) gives those of ddq and
// lambda. H is that of inverse dynamics with constraint forces as external forces that move with their bodies, corrected by how
// these forces change relative to the bodies (Carpentier, Budhiraja, Mansard 2021, section IV, extended to every constraint).
// Rows at a bound keep their force.
#pragma once

#include "algorithm/factor_inverse.hpp"
#include "algorithm/gravity_derivatives.hpp"
#include "algorithm/constrained/instance_derivatives.hpp"

namespace dyn {

// Returns whether H couples degrees of freedom that the tree does not relate.
template <class T>
bool couples_unrelated_dofs(const Model& m, Data<T>& d) {
  bool found = m.has_mimic;
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index) { found = found || s.c.body2 != 0; });
  return found;
}
// Inverse dynamics never writes entries of unrelated degrees of freedom; forces between bodies have filled them.
template <class T>
void clear_unrelated(const Model& m, Data<T>& d) {
  if (couples_unrelated_dofs(m, d)) std::fill_n(d.dtau_dq, std::ptrdiff_t(m.n.nv) * m.n.nv, T(0));
}

// Inverts the KKT system. Returns 0 or the singular joint, with d.dtau_dq cleared.
template <class T>
Index prepare_kkt(const Model& m, Data<T>& d, const dynConstraintResult& result, const KktSystem<T>& K) {
  if (const Index failed = factorize(m, d)) return clear_unrelated(m, d), joint_of(m, failed - 1);
  invert(m, d);
  const bool bounded = any_bounded(m, d);
  invert_kkt(m, d, bounded, !bounded && result.regularisation == 0, K);
  return 0;
}

// d.constraint_ddq, d.lambda and their derivatives, as columns of kkt_system. Those by tau are the first nv columns of the
// inverse. Returns 0 or the singular joint.
template <class T>
Index constrained_dynamics_derivatives(const Model& m, Data<T>& d, const T* v, const T* tau, const T* fext,
                                       const ProximalOptions& options, dynConstraintResult& result) {
  T* ddq = d.constraint_ddq;
  if (const Index failed = constrained_dynamics(m, d, v, tau, fext, options, ddq, result)) return failed;
  const KktSystem<T> K = kkt_system(m, d, result.rows);
  const T *vx = d.expand(m, v, d.vx), *ax = d.expand(m, static_cast<const T*>(ddq), d.ax);
  derivative_columns(m, d, vx, ax);
  if (fext) subtract_external_at_root(m, d, fext);
  subtract_constraint_forces(m, d);
  torque_derivatives(m, d, v, static_cast<const T*>(ddq));
  differentiate_constraints(m, d, vx, ax, K, d.dtau_dq);
  if (const Index failed = prepare_kkt(m, d, result, K)) return failed;
  const bool related = !couples_unrelated_dofs(m, d);
  minus_kkt_product(m, K, related, d.dtau_dq, K.Dq, K.by_q);
  minus_kkt_product(m, K, related, d.dtau_dv, K.Dv, K.by_v);
  clear_unrelated(m, d);
  return 0;
}

// The same for impulses, where d.constraint_ddq is v_plus.
//   M (v_plus - v) - J^T lambda = 0        J (v_plus + e v) = 0
template <class T>
Index constraint_impulse_derivatives(const Model& m, Data<T>& d, const T* v, const ProximalOptions& options,
                                     dynConstraintResult& result) {
  T *v_plus = d.constraint_ddq, *jump = d.constraint_step,
    *at_rest = d.kkt_by_state;  // at_rest: valid until the product is written there
  const T *zero = d.zero, *none = nullptr;
  const std::ptrdiff_t n = m.n.nv;
  if (const Index failed = constraint_impulse(m, d, v, options, v_plus, result)) return failed;
  const KktSystem<T> K = kkt_system(m, d, result.rows);

  // by q: H of M jump - J^T lambda, without gravity and springs
  std::fill_n(at_rest, n * n, T(0));
  static_torque_derivatives(m, d, none, at_rest);
  for (Index k = 0; k < m.n.nv; ++k) jump[k] = v_plus[k] - v[k];
  const T *zero_velocity = d.expand(m, zero, d.vx), *velocity_jump = d.expand(m, static_cast<const T*>(jump), d.ax);
  derivative_columns(m, d, zero_velocity, velocity_jump);
  subtract_constraint_forces(m, d);
  torque_derivatives(m, d, zero, static_cast<const T*>(jump));
  for (std::ptrdiff_t k = 0; k < n * n; ++k) d.dtau_dq[k] -= at_rest[k];
  differentiate_constraints(m, d, zero_velocity, velocity_jump, K, d.dtau_dq);
  if (const Index failed = prepare_kkt(m, d, result, K)) return failed;

  // D of J (v_plus + e v), by q and by v
  std::fill_n(K.Dq, K.rows * n, T(0)), std::fill_n(K.Dv, K.rows * n, T(0));
  const T* after = d.expand(m, static_cast<const T*>(v_plus), d.ax);
  derivative_columns(m, d, after, zero);
  differentiate_rates(m, d, after, false, K, K.Dq);
  const T* before = d.expand(m, v, d.vx);
  derivative_columns(m, d, before, zero);
  differentiate_rates(m, d, before, true, K, K.Dq);
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index slot) {
    const T *J = propagated_jacobian_of(m, d, slot), factor = T(1) + T(s.c.restitution);
    for (Index c = 0; c < s.support_count; ++c)
      for (Index r = 0; r < s.rows; ++r)
        K.Dv[s.first + r + K.rows * std::ptrdiff_t(supporting_dofs_of(m, d, slot)[c])] += factor * J[row_lanes * c + r];
  });
  minus_kkt_product(m, K, !couples_unrelated_dofs(m, d), d.dtau_dq, K.Dq, K.by_q);
  minus_kkt_product(m, K, true, none, K.Dv, K.by_v);
  for (std::ptrdiff_t k = 0; k < n; ++k) K.by_v[k + K.ld * k] += T(1);
  clear_unrelated(m, d);
  return 0;
}

}  // namespace dyn
