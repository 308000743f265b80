// The linearised step (step_linearisation.hpp): the equations of its rows, and their solution.
#include "simulation/step_linearisation.hpp"

namespace dyn::simulation {

// K dlambda = -(J dv' + E): sticking and pressed rows. Sliding ones follow.
void StepJacobian::assemble() const {
  std::fill_n(y.Z, rows * nv, 0.0);
  add_product(y.Z, nv, rows, {y.J, nv, 1}, d.Minv, nv, Index(nv), nv);
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
  for_each_sliding([&](const JacobianContact& c, Index t, const double* e, double by) {
    double *const first = y.K + rows * t, *const second = first + rows;
    turn_rows(first, second, e, by, rows);
    second[t] -= e[1], second[t + 1] += e[0];
    first[t] += e[0], first[t + 1] += e[1], first[c.first] += w.laws[c.contact].material.friction;
  });
}

// wanted = -(J dv' + E)
void StepJacobian::find_wanted() const {
  if (along) {
    for (Index r = 0; r < rows; ++r)
      y.wanted[r] = -(inner(J(r), y.state, nv) + inner(E(r), y.direction, 2 * nv) + y.given.row[r]);
  } else {
    for (Index r = 0; r < rows; ++r) std::fill_n(std::copy_n(E(r), 2 * nv, y.wanted + columns * r), nv, 0.0);
    add_product(y.wanted, columns, rows, {y.J, nv, 1}, y.state, columns, Index(nv), columns);
    for (std::ptrdiff_t k = 0; k < rows * columns; ++k) y.wanted[k] = -y.wanted[k];
  }
  for_each_sliding([&](const JacobianContact&, Index t, const double* e, double by) {
    double* const b = y.wanted + columns * t;
    turn_rows(b, b + columns, e, by, columns);
    if (along) b[0] -= y.given.slide[t];
  });
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

// Of two rows of a contact that slides: dlambda_t + mu e dlambda_n + mu lambda_n / |u| (1 - e e^T) du = 0, with
// du = K dlambda - b: along e (first), where the last term is none, and across it (second).
void StepJacobian::turn_rows(double* first, double* second, const double* e, double by, std::ptrdiff_t n) {
  for (std::ptrdiff_t k = 0; k < n; ++k) second[k] = by * (e[0] * second[k] - e[1] * first[k]), first[k] = 0;
}

// Rows are scaled: units and masses differ.
void StepJacobian::factor_rows() {
  for (Index r = 0; r < rows; ++r) {
    double* const row = y.factor + rows * r;
    double most = 0;
    for (Index s = 0; s < rows; ++s) row[s] = y.K[rows * r + s] * y.scale[s], most = std::max(most, std::abs(row[s]));
    y.row_scale[r] = y.rows[r].kind != JacobianRowKind::Slide ? y.scale[r] : most > 0 ? 1 / most : 0;
    for (Index s = 0; s < rows; ++s) row[s] *= y.row_scale[r];
  }
  system = {y.factor, rows, y.pivots, y.unknowns};
  system.factor(tuning::derivatives::independent);
}

// Adds J^T lambda to the state, K lambda = wanted. Returns whether the equations are consistent.
bool StepJacobian::solve_rows() const {
  using tuning::derivatives::consistent;
  for (Index r = 0; r < rows; ++r)
    for (std::ptrdiff_t c = 0; c < columns; ++c) y.wanted[columns * r + c] *= y.row_scale[r];
  const double size = largest_of(y.wanted, rows * columns);
  system.solve(y.wanted, columns);
  for (Index r = 0; along && r < system.rank; ++r)
    add_row(y.state, y.Z + nv * system.columns[r], y.scale[system.columns[r]] * y.wanted[r], nv);
  if (!along) {
    double* const Z = y.rest;  // of the independent rows
    for (Index r = 0; r < system.rank; ++r) {
      const double* const z = y.Z + nv * system.columns[r];
      const double by = y.scale[system.columns[r]];
      for (Index k = 0; k < nv; ++k) Z[nv * r + k] = z[k] * by;
    }
    add_product(y.state, columns, nv, {Z, 1, nv}, y.wanted, columns, system.rank, columns);
  }
  return largest_of(y.wanted + system.rank * columns, (rows - system.rank) * columns) <= consistent * size;
}
// From the gradient by the state after the impulses to that before them.
void StepJacobian::transpose_rows() const {
  double* const b = y.row_adjoint;
  std::fill_n(b, rows, 0.0);
  for (Index r = 0; r < system.rank; ++r) {
    const Index of = system.columns[r];
    b[r] = y.scale[of] * inner(y.Z + nv * of, y.state_adjoint, nv);
  }
  system.solve_transposed(b);
  for (Index r = 0; r < rows; ++r) b[r] *= y.row_scale[r], y.gradient.slide[r] = 0;
  for_each_sliding([&](const JacobianContact&, Index t, const double* e, double by) {
    const double second = by * b[t + 1];
    y.gradient.slide[t] = -b[t], b[t] = -e[1] * second, b[t + 1] = e[0] * second;
  });
  for (Index r = 0; r < rows; ++r) {
    add_row(y.state_adjoint, J(r), -b[r], nv), add_row(y.adjoint, E(r), -b[r], 2 * nv);
    y.gradient.row[r] = -b[r];
  }
}

// Whether impulses that the rows leave open move nothing: sliding contacts may share a load in ways that turn a body
// differently.
bool StepJacobian::is_determined() const {
  const Index open = rows - system.rank;
  if (open == 0) return true;
  double *const null = y.G, *const motion = y.wanted;
  for (Index r = 0; r < open; ++r) {
    double* const own = null + rows * r;
    system.null_vector(system.rank + r, own);
    for (Index k = 0; k < rows; ++k) own[k] *= y.scale[k];
  }
  std::fill_n(motion, open * nv, 0.0);
  add_product(motion, nv, open, {null, rows, 1}, y.Z, nv, rows, nv);
  double* const moved = y.row_adjoint;  // by a unit of each impulse
  for (Index k = 0; k < rows; ++k) moved[k] = largest_of(y.Z + nv * k, nv);
  for (Index r = 0; r < open; ++r) {
    double most = 0;
    for (Index k = 0; k < rows; ++k) most += std::abs(null[rows * r + k]) * moved[k];
    if (largest_of(motion + nv * r, nv) > tuning::derivatives::consistent * most) return false;
  }
  return true;
}

}  // namespace dyn::simulation
