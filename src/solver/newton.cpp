#include "dyn/solver/newton.hpp"

namespace dyn::solver {

namespace {

constexpr double eta = 1e-10, first_rho = 1, growth = 10, most_rho = 1e8;

// H += rho (I - P_K'(r)) of one cone.
void add_curvature(const Cone& cone, const double* r, double rho, const Matrix& H) {
  const Index n = cone.row, m = cone.size - 1;
  double u[5];
  const double t = norm(r + n + 1, m), mu = cone.mu;
  if (t <= mu * r[n]) return;
  if (r[n] <= -mu * t) {
    for (Index i = 0; i <= m; ++i) H(n + i, n + i) += rho;
    return;
  }
  for (Index i = 0; i < m; ++i) u[i] = r[n + 1 + i] / t;
  const double a = 1 / (1 + mu * mu), across = mu * a * (r[n] + mu * t) / t;  // P' = a (1, mu u)(1, mu u)' + across (I - u u')
  H(n, n) += rho * (1 - a);
  for (Index i = 0; i < m; ++i) {
    H(n + 1 + i, n) -= rho * a * mu * u[i], H(n, n + 1 + i) -= rho * a * mu * u[i];
    for (Index j = 0; j < m; ++j) H(n + 1 + i, n + 1 + j) += rho * ((i == j) * (1 - across) - (a * mu * mu - across) * u[i] * u[j]);
  }
}

struct Lagrangian {
  Workspace& w;
  const Problem& p;
  double rho;
  double *r, *y, *plus;  // x - z / rho, its projection, z+

  // L and, in w.newton, its gradient; c = G x + g
  double operator()(const double* x, const double* c) {
    double value = 0;
    for (Index i = 0; i < p.n; ++i) r[i] = x[i] - w.z[i] / rho;
    project(p, r, y);
    for (Index i = 0; i < p.n; ++i) {
      plus[i] = rho * (y[i] - r[i]);
      value += 0.5 * x[i] * (c[i] + p.g[i]) + x[i] * w.s[i] + 0.5 / rho * plus[i] * plus[i];
      w.newton[i] = c[i] + w.s[i] - plus[i];
    }
    return value;
  }
};

void correction(const Problem& p, const double* z, double* s) {
  std::fill_n(s, p.n, 0.0);
  for (Index k = 0; k < p.cones; ++k) s[p.cone[k].row] = de_saxce(p.cone[k].mu, p.cone[k].size, z + p.cone[k].row);
}

double largest(const Problem& p, const double* e) {
  double worst = 0;
  for (Index i = 0; i < p.n; ++i) worst = std::max(worst, std::fabs(e[i]) / p.unit[i]);
  return worst;
}

}  // namespace

void newton(Workspace& w, Budget& b) {
  const Problem& p = w.problem;
  const Index n = p.n;
  if (b.newton && b.warm && alart_curnier(w, b, w.y, w.c, 4)) return;
  double *x = w.x, *c = w.v, *y = w.u;
  Lagrangian L{w, p, first_rho, w.r, y, w.t};
  std::copy_n(w.y, n, x), std::copy_n(w.c, n, c);
  correction(p, c, w.s);
  for (Index i = 0; i < n; ++i) w.r[i] = x[i] - (c[i] + w.s[i]) / L.rho;
  project(p, w.r, w.z);
  for (Index i = 0; i < n; ++i) w.z[i] = L.rho * (w.z[i] - w.r[i]);
  double before = HUGE_VAL;
  while (!b.spent()) {
    correction(p, w.z, w.s);
    double value = L(x, c), gradient = largest(p, w.newton);
    for (Index k = 0; k < 20 && !b.spent(); ++k) {
      ++b.iterations, ++b.factorizations;
      w.factor.ld = p.G.ld;
      std::copy_n(p.G.x, std::ptrdiff_t(p.G.ld) * n, w.factor.x);
      for (Index i = 0; i < n; ++i) w.factor(i, i) += eta;
      for (Index i = 0; i < p.boxes; ++i)
        if (y[i] != w.r[i]) w.factor(i, i) += L.rho;
      for (Index i = 0; i < p.cones; ++i) add_curvature(p.cone[i], w.r, L.rho, w.factor);
      for (Index i = 0; i < n; ++i) w.step[i] = -w.newton[i];
      const double* g = w.newton;
      if (!cholesky(w.factor, n)) return;
      cholesky_solve(w.factor, n, w.step);
      times(p.G, w.step, nullptr, w.step_c, n);
      const double slope = dot(g, w.step, n);
      double t = 1, next = value;
      for (; t > 1e-6; t /= 2) {
        for (Index i = 0; i < n; ++i) w.trial[i] = x[i] + t * w.step[i], w.trial_c[i] = c[i] + t * w.step_c[i];
        next = L(w.trial, w.trial_c);
        if (next <= value + 1e-4 * t * slope + 1e-15 * std::fabs(value)) break;
      }
      std::swap_ranges(x, x + n, w.trial), std::swap_ranges(c, c + n, w.trial_c);
      value = next, gradient = largest(p, w.newton);
      if (gradient <= std::max(0.1 * b.tolerance, 1e-2 * std::min(before, p.speed))) break;
    }
    std::copy_n(w.t, n, w.z);
    double primal = 0;
    for (Index i = 0; i < n; ++i) primal = std::max(primal, std::fabs(x[i] - y[i]) / p.unit[i]);
    std::copy_n(y, n, w.s);
    times(p.G, w.s, p.g, w.newton_c, n);
    if (keep_best(w, b, w.s, w.newton_c)) return;
    if (b.newton && alart_curnier(w, b, w.s, w.newton_c, 4)) return;
    if (primal > 0.1 * before) L.rho = std::min(L.rho * growth, most_rho);
    before = primal;
  }
}

}  // namespace dyn::solver
