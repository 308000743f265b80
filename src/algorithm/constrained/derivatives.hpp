// Derivatives of constrained dynamics and of impulses on the tangent space: M ddq + nle - tau - J^T lambda = 0 and c = 0, with H, D the
// derivatives of the two at fixed ddq and lambda, give those of ddq and lambda by the inverse of the KKT matrix (kkt_inverse.hpp).
// H is that of inverse dynamics with the constraint forces as external ones, which move with their bodies, less what the forces do beside
// (Carpentier, Budhiraja, Mansard 2021, section IV, for every constraint). Rows at a bound keep their force.
#pragma once

#include "algorithm/factor_inverse.hpp"
#include "algorithm/gravity_derivatives.hpp"
#include "algorithm/constrained/instance_derivatives.hpp"

namespace dyn {

// Whether H has entries beside those of related degrees of freedom.
template <class T>
bool beyond_tree(const Model& m, Data<T>& d) {
  bool found = m.has_mimic;
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index) { found = found || s.c.body2 != 0; });
  return found;
}
// Inverse dynamics leaves entries of unrelated degrees of freedom zero for good; forces between bodies have filled them.
template <class T>
void clear_unrelated(const Model& m, Data<T>& d) {
  if (beyond_tree(m, d)) std::fill_n(d.dtau_dq, std::ptrdiff_t(m.n.nv) * m.n.nv, T(0));
}

// The inverse of the system, whose rows have been differentiated. Returns 0 or the joint that is singular; d.dtau_dq is then cleared.
template <class T>
Index prepare_kkt(const Model& m, Data<T>& d, const dynConstraintResult& result, const KktSystem<T>& K) {
  if (const Index failed = factorize(m, d)) return clear_unrelated(m, d), joint_of(m, failed - 1);
  invert(m, d);
  const bool bounded = any_bounded(m, d);
  invert_kkt(m, d, bounded, !bounded && result.regularisation == 0, K);
  return 0;
}

// d.constraint_ddq, d.lambda, and their derivatives, columns of both, in kkt_system: by tau the first nv columns of inverse. Returns 0 or the
// joint that is singular.
template <class T>
Index constrained_dynamics_derivatives(const Model& m, Data<T>& d, const T* v, const T* tau, const T* fext, const ProximalOptions& options,
                                       dynConstraintResult& result) {
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
  const bool related = !beyond_tree(m, d);
  minus_kkt_product(m, K, related, d.dtau_dq, K.Dq, K.by_q);
  minus_kkt_product(m, K, related, d.dtau_dv, K.Dv, K.by_v);
  clear_unrelated(m, d);
  return 0;
}

// The same of impulses: d.constraint_ddq is v_plus.
//   M (v_plus - v) - J^T lambda = 0        J (v_plus + e v) = 0
template <class T>
Index constraint_impulse_derivatives(const Model& m, Data<T>& d, const T* v, const ProximalOptions& options, dynConstraintResult& result) {
  T *v_plus = d.constraint_ddq, *jump = d.constraint_step, *at_rest = d.kkt_by_state;  // at_rest: until the product lies there
  const T *zero = d.zero, *none = nullptr;
  const std::ptrdiff_t n = m.n.nv;
  if (const Index failed = constraint_impulse(m, d, v, options, v_plus, result)) return failed;
  const KktSystem<T> K = kkt_system(m, d, result.rows);

  // by q: H of M jump - J^T lambda, what gravity and springs do left out
  std::fill_n(at_rest, n * n, T(0));
  static_torque_derivatives(m, d, none, at_rest);
  for (Index k = 0; k < m.n.nv; ++k) jump[k] = v_plus[k] - v[k];
  const T *still = d.expand(m, zero, d.vx), *jumping = d.expand(m, static_cast<const T*>(jump), d.ax);
  derivative_columns(m, d, still, jumping);
  subtract_constraint_forces(m, d);
  torque_derivatives(m, d, zero, static_cast<const T*>(jump));
  for (std::ptrdiff_t k = 0; k < n * n; ++k) d.dtau_dq[k] -= at_rest[k];
  differentiate_constraints(m, d, still, jumping, K, d.dtau_dq);
  if (const Index failed = prepare_kkt(m, d, result, K)) return failed;

  // D of J (v_plus + e v): by q, by v
  std::fill_n(K.Dq, K.rows * n, T(0)), std::fill_n(K.Dv, K.rows * n, T(0));
  const T* after = d.expand(m, static_cast<const T*>(v_plus), d.ax);
  derivative_columns(m, d, after, zero);
  differentiate_rates(m, d, after, false, K, K.Dq);
  const T* before = d.expand(m, v, d.vx);
  derivative_columns(m, d, before, zero);
  differentiate_rates(m, d, before, true, K, K.Dq);
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index slot) {
    const T *J = carried_of(m, d, slot), factor = T(1) + T(s.c.restitution);
    for (Index c = 0; c < s.support; ++c)
      for (Index r = 0; r < s.rows; ++r) K.Dv[s.first + r + K.rows * std::ptrdiff_t(support_of(m, d, slot)[c])] += factor * J[row_lanes * c + r];
  });
  minus_kkt_product(m, K, !beyond_tree(m, d), d.dtau_dq, K.Dq, K.by_q);
  minus_kkt_product(m, K, true, none, K.Dv, K.by_v);
  for (std::ptrdiff_t k = 0; k < n; ++k) K.by_v[k + K.ld * k] += T(1);
  clear_unrelated(m, d);
  return 0;
}

}  // namespace dyn
