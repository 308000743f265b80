#include "solver/smoothing.hpp"

#include "solver/alart_curnier.hpp"

namespace dyn::solver {

namespace {

using namespace tuning::smoothing;

// Its unknowns y and velocities c are in units in which cones are their own duals, |t| <= n, and blocks have a mean diagonal of 1.
class Smoothing {
 public:
  Smoothing(Workspace& w, Budget& b) : w(w), p(w.problem), b(b) {}
  bool run();

 private:
  Workspace& w;
  const Problem& p;
  Budget& b;
  const Index n = p.n;
  Matrix &G = w.factor, &A = w.active;
  double *const unit = w.step, *const g = w.step_c, *y = w.x, *c = w.v, *map = w.r, *next = w.z, *next_c = w.u, *next_map = w.s,
         *const dy = w.t;
  double eps = 0, tried = HUGE_VAL;

  void set_units();
  double error(const double* y, const double* c, double* map) const;
  void fill_matrix();
  bool step(double& error, double& part);
  bool accept();
};

double plus(double z, double eps) { return (z + std::sqrt(z * z + 4 * eps * eps)) / 2; }
double slope(double z, double eps) { return (1 + z / std::sqrt(z * z + 4 * eps * eps)) / 2; }

// The smoothed projection onto [lower, upper] and its derivative.
struct Bounded {
  double value, slope;
};
Bounded bounded(const Block& s, double z, double eps) {
  Bounded out{z, 1};
  if (!std::isinf(s.lower)) out = {s.lower + plus(z - s.lower, eps), solver::slope(z - s.lower, eps)};
  if (!std::isinf(s.upper)) out.value -= plus(z - s.upper, eps), out.slope -= solver::slope(z - s.upper, eps);
  return out;
}

// The smoothed projection of z = (n, t) onto the cone: (normal, along t / |t|), and its derivatives.
struct Projected {
  double direction[Block::max_rows - 1];
  double normal, along, own, mixed, across;  // d normal / d n = d along / d |t|; d normal / d |t|; along / |t|
};
Projected projected(const double* z, Index rows, double eps) {
  Projected out;
  const double length = norm(z + 1, rows - 1);
  for (Index i = 1; i < rows; ++i) out.direction[i - 1] = length > 0 ? z[i] / length : i == 1;
  const double low = z[0] - length, high = z[0] + length, a = plus(low, eps), b = plus(high, eps);
  const double low_slope = slope(low, eps), high_slope = slope(high, eps);
  out.normal = (a + b) / 2, out.along = (b - a) / 2;
  out.own = (high_slope + low_slope) / 2, out.mixed = (high_slope - low_slope) / 2;
  out.across = length > tuning::epsilon * high ? out.along / length : out.own;
  return out;
}

void Smoothing::set_units() {
  p.for_each([&](const Block& s) {
    double trace = 0;
    for (Index i = s.first; i < s.first + s.rows; ++i) {
      unit[i] = s.is_cone() && i == s.first ? 1 / s.mu : 1;
      trace += p.G(i, i) * unit[i] * unit[i];
    }
    const double scale = s.is_cone() ? std::sqrt(s.rows / trace) : 1;
    for (Index i = s.first; i < s.first + s.rows; ++i) unit[i] *= scale;
  });
  G.ld = padded(n);
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) G(i, j) = unit[i] * p.G(i, j) * unit[j];
    g[j] = unit[j] * p.g[j], eps = std::max(eps, std::fabs(g[j]));
  }
}

// Fills the map. Returns its norm.
double Smoothing::error(const double* y, const double* c, double* map) const {
  double sum = 0;
  p.for_each([&](const Block& s) {
    const Index f = s.first;
    if (!s.is_cone()) {
      for (Index i = f; i < f + s.rows; ++i) map[i] = y[i] - bounded(s, y[i] - rho * c[i], eps).value;
    } else {
      double z[Block::max_rows];
      const double slip = norm(c + f + 1, s.rows - 1);
      z[0] = y[f] - rho * (c[f] + std::sqrt(slip * slip + eps * eps));
      for (Index i = 1; i < s.rows; ++i) z[i] = y[f + i] - rho * c[f + i];
      const Projected out = projected(z, s.rows, eps);
      map[f] = y[f] - out.normal;
      for (Index i = 1; i < s.rows; ++i) map[f + i] = y[f + i] - out.along * out.direction[i - 1];
    }
    for (Index i = f; i < f + s.rows; ++i) sum += map[i] * map[i];
  });
  return std::sqrt(sum);
}

