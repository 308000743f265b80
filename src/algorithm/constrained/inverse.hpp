// Inverse dynamics under constraints. For unactuated degrees of freedom u finds the smallest lambda with J_u^T lambda = h_u, h =
// M a + nle - J^T fext, in the least-squares sense: N lambda = J_u h_u, N = J_u J_u^T, by the proximal iteration from zero.
#pragma once

#include "algorithm/constrained/constrained_dynamics.hpp"

namespace dyn {

inline bool flies(const Model& m, Index joint) {
  return m.joints()[joint].parent == 0 && m.joints()[joint].type == DYN_JOINT_TYPE_FREE_FLYER;
}

// Computes tau and d.lambda. actuated: nv flags, or null: all but free flyers. Returns 0 or the singular joint.
template <class T>
Index constrained_inverse_dynamics(const Model& m, Data<T>& d, const T* v, const T* a, const T* fext,
                                   const std::int32_t* actuated, T* tau, dynConstraintResult& result) {
  if (const Index failed = constraint_factor(m, d)) return failed;
  evaluate_rows(m, d, static_cast<const T*>(nullptr), static_cast<const T*>(nullptr));
  inverse_dynamics(m, d, v, a, fext, tau);
  const Index rows = active_rows(m, d);
  const std::ptrdiff_t ld = padded_rows(rows);
  const RowWork<T> work = row_work(m, d);
  T *N = d.row_matrix, *b = row_vector(m, d, 0), *row = row_vector(m, d, 1);
  std::fill_n(N, ld * rows, T(0)), std::fill_n(b, rows, T(0));

  // J by degrees of freedom: rows of lanes, constraint by constraint
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index k) {
    T* J = d.propagated_jacobian + row_lanes * std::ptrdiff_t(k) * m.n.nvx;
    constraint_jacobian(m, d, s, J);
    if (one_sided(s.c.type)) std::fill_n(J, row_lanes * std::ptrdiff_t(m.n.nv), T(0));  // one-sided forces do not hold
  });
  auto for_each_unactuated = [&](auto&& f) {
    for (Index j = 1; j < m.n.joints; ++j)
      for (Index k = m.joints()[j].idx_v, end = k + m.joints()[j].nv; k < end; ++k)
        if (actuated ? actuated[k] == 0 : flies(m, j)) f(k);
  };
  auto read_row = [&](Index k) {
    for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index slot) {
      const T* J = d.propagated_jacobian + row_lanes * (std::ptrdiff_t(slot) * m.n.nvx + k);
      for (Index r = 0; r < s.rows; ++r) row[s.first + r] = J[r];
    });
  };
  for_each_unactuated([&](Index k) {
    read_row(k);
    for (Index c = 0; c < rows; ++c) {
      b[c] += row[c] * tau[k];
      for (Index r = 0; r < rows; ++r) N[ld * c + r] += row[r] * row[c];
    }
  });
  T most = T(0), first, last;
  for (Index r = 0; r < rows; ++r) most = std::max(most, N[ld * r + r]);
  ProximalResult<T> found;
  std::fill_n(d.lambda, rows, T(0));
  if (most > T(0)) {
    for (Index c = 0; c < rows; ++c) {
      b[c] *= T(1) / most;
      for (Index r = 0; r < rows; ++r) N[ld * c + r] *= T(1) / most;
    }
    const T mu = T(automatic_regularisation);
    found.rank = pivoted_factor(N, ld, rows, T(independent), work.range, work.vector(4), first, last);
    found.condition = first / last, found.regularisation = mu;
    factor_rows(N, ld, rows, mu, mu / T(2), work.factor, work.vector(0));
    if (!iterate(N, ld, rows, work.factor, work.vector(0), b, ProximalOptions{}, work.vector(1), d.lambda, found))
      found.reason = DYN_CONSTRAINT_REASON_MAX_ITERATIONS;
    if (found.rank < rows) {  // round-off outside the range has grown by 1 / mu
      factor_range(work.range, ld, found.rank, rows, work.factor, work.vector(0));
      project_on_range(work.range, ld, found.rank, rows, work.factor, work.vector(0), work.vector(4), d.lambda);
    }
  }
  for (Index k = 0; k < m.n.nv; ++k) {
    read_row(k);
    for (Index r = 0; r < rows; ++r) tau[k] -= row[r] * d.lambda[r];
  }
  result.residual = 0;
  for_each_unactuated([&](Index k) {
    using std::abs;
    result.residual = std::max(result.residual, double(abs(tau[k])));
    tau[k] = T(0);
  });
  result.reason = found.reason, result.rows = rows, result.rank = found.rank, result.iterations = found.iterations;
  result.condition = double(found.condition), result.regularisation = double(found.regularisation);
  return 0;
}

}  // namespace dyn
