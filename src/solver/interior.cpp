#include "solver/interior.hpp"

#include "solver/lorentz.hpp"

namespace dyn::solver {

namespace {

using namespace tuning::interior;

class Interior {
 public:
  Interior(Workspace& w_, Budget& b_)
      : w(w_),
        p(w_.problem),
        b(b_),
        y(w_.x),
        U(w_.z),
        upper(w_.s),
        c(w_.u),
        dy(w_.r),
        dU(w_.newton),
        dupper(w_.newton_c),
        dc(w_.step_c) {}
  bool run(double factor);

 private:
  Workspace& w;
  const Problem& p;
  Budget& b;
  double *y, *U, *upper, *c;  // U of boxes: z_l; upper: z_u
  double *dy, *dU, *dupper, *dc;

  double stopping_impulse(double regularisation);
  bool begin(double factor);
  double complementarity() const;
  bool factorize();
  void direction(double sigma);
  double max_step_to_boundary() const;
  double scaling(const Cone& cone, double* v) const;
  // slip: c_t / |c_t|. along: x_t along it, the derivative of de Saxce's correction.
  void slip(const Cone& cone, double* u) const {
    const double *ct = c + cone.row + 1, length = norm(ct, cone.size - 1);
    for (Index i = 0; i + 1 < cone.size; ++i) u[i] = length > 0 ? ct[i] / length : 0;
  }
  static double along(const Cone& cone, const double* u, const double* x) {
    double sum = 0;
    for (Index i = 0; i + 1 < cone.size; ++i) sum += u[i] * x[cone.row + 1 + i];
    return sum;
  }
};

// Solves (G + regularisation) y = -g. Returns the size of y, infinite if singular.
double Interior::stopping_impulse(double regularisation) {
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

// Start on the cones' axes, with impulses that stop all motion, or nearly all where redundant rows contradict one another.
bool Interior::begin(double factor) {
  double speed = 0, impulse = stopping_impulse(exact);
  for (Index i = 0; i < p.n; ++i) speed = std::max(speed, std::fabs(p.g[i]));
  if (exact * impulse > contradiction * speed) impulse = stopping_impulse(rough);
  if (!std::isfinite(impulse)) return false;
  impulse = factor * std::max(impulse, speed);
  for (Index i = 0; i < p.boxes; ++i) {
    const bool l = std::isfinite(p.lower[i]), u = std::isfinite(p.upper[i]);
    y[i] = l && u ? 0.5 * (p.lower[i] + p.upper[i]) : l ? p.lower[i] + impulse : u ? p.upper[i] - impulse : 0;
    U[i] = l ? speed : 0, upper[i] = u ? speed : 0;
  }
  for (Index k = 0; k < p.cones; ++k) {
    const Cone& cone = p.cone[k];
    std::fill_n(y + cone.row, cone.size, 0.0), std::fill_n(U + cone.row, cone.size, 0.0);
    y[cone.row] = impulse / cone.mu, U[cone.row] = speed;
  }
  return true;
}

// sigma of the nearest point of the path.
double Interior::complementarity() const {
  double sum = 0;
  Index count = p.cones;
  for (Index i = 0; i < p.boxes; ++i) {
    if (U[i] > 0) sum += U[i] * (y[i] - p.lower[i]), ++count;
    if (upper[i] > 0) sum += upper[i] * (p.upper[i] - y[i]), ++count;
  }
  for (Index k = 0; k < p.cones; ++k) {
    const Cone& cone = p.cone[k];
    sum += cone.mu * y[cone.row] * U[cone.row];
    for (Index i = 1; i < cone.size; ++i) sum += y[cone.row + i] * U[cone.row + i];
  }
  return count ? sum / count : 0;
}

// W^2 = ratio (2 v v' - J) maps Y to U. Returns the ratio.
double Interior::scaling(const Cone& cone, double* v) const {
  const Index n = cone.row, m = cone.size - 1;
  const double *Yt = y + n + 1, *Ut = U + n + 1, Y0 = cone.mu * y[n], U0 = U[n];
  const double Y_size = std::sqrt(lorentz(Y0, Yt, Y0, Yt, m)), U_size = std::sqrt(lorentz(U0, Ut, U0, Ut, m));
  double inner = Y0 * U0;
  for (Index i = 0; i < m; ++i) inner += Yt[i] * Ut[i];
  const double scale = 1 / std::sqrt(2 * (1 + inner / (Y_size * U_size)));
  v[0] = scale * (U0 / U_size + Y0 / Y_size);
  for (Index i = 0; i < m; ++i) v[1 + i] = scale * (Ut[i] / U_size - Yt[i] / Y_size);
  return U_size / Y_size;
}

// Factorizes dU/dy + W^2.
bool Interior::factorize() {
  const Matrix& A = w.factor;
  std::copy_n(p.G.x, std::ptrdiff_t(p.G.ld) * p.n, A.x);
  for (Index i = 0; i < p.boxes; ++i) {
    A(i, i) += box_proximal;
    if (U[i] > 0) A(i, i) += U[i] / (y[i] - p.lower[i]);
    if (upper[i] > 0) A(i, i) += upper[i] / (p.upper[i] - y[i]);
  }
  for (Index k = 0; k < p.cones; ++k) {
    const Cone& cone = p.cone[k];
    double u[5], v[6];
    slip(cone, u);
    for (Index j = 0; j < p.n; ++j) A(cone.row, j) = A(cone.row, j) / cone.mu + along(cone, u, A.column(j));
    const double ratio = scaling(cone, v);
    for (Index j = 0; j < cone.size; ++j)  // by columns of y, with Y_0 = mu y_n
      for (Index i = 0; i < cone.size; ++i)
        A(cone.row + i, cone.row + j) += ratio * (2 * v[i] * v[j] - (i == j) * (i == 0 ? 1 : -1)) * (j == 0 ? cone.mu : 1);
  }
  ++b.factorizations;
  return lu(A, p.n, w.pivots);
}

// Direction to the point of the path at sigma: (U' + W^2) dy = sigma Y^-1 - U(y), and the changes of U and the boxes' z.
void Interior::direction(double sigma) {
  for (Index i = 0; i < p.boxes; ++i) {
    dy[i] = -c[i];
    if (U[i] > 0) dy[i] += sigma / (y[i] - p.lower[i]);
    if (upper[i] > 0) dy[i] -= sigma / (p.upper[i] - y[i]);
  }
  for (Index k = 0; k < p.cones; ++k) {
    const Cone& cone = p.cone[k];
    const Index n = cone.row, m = cone.size - 1;
    const double Y0 = cone.mu * y[n], inverse = sigma / lorentz(Y0, y + n + 1, Y0, y + n + 1, m);
    double u[5];
    slip(cone, u);
    dy[n] = inverse * Y0 - c[n] / cone.mu - along(cone, u, c);
    for (Index i = 1; i <= m; ++i) dy[n + i] = -inverse * y[n + i] - c[n + i];
  }
  lu_solve(w.factor, p.n, w.pivots, dy);
  times(p.G, dy, nullptr, dc, p.n);
  for (Index i = 0; i < p.boxes; ++i) {
    dU[i] = U[i] > 0 ? (sigma - U[i] * dy[i]) / (y[i] - p.lower[i]) - U[i] : 0;
    dupper[i] = upper[i] > 0 ? (sigma + upper[i] * dy[i]) / (p.upper[i] - y[i]) - upper[i] : 0;
  }
  for (Index k = 0; k < p.cones; ++k) {
    const Cone& cone = p.cone[k];
    const Index n = cone.row;
    double u[5];
    slip(cone, u);
    dU[n] = (c[n] + dc[n]) / cone.mu + along(cone, u, c) + along(cone, u, dc) - U[n];
    for (Index i = n + 1; i < n + cone.size; ++i) dU[i] = c[i] + dc[i] - U[i];
  }
}

// Step length to the boundary.
double Interior::max_step_to_boundary() const {
  double t = HUGE_VAL;
  const auto limit = [&](double a, double d) { t = d < 0 ? std::min(t, -a / d) : t; };
  for (Index i = 0; i < p.boxes; ++i) {
    if (U[i] > 0) limit(U[i], dU[i]), limit(y[i] - p.lower[i], dy[i]);
    if (upper[i] > 0) limit(upper[i], dupper[i]), limit(p.upper[i] - y[i], -dy[i]);
  }
  for (Index k = 0; k < p.cones; ++k) {
    const Cone& cone = p.cone[k];
    const Index n = cone.row, m = cone.size - 1;
    t = std::min(t, within_cone(cone.mu * y[n], y + n + 1, cone.mu * dy[n], dy + n + 1, m));
    t = std::min(t, within_cone(U[n], U + n + 1, dU[n], dU + n + 1, m));
  }
  return t;
}

bool Interior::run(double factor) {
  if (!begin(factor)) return false;
  double tried = HUGE_VAL;
  for (Index k = 0, short_steps = 0; k < max_steps && short_steps < max_short_steps && !b.spent(); ++k) {
    ++b.iterations;
    times(p.G, y, p.g, c, p.n);
    if (!factorize()) return false;
    const double sigma = complementarity();
    direction(0);
    const double left = 1 - std::min(1.0, max_step_to_boundary());  // sigma that an affine step would leave (Mehrotra 1992)
    direction(sigma * left * left * left);
    const double t = std::min(1.0, to_boundary * max_step_to_boundary());
    if (!(t > 0)) return false;
    axpy(t, dy, y, p.n), axpy(t, dU, U, p.n), axpy(t, dupper, upper, p.boxes);
    short_steps = t < short_step ? short_steps + 1 : 0;
    project(p, y, w.trial);
    times(p.G, w.trial, p.g, w.trial_c, p.n);
    if (keep_best(w, b, w.trial, w.trial_c)) return true;
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
