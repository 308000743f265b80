// Projected block Gauss-Seidel without a matrix, by z = Y^T lambda at the degrees of freedom:
//   c = g + Y D^-1 z        after a change of lambda: z += Y^T change
// A constraint costs as much as it has supporting dofs, however many rows the island has.
#include "algorithm/constrained/delassus.hpp"
#include "simulation/accelerated_sweeps.hpp"
#include "solver/pgs.hpp"
#include "solver/residuals.hpp"

namespace dyn::simulation {

namespace {

using namespace tuning::gauss_seidel;

// Scaled impulse; 0 where the scale holds the row at zero.
double per_scale(double lambda, double scale) { return scale > 0 ? lambda / scale : 0; }

struct MatrixFreeGaussSeidel {
  const Island& x;
  const double* Dinv;
  double* z;

  Simd<double, row_lanes> gather(const ActiveConstraint& a) const { return x.gather(a, Dinv, z); }  // G lambda, rows in lanes
  void change(const ActiveConstraint& a, const double* by) const { x.scatter(a, by, z); }
  double wanted(Index i) const { return x.g[i] + x.bias[i]; }
  double soft(Index i) const { return x.compliance[i]; }

  // One row of an equality or a box. Returns the change of its velocity.
  double row(const ActiveConstraint& a, const ConstraintBlock& s, Index r, double lower, double upper) const {
    const Index i = a.s->first + r;
    const double G = s.diagonal[r] + soft(i);
    if (!(G > 0)) return 0;
    const double c = wanted(i) + gather(a)[int(r)] + soft(i) * x.lambda[i], to = std::clamp(x.lambda[i] - c / G, lower, upper);
    double by[max_rows] = {};
    by[r] = to - x.lambda[i];
    if (by[r] == 0) return 0;
    x.lambda[i] = to;
    change(a, by);
    return std::abs(G * by[r]);
  }
  double contact(const ActiveConstraint& a, ConstraintBlock& s, double mu) const {
    const Index first = a.s->first, rows = a.s->rows, normal = normal_row(rows);
    if (rows == 1 || mu == 0) return row(a, s, normal, 0, HUGE_VAL);
    const Index* order = order_of[rows];
    const auto Gl = gather(a);
    double b[max_rows] = {}, now[max_rows] = {}, to[max_rows] = {}, by[max_rows] = {};
    for (Index i = 0; i < rows; ++i) now[i] = per_scale(x.lambda[first + order[i]], s.scale[i]);
    for (Index i = 0; i < rows; ++i) {
      const Index at = first + order[i];
      b[i] = s.scale[i] * (wanted(at) + Gl[int(order[i])] + soft(at) * x.lambda[at]);
      for (Index j = 0; j < rows; ++j) b[i] -= s.G[i + row_lanes * j] * now[j];
    }
    solver::solve_cone({0, rows, mu}, s.local, s.G[0], b, to);
    double most = 0;
    for (Index i = 0; i < rows; ++i) {
      by[order[i]] = (to[i] - now[i]) * s.scale[i];
      most = std::max(most, std::abs(by[order[i]]) * s.diagonal[order[i]]);
      x.lambda[first + order[i]] = to[i] * s.scale[i];
    }
    if (most > 0) change(a, by);
    return most;
  }
  // One sweep. Returns the largest change of a row's velocity by its own impulse.
  double operator()() const {
    double most = 0;
    for (Index k = 0, boxes = 0, contacts = 0; k < x.constraint_count; ++k) {
      const ActiveConstraint& a = x.constraint(k);
      ConstraintBlock& s = x.w.blocks[k];
      if (a.kind == RowKind::Equality)
        for (Index r = 0; r < a.s->rows; ++r) most = std::max(most, row(a, s, r, -HUGE_VAL, HUGE_VAL));
      else if (a.kind == RowKind::Box)
        most = std::max(most, row(a, s, 0, x.lower[boxes], x.upper[boxes])), ++boxes;
      else
        most = std::max(most, contact(a, s, x.friction[contacts])), ++contacts;
    }
    return most;
  }
  // One sweep without friction.
  double frictionless_sweep() const {
    double most = 0;
    for (Index k = 0, boxes = 0; k < x.constraint_count; ++k) {
      const ActiveConstraint& a = x.constraint(k);
      const ConstraintBlock& s = x.w.blocks[k];
      if (a.kind == RowKind::Equality)
        for (Index r = 0; r < a.s->rows; ++r) most = std::max(most, row(a, s, r, -HUGE_VAL, HUGE_VAL));
      else if (a.kind == RowKind::Box)
        most = std::max(most, row(a, s, 0, x.lower[boxes], x.upper[boxes])), ++boxes;
      else
        most = std::max(most, row(a, s, normal_row(a.s->rows), 0, HUGE_VAL));
    }
    return most;
  }
  // Largest |y - P_K(y - u)| as a velocity (solver/residuals.hpp). Also sets c = G lambda + g.
  double residual() const {
    double worst = 0;
    double most = 0;  // impulse, as a speed
    const auto enter = [&](double wrong, double impulse) {
      most = std::max(most, std::abs(impulse));
      if (!(wrong <= worst)) worst = wrong >= 0 ? wrong : HUGE_VAL;  // NaN counts as infinite
    };
    for (Index k = 0, boxes = 0, contacts = 0; k < x.constraint_count; ++k) {
      const ActiveConstraint& a = x.constraint(k);
      const ConstraintBlock& s = x.w.blocks[k];
      const auto Gl = gather(a);
      const Index first = a.s->first, rows = a.s->rows;
      for (Index r = 0; r < rows; ++r) x.c[first + r] = x.g[first + r] + Gl[int(r)];
      auto velocity = [&](Index r) { return wanted(first + r) + Gl[int(r)] + soft(first + r) * x.lambda[first + r]; };
      auto of_row = [&](Index r, double lower, double upper) {
        const double G = s.diagonal[r] + soft(first + r), l = x.lambda[first + r];
        if (G > 0) enter(G * std::abs(l - std::clamp(l - velocity(r) / G, lower, upper)), G * l);
      };
      if (a.kind == RowKind::Equality) {
        for (Index r = 0; r < rows; ++r) of_row(r, -HUGE_VAL, HUGE_VAL);
      } else if (a.kind == RowKind::Box) {
        of_row(0, x.lower[boxes], x.upper[boxes]), ++boxes;
      } else if (const double mu = x.friction[contacts++]; rows == 1 || mu == 0) {
        of_row(normal_row(rows), 0, HUGE_VAL);
      } else {
        const Index* order = order_of[rows];
        double across = 0, y[max_rows] = {}, c[max_rows] = {}, e[max_rows] = {};
        for (Index i = 1; i < rows; ++i) across = std::max(across, s.G[i + row_lanes * i]);
        const double dn = 1 / std::sqrt(s.G[0]), dt = across > 0 ? 1 / std::sqrt(across) : dn;
        for (Index i = 0; i < rows; ++i) {
          const double di = i ? dt : dn;
          y[i] = per_scale(x.lambda[first + order[i]], s.scale[i]) / di, c[i] = di * s.scale[i] * velocity(order[i]);
        }
        solver::natural_map({0, rows, mu * dn / dt}, y, c, e);
        for (Index i = 0; i < rows; ++i) enter(std::abs(e[i]) / (i ? dt : dn), y[i] / (i ? dt : dn));
      }
    }
    return solver::is_lost_to_round_off(most, x.fastest) ? HUGE_VAL : worst;
  }
  void start() const {
    x.clear_supporting_dofs(z);
    x.scatter_all(z);
  }
};

}  // namespace

void Island::prepare_blocks() {
  using P = Simd<double, row_lanes>;
  fastest = speed();
  const double* Dinv = inverse_pivots(m, d);
  for (Index k = 0, at = 0; k < constraint_count; ++k) {
    const ActiveConstraint& a = constraint(k);
    ConstraintBlock& s = w.blocks[k];
    const Index rows_ = a.s->rows;
    P G[max_rows];
    for (P& column : G) column = P::zero();
    const double* y = a.Y;
    for (Index n = 0; n < a.s->support_count; ++n, y += row_lanes) {
      const P e = P::load(y) * Dinv[a.support[n]];
      for (Index r = 0; r < rows_; ++r) G[r] = G[r] + e * y[r];
    }
    double block[max_rows * row_lanes];
    for (Index r = 0; r < rows_; ++r) G[r].store(block + row_lanes * r);
    for (Index r = 0; r < rows_; ++r) s.diagonal[r] = block[r + row_lanes * r];
    if (a.kind != RowKind::Contact) continue;
    const Index contact = at++;
    const double mu = friction[contact];
    if (rows_ == 1 || mu == 0) continue;
    const Index* order = order_of[rows_];
    for (Index i = 0; i < rows_; ++i) s.scale[i] = i < 3 ? 1 : (i == rows_ - 1 ? torsion[contact] : rolling[contact]) / mu;
    for (Index j = 0; j < rows_; ++j)
      for (Index i = 0; i < rows_; ++i)
        s.G[i + row_lanes * j] =
            s.scale[i] * s.scale[j] * (block[order[i] + row_lanes * order[j]] + (i == j ? compliance[a.s->first + order[i]] : 0));
  }
}

// Eigenvectors that Gauss-Seidel needs in addition.
void Island::prepare_cones() {
  if (has_cones) return;
  has_cones = true;
  for (Index k = 0, contact = 0; k < constraint_count; ++k) {
    if (constraint(k).kind != RowKind::Contact) continue;
    const double mu = friction[contact++];
    const Index rows_ = constraint(k).s->rows;
    if (rows_ == 1 || mu == 0) continue;
    ConstraintBlock& s = w.blocks[k];
    solver::Problem p;
    p.G = {s.G, row_lanes};
    s.local = solver::local_cone(p, {0, rows_, mu});
  }
}

// Largest velocity that is to change. Torsion and rolling rows count by their lengths, rows without a coefficient not at all.
double Island::speed() const {
  double most = 0;
  for (Index k = 0, contact = 0; k < constraint_count; ++k) {
    const ActiveConstraint& a = constraint(k);
    const bool touches = a.kind == RowKind::Contact;
    for (Index r = 0; r < a.s->rows; ++r) {
      const double length = r < 3 || !touches ? 1
                            : friction[contact] > 0
                                ? (r == a.s->rows - 1 ? torsion[contact] : rolling[contact]) / friction[contact]
                                : 0;
      most = std::max(most, length * std::abs(g[a.s->first + r] + bias[a.s->first + r]));
    }
    contact += touches;
  }
  return most;
}

double Island::residual() const {
  const MatrixFreeGaussSeidel sweep{*this, inverse_pivots(m, d), by_dof};
  sweep.start();
  return sweep.residual();
}

bool Island::accept_guess(dynContactReport& report) {
  if (bounces) return false;
  const MatrixFreeGaussSeidel sweep{*this, inverse_pivots(m, d), by_dof};
  const double most = speed();
  sweep.start();
  report.residual = most > 0 ? sweep.residual() / most : 0;
  for (int k = 0; k < guess_sweeps && report.residual > tolerance && report.residual < tuning::island::tolerance; ++k) {
    prepare_cones();
    sweep(), ++report.iterations;
    report.residual = sweep.residual() / most;
  }
  tolerance = wanted(report.residual, tolerance);
  return report.residual <= tolerance;
}

// Sweeps until changes are small, then until the residual meets the tolerance. At least one: cones may have turned since the
// guess.
void Island::gauss_seidel(dynContactReport& report) {
  const MatrixFreeGaussSeidel sweep{*this, inverse_pivots(m, d), by_dof};
  const double tolerated = tolerance * speed();
  w.limit.expect(solver::TimeLimit::Unit::Sweep, rows);
  sweep.start(), prepare_cones();
  for (bool last = false; !last;) {
    const double changed = sweep();
    last = ++report.iterations >= w.max_iterations() || w.time_is_up();
    if (!last && changed > tolerated) continue;
    const double left = sweep.residual();
    report.residual = left > 0 ? left / speed() : 0;
    if (left <= tolerated) break;
  }
}

void Island::gauss_seidel_and_newton(dynContactReport& report) {
  const MatrixFreeGaussSeidel sweep{*this, inverse_pivots(m, d), by_dof};
  const double most = speed();
  sweep.start();
  report.residual = most > 0 ? sweep.residual() / most : 0;
  prepare_cones();
  // Each Newton attempt gets twice as many sweeps as the last, from the second on an interior point start.
  // At least one sweep: the guess need not lie in its cones.
  Index tries = 0;
  double best = HUGE_VAL;  // residual of what is kept
  const auto may_sweep = [&] { return report.iterations == 0 || within_budget(report); };
  for (Index some = first_sweeps; (large() || some <= max_small) && report.residual > enough && may_sweep(); some *= 2) {
    w.limit.expect(solver::TimeLimit::Unit::Sweep, rows);
    for (Index k = 0; k < some && may_sweep(); ++k) sweep(), ++report.iterations;
    report.residual = sweep.residual() / most;
    if (report.residual <= enough || newton(report, ++tries >= 2)) break;
    if (report.residual < best) best = report.residual, std::copy_n(lambda, rows, kept);
    sweep.start();
  }
  if (report.residual > best) report.residual = best, std::copy_n(kept, rows, lambda);
}

void Island::gauss_seidel_while_improving(dynContactReport& report) {
  const MatrixFreeGaussSeidel sweep{*this, inverse_pivots(m, d), by_dof};
  const double most = speed();
  prepare_cones();
  std::copy_n(lambda, rows, kept);
  w.limit.expect(solver::TimeLimit::Unit::Sweep, solver::tuning::sweeps_a_check * rows);
  for (Index worse = 0, k = 0;
       worse < max_stalls && k < w.method_iterations() / 2 && report.residual > tolerance && !w.time_is_up(); ++k) {
    sweep.start();
    for (int i = 0; i < solver::tuning::sweeps_a_check; ++i) sweep();
    report.iterations += solver::tuning::sweeps_a_check;
    const double now = sweep.residual() / most;
    worse = now < tuning::progress * report.residual ? 0 : worse + 1;
    if (now < report.residual) report.residual = now, std::copy_n(lambda, rows, kept);
  }
  std::copy_n(kept, rows, lambda);
}

// Approximate frictionless solution for position corrections; later steps correct the rest. Needs by_dof = 0.
void Island::gauss_seidel_frictionless() {
  const double least =
      std::max(correction_change, uses_gauss_seidel_only() ? tolerance : 0);  // of the largest change in the first sweep
  std::fill_n(lambda, rows, 0.0);
  if (!uses_gauss_seidel_only() && has_runs()) {
    build_rows();
    AcceleratedSweeps(*this).frictionless(correction_sweeps, least);
    return scatter_all(by_dof);
  }
  const MatrixFreeGaussSeidel sweep{*this, inverse_pivots(m, d), by_dof};
  const double first = sweep.frictionless_sweep();
  for (int k = 1; k < correction_sweeps && sweep.frictionless_sweep() > least * first; ++k) {}
}

}  // namespace dyn::simulation
