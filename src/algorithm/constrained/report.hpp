// Constraint diagnostics: rank, condition, and dependent rows, from the eigenvectors of the Delassus matrix with unit diagonal.
// Eigenvectors of eigenvalue 0 are combinations of rows that no motion changes: C along them cannot be removed. As many count as
// zero as steps leave out rows (redundant_rows.hpp). An error that their misalignment explains is no contradiction.
#pragma once

#include <algorithm>

#include "algorithm/constrained/constrained_dynamics.hpp"

namespace dyn {

// Jacobi's method: A becomes diagonal, the columns of V its eigenvectors.
template <class T>
void jacobi_eigenvectors(T* A, T* V, std::ptrdiff_t ld, Index n) {
  using std::abs;
  using std::sqrt;
  for (Index c = 0; c < n; ++c)
    for (Index r = 0; r < n; ++r) V[ld * c + r] = T(r == c);
  for (int sweep = 0; sweep < 60; ++sweep) {
    T off = T(0);
    for (Index p = 0; p < n; ++p)
      for (Index q = p + 1; q < n; ++q) {
        const T x = A[ld * q + p];
        off = std::max(off, abs(x));
        if (abs(x) < T(1e-18)) continue;
        const T theta = (A[ld * q + q] - A[ld * p + p]) / (T(2) * x);
        const T t = (theta >= T(0) ? T(1) : T(-1)) / (abs(theta) + sqrt(theta * theta + T(1))), c = T(1) / sqrt(t * t + T(1)),
                s = t * c;
        auto turn = [&](T& a, T& b) {
          const T u = a, w = b;
          a = c * u - s * w, b = s * u + c * w;
        };
        for (Index k = 0; k < n; ++k) turn(A[ld * p + k], A[ld * q + k]);
        for (Index k = 0; k < n; ++k) turn(A[ld * k + p], A[ld * k + q]);
        for (Index k = 0; k < n; ++k) turn(V[ld * p + k], V[ld * q + k]);
      }
    if (off < T(1e-15)) return;
  }
}

// rows_out(row among all, verdict, share, error). Returns 0 or the singular joint.
template <class T, class Out>
Index constraint_report(const Model& m, Data<T>& d, dynConstraintReport& report, Out&& rows_out) {
  using std::abs;
  using std::sqrt;
  constexpr double rounding = 1e-10, participating = 1e-6, little = 0.1;
  if (const Index failed = constraint_factor(m, d)) return failed;
  evaluate_rows(m, d, static_cast<const T*>(nullptr), static_cast<const T*>(nullptr));
  propagate_rows(m, d);
  const Index left_out = drop_redundant_rows(m, d, misalignment_tolerance);
  const double agreement = explained_error(m, d);
  keep_all_rows(m, d), propagate_rows(m, d);
  const Index n = active_rows(m, d);
  const std::ptrdiff_t ld = padded_rows(n);
  delassus(m, d, n, d.row_matrix);
  T *C = row_vector(m, d, 0), *scale = row_vector(m, d, 1), *along = row_vector(m, d, 2), *share = row_vector(m, d, 3);
  T *A = d.row_scaled, *V = d.row_range, most = T(0);
  for_each_constraint(m, d, [&](const ConstraintInstance<T>& s, Index) {
    for (Index r = 0; r < s.rows; ++r) C[s.first + r] = s.error[r];
  });
  for (Index i = 0; i < n; ++i) most = std::max(most, d.row_matrix[ld * i + i]);
  for (Index i = 0; i < n; ++i)
    scale[i] = d.row_matrix[ld * i + i] > T(1e-24) * most ? T(1) / sqrt(d.row_matrix[ld * i + i]) : T(0);
  // rows that almost nothing moves: by what would move them
  for_each_constraint(m, d, [&](const ConstraintInstance<T>& s, Index) {
    for (Index r = 0; is_rigid_equality(s.c) && r < s.rows; ++r)
      if (const T moved = d.row_share[s.first + r]; moved < T(little)) scale[s.first + r] *= moved;
  });
  bool has_friction = false;
  const auto decompose = [&](bool with_friction) {
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) A[ld * j + i] = d.row_matrix[ld * j + i] * scale[i] * scale[j];
    for_each_constraint(m, d, [&](const ConstraintInstance<T>& s, Index) {
      if (s.c.type != DYN_CONSTRAINT_TYPE_FRICTION) return;
      has_friction = true;
      for (Index i = 0; i < n && !with_friction; ++i) A[ld * s.first + i] = A[ld * i + s.first] = T(0);
    });
    jacobi_eigenvectors(A, V, ld, n);
  };
  decompose(true);
  // the left_out smallest eigenvalues count as zero
  for (Index k = 0; k < n; ++k) along[k] = A[ld * k + k];
  std::sort(along, along + n);
  const double zero = std::max(rounding, left_out > 0 ? double(along[left_out - 1]) * (1 + rounding) : 0);

  report.rows = n, report.rank = 0;
  report.smallest = report.largest = 0;
  for (Index i = 0; i < n; ++i) along[i] = share[i] = T(0);
  for (Index k = 0; k < n; ++k) {
    const double e = double(A[ld * k + k]);
    if (e > zero) {
      report.smallest = report.rank == 0 ? e : std::min(report.smallest, e), report.largest = std::max(report.largest, e);
      ++report.rank;
      continue;
    }
    for (Index i = 0; i < n; ++i) share[i] += V[ld * k + i] * V[ld * k + i];
  }
  if (has_friction) decompose(false);  // friction has no position error, so it contradicts nothing
  for (Index k = 0; k < n; ++k) {
    if (double(A[ld * k + k]) > zero) continue;
    T c = T(0);
    for (Index i = 0; i < n; ++i) c += V[ld * k + i] * C[i] * scale[i];
    for (Index i = 0; i < n; ++i) along[i] += c * V[ld * k + i];
  }
  report.condition = report.rank ? report.largest / report.smallest : 1;
  report.redundant = n - report.rank, report.contradictory = 0, report.error = report.contradiction = 0;
  for (Index i = 0; i < n; ++i) {
    const bool immobile = scale[i] == T(0);
    const double off = double(immobile ? abs(C[i]) : abs(along[i]) / scale[i]);
    const bool dependent = immobile || share[i] > T(participating), contradicts = dependent && off > agreement;
    report.error = std::max(report.error, double(abs(C[i]))),
    report.contradiction = std::max(report.contradiction, dependent ? off : 0.0);
    report.contradictory += contradicts;
    const dynRowVerdict verdict = contradicts ? DYN_ROW_VERDICT_CONTRADICTORY
                                  : immobile  ? DYN_ROW_VERDICT_IMMOBILE
                                  : dependent ? DYN_ROW_VERDICT_REDUNDANT
                                              : DYN_ROW_VERDICT_INDEPENDENT;
    rows_out(i, verdict, immobile ? 1.0 : double(share[i]), double(C[i]));
  }
  return 0;
}

}  // namespace dyn
