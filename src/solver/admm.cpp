#include "dyn/solver/admm.hpp"

namespace dyn::solver {

namespace {

constexpr double eta = 1e-6, first_rho = 0.1, relaxation = 1.6;

void correction(const Problem& p, const double* z, double* s) {
  std::fill_n(s, p.n, 0.0);
  for (Index k = 0; k < p.cones; ++k) s[p.cone[k].row] = de_saxce(p.cone[k].mu, p.cone[k].size, z + p.cone[k].row);
}

bool factorize(Workspace& w, Budget& b, double rho) {
  const Problem& p = w.problem;
  w.factor.ld = p.G.ld;
  std::copy_n(p.G.x, std::ptrdiff_t(p.G.ld) * p.n, w.factor.x);
  for (Index i = 0; i < p.n; ++i) w.factor(i, i) += eta + rho;
  ++b.factorizations;
  return cholesky(w.factor, p.n);
}

}  // namespace

void admm(Workspace& w, Budget& b) {
  const Problem& p = w.problem;
  const Index n = p.n;
  const double alpha = b.relaxation > 0 ? b.relaxation : relaxation;
  double *x = w.x, *y = w.v, *z = w.z, *s = w.s, *r = w.r, *y_before = w.u, rho = first_rho;
  if (b.newton && b.warm && alart_curnier(w, b, w.y, w.c, 4)) return;
  std::copy_n(w.y, n, x), std::copy_n(w.y, n, y);
  // the dual variable of the start: its corrected velocity, as far as it is in K* and orthogonal to y
  correction(p, w.c, s);
  for (Index i = 0; i < n; ++i) r[i] = y[i] - (w.c[i] + s[i]) / rho;
  project(p, r, z);
  for (Index i = 0; i < n; ++i) z[i] = rho * (z[i] - r[i]);
  if (!factorize(w, b, rho)) return;

  double tried = HUGE_VAL;  // error at which Newton's method was last tried
  Index changed = 0;        // iteration of rho's last change
  while (!b.spent()) {
    ++b.iterations;
    correction(p, z, s);
    for (Index i = 0; i < n; ++i) x[i] = eta * x[i] + rho * y[i] + z[i] - p.g[i] - s[i];
    cholesky_solve(w.factor, n, x);
    for (Index i = 0; i < n; ++i) r[i] = alpha * x[i] + (1 - alpha) * y[i] - z[i] / rho;
    std::swap(y, y_before);
    project(p, r, y);
    double primal = 0, dual = 0;
    for (Index i = 0; i < n; ++i) {
      z[i] = rho * (y[i] - r[i]);
      primal = std::max(primal, std::fabs(x[i] - y[i]) / p.unit[i]);
      dual = std::max(dual, rho * std::fabs(y[i] - y_before[i]) / p.unit[i]);
    }
    const double error = std::max(primal, dual);
    if (error <= b.tolerance || (b.newton && error < 0.3 * tried) || b.iterations % 10 == 0) {
      times(p.G, y, p.g, w.newton_c, n);
      if (keep_best(w, b, y, w.newton_c)) return;
      if (b.newton) {
        tried = error;
        if (alart_curnier(w, b, y, w.newton_c, 4)) return;
      }
    }
    // the penalty that would have made both errors equal
    if (b.iterations >= changed + 5) {
      const double ratio = std::sqrt(primal / dual);
      if (ratio > 3 || ratio < 1 / 3.0) {
        rho = std::min(std::max(rho * std::min(std::max(ratio, 0.03), 30.0), 1e-6), 1e6);
        changed = b.iterations;
        if (!factorize(w, b, rho)) return;
      }
    }
  }
}

}  // namespace dyn::solver
