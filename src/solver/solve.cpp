#include "solver/list.hpp"

namespace dyn::solver {

namespace {

using namespace tuning::accept;

struct Attempt {
  const dynContactProblem& x;
  Solver solver;
  Workspace& w;
  Budget& b;
  dynContactReport& out;

  double free_speed();
  void operator()(double restitution);
  // Returns whether the impulses gain energy beyond the tolerance, or no impulses reach such velocities.
  bool is_refused() const {
    double size = 0, sum = 0;
    for (Index i = 0; i < w.problem.n; ++i) size += std::fabs(w.y[i] * w.free_g[i]), sum += std::fabs(w.y[i]);
    const double round_off = tuning::epsilon * sum * sum;  // of y'Gy: unbounded impulses jam
    return out.energy + round_off > (energy + energy_by_tolerance * b.tolerance) * size || out.residual > max_residual;
  }
};

// Largest velocity with no impulses but those that boxes force.
double Attempt::free_speed() {
  const Problem& p = w.problem;
  std::fill_n(w.x, p.n, 0.0);
  project(p, w.x, w.x);
  times(p.G, w.x, p.g, w.v, p.n);
  double speed = 0;
  for (Index i = 0; i < p.n; ++i) speed = std::max(speed, std::fabs(w.v[i]) * p.per_unit[i]);
  return speed;
}

// Solves from w.y with restitution scaled by a factor.
void Attempt::operator()(double restitution) {
  Problem& p = w.problem;
  for (Index i = 0; i < p.n; ++i) p.g[i] = w.free_g[i] + restitution * p.approach[i];
  p.speed = free_speed();
  const double tolerance = b.tolerance, enough = b.enough;
  b.tolerance *= p.speed, b.enough *= p.speed, b.best = HUGE_VAL, b.status = DYN_CONTACT_STATUS_STALLED;
  const auto keep = [&] {
    times(p.G, w.x, p.g, w.v, p.n);
    return keep_best(w, b, w.x, w.v);
  };
  const auto keep_none = [&] {
    std::fill_n(w.x, p.n, 0.0);
    project(p, w.x, w.x);
    return keep();
  };
  std::copy_n(w.y, p.n, w.x);
  bool solved = p.speed > 0 && keep();
  // nothing moves, or the guess is far off
  if (!solved && !(tuning::start::close_guess * b.best < p.speed)) solved = keep_none();
  if (!solved) {
    if (b.best == HUGE_VAL) std::copy_n(w.x, p.n, w.y), std::copy_n(w.v, p.n, w.c);  // too large to be the best: yet the start
    solver(w, b);
  }
  b.tolerance = tolerance, b.enough = enough;
  if (b.brief && !p.bounces)
    out.residual = b.best > 0 ? b.best / p.speed : 0;
  else
    report(x, p, w.y, w.c, out);
  out.restitution_scale = restitution;
}

}  // namespace

void solve(const dynContactProblem& x, Solver solver, Workspace& w, Budget& b, const double* lambda, dynContactReport& out) {
  Problem& p = w.problem;
  scale(x, p);
  std::copy_n(p.g, p.n, w.free_g);
  if (b.warm)
    scale_guess(p, lambda, w.y);
  else {
    std::fill_n(w.y, p.n, 0.0);
    project(p, w.y, w.y);
  }
  Attempt run{x, solver, w, b, out};
  Tries tries{b.max_iterations};
  if (p.bounces) b.max_iterations = tries.next();
  run(1);
  Index iterations = b.iterations, newton_steps = b.newton_steps;
  tries.left -= iterations + newton_steps;
  const auto again = [&](double factor) {
    b.iterations = b.newton_steps = 0, b.max_iterations = tries.next();
    std::fill_n(w.y, p.n, 0.0);
    project(p, w.y, w.y);
    run(factor);
    iterations += b.iterations, newton_steps += b.newton_steps;
    tries.left -= b.iterations + b.newton_steps;
  };
  const auto late = [&] { return b.status == DYN_CONTACT_STATUS_TIME_BUDGET; };  // out of time: use what there is
  if (p.bounces && run.is_refused() && !late()) {
    b.warm = false;
    double low = 0, high = 1;
    while (high - low > restitution_step && tries.left > 1 && !late()) {
      const double factor = 0.5 * (low + high);
      again(factor);
      (run.is_refused() ? high : low) = factor;
    }
    if (!late()) again(low);
  }
  b.iterations = iterations, b.newton_steps = newton_steps;
  out.status = b.status, out.iterations = b.iterations, out.newton_steps = b.newton_steps, out.factorizations = b.factorizations;
}

void evaluate(const dynContactProblem& x, Workspace& w, const double* lambda, dynContactReport& out) {
  Problem& p = w.problem;
  scale(x, p);
  Budget b;
  Attempt run{x, nullptr, w, b, out};
  for (Index i = 0; i < p.n; ++i) p.g[i] += p.approach[i], w.y[i] = lambda[p.source[i]] / p.d[i];
  p.speed = run.free_speed();
  exact_velocity(p, w.y, w.c);
  report(x, p, w.y, w.c, out);
  // rows without a coefficient should be zero
  const Index rows = Index(row_count(x));
  std::copy_n(lambda, rows, w.x);
  for (Index i = 0; i < p.n; ++i) w.x[p.source[i]] = 0;
  for (Index i = 0; i < rows; ++i) out.primal = std::max(out.primal, std::fabs(w.x[i]));
  out.restitution_scale = 1;
}

}  // namespace dyn::solver
