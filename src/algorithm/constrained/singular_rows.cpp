// Rows that are small only at a singular configuration of the mechanism.
#include "algorithm/constrained/redundant_rows_search.hpp"

namespace dyn {

namespace {

// Second derivative, of a row's terms times a motion squared, above which the configuration is singular.
constexpr double bends = 1e-2;

}  // namespace

// Rates and accelerations of the rows at v, without those of joints.
void RedundantRows::evaluate(const double* v) const {
  const double* expanded = d.expand(m, v, d.row_motion + 2 * m.n.nv);
  for_each_row([&](const EqualityRows& x, Index) {
    if (of_path(x.s->c)) x.s->rate[0] = path_rate(m, d, *x.s, expanded);
    else if (between_joints(x.s->c.type)) evaluate_joints(d, *x.s, expanded, static_cast<const double*>(nullptr));
    else evaluate_frames(m, d, *x.s, expanded, static_cast<const double*>(nullptr));
  });
}

// w: some motion less what the kept rows forbid of it, in the metric of M.
void RedundantRows::allowed_motion(Index rank, double* w) const {
  Random random{1};
  for (Index k = 0; k < m.n.nv; ++k) w[k] = random.uniform(-1, 1);
  evaluate(w);
  double *const rate = work.vector(0), *const taken = d.row_motion + m.n.nv;
  for_each_acting_row([&](const EqualityRows& x, Index r, Index a) { rate[a] = scale[a] * x.s->rate[r]; });
  for (Index k = 0; k < rank; ++k) {  // R_K^T R_K impulse = rate
    for (Index j = 0; j < k; ++j) rate[pivots[k]] -= R[ld * j + pivots[k]] * rate[pivots[j]];
    rate[pivots[k]] /= R[ld * k + pivots[k]];
  }
  for (Index k = rank - 1; k >= 0; --k) {
    for (Index j = k + 1; j < rank; ++j) rate[pivots[k]] -= R[ld * k + pivots[j]] * rate[pivots[j]];
    rate[pivots[k]] /= R[ld * k + pivots[k]];
  }
  std::fill_n(taken, m.n.nv, 0.0);
  for_each_acting_row([&](const EqualityRows& x, Index r, Index a) {
    for (Index k = 0; k < x.s->support_count && state[a] == 1; ++k)
      taken[x.support[k]] += x.Y[row_lanes * k + r] * scale[a] * rate[a];
  });
  scatter(m, d, taken);
  double most = 0;
  for (Index k = 0; k < m.n.nv; ++k) w[k] -= taken[k], most = std::max(most, std::abs(w[k]));
  for (Index k = 0; k < m.n.nv && most > 0; ++k) w[k] /= most;
}

// Returns whether the second derivative of a dropped row, along a motion that the kept rows allow, is larger than a
// misalignment's.
bool RedundantRows::is_singular(Index rank) {
  bool singular = false;
  double *const w = d.row_motion, *const bend = work.vector(0), *const rates = work.vector(7);
  for_each_row([&](const EqualityRows& x, Index row) { std::copy_n(x.s->rate, x.s->rows, rates + row); });
  allowed_motion(rank, w);
  evaluate(w);
  for_each_acting_row([&](const EqualityRows& x, Index r, Index a) { bend[a] = scale[a] * x.s->acceleration[r]; });
  for_each_row([&](const EqualityRows& x, Index row) { std::copy_n(rates + row, x.s->rows, x.s->rate); });
  for (Index i = 0; i < acting; ++i) {
    if (state[i] != 2 || !(moved_by[i] > aligned) || !(moved_by[i] < misalignment)) continue;
    weights(i, rank);
    double sum = bend[i], whole = scale[i] * bound_of[i];
    for (Index j = 0; j < acting; ++j) sum -= weight[j] * bend[j], whole += std::abs(weight[j]) * scale[j] * bound_of[j];
    singular = singular || std::abs(sum) > bends * whole;
  }
  return singular;
}

}  // namespace dyn
