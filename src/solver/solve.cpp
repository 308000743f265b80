#include "dyn/solver/list.hpp"

namespace dyn::solver {

namespace {

// From w.y, with restitution by a factor.
void run(const dynContactProblem& x, Solver solver, Workspace& w, Budget& b, double factor, dynContactReport& out) {
  Problem& p = w.problem;
  for (Index i = 0; i < p.n; ++i) p.g[i] = w.free_g[i] + factor * p.approach[i];
  // the largest velocity without impulses, or with those that boxes force
  for (Index i = 0; i < p.n; ++i) w.x[i] = 0;
  project(p, w.x, w.x);
  times(p.G, w.x, p.g, w.c, p.n);
  p.speed = 0;
  for (Index i = 0; i < p.n; ++i) p.speed = std::max(p.speed, std::fabs(w.c[i]) / p.unit[i]);
  const double tolerance = b.tolerance;
  b.tolerance *= p.speed, b.best = HUGE_VAL, b.status = DYN_CONTACT_MAX_ITERATIONS;
  std::copy_n(w.y, p.n, w.x);
  times(p.G, w.x, p.g, w.v, p.n);
  if (!keep_best(w, b, w.x, w.v)) solver(w, b);
  b.tolerance = tolerance;
  report(x, p, w.y, w.c, out);
}

}  // namespace

void solve(const dynContactProblem& x, Solver solver, Workspace& w, Budget& b, double* lambda, dynContactReport& out) {
  Problem& p = w.problem;
  scale(x, p);
  std::copy_n(p.g, p.n, w.free_g);
  if (b.warm)
    scale_guess(p, lambda, w.y);
  else {
    std::fill_n(w.y, p.n, 0.0);
    project(p, w.y, w.y);
  }
  double factor = 1;
  run(x, solver, w, b, factor, out);
  out.restitution_scale = factor;
  out.status = b.status, out.iterations = b.iterations, out.newton_steps = b.newton_steps, out.factorizations = b.factorizations;
  unscale(x, p, w.y, lambda);
}

}  // namespace dyn::solver
