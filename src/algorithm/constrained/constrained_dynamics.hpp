// Forward dynamics, impulses and inverse dynamics under the constraints of a data.
#pragma once

#include "algorithm/articulated_factor.hpp"
#include "algorithm/forward_dynamics.hpp"
#include "algorithm/constrained/bounded.hpp"
#include "algorithm/constrained/redundant_rows.hpp"

namespace dyn {

template <class T>
RowWork<T> row_work(const Model& m, const Data<T>& d) {
  return {d.row_factor, d.row_scaled, d.row_range, d.row_vectors, padded_rows(m.n.constraint_rows)};
}
// Vectors in addition to those of the solver.
template <class T>
DYN_INLINE T* row_vector(const Model& m, const Data<T>& d, int k) {
  return d.row_vectors + (8 + k) * padded_rows(m.n.constraint_rows);
}

// Prepares the factor of M^-1 at the roots of the trees, after forward dynamics.
template <class T>
void prepare_columns(const Model& m, Data<T>& d) {
  if (!m.has_mimic) articulated_columns(m, d);
}

// Factor of M^-1 at d.q. Returns 0 or the singular joint.
template <class T>
Index constraint_factor(const Model& m, Data<T>& d) {
  if (m.has_mimic) {
    crba(m, d);
    if (const Index failed = factorize(m, d)) return joint_of(m, failed - 1);
  } else {
    if (const Index failed = articulated_factor(m, d)) return m.bodies()[failed].joint;
  }
  return 0;
}

// lambda for the right-hand side b, within bounds.
template <class T>
void solve_rows(const Model& m, Data<T>& d, Index rows, const T* b, bool bounded, const ProximalOptions& options, T* lambda,
                ProximalResult<T>& result) {
  const std::ptrdiff_t ld = padded_rows(rows);
  delassus(m, d, rows, d.row_matrix);
  if (!bounded) return solve_equalities(row_work(m, d), d.row_matrix, ld, rows, b, options, lambda, result);
  T *lower = row_vector(m, d, 1), *upper = row_vector(m, d, 2);
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index) {
    for (Index r = 0; r < s.rows; ++r) {
      lower[s.first + r] = one_sided(s.c.type) ? s.lower[r] : T(-HUGE_VAL);
      upper[s.first + r] = one_sided(s.c.type) ? s.upper[r] : T(HUGE_VAL);
    }
  });
  solve_bounded(row_work(m, d), d.row_matrix, ld, rows, b, Bounds<T>{lower, upper, d.row_state, d.row_state + ld, d.row_free},
                options, lambda, result);
}

template <class T>
bool any_bounded(const Model& m, Data<T>& d) {
  bool found = false;
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index) { found = found || one_sided(s.c.type); });
  return found;
}

// Largest |G lambda - b| over rows that are not at a bound.
template <class T>
T rows_residual(const Model& m, Data<T>& d, Index rows, const T* b, const T* lambda, bool bounded) {
  T* left = row_vector(m, d, 3);
  row_residual(d.row_matrix, padded_rows(rows), rows, b, lambda, left);
  if (bounded)
    for (Index r = 0; r < rows; ++r)
      if (d.row_state[r] != 0) left[r] = T(0);
  return largest_size(left, rows);
}

// Completes the result when lambda is known.
template <class T>
void report_rows(const Model& m, Data<T>& d, Index rows, const T* b, bool bounded, ProximalResult<T>& found,
                 dynConstraintResult& result) {
  result.reason = found.reason;
  result.rows = rows, result.rank = found.rank, result.iterations = found.iterations;
  result.residual = double(rows_residual(m, d, rows, b, d.lambda, bounded));
  result.contradiction = double(found.contradiction), result.condition = double(found.condition),
  result.regularisation = double(found.regularisation);
}

// Computes ddq and d.lambda. Returns 0 or the singular joint.
template <class T>
Index constrained_dynamics(const Model& m, Data<T>& d, const T* v, const T* tau, const T* fext, const ProximalOptions& options,
                           T* ddq, dynConstraintResult& result) {
  if (const Index failed = forward_dynamics(m, d, v, tau, fext, ddq)) return failed;
  const Index rows = active_rows(m, d);
  ProximalResult<T> found;
  T *b = row_vector(m, d, 0), *x = d.constraint_step;
  const bool bounded = any_bounded(m, d);
  prepare_columns(m, d);
  evaluate_rows(m, d, d.expand(m, v, d.vx), d.expand(m, static_cast<const T*>(ddq), d.ax));
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index) {
    const T kp = T(s.c.stiffness), kd = T(s.c.damping);
    for (Index r = 0; r < s.rows; ++r) b[s.first + r] = -(s.acceleration[r] + kp * s.error[r] + kd * s.rate[r]);
  });
  propagate_rows(m, d);
  if constexpr (std::is_same_v<T, double>)
    if (options.misalignment > 0) drop_redundant_rows(m, d, options.misalignment);
  clear_dropped_rows(m, d, b);
  solve_rows(m, d, rows, b, bounded, options, d.lambda, found);
  gather(m, d, d.lambda, x);
  scatter(m, d, x);
  for (Index k = 0; k < m.n.nv; ++k) ddq[k] += x[k];
  report_rows(m, d, rows, b, bounded, found, result);
  if (options.misalignment > 0) keep_all_rows(m, d);
  return 0;
}

// Computes v_plus and d.lambda.
template <class T>
Index constraint_impulse(const Model& m, Data<T>& d, const T* v, const ProximalOptions& options, T* v_plus,
                         dynConstraintResult& result) {
  if (const Index failed = constraint_factor(m, d)) return failed;
  const Index rows = active_rows(m, d);
  ProximalResult<T> found;
  T *b = row_vector(m, d, 0), *x = d.constraint_step;
  const bool bounded = any_bounded(m, d);
  evaluate_rows(m, d, d.expand(m, v, d.vx), static_cast<const T*>(nullptr));
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index) {
    if (s.c.type == DYN_CONSTRAINT_TYPE_FRICTION) s.lower[0] = s.upper[0] = T(0);  // a bounded force has no impulse
    for (Index r = 0; r < s.rows; ++r) b[s.first + r] = -(T(1) + T(s.c.restitution)) * s.rate[r];
  });
  propagate_rows(m, d);
  solve_rows(m, d, rows, b, bounded, options, d.lambda, found);
  gather(m, d, d.lambda, x);
  scatter(m, d, x);
  for (Index k = 0; k < m.n.nv; ++k) v_plus[k] = v[k] + x[k];
  report_rows(m, d, rows, b, bounded, found, result);
  return 0;
}

// J of all rows, rows x nv with leading dimension ld.
template <class T>
void constraint_jacobian(const Model& m, Data<T>& d, T* J, std::ptrdiff_t ld) {
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index) {
    constraint_jacobian(m, d, s, d.constraint_columns);
    for (Index k = 0; k < m.n.nv; ++k)
      for (Index r = 0; r < s.rows; ++r) J[s.first + r + ld * k] = d.constraint_columns[row_lanes * k + r];
  });
}

}  // namespace dyn
