// An island by its dense Delassus matrix and the contact solvers of solver/.
#include "algorithm/constrained/constrained_dynamics.hpp"
#include "simulation/island.hpp"
#include "solver/list.hpp"

namespace dyn::simulation {

namespace {

bool share_no_tree(const ActiveConstraint& a, const ActiveConstraint& b) {
  if (is_path_row(a) || is_path_row(b)) return false;  // of several trees
  auto in = [&](Index tree) { return tree >= 0 && (tree == b.tree1 || tree == b.tree2); };
  return !in(a.tree1) && !in(a.tree2);
}

template <int columns>
void couple_constraints(const ActiveConstraint& a, const PropagatedRows& of_a, const ActiveConstraint& b,
                        const PropagatedRows& of_b, const double* Dinv, double* block, std::ptrdiff_t ld) {
  couple<columns>(of_a.support, a.support_count, of_a.Y, of_b.support, b.support_count, of_b.Y, Dinv, block, ld);
}

dynContactProblem problem(const Island& x) {
  dynContactProblem p{};
  p.struct_size = sizeof p;
  p.equalities = x.equalities, p.boxes = x.boxes, p.contacts = x.contacts;
  p.contact_rows = x.w.contact_rows, p.G = x.w.matrix, p.G_stride = std::int32_t(x.stride());
  p.g = x.g, p.bias = x.bias, p.lower = x.lower, p.upper = x.upper;
  return p;
}

}  // namespace

// G = Z^T Z, Z = D^-1/2 Y row by row, as for one tree. Returns false if Z is larger than G, or if its zeros cost more products
// than pairs of constraints do, each by the degrees of freedom of one of them.
bool Island::dense_matrix() {
  using P = Simd<double, row_lanes>;
  Index low = m.n.nvx, high = 0;
  std::ptrdiff_t carried = 0;
  for (Index k = 0; k < constraint_count; ++k) {
    const ActiveConstraint& a = constraint(k);
    if (a.support_count == 0) continue;
    const Index* const support = rows_of(a).support;
    low = std::min(low, support[a.support_count - 1]), high = std::max(high, support[0]), carried += a.support_count;
  }
  const Index dofs = high - low + 1;
  if (dofs < 1 || dofs > rows || std::ptrdiff_t(dofs) * rows > row_lanes * carried) return false;
  const std::ptrdiff_t ld = stride();
  const double* Dinv = inverse_pivots(m, d) + low;
  double *const Z = w.solver.factor.x, *const G = w.matrix, *const root = kept;
  for (Index k = 0; k < dofs; ++k) root[k] = std::sqrt(Dinv[k]);
  std::fill_n(Z, ld * dofs, 0.0);
  for (Index k = 0; k < constraint_count; ++k) {
    const ActiveConstraint& a = constraint(k);
    const PropagatedRows of = rows_of(a);
    for (Index n = 0; n < a.support_count; ++n) {
      const Index dof = of.support[n] - low;
      (P::load(of.Y + row_lanes * n) * root[dof]).store(Z + ld * dof + a.first);
    }
  }
  constexpr int columns = 4;
  for (Index c = 0; c < rows; c += columns)
    for (Index r = c / row_lanes * row_lanes; r < rows; r += row_lanes) {
      P sum[columns] = {P::zero(), P::zero(), P::zero(), P::zero()};
      for (Index k = 0; k < dofs; ++k) {
        const double* const z = Z + ld * k;
        const P x = P::load(z + r);
        for (int i = 0; i < columns; ++i) sum[i] = sum[i] + x * z[c + i];
      }
      for (int i = 0; i < columns && c + i < rows; ++i) sum[i].store(G + r + ld * (c + i));
    }
  mirror(G, ld, rows);
  return true;
}

// Constraints are in row order: lanes beyond one are zero and overwritten by the next.
void Island::matrix() {
  if (has_matrix) return;
  has_matrix = true;
  if (dense_matrix()) return;
  static constexpr auto couples = std::array{couple_constraints<1>, couple_constraints<2>, couple_constraints<3>,
                                             couple_constraints<4>, couple_constraints<5>, couple_constraints<6>};
  const std::ptrdiff_t ld = stride();
  const double* Dinv = inverse_pivots(m, d);
  double* G = w.matrix;
  std::fill_n(G, ld * rows, 0.0);
  for (Index i = 0; i < constraint_count; ++i) {
    const ActiveConstraint& a = constraint(i);
    const PropagatedRows of_a = rows_of(a);
    for (Index j = i; j < constraint_count; ++j) {
      const ActiveConstraint& b = constraint(j);
      if (share_no_tree(a, b)) continue;
      double *block = G + b.first + ld * a.first, *mirrored = G + a.first + ld * b.first;
      const PropagatedRows of_b = b.kept.Y ? b.kept : propagate_anew(m, d, b, 1);
      couples[std::size_t(a.rows - 1)](a, of_a, b, of_b, Dinv, block, ld);
      for (Index col = 0; col < a.rows; ++col)
        for (Index row = 0; row < b.rows; ++row) mirrored[col + ld * row] = block[row + ld * col];
    }
  }
}

// Projects the equality right-hand side onto range(G): removes components that no impulse can produce, so impulses stay bounded.
// Example: a linkage at its limit. For a null vector n of the equality block, G n = 0 in all rows, so contacts do not change.
void Island::project_rhs_to_range() {
  const RowWork<double> work = row_work(m, d);
  const Index n = equalities;
  const double round_off = solver::tuning::round_off * n;  // of the unit diagonal, in pivots
  const std::ptrdiff_t ld = padded_rows(n);
  double *const block = work.factor, *const asked = work.vector(1), *const consistent = work.vector(2),
                *const scale = work.vector(3);
  for (Index j = 0; j < n; ++j) {
    std::copy_n(w.matrix + stride() * j, n, block + ld * j);
    block[j + ld * j] += compliance[j];
  }
  scale_rows(block, ld, n, scale, work.scaled);
  for (Index i = 0; i < n; ++i) asked[i] = (g[i] + bias[i]) * scale[i];
  ProximalResult<double> found;
  if (!consistent_part(work, work.scaled, ld, n, round_off, asked, consistent, found)) return;
  double off = 0;
  const double most = speed();
  for (Index i = 0; i < n; ++i) {
    if (scale[i] == 0) continue;
    const double change = (asked[i] - consistent[i]) / scale[i];
    off = std::max(off, std::abs(change)), g[i] -= change;
  }
  inconsistency = most > 0 ? off / most : 0;
}

// Tries the guess lambda first, then zero without sweeps, then the other exact solver. The best result counts. The first try ends
// at a residual of `enough` after half an attempt of Newton's method: finer ones cost little or very much.
void Island::solve(dynContactReport& best) {
  if (!has_room_for_matrix() || (best.iterations > 0 && left(best) <= 0)) return;
  w.limit.expect(solver::TimeLimit::Unit::Matrix, double(rows) * rows);
  if (w.time_is_up()) return;
  matrix();
  double* const asked = c;
  std::copy_n(g, equalities, asked);
  if (equalities > 0) project_rhs_to_range();
  dynContactProblem p = problem(*this);
  p.friction = friction, p.torsion = torsion, p.rolling = rolling, p.compliance = compliance;
  if (bounces) p.restitution = restitution, p.v_minus = v_minus;
  const dynContactSolverType other =
      w.options.solver == DYN_CONTACT_SOLVER_TYPE_ADMM ? DYN_CONTACT_SOLVER_TYPE_NEWTON : DYN_CONTACT_SOLVER_TYPE_ADMM;
  const struct {
    dynContactSolverType solver;
    bool warm;
    double tolerance;
  } tries[] = {{w.options.solver, true, tolerance}, {w.options.solver, false, enough}, {other, false, enough}};
  std::int32_t iterations = best.iterations, newton_steps = best.newton_steps;  // counts what was tried before
  for (const auto& t : tries) {
    matrix();
    solver::Budget b;
    b.tolerance = t.tolerance,
    b.max_iterations = std::min(w.method_iterations(), std::max<Index>(1, w.max_iterations() - iterations - newton_steps)),
    b.enough = enough, b.few = solver::tuning::start::sweep_steps / 2;
    b.warm = b.sweeps = t.warm;
    b.brief = true, b.limit = &w.limit;
    dynContactReport report{};
    solver::solve(p, solver::solvers[t.solver], w.solver, b, lambda, report);
    has_matrix = !matrix_is_shared(m);
    iterations += report.iterations, newton_steps += report.newton_steps;
    if (report.residual < best.residual) best = report, solver::unscale(p, w.solver.problem, w.solver.y, lambda);
    if (iterations + newton_steps >= w.max_iterations() || best.residual <= enough ||
        w.options.solver == DYN_CONTACT_SOLVER_TYPE_PGS || w.time_is_up())
      break;
  }
  best.iterations = iterations, best.newton_steps = newton_steps;
  std::copy_n(asked, equalities, g);
}

// Adds far_softness of the largest G of an equality that is far off to all of its rows of the same unit: rows of a stretched arm
// are small by themselves. One row alone is never out of reach.
void Island::soften_far_equalities() {
  for (Index k = 0; k < constraint_count && constraint(k).kind == RowKind::Equality; ++k) {
    const ActiveConstraint& x = constraint(k);
    if (!x.far || x.rows == 1) continue;
    double largest[2] = {};
    const auto own = [&](Index r) -> double& { return w.matrix[(stride() + 1) * (x.first + r)]; };
    for (Index r = 0; r < x.rows; ++r) largest[is_angle(x, r)] = std::max(largest[is_angle(x, r)], own(r));
    for (Index r = 0; r < x.rows; ++r) own(r) += tuning::island::far_softness * largest[is_angle(x, r)];
  }
}

// Smallest displacement that removes the error in bias, without friction. Rows are a little soft: where they are inconsistent or
// almost dependent, the displacement is a least-squares one, at most sqrt(1 / softness) / 2 times what an error moves by itself.
// far: errors are larger than what a step removes, and may stay.
void Island::solve_displacement(bool far) {
  constexpr double softness = tuning::island::correction_softness;
  w.limit.expect(solver::TimeLimit::Unit::Matrix, double(rows) * rows);
  matrix();
  if (far) soften_far_equalities();
  if (equalities == rows) {
    for (Index i = 0; i < rows; ++i) g[i] = -bias[i];
    return solve_regularised(row_work(m, d), w.matrix, stride(), rows, static_cast<const double*>(g), softness, lambda);
  }
  for (Index i = 0; i < rows; ++i) compliance[i] = softness * w.matrix[i + stride() * i];
  dynContactProblem p = problem(*this);
  p.compliance = compliance;
  solver::Budget b;
  b.tolerance = softness, b.max_iterations = w.method_iterations(), b.brief = true,
  b.limit = &w.limit;
  dynContactReport report{};
  solver::solve(p, solver::solvers[w.options.solver], w.solver, b, lambda, report);
  has_matrix = !matrix_is_shared(m);
  solver::unscale(p, w.solver.problem, w.solver.y, lambda);
}

}  // namespace dyn::simulation
