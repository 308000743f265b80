#include "solver/interior.hpp"

#include "solver/interior_point.hpp"

namespace dyn::solver {

namespace {

using namespace tuning::interior;

class Interior {
 public:
  Interior(Workspace& w, Budget& b)
      : w(w),
        p(w.problem),
        b(b),
        path{*this, p.n, w.x, w.u, w.r, w.step_c, w.t, w.z, w.s, w.newton, w.newton_c} {}
  bool run(double factor);

  // of the operator
  static constexpr bool inverse_laws = true;
  static constexpr double compliance = tuning::round_off, edge = 0;
  template <class F>
  void for_each(F&& f) const {
    for (Index k = 0; k < p.blocks; ++k) f(p.block[k], k);
  }
  LawMatrix& law(Index k) const { return w.laws[k]; }
  double correction(Index) const { return 0; }
  bool factorize(bool symmetric);
  void solve(const double* r, double* a, double* G_a) const;

 private:
  Workspace& w;
  const Problem& p;
  Budget& b;
  InteriorPoint<Interior> path;

  double stopping_impulse();
};

// G + K^-1
bool Interior::factorize(bool) {
  w.factor.ld = p.G.ld;
  std::copy_n(p.G.x, std::ptrdiff_t(p.G.ld) * p.n, w.factor.x);
  for_each([&](const Block& s, Index k) {
    for (Index j = 0; j < s.rows; ++j)
      for (Index i = 0; i < s.rows; ++i) w.factor(s.first + i, s.first + j) += w.laws[k][i][j];
  });
  ++b.factorizations;
  return lu(w.factor, p.n, w.pivots);
}

void Interior::solve(const double* r, double* a, double* G_a) const {
  std::copy_n(r, p.n, a);
  lu_solve(w.factor, p.n, w.pivots, a);
  times(p.G, a, nullptr, G_a, p.n);
}

// Solves (G + regularisation) y = -g. Returns the size of y, infinite if singular.
double Interior::stopping_impulse() {
  double* const y = w.x;
  w.factor.ld = p.G.ld;
  std::copy_n(p.G.x, std::ptrdiff_t(p.G.ld) * p.n, w.factor.x);
  for (Index i = 0; i < p.n; ++i) w.factor(i, i) += regularisation, y[i] = -p.g[i];
  ++b.factorizations;
  if (!cholesky(w.factor, p.n)) return HUGE_VAL;
  cholesky_solve(w.factor, p.n, y);
  double impulse = 0;
  for (Index i = 0; i < p.n; ++i) impulse = std::max(impulse, std::fabs(y[i]));
  return impulse;
}

// From impulses that stop all motion, on the cones' axes. Where redundant rows contradict one another these have no bound: their
// geometric mean with impulses of the size of the speed is taken.
bool Interior::run(double factor) {
  double speed = 0, impulse = stopping_impulse(), tried = HUGE_VAL;
  for (Index i = 0; i < p.n; ++i) speed = std::max(speed, std::fabs(p.g[i]));
  if (regularisation * impulse > tuning::accept::max_residual * speed) impulse = std::sqrt(impulse * speed);
  if (!std::isfinite(impulse)) return false;
  std::fill_n(path.y, p.n, 0.0), std::fill_n(path.c, p.n, 0.0);
  path.start_inside(factor * std::max(impulse, speed), speed);
  for (Index k = 0; k < max_steps && !b.spent(); ++k) {
    ++b.iterations;
    times(p.G, path.y, p.g, path.c, p.n);
    const bool stuck = !path.step();
    project(p, path.y, w.trial);
    times(p.G, w.trial, p.g, w.trial_c, p.n);
    if (keep_best(w, b, w.trial, w.trial_c)) return true;
    if (stuck) return false;
    const double error = residual(p, w.trial, w.trial_c).residual;
    if (!(error < newton_error * p.speed && error < newton_reduction * tried)) continue;
    tried = error;
    if (alart_curnier(w, b, w.trial, w.trial_c)) return true;
  }
  return false;
}

}  // namespace

bool interior(Workspace& w, Budget& b, double factor) { return Interior(w, b).run(factor); }

}  // namespace dyn::solver
