#include "simulation/interior.hpp"

#include "solver/lorentz.hpp"

namespace dyn::simulation {

namespace {

using solver::lorentz;
using solver::within_cone;
using namespace tuning::interior;
using solver::tuning::interior::to_boundary, solver::tuning::interior::newton_error,
    solver::tuning::interior::newton_reduction, solver::tuning::interior::short_step, solver::tuning::interior::max_short_steps;
using tuning::newton::min_compliance, tuning::newton::refinements;

}  // namespace

void Interior::start_inside(double shift) {
  for_each([&](const Block& b, const State& s, Index) {
    double *yk = y + b.first, *Uk = U + b.first, *top = upper + b.first;
    const double* ck = c + b.first;
    if (!b.is_cone()) {
      for (Index i = 0; i < b.rows; ++i) {
        const bool l = std::isfinite(b.lower), u = std::isfinite(b.upper);
        Uk[i] = top[i] = 0;
        if (l && u) yk[i] = 0.5 * (b.lower + b.upper);
        else if (l) yk[i] = std::max(yk[i], b.lower + shift);
        else if (u) yk[i] = std::min(yk[i], b.upper - shift);
        if (l) Uk[i] = std::max(ck[i], shift);
        if (u) top[i] = std::max(-ck[i], shift);
      }
      return;
    }
    solver::project_cone(b.mu, b.rows, yk, yk);
    const double Yt = solver::norm(yk + 1, b.rows - 1), Ut = solver::norm(ck + 1, b.rows - 1);
    yk[0] = std::max(yk[0], (Yt + shift) / b.mu);
    Uk[0] = std::max(ck[0] / b.mu + (fixed_correction ? s.correction : 0.0), Ut) + shift;
    for (Index i = 1; i < b.rows; ++i) Uk[i] = ck[i];
  });
}

// sigma of the nearest point of the path.
double Interior::complementarity() const {
  double sum = 0;
  Index count = 0;
  for_each([&](const Block& b, const State&, Index) {
    const double *yk = y + b.first, *Uk = U + b.first, *top = upper + b.first;
    if (b.is_cone()) {
      sum += b.mu * yk[0] * Uk[0], ++count;
      for (Index i = 1; i < b.rows; ++i) sum += yk[i] * Uk[i];
      return;
    }
    for (Index i = 0; i < b.rows; ++i) {
      if (Uk[i] > 0) sum += Uk[i] * (yk[i] - b.lower), ++count;
      if (top[i] > 0) sum += top[i] * (b.upper - yk[i]), ++count;
    }
  });
  return count ? sum / count : 0;
}

// law = (W^2 S + N)^-1 B of a cone, W^-2 = (2 v v' - J) / ratio; a compliance is added to its inverse.
void Interior::scale_cone(const Block& b, State& s) const {
  const double *yk = y + b.first, *Uk = U + b.first, *ck = c + b.first;
  const Index m = b.rows - 1;
  const double Y0 = b.mu * yk[0], U0 = Uk[0];
  const double Y_size = std::sqrt(lorentz(Y0, yk + 1, Y0, yk + 1, m)), U_size = std::sqrt(lorentz(U0, Uk + 1, U0, Uk + 1, m));
  double inner = Y0 * U0, v[6], A[6][6], n[6] = {}, nA[6] = {};
  for (Index i = 1; i <= m; ++i) inner += yk[i] * Uk[i];
  const double scale = 1 / std::sqrt(2 * (1 + inner / (Y_size * U_size))), ratio = Y_size / U_size;
  v[0] = scale * (U0 / U_size + Y0 / Y_size);
  for (Index i = 1; i <= m; ++i) v[i] = scale * (yk[i] / Y_size - Uk[i] / U_size);
  for (Index i = 1; i <= m; ++i) n[0] += yk[i] * ck[i] * b.mu / (Y0 * Y0), n[i] = -ck[i] / Y0;
  for (Index i = 0; i <= m; ++i)
    for (Index j = 0; j <= m; ++j) A[i][j] = ratio * (2 * v[i] * v[j] - (i == j) * (i == 0 ? 1 : -1)) / (i == 0 ? b.mu : 1);
  for (Index j = 0; j <= m; ++j)
    for (Index i = 0; i <= m; ++i) nA[j] += n[i] * A[i][j];
  // Sherman-Morrison, N = (1, 0) n'; dropped where it would change the sign
  if (const double own = 1 + nA[0]; !fixed_correction && own > 0)
    for (Index i = 0; i <= m; ++i) {
      const double first = A[i][0] / own;
      for (Index j = 0; j <= m; ++j) A[i][j] -= first * nA[j];
    }
  for (Index i = 0; i <= m; ++i) {
    s.law[i][0] = A[i][0] / b.mu;
    for (Index j = 1; j <= m; ++j) s.law[i][j] = A[i][j] - (fixed_correction ? 0 : A[i][0] * yk[j] / Y0);
  }
  if (const double R = b.soft[0]; R > 0) {
    const double share = R / (1 + R * s.law[0][0]);
    double column[6], row[6];
    for (Index i = 0; i <= m; ++i) column[i] = s.law[i][0], row[i] = s.law[0][i];
    for (Index i = 0; i <= m; ++i)
      for (Index j = 0; j <= m; ++j) s.law[i][j] -= share * column[i] * row[j];
  }
}

bool Interior::factorize_barrier() {
  for_each([&](const Block& b, State& s, Index k) {
    s.acts = true, activate(k);
    if (b.is_cone()) return scale_cone(b, s);
    const double *yk = y + b.first, *Uk = U + b.first, *top = upper + b.first;
    for (Index i = 0; i < b.rows; ++i) {
      double E = min_compliance + b.soft[i];
      if (Uk[i] > 0) E += Uk[i] / (yk[i] - b.lower);
      if (top[i] > 0) E += top[i] / (b.upper - yk[i]);
      for (Index j = 0; j < b.rows; ++j) s.law[i][j] = i == j ? 1 / E : 0;
    }
  });
  return factorize(fixed_correction);
}

// Direction to the point of the path at sigma: dy, dc = G dy, and the changes of U and the boxes' z.
void Interior::direction_to(double sigma) {
  for_each([&](const Block& b, const State& s, Index) {
    const double *yk = y + b.first, *Uk = U + b.first, *top = upper + b.first, *ck = c + b.first;
    double* r = rhs + b.first;
    if (!b.is_cone()) {
      for (Index i = 0; i < b.rows; ++i) {
        r[i] = -ck[i];
        if (Uk[i] > 0) r[i] += sigma / (yk[i] - b.lower);
        if (top[i] > 0) r[i] -= sigma / (b.upper - yk[i]);
      }
      return;
    }
    const Index m = b.rows - 1;
    const double Y0 = b.mu * yk[0], inverse = sigma / lorentz(Y0, yk + 1, Y0, yk + 1, m);
    double head = inverse * Y0 - (fixed_correction ? s.correction : 0);
    for (Index i = 1; i <= m; ++i) {
      const double t = -inverse * yk[i];
      if (!fixed_correction) head += yk[i] / Y0 * t;
      r[i] = t - ck[i];
    }
    r[0] = b.mu * head - ck[0];
  });
  std::fill_n(dy, x.rows, 0.0);
  for (int k = 0; k <= refinements; ++k) {  // iterative refinement
    G.clear();
    for_each([&](const Block& b, const State& s, Index constraint) {
      G.by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
        double by[rows];
        apply<rows>(s, rhs + b.first, by), G.scatter<rows>(constraint, by);
      });
    });
    factor.solve(w.by_segment);
    for_each([&](const Block& b, const State& s, Index constraint) {
      G.by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
        double v[rows], by[rows];
        double *r = rhs + b.first, *to = dy + b.first;
        G.gather<rows>(constraint, v);
        for (int i = 0; i < rows; ++i) r[i] -= v[i];
        apply<rows>(s, r, by);
        for (int i = 0; i < rows; ++i) to[i] += by[i], r[i] = v[i] + (k ? dc[b.first + i] : 0);
      });
    });
    times(dy, dc);
    for_each([&](const Block& b, const State&, Index) {
      for (Index i = 0; i < b.rows; ++i) rhs[b.first + i] -= dc[b.first + i];
    });
  }
  for_each([&](const Block& b, const State& s, Index) {
    const double *yk = y + b.first, *Uk = U + b.first, *top = upper + b.first, *ck = c + b.first,
                 *dyk = dy + b.first, *dck = dc + b.first;
    double *dUk = dU + b.first, *dtop = dupper + b.first;
    if (!b.is_cone()) {
      for (Index i = 0; i < b.rows; ++i) {
        dUk[i] = Uk[i] > 0 ? (sigma - Uk[i] * dyk[i]) / (yk[i] - b.lower) - Uk[i] : 0;
        dtop[i] = top[i] > 0 ? (sigma + top[i] * dyk[i]) / (b.upper - yk[i]) - top[i] : 0;
      }
      return;
    }
    const double Y0 = b.mu * yk[0];
    dUk[0] = (ck[0] + dck[0]) / b.mu + (fixed_correction ? s.correction : 0) - Uk[0];
    for (Index i = 1; !fixed_correction && i < b.rows; ++i)
      dUk[0] -= (yk[i] * (ck[i] + dck[i]) + ck[i] * (dyk[i] - yk[i] / yk[0] * dyk[0])) / Y0;
    for (Index i = 1; i < b.rows; ++i) dUk[i] = ck[i] + dck[i] - Uk[i];
  });
}

