// The linearised step (step_linearisation.hpp): the equations of its rows, and their solution.
#include "simulation/step_linearisation.hpp"

namespace dyn::simulation {

// K dlambda = -(J dv' + E): sticking and pressed rows. Sliding ones follow.
void StepJacobian::assemble() const {
  for (Index r = 0; r < rows; ++r) {
    double *const z = y.Z + nv * r, *const b = y.wanted + columns * r;
    std::fill_n(z, nv, 0.0), std::fill_n(b, columns, 0.0);
    add_rows(z, d.Minv, nv, J(r), 1, Index(nv), nv);
    add_rows(b, y.state, columns, J(r), 1, Index(nv), columns);
    for (std::ptrdiff_t c = 0; c < 2 * nv; ++c) b[c] += E(r)[c];
    for (std::ptrdiff_t c = 0; c < columns; ++c) b[c] = -b[c];
  }
  for (Index r = 0; r < rows; ++r)
    for (Index s = 0; s <= r; s += 4) {  // sums side by side
      const double *const z = y.Z + nv * s, *const j = J(r);
      const Index count = std::min<Index>(4, r + 1 - s);
      double sum[4] = {};
      const auto add = [&](Index k, Index n) {
        for (Index i = 0; i < n; ++i) sum[i] += j[k] * z[nv * i + k];
      };
      for (Index k = 0; k < nv; ++k)
        if (j[k] != 0) count == 4 ? add(k, 4) : add(k, count);
      for (Index i = 0; i < count; ++i) y.K[rows * r + s + i] = y.K[rows * (s + i) + r] = sum[i];
    }
  for (Index k = 0; k < contacts; ++k) y.K[(rows + 1) * y.contacts[k].first] += compliance(w.laws[y.contacts[k].contact]);
  double most = 0;
  for (Index r = 0; r < rows; ++r) most = std::max(most, y.K[(rows + 1) * r]);
  for (Index r = 0; r < rows; ++r) {
    const double own = y.K[(rows + 1) * r];
    y.scale[r] = own > solver::tuning::pgs::tiny * most ? 1 / std::sqrt(own) : 0;  // else nothing moves it
  }
  for (Index k = 0; k < contacts; ++k) {
    const JacobianContact& c = y.contacts[k];
    if (c.first + 1 < rows && y.rows[c.first + 1].kind == JacobianRowKind::Slide) slide(c);
  }
}

// Contacts and limits that hardly press: without them, their velocities would differ by less than the margin.
void StepJacobian::flag_weak_rows(double margin) const {
  for (Index r = 0; r < rows; ++r) {
    const JacobianRow& row = y.rows[r];
    if (row.lambda * y.K[(rows + 1) * r] >= margin) continue;
    if (row.kind == JacobianRowKind::Normal) x.modes.degenerate[y.contacts[row.of].contact] = 1;
    const bool counted = row.kind == JacobianRowKind::Limit && std::abs(limit_gap(m, x.q, row.of)) < margin;  // by find_modes
    if (row.kind == JacobianRowKind::Limit && !counted) ++x.degenerate;
  }
}

// dlambda_t + mu e dlambda_n + mu lambda_n / |u| (1 - e e^T) du = 0, with du = K dlambda - b: along e, where the last term is
// none, and across it.
void StepJacobian::slide(const JacobianContact& c) const {
  const double mu = w.laws[c.contact].material.friction, by = mu * y.rows[c.first].lambda / c.sliding;
  const Index t = c.first + 1;
  double *const along = y.K + rows * t, *const across = along + rows;
  double *const b0 = y.wanted + columns * t, *const b1 = b0 + columns;
  const double* const e = c.direction;
  for (Index k = 0; k < rows; ++k) across[k] = by * (e[0] * across[k] - e[1] * along[k]), along[k] = 0;
  for (std::ptrdiff_t k = 0; k < columns; ++k) b1[k] = by * (e[0] * b1[k] - e[1] * b0[k]), b0[k] = 0;
  across[t] -= e[1], across[t + 1] += e[0];
  along[t] += e[0], along[t + 1] += e[1], along[c.first] += mu;
}

// Adds J^T lambda to the state, K lambda = wanted. Rows are scaled: units and masses differ. Returns whether the equations are
// consistent and determine the motion.
bool StepJacobian::solve_rows() const {
  using tuning::derivatives::independent, tuning::derivatives::consistent;
  const auto largest = [&](Index first, Index end) {
    double most = 0;
    for (std::ptrdiff_t k = first * columns; k < end * columns; ++k) most = std::max(most, std::abs(y.wanted[k]));
    return most;
  };
  for (Index r = 0; r < rows; ++r) {
    double* const row = y.factor + rows * r;
    double most = 0, by = y.scale[r];
    for (Index s = 0; s < rows; ++s) row[s] = y.K[rows * r + s] * y.scale[s], most = std::max(most, std::abs(row[s]));
    if (y.rows[r].kind == JacobianRowKind::Slide) by = most > 0 ? 1 / most : 0;
    for (Index s = 0; s < rows; ++s) row[s] *= by;
    for (std::ptrdiff_t c = 0; c < columns; ++c) y.wanted[columns * r + c] *= by;
  }
  const double size = largest(0, rows);
  solver::RankedLu lu = lu_of(rows);
  lu.factor(independent), lu.solve(y.wanted, columns);
  for (Index k = 0; k < nv; ++k) {
    for (Index r = 0; r < lu.rank; ++r) y.rest[r] = y.Z[nv * lu.columns[r] + k] * y.scale[lu.columns[r]];
    add_rows(state(k), y.wanted, columns, y.rest, 1, lu.rank, columns);
  }
  return largest(lu.rank, rows) <= consistent * size && is_determined(lu);
}

// Whether impulses that the rows leave open move nothing: sliding contacts may share a load in ways that turn a body
// differently.
bool StepJacobian::is_determined(const solver::RankedLu& lu) const {
  double *const open = y.rest, *const sum = x.plus, *const all = sum + nv;
  for (Index at = lu.rank; at < rows; ++at) {
    lu.null_vector(at, open);
    std::fill_n(sum, 2 * nv, 0.0);
    for (Index r = 0; r < rows; ++r) {
      const double by = open[r] * y.scale[r];
      const double* const z = y.Z + nv * r;
      for (Index k = 0; k < (by != 0 ? nv : 0); ++k) sum[k] += z[k] * by, all[k] += std::abs(z[k] * by);
    }
    double motion = 0, moved = 0;
    for (Index k = 0; k < nv; ++k) motion = std::max(motion, std::abs(sum[k])), moved = std::max(moved, all[k]);
    if (motion > tuning::derivatives::consistent * moved) return false;
  }
  return true;
}

}  // namespace dyn::simulation
