#include "algorithm/constrained/constrained_dynamics.hpp"

#include "model/length.hpp"

namespace dyn {

double explained_error(const Model& m, const Data<double>& d) {
  constexpr double exact = 1e-7, explained = 10;  // of rows that are exactly redundant; of a misalignment over the length
  return std::max(exact, explained * d.row_moved[0] * own_length(m));
}

// With the dropped rows C times the kept ones: (1 + C^T C) y = errors_K + C^T errors_D.
void share_errors(const Model& m, Data<double>& d, double* errors) {
  const Index count = d.row_system[0], n = d.row_system[1], dropped = d.row_system[2];
  if (dropped == 0) return;
  const RowWork<double> work = row_work(m, d);
  const std::ptrdiff_t ld = padded_rows(n);
  double *const A = work.scaled, *const out = work.vector(1), *const own = work.vector(2);
  const auto for_each_error = [&](auto&& f) {
    for (Index i = 0, row = 0; i < count; ++i)
      for (Index r = 0; r < d.equality_rows[i].s->rows; ++r, ++row) f(errors[d.equality_rows[i].s->first + r], row);
  };
  for_each_error([&](double error, Index row) { out[row] = own[row] = error; });
  std::fill_n(A, ld * n, 0.0);
  for (Index i = 0; i < n; ++i) A[ld * i + i] = 1;
  const Index* const dropped_rows = d.row_system + 3;
  // f(row, its place among them) for the kept rows
  const auto for_each_kept = [&](auto&& f) {
    for (Index i = 0, gone = 0; i < n; ++i) {
      if (gone < dropped && dropped_rows[gone] == i) ++gone;
      else f(i, i - gone);
    }
  };
  for (Index k = 0; k < dropped; ++k) {
    const double* C = d.row_dependence + std::ptrdiff_t(n - dropped) * k;
    const Index row = dropped_rows[k];
    out[row] = 0;
    for_each_kept([&](Index i, Index a) {
      if (C[a] == 0) return;
      out[i] += C[a] * own[row];
      for_each_kept([&](Index j, Index b) { A[ld * j + i] += C[a] * C[b]; });
    });
  }
  factor_rows(A, ld, n, 0.0, 0.0, work.factor, work.vector(0));
  solve_factored(work.factor, work.vector(0), ld, n, out);
  for_each_error([&](double& error, Index row) { error = out[row]; });
}

}  // namespace dyn
