// Projects q onto the constraints: Levenberg-Marquardt on the manifold. In the metric of M the step is
//   dq = - M^-1 J^T (G + mu 1)^-1 C        G = J M^-1 J^T
// This is the smallest step that removes the linearised C. Contradictory rows end at the least sum of squares.
#pragma once

#include "algorithm/constrained/constrained_dynamics.hpp"
#include "model/length.hpp"

namespace dyn {

// Replaces the factor of M^-1 by that of the identity.
template <class T>
void set_unit_mass(const Model& m, Data<T>& d) {
  if (m.has_mimic) {
    std::fill_n(d.L, m.n.nv * padded_factor(m), T(0));
    std::fill_n(d.D, m.n.nv, T(1));
    d.invalidate(Stage::Factor);
    return;
  }
  for (Index k = 0; k < m.n.nvx; ++k) d.U_root[k] = Force<T>::zero(), d.Dinv[k] = T(1);
}

// Factor and rows at d.q. A limit that holds, and dry friction, ask for no motion. Returns 0 or the singular joint.
template <class T>
Index project_rows(const Model& m, Data<T>& d, bool weigh) {
  if (const Index failed = constraint_factor(m, d)) return failed;
  if (!weigh) set_unit_mass(m, d);
  evaluate_rows(m, d, static_cast<const T*>(nullptr), static_cast<const T*>(nullptr));
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index) {
    if (one_sided(s.c.type) && s.error[0] == T(0)) s.g1 = T(0);
  });
  return 0;
}
// Sum of squares.
template <class T>
T gather_errors(const Model& m, Data<T>& d, T* C, bool with_dropped) {
  T sum = T(0);
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index) {
    for (Index r = 0; r < s.rows; ++r) C[s.first + r] = s.error[r];
  });
  if (!with_dropped) clear_dropped_rows(m, d, C);
  for (Index i = 0, rows = active_rows(m, d); i < rows; ++i) sum += C[i] * C[i];
  return sum;
}

// out: velocity nearest to v in the metric of M that the rows allow at d.q (factor computed). It may leave a limit. out null: the
// result only.
template <class T>
void project_velocity(const Model& m, Data<T>& d, const T* v, T* out, dynConstraintResult& result) {
  ProximalResult<T> found;
  const bool bounded = any_bounded(m, d);
  T *b = row_vector(m, d, 0), *step = d.constraint_step;
  evaluate_rows(m, d, d.expand(m, v, d.vx), static_cast<const T*>(nullptr));
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index) {
    if (s.c.type == DYN_CONSTRAINT_TYPE_FRICTION) s.lower[0] = s.upper[0] = T(0);
    for (Index r = 0; r < s.rows; ++r) b[s.first + r] = -s.rate[r];
  });
  clear_dropped_rows(m, d, b);
  propagate_rows(m, d);
  solve_rows(m, d, active_rows(m, d), b, bounded, ProximalOptions{}, d.lambda, found);
  result.rank = found.rank, result.condition = double(found.condition);
  if (!out) return;
  gather(m, d, d.lambda, step);
  scatter(m, d, step);
  for (Index k = 0; k < m.n.nv; ++k) out[k] = v[k] + step[k];
}

// State of the iteration.
template <class T>
struct DescentResult {
  T cost = T(0);     // |C|^2
  int iterations = 0;
  bool ended = true;  // converged, or no step reduces |C|
  bool aligned = false;  // only what the misalignment of dropped rows explains is left
};

// Largest component of a step: angles in rad, displacements over the model's length.
template <class T>
T largest_part(const Model& m, const T* step, T length) {
  using std::abs;
  T out = T(0);
  const auto look = [&](Index first, Index end, T unit) {
    for (Index k = first; k < end; ++k) out = std::max(out, abs(step[k]) / unit);
  };
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    const Index v = b.user_v, linear = b.type == BodyType::FreeFlyer ? 3 : b.type == BodyType::Prismatic ? 1 : 0;
    const Index dofs = b.type == BodyType::FreeFlyer ? 6 : b.type == BodyType::Spherical ? 3 : 1;
    look(v, v + linear, length), look(v + linear, v + dofs, T(1));
  }
  return out;
}

