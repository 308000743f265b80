#include "solver/multipliers.hpp"

namespace dyn::solver {

namespace {

using namespace tuning::multipliers;

// H += rho (I - P_K'(r)) of one cone: on its surface P' = a (1, mu u)(1, mu u)' + across (I - u u')
void add_curvature(const Block& s, const double* r, double rho, const Matrix& H) {
  const Index n = s.first, m = s.rows - 1;
  double u[5];
  const double t = norm(r + n + 1, m), mu = s.mu;
  if (t <= mu * r[n]) return;
  if (r[n] <= -mu * t) {
    for (Index i = 0; i <= m; ++i) H(n + i, n + i) += rho;
    return;
  }
  for (Index i = 0; i < m; ++i) u[i] = r[n + 1 + i] / t;
  const double a = 1 / (1 + mu * mu), across = mu * a * (r[n] + mu * t) / t;
  H(n, n) += rho * (1 - a);
  for (Index i = 0; i < m; ++i) {
    H(n + 1 + i, n) -= rho * a * mu * u[i], H(n, n + 1 + i) -= rho * a * mu * u[i];
    for (Index j = 0; j < m; ++j)
      H(n + 1 + i, n + 1 + j) += rho * ((i == j) * (1 - across) - (a * mu * mu - across) * u[i] * u[j]);
  }
}

}  // namespace

Multipliers::Multipliers(Workspace& w_, Budget& b_)
    : y(w_.v), w(w_), b(b_), p(w_.problem), x(w_.x), z(w_.z), s(w_.s), r(w_.r), y_before(w_.u) {
  std::copy_n(w.y, p.n, x), std::copy_n(w.y, p.n, y);
  // z: the part of the corrected velocity that is in K* and orthogonal to y
  std::copy_n(w.c, p.n, z);
  correct();
  for (Index i = 0; i < p.n; ++i) r[i] = y[i] - (w.c[i] + s[i]) / rho;
  project(p, r, z);
  for (Index i = 0; i < p.n; ++i) z[i] = rho * (z[i] - r[i]);
}

void Multipliers::correct() {
  std::fill_n(s, p.n, 0.0);
  p.for_each([&](const Block& b) {
    if (b.is_cone()) s[b.first] = de_saxce(b.mu, b.rows, z + b.first);
  });
}

bool Multipliers::admm_step() {
  const Index n = p.n;
  const double alpha = b.relaxation > 0 ? b.relaxation : relaxation;
  if (factor_rho != rho) {
    w.factor.ld = p.G.ld;
    std::copy_n(p.G.x, std::ptrdiff_t(p.G.ld) * n, w.factor.x);
    for (Index i = 0; i < n; ++i) w.factor(i, i) += rho;
    ++b.factorizations;
    if (!cholesky(w.factor, n)) return false;
    factor_rho = rho;
  }
  ++b.iterations;
  correct();
  for (Index i = 0; i < n; ++i) x[i] = rho * y[i] + z[i] - p.g[i] - s[i];
  cholesky_solve(w.factor, n, x);
  for (Index i = 0; i < n; ++i) r[i] = alpha * x[i] + (1 - alpha) * y[i] - z[i] / rho;
  std::swap(y, y_before);
  project(p, r, y);
  double primal = 0, dual = 0;
  for (Index i = 0; i < n; ++i) {
    z[i] = rho * (y[i] - r[i]);
    primal = std::max(primal, std::fabs(x[i] - y[i]) * p.per_unit[i]);
    dual = std::max(dual, rho * std::fabs(y[i] - y_before[i]) * p.per_unit[i]);
  }
  error = std::max(primal, dual);
  if (++changed >= balance_interval) balance(primal, dual);
  return true;
}

// Sets the penalty that would make both relative errors equal (OSQP: Stellato et al. 2020).
void Multipliers::balance(double primal, double dual) {
  double force = 0, speed = p.speed;
  for (Index i = 0; i < p.n; ++i)
    force = std::max(force, std::fabs(y[i]) * p.per_unit[i]), speed = std::max(speed, std::fabs(z[i]) * p.per_unit[i]);
  const double ratio = std::sqrt(primal / force / (dual / speed));
  if (!(ratio > balance_ratio || ratio < 1 / balance_ratio)) return;
  rho = std::min(rho * std::min(std::max(ratio, 1 / max_rho_factor), max_rho_factor), 1 / tuning::round_off);  // G counts
  changed = 0;
}

// Returns L(x, y(x), z). Sets y(x) in y, z+ in w.t and the gradient in w.newton; c = G x + g.
double Multipliers::lagrangian(const double* at, const double* c) {
  double value = 0;
  for (Index i = 0; i < p.n; ++i) r[i] = at[i] - z[i] / joint_rho;
  project(p, r, y);
  for (Index i = 0; i < p.n; ++i) {
    w.t[i] = joint_rho * (y[i] - r[i]);
    value += 0.5 * at[i] * (c[i] + p.g[i]) + at[i] * s[i] + 0.5 / joint_rho * w.t[i] * w.t[i];
    w.newton[i] = c[i] + s[i] - w.t[i];
  }
  return value;
}

bool Multipliers::hessian(double damping) {
  w.factor.ld = p.G.ld, factor_rho = 0;
  std::copy_n(p.G.x, std::ptrdiff_t(p.G.ld) * p.n, w.factor.x);
  for (Index i = 0; i < p.n; ++i) w.factor(i, i) += damping;
  p.for_each([&](const Block& s) {
    if (s.is_cone()) add_curvature(s, r, joint_rho, w.factor);
    else if (y[s.first] != r[s.first]) w.factor(s.first, s.first) += joint_rho;
  });
  ++b.factorizations;
  return cholesky(w.factor, p.n);
}

bool Multipliers::augmented_lagrangian_step(Index max_steps) {
  const Index n = p.n;
  double* c = w.newton_c;
  const auto size = [&](const double* e) {
    double worst = 0;
    for (Index i = 0; i < n; ++i) worst = std::max(worst, std::fabs(e[i]) * p.per_unit[i]);
    return worst;
  };
  times(p.G, x, p.g, c, n);
  correct();
  double value = lagrangian(x, c), gradient = size(w.newton);
  const double enough = std::max(subproblem_tolerance * b.tolerance, subproblem_reduction * std::min(primal_before, p.speed));
  for (Index k = 0; k < max_steps && gradient > enough && !b.spent(); ++k) {
    ++b.iterations;
    // Levenberg-Marquardt: steps are unique for redundant contacts
    if (!hessian(std::min(max_damping, std::max(tuning::proximal, damping_by_gradient * gradient / p.speed)))) return false;
    for (Index i = 0; i < n; ++i) w.step[i] = -w.newton[i];
    cholesky_solve(w.factor, n, w.step);
    times(p.G, w.step, nullptr, w.step_c, n);
    double next = value;
    for (double t = 1; t > min_step; t /= 2) {
      for (Index i = 0; i < n; ++i) w.trial[i] = x[i] + t * w.step[i], w.trial_c[i] = c[i] + t * w.step_c[i];
      next = lagrangian(w.trial, w.trial_c);
      if (next <= value + tuning::round_off * std::fabs(value)) break;
    }
    std::copy_n(w.trial, n, x), std::copy_n(w.trial_c, n, c);
    value = next, gradient = size(w.newton);
  }
  std::copy_n(w.t, n, z);
  double primal = 0;
  for (Index i = 0; i < n; ++i) primal = std::max(primal, std::fabs(x[i] - y[i]) * p.per_unit[i]);
  if (primal > slow_primal * primal_before)  // up to where round-off dominates
    joint_rho =
        std::min(penalty_growth * joint_rho, std::max(1.0, subproblem_tolerance * b.tolerance / (tuning::epsilon * size(y))));
  primal_before = primal;
  error = std::max(primal, gradient);
  return true;
}

}  // namespace dyn::solver