// A = d map / dy + damping
void Smoothing::fill_matrix() {
  A.ld = padded(n);
  p.for_each([&](const Block& s) {
    const Index f = s.first, rows = s.rows;
    if (!s.is_cone()) {
      for (Index i = f; i < f + rows; ++i) {
        const double own = bounded(s, y[i] - rho * c[i], eps).slope;
        for (Index j = 0; j < n; ++j) A(i, j) = own * rho * G(i, j);
        A(i, i) += 1 - own + damping;
      }
      return;
    }
    double z[Block::max_rows], slip[Block::max_rows - 1];  // slip: the smoothed direction of c_t
    const double length = norm(c + f + 1, rows - 1), smoothed = std::sqrt(length * length + eps * eps);
    z[0] = y[f] - rho * (c[f] + smoothed);
    for (Index i = 1; i < rows; ++i) z[i] = y[f + i] - rho * c[f + i], slip[i - 1] = c[f + i] / smoothed;
    const Projected out = projected(z, rows, eps);
    for (Index j = 0; j < n; ++j) {
      double dz[Block::max_rows], along = 0;
      dz[0] = G(f, j);
      for (Index i = 1; i < rows; ++i) dz[i] = G(f + i, j), dz[0] += slip[i - 1] * dz[i];
      for (Index i = 0; i < rows; ++i) dz[i] = (j == f + i) - rho * dz[i];
      for (Index i = 1; i < rows; ++i) along += out.direction[i - 1] * dz[i];
      A(f, j) = -(out.own * dz[0] + out.mixed * along);
      for (Index i = 1; i < rows; ++i)
        A(f + i, j) = -(out.across * dz[i] + (out.mixed * dz[0] + (out.own - out.across) * along) * out.direction[i - 1]);
    }
    for (Index i = f; i < f + rows; ++i) A(i, i) += 1 + damping;
  });
}

// A Newton step with line search. Returns false if there is none.
bool Smoothing::step(double& size, double& part) {
  fill_matrix();
  ++b.newton_steps, ++b.factorizations;
  if (!lu(A, n, w.pivots)) return false;
  for (Index i = 0; i < n; ++i) dy[i] = -map[i];
  lu_solve(A, n, w.pivots, dy);
  part = 1;
  for (int k = 0;; ++k, part /= 2) {
    for (Index i = 0; i < n; ++i) next[i] = y[i] + part * dy[i];
    times(G, next, g, next_c, n);
    const double found = error(next, next_c, next_map);
    if (k < halvings && !(found <= (1 - decrease * part) * size)) continue;
    if (!std::isfinite(found)) return false;
    size = found, std::swap(y, next), std::swap(c, next_c), std::swap(map, next_map);
    return true;
  }
}

// Whether y, projected, meets the tolerance, or Newton's method from it does.
bool Smoothing::accept() {
  for (Index i = 0; i < n; ++i) next[i] = unit[i] * y[i];
  project(p, next, next);
  times(p.G, next, p.g, next_c, n);
  if (keep_best(w, b, next, next_c)) return true;
  const double now = residual(p, next, next_c).residual;
  if (!(now < newton_error * p.speed && now < newton_reduction * tried)) return false;
  tried = now;
  return alart_curnier(w, b, next, next_c);
}

bool Smoothing::run() {
  if (n > max_rows) return false;
  set_units();
  const double first = eps;
  std::fill_n(y, n, 0.0);
  std::copy_n(g, n, c);
  for (Index steps = 0; steps < max_steps && !b.spent() && eps > tuning::epsilon * first;) {
    double size = error(y, c, map), part = 1;
    bool near = false;
    for (int k = 0; k < steps_each && !near && !b.spent(); ++k, ++steps) {
      if (!step(size, part)) return false;
      if (accept()) return true;
      near = size < closeness * eps;
    }
    if (steps >= judged_after && eps > hopeful * first) return false;
    eps = near ? reduction * eps : part < short_part ? std::min(first, growth * eps) : slow_reduction * eps;
  }
  return false;
}

}  // namespace

bool smoothing_newton(Workspace& w, Budget& b) { return Smoothing(w, b).run(); }

}  // namespace dyn::solver