// Steps from d.q while they reduce |C|. The damping is proportional to |C|, so it also converges where J loses rank at the
// solution (a linkage stretched to its full length; Sugihara 2011); each step there leaves a quarter of C. C is row vector 0.
template <class T>
Index levenberg_marquardt(const Model& m, Data<T>& d, int max_iterations, bool weigh, T tolerance, T min_damping,
                          double misalignment, DescentResult<T>& found) {
  constexpr double least = 1e-9, most = 1e6;
  const T length = T(own_length(m));
  const Index rows = active_rows(m, d);
  const std::ptrdiff_t ld = padded_rows(rows);
  const RowWork<T> work = row_work(m, d);
  T *C = row_vector(m, d, 0), *lambda = row_vector(m, d, 1), *Dinv = work.vector(0), *step = d.constraint_step,
    *before = d.constraint_q;
  if (const Index failed = project_rows(m, d, weigh)) return failed;
  found.cost = gather_errors(m, d, C, misalignment > 0), found.ended = found.aligned = false;
  T damping = T(least);
  for (int k = 0; k < max_iterations && largest_size(C, rows) > tolerance && damping < T(most); ++k) {
    ++found.iterations;
    if constexpr (std::is_same_v<T, double>)
      if (misalignment > 0) keep_all_rows(m, d);
    propagate_rows(m, d);
    for (Index i = 0; i < rows; ++i) lambda[i] = -C[i];
    if constexpr (std::is_same_v<T, double>)
      if (misalignment > 0) {
        drop_redundant_rows(m, d, misalignment), share_errors(m, d, lambda);
        const T left = largest_size(C, rows);
        found.aligned = left <= explained_error(m, d) && largest_size(lambda, rows) <= std::max(tolerance, d.row_moved[0] * left);
        if (found.aligned) break;
      }
    delassus(m, d, rows, d.row_matrix);
    T trace = T(0);
    for (Index i = 0; i < rows; ++i) trace += d.row_matrix[ld * i + i];
    const T mu = std::max(damping * std::min(T(1), T(2) * largest_size(C, rows) / length), min_damping) * trace / T(double(rows));
    if (!(mu > T(0))) break;
    factor_rows(d.row_matrix, ld, rows, mu, mu / T(2), work.factor, Dinv);
    solve_factored(work.factor, Dinv, ld, rows, lambda);
    gather(m, d, lambda, step);
    scatter(m, d, step);
    // limits a step to one radian, or to C plus the model's own length, because C is nonlinear beyond
    const T longest = largest_part(m, static_cast<const T*>(step), length), allowed = T(1) + largest_size(C, rows) / length;
    for (Index k = 0; k < m.n.nv && longest > allowed; ++k) step[k] *= allowed / longest;
    std::copy(d.q, d.q + m.n.nq, before);
    integrate(m, static_cast<const T*>(before), static_cast<const T*>(step), d.q);
    if (const Index failed = project_rows(m, d, weigh)) return failed;
    T* trial = lambda;
    const T now = gather_errors(m, d, trial, misalignment > 0);
    if (now < found.cost) {
      std::copy(trial, trial + rows, C);
      found.cost = now, damping = std::max(T(least), damping / T(10));
      continue;
    }
    std::copy(before, before + m.n.nq, d.q);
    damping = damping * T(10);
    if (const Index failed = project_rows(m, d, weigh)) return failed;
  }
  found.ended = found.aligned || largest_size(C, rows) <= tolerance || !(damping < T(most));
  return 0;
}

// Restarts beside a point where no small step helps, which may be a saddle (a flat stretched linkage). Keeps the better q.
template <class T>
Index escape_saddle(const Model& m, Data<T>& d, int max_iterations, bool weigh, T tolerance, T min_damping, double misalignment,
                    DescentResult<T>& found) {
  T *kept = d.constraint_q + m.n.nq, *step = d.constraint_step;
  Random random{1};
  for (const double size : {0.01, 0.3}) {
    if (!found.ended || found.aligned || largest_size(row_vector(m, d, 0), active_rows(m, d)) <= tolerance) break;
    std::copy(d.q, d.q + m.n.nq, kept);
    for (Index k = 0; k < m.n.nv; ++k) step[k] = T(random.uniform(-size, size));
    integrate(m, static_cast<const T*>(kept), static_cast<const T*>(step), d.q);
    const T before = found.cost;
    if (const Index failed = levenberg_marquardt(m, d, max_iterations, weigh, tolerance, min_damping, misalignment, found))
      return failed;
    if (found.cost < T(0.999) * before) continue;
    std::copy(kept, kept + m.n.nq, d.q);
    if (const Index failed = project_rows(m, d, weigh)) return failed;
    found.cost = gather_errors(m, d, row_vector(m, d, 0), misalignment > 0), found.ended = true;
  }
  return 0;
}

// Sets d.q to the solution. v, unless null: becomes the nearest velocity that the rows allow there. min_damping: lower bound that
// keeps rounding from moving d.q where J nearly loses rank. misalignment: redundant rows are left out up to it
// (redundant_rows.hpp).
template <class T>
Index project(const Model& m, Data<T>& d, int max_iterations, bool weigh, T tolerance, T* v, dynConstraintResult& result,
              double misalignment, T min_damping) {
  const Index rows = active_rows(m, d);
  const T* C = row_vector(m, d, 0);
  DescentResult<T> descent;
  if (const Index failed = levenberg_marquardt(m, d, max_iterations, weigh, tolerance, min_damping, misalignment, descent))
    return failed;
  if (const Index failed = escape_saddle(m, d, max_iterations, weigh, tolerance, min_damping, misalignment, descent))
    return failed;
  result.rows = rows, result.iterations = descent.iterations, result.residual = double(largest_size(C, rows));
  const bool closed = result.residual <= double(tolerance);
  result.reason = closed || descent.aligned ? DYN_CONSTRAINT_REASON_CONVERGED
                  : descent.ended           ? DYN_CONSTRAINT_REASON_CONTRADICTORY
                                            : DYN_CONSTRAINT_REASON_MAX_ITERATIONS;
  result.contradiction = descent.ended && !closed ? result.residual : 0;

  project_velocity(m, d, v ? v : static_cast<const T*>(d.zero), v, result);
  if (misalignment > 0) keep_all_rows(m, d);
  return 0;
}

}  // namespace dyn
