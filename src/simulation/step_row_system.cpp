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
    for (Index s = 0; s < rows; ++s) {
      double sum = 0;
      for (Index k = 0; k < nv; ++k) sum += J(r)[k] * y.Z[nv * s + k];
      y.K[rows * r + s] = sum;
    }
  for (Index k = 0; k < contacts; ++k) {
    const JacobianContact& c = y.contacts[k];
    y.K[(rows + 1) * c.first] += compliance(w.laws[c.contact]);
    if (c.first + 1 < rows && y.rows[c.first + 1].kind == JacobianRowKind::Slide) slide(c);
  }
}

// dlambda_t + mu e dlambda_n + mu lambda_n / |u| (1 - e e^T) du = 0, with du = K dlambda - b
void StepJacobian::slide(const JacobianContact& c) const {
  const double mu = w.laws[c.contact].material.friction, by = mu * y.rows[c.first].lambda / c.sliding;
  double *const K0 = y.K + rows * (c.first + 1), *const K1 = K0 + rows;
  double *const b0 = y.wanted + columns * (c.first + 1), *const b1 = b0 + columns;
  const double p[2] = {-c.direction[1] * by, c.direction[0] * by};  // (1 - e e^T) = n n^T with n across e
  const double n[2] = {-c.direction[1], c.direction[0]};
  const auto combine = [&](double* a, double* b, std::ptrdiff_t count) {
    for (std::ptrdiff_t k = 0; k < count; ++k) {
      const double across = n[0] * a[k] + n[1] * b[k];
      a[k] = p[0] * across, b[k] = p[1] * across;
    }
  };
  combine(K0, K1, rows), combine(b0, b1, columns);
  K0[c.first + 1] += 1, K1[c.first + 2] += 1;
  K0[c.first] += mu * c.direction[0], K1[c.first] += mu * c.direction[1];
}

// lambda = K^-1 wanted. Where K is singular, with a little regularisation, refined. Returns whether the equations are
// consistent and determine the motion.
bool StepJacobian::solve_rows() const {
  constexpr double softness = 1e-10, floor = 1e-14, independent = 1e-9, consistent = 1e-6;
  constexpr int refinements = 2;
  std::copy_n(y.K, rows * rows, y.factor);
  if (factor_with_pivots(y.factor, rows) > independent) {
    std::copy_n(y.wanted, rows * columns, y.lambda);
    return substitute(y.factor, rows, y.lambda, columns), true;
  }
  double size = 0;
  for (Index r = 0; r < rows; ++r) size = std::max(size, std::abs(y.K[(rows + 1) * r]));
  std::copy_n(y.K, rows * rows, y.factor);
  for (Index r = 0; r < rows; ++r) y.factor[(rows + 1) * r] += softness * y.K[(rows + 1) * r] + floor * size;
  factor_with_pivots(y.factor, rows);
  const auto largest = [&](const double* a) {
    double most = 0;
    for (Index k = 0; k < rows * columns; ++k) most = std::max(most, std::abs(a[k]));
    return most;
  };
  std::fill_n(y.lambda, rows * columns, 0.0);
  for (int n = 0;; ++n) {
    std::copy_n(y.wanted, rows * columns, y.rest);
    for (Index r = 0; r < rows; ++r)
      for (Index s = 0; s < (n ? rows : 0); ++s)
        add_row(y.rest + columns * r, y.lambda + columns * s, -y.K[rows * r + s], columns);
    if (n > refinements) return largest(y.rest) <= consistent * largest(y.wanted) && is_determined();
    substitute(y.factor, rows, y.rest, columns);
    for (Index k = 0; k < rows * columns; ++k) y.lambda[k] += y.rest[k];
  }
}

// Whether impulses that the rows leave open move nothing: sliding contacts may share a load in ways that turn a body
// differently.
bool StepJacobian::is_determined() const {
  constexpr double open = 1e6, moves = 1e-4;
  double size = 0, impulses = 0, motion = 0, moved = 0;
  for (Index r = 0; r < rows; ++r) {
    size = std::max(size, std::abs(y.K[(rows + 1) * r]));
    y.rest[columns * r] = 1 + 0.37 * double((7 * r) % 11);  // of no symmetry
    std::fill_n(y.rest + columns * r + 1, columns - 1, 0.0);
  }
  substitute(y.factor, rows, y.rest, columns);
  for (Index r = 0; r < rows; ++r) impulses = std::max(impulses, std::abs(y.rest[columns * r]));
  if (!(impulses * size > open)) return true;
  for (Index k = 0; k < nv; ++k) {
    double sum = 0, all = 0;
    for (Index r = 0; r < rows; ++r) {
      const double by = y.Z[nv * r + k] * y.rest[columns * r];
      sum += by, all += std::abs(by);
    }
    motion = std::max(motion, std::abs(sum)), moved = std::max(moved, all);
  }
  return motion <= moves * moved;
}

// Gauss with row pivots, in place. Returns the least pivot over the largest.
double StepJacobian::factor_with_pivots(double* F, Index rows) const {
  double least = HUGE_VAL, most = 0;
  for (Index k = 0; k < rows; ++k) {
    Index pivot = k;
    for (Index r = k + 1; r < rows; ++r)
      if (std::abs(F[rows * r + k]) > std::abs(F[rows * pivot + k])) pivot = r;
    y.pivots[k] = pivot;
    if (pivot != k) std::swap_ranges(F + rows * k, F + rows * (k + 1), F + rows * pivot);
    double& own = F[rows * k + k];
    least = std::min(least, std::abs(own)), most = std::max(most, std::abs(own));
    if (own == 0) own = 1;
    for (Index r = k + 1; r < rows; ++r)
      if (double& by = F[rows * r + k]; by != 0)
        by /= own, add_row(F + rows * r + k + 1, F + rows * k + k + 1, -by, rows - k - 1);
  }
  return most > 0 ? least / most : 0;
}

// b, rows x columns, becomes the solution of a factored matrix.
void StepJacobian::substitute(const double* F, Index rows, double* b, std::ptrdiff_t columns) const {
  for (Index k = 0; k < rows; ++k) {
    if (y.pivots[k] != k) std::swap_ranges(b + columns * k, b + columns * (k + 1), b + columns * y.pivots[k]);
    double* const to = b + columns * k;
    for (std::ptrdiff_t c = 0; c < columns; ++c) to[c] = -to[c];
    add_rows(to, b, columns, F + rows * k, 1, k, columns);
    for (std::ptrdiff_t c = 0; c < columns; ++c) to[c] = -to[c];
  }
  for (Index k = rows - 1; k >= 0; --k) {
    double* const to = b + columns * k;
    for (std::ptrdiff_t c = 0; c < columns; ++c) to[c] = -to[c];
    add_rows(to, b + columns * (k + 1), columns, F + rows * k + k + 1, 1, rows - k - 1, columns);
    const double by = -1 / F[rows * k + k];
    for (std::ptrdiff_t c = 0; c < columns; ++c) to[c] *= by;
  }
}

}  // namespace dyn::simulation