// Step length to the boundary.
double Interior::max_step_to_boundary() const {
  double t = HUGE_VAL;
  const auto limit = [&](double a, double d) { t = d < 0 ? std::min(t, -a / d) : t; };
  for_each([&](const Block& b, const State&, Index) {
    const double *yk = y + b.first, *Uk = U + b.first, *top = upper + b.first;
    const double *dyk = dy + b.first, *dUk = dU + b.first, *dtop = dupper + b.first;
    if (b.is_cone()) {
      t = std::min(t, within_cone(b.mu * yk[0], yk + 1, b.mu * dyk[0], dyk + 1, b.rows - 1));
      t = std::min(t, within_cone(Uk[0], Uk + 1, dUk[0], dUk + 1, b.rows - 1));
      return;
    }
    for (Index i = 0; i < b.rows; ++i) {
      if (Uk[i] > 0) limit(Uk[i], dUk[i]), limit(yk[i] - b.lower, dyk[i]);
      if (top[i] > 0) limit(top[i], dtop[i]), limit(b.upper - yk[i], -dyk[i]);
    }
  });
  return t;
}

bool Interior::step(dynContactReport& report) {
  ++report.newton_steps;
  if (!factorize_barrier()) return false;
  const double sigma = complementarity();
  direction_to(0);
  const double left = 1 - std::min(1.0, max_step_to_boundary());  // sigma that an affine step would leave
  direction_to(sigma * left * left * left);
  const double t = std::min(1.0, to_boundary * max_step_to_boundary());
  if (!(t > 0) || !std::all_of(dc, dc + x.rows, [](double change) { return std::isfinite(change); })) return false;
  for (Index i = 0; i < x.rows; ++i) y[i] += t * dy[i], c[i] += t * dc[i], U[i] += t * dU[i], upper[i] += t * dupper[i];
  short_steps = t < short_step ? short_steps + 1 : 0;
  return short_steps < max_short_steps;
}

// Newton's method from here; if it fails, the iterate is restored.
bool Interior::newton_refine(Index most, dynContactReport& report) {
  std::copy_n(y, x.rows, y_here), std::copy_n(c, x.rows, c_here);
  if (Newton::run(most, 0, report)) return true;
  std::copy_n(y_here, x.rows, y), std::copy_n(c_here, x.rows, c);
  return false;
}

bool Interior::run(dynContactReport& report) {
  Error now = error();
  start_inside(inside * std::sqrt(now.own / x.rows)), velocities(y, c);
  double tried = HUGE_VAL;
  short_steps = 0;
  for (Index k = 0; k < max_steps && x.within_budget(report) && step(report); ++k) {
    now = error();
    if (!(now.most < newton_error * x.fastest && now.most < newton_reduction * tried)) continue;
    tried = now.most;
    if (newton_refine(newton_steps, report)) return true;
  }
  return false;
}

bool interior(const Island& x, dynContactReport& report) {
  Interior method(x);
  if (method.Newton::run(report) || method.run(report)) return true;
  method.write_best(report);
  return false;
}

}  // namespace dyn::simulation
