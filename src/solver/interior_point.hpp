// One path of an interior-point method for Coulomb's law, over a Delassus operator. Y = (mu y_n, y_t) and U lie in the cone
// |.| <= ._0 and follow Y o U = sigma (1, 0), o the Jordan product, to sigma = 0, with
//   U_0 = c_n / mu + sqrt(|c_t|^2 + edge^2),  U_t = c_t,  edge = a share of sigma / Y_0
// which is de Saxce's correction |c_t| without its kink at stick (nonsmooth: Acary, Armand, Nguyen and Shpakovych 2024).
// Boxes y in [l, u]: z_l (y - l) = sigma, z_u (u - y) = sigma, z_l - z_u = c. Steps use Nesterov-Todd scaling and the centring of
// Mehrotra (1992):
//   (B G + W^2 S) dy = sigma Y^-1 - U        S = dY/dy,  B = dU/dc,  W^2 Y = U
// or dy = K (r - G dy) with the law K = (W^2 S)^-1 B of each block.
// With a fixed correction s, U_0 = c_n / mu + s: a convex problem.
// Operator: for_each(f(block, k)); law(k) and correction(k) of a block; factorize(symmetric) of 1 + K G; solve(r, dy, dc), which
// sets dc = G dy, too; inverse_laws, if law(k) holds K^-1; compliance, the least of bounded rows; edge, of sigma / Y_0.
#pragma once

#include "solver/block.hpp"
#include "solver/lorentz.hpp"

namespace dyn::solver {

template <class Operator>
struct InteriorPoint {
  Operator& G;
  Index n;                                                      // rows
  double *y, *c, *dy, *dc, *rhs, *U, *upper, *dU, *dupper;      // U of boxes: z_l; upper: z_u
  bool fixed_correction = false;
  Index short_steps = 0;
  double sigma = 0;  // of the nearest point of the path

  // Moves the iterate inside the cones by an impulse and a velocity.
  void start_inside(double impulse, double velocity);
  // Returns false if the path is stuck.
  bool step();

 private:
  // The correction is e + u . c_t at c, with the gradient u. Returns e.
  double correction(const Block& s, Index k, double* u) const {
    const double *ct = c + s.first + 1, edge = Operator::edge * sigma / (s.mu * y[s.first]);
    double square = edge * edge;
    for (Index i = 0; i + 1 < s.rows; ++i) square += ct[i] * ct[i];
    const double length = std::sqrt(square);
    for (Index i = 0; i + 1 < s.rows; ++i) u[i] = length > 0 && !fixed_correction ? ct[i] / length : 0;
    return fixed_correction ? G.correction(k) : length > 0 ? edge * edge / length : 0;
  }
  double complementarity() const;
  void scale_cone(const Block& s, Index k, LawMatrix& law) const;
  bool factorize();
  void direction_to(double target);
  double max_step_to_boundary() const;
};

template <class Operator>
void InteriorPoint<Operator>::start_inside(double impulse, double velocity) {
  short_steps = 0;
  G.for_each([&](const Block& s, Index k) {
    double *yk = y + s.first, *Uk = U + s.first, *top = upper + s.first;
    const double* ck = c + s.first;
    if (!s.is_cone()) {
      for (Index i = 0; i < s.rows; ++i) {
        const bool l = std::isfinite(s.lower), u = std::isfinite(s.upper);
        Uk[i] = top[i] = 0;
        if (l && u) yk[i] = 0.5 * (s.lower + s.upper);
        else if (l) yk[i] = std::max(yk[i], s.lower + impulse);
        else if (u) yk[i] = std::min(yk[i], s.upper - impulse);
        if (l) Uk[i] = std::max(ck[i], velocity);
        if (u) top[i] = std::max(-ck[i], velocity);
      }
      return;
    }
    project_cone(s.mu, s.rows, yk, yk);
    const double Yt = norm(yk + 1, s.rows - 1), Ut = norm(ck + 1, s.rows - 1);
    yk[0] = std::max(yk[0], (Yt + impulse) / s.mu);
    Uk[0] = std::max(ck[0] / s.mu + (fixed_correction ? G.correction(k) : 0.0), Ut) + velocity;
    for (Index i = 1; i < s.rows; ++i) Uk[i] = ck[i];
  });
}

// sigma of the nearest point of the path.
template <class Operator>
double InteriorPoint<Operator>::complementarity() const {
  double sum = 0;
  Index count = 0;
  G.for_each([&](const Block& s, Index) {
    const double *yk = y + s.first, *Uk = U + s.first, *top = upper + s.first;
    if (s.is_cone()) {
      sum += s.mu * yk[0] * Uk[0], ++count;
      for (Index i = 1; i < s.rows; ++i) sum += yk[i] * Uk[i];
      return;
    }
    for (Index i = 0; i < s.rows; ++i) {
      if (Uk[i] > 0) sum += Uk[i] * (yk[i] - s.lower), ++count;
      if (top[i] > 0) sum += top[i] * (s.upper - yk[i]), ++count;
    }
  });
  return count ? sum / count : 0;
}

// The law of a cone or its inverse. W^2 = ratio (2 v v' - J), W^-2 the same with 1 / ratio and v reflected.
template <class Operator>
void InteriorPoint<Operator>::scale_cone(const Block& s, Index k, LawMatrix& law) const {
  const double *yk = y + s.first, *Uk = U + s.first, mu = s.mu, R = s.soft[0];
  const Index m = s.rows - 1;
  const double Y0 = mu * yk[0], U0 = Uk[0];
  const double Y_size = std::sqrt(lorentz(Y0, yk + 1, Y0, yk + 1, m)), U_size = std::sqrt(lorentz(U0, Uk + 1, U0, Uk + 1, m));
  double inner = Y0 * U0, v[6], u[5];
  for (Index i = 1; i <= m; ++i) inner += yk[i] * Uk[i];
  const double scale = 1 / std::sqrt(2 * (1 + inner / (Y_size * U_size))), ratio = U_size / Y_size;
  v[0] = scale * (U0 / U_size + Y0 / Y_size);
  for (Index i = 1; i <= m; ++i) v[i] = scale * (Uk[i] / U_size - yk[i] / Y_size);
  correction(s, k, u);
  const auto square = [&](Index i, Index j) { return 2 * v[i] * v[j] - (i == j) * (i == 0 ? 1 : -1); };
  if constexpr (Operator::inverse_laws) {  // B^-1 W^2 S
    for (Index j = 0; j <= m; ++j) {
      const double unit = ratio * (j == 0 ? mu : 1);
      law[0][j] = mu * unit * square(0, j);
      for (Index i = 1; i <= m; ++i) law[i][j] = unit * square(i, j), law[0][j] -= mu * u[i - 1] * law[i][j];
    }
    law[0][0] += R;
    return;
  }
  for (Index i = 0; i <= m; ++i) {  // S^-1 W^-2 B
    const auto entry = [&](Index j) { return ((i == 0) == (j == 0) ? 1 : -1) * square(i, j) / (ratio * (i == 0 ? mu : 1)); };
    law[i][0] = entry(0) / mu;
    for (Index j = 1; j <= m; ++j) law[i][j] = entry(j) + entry(0) * u[j - 1];
  }
  if (!(R > 0)) return;
  const double share = R / (1 + R * law[0][0]);
  double column[6], row[6];
  for (Index i = 0; i <= m; ++i) column[i] = law[i][0], row[i] = law[0][i];
  for (Index i = 0; i <= m; ++i)
    for (Index j = 0; j <= m; ++j) law[i][j] -= share * column[i] * row[j];
}

template <class Operator>
bool InteriorPoint<Operator>::factorize() {
  G.for_each([&](const Block& s, Index k) {
    LawMatrix& law = G.law(k);
    if (s.is_cone()) return scale_cone(s, k, law);
    const double *yk = y + s.first, *Uk = U + s.first, *top = upper + s.first;
    for (Index i = 0; i < s.rows; ++i) {
      double E = Operator::compliance + s.soft[i];
      if (Uk[i] > 0) E += Uk[i] / (yk[i] - s.lower);
      if (top[i] > 0) E += top[i] / (s.upper - yk[i]);
      for (Index j = 0; j < s.rows; ++j) law[i][j] = i != j ? 0 : Operator::inverse_laws ? E : 1 / E;
    }
  });
  return G.factorize(fixed_correction);
}

// Direction to the point of the path at target: dy, dc = G dy, and the changes of U and the boxes' z.
template <class Operator>
void InteriorPoint<Operator>::direction_to(double target) {
  G.for_each([&](const Block& s, Index k) {
    const double *yk = y + s.first, *Uk = U + s.first, *top = upper + s.first, *ck = c + s.first;
    double* r = rhs + s.first;
    if (!s.is_cone()) {
      for (Index i = 0; i < s.rows; ++i) {
        r[i] = -ck[i];
        if (Uk[i] > 0) r[i] += target / (yk[i] - s.lower);
        if (top[i] > 0) r[i] -= target / (s.upper - yk[i]);
      }
      return;
    }
    const Index m = s.rows - 1;
    const double Y0 = s.mu * yk[0], inverse = target / lorentz(Y0, yk + 1, Y0, yk + 1, m);
    double u[5], head = inverse * Y0 - correction(s, k, u);
    for (Index i = 1; i <= m; ++i) {
      const double t = -inverse * yk[i];
      head -= u[i - 1] * t;
      r[i] = t - ck[i];
    }
    r[0] = s.mu * head - ck[0];
  });
  G.solve(rhs, dy, dc);
  G.for_each([&](const Block& s, Index k) {
    const double *yk = y + s.first, *Uk = U + s.first, *top = upper + s.first, *ck = c + s.first, *dyk = dy + s.first,
                 *dck = dc + s.first;
    double *dUk = dU + s.first, *dtop = dupper + s.first;
    if (!s.is_cone()) {
      for (Index i = 0; i < s.rows; ++i) {
        dUk[i] = Uk[i] > 0 ? (target - Uk[i] * dyk[i]) / (yk[i] - s.lower) - Uk[i] : 0;
        dtop[i] = top[i] > 0 ? (target + top[i] * dyk[i]) / (s.upper - yk[i]) - top[i] : 0;
      }
      return;
    }
    double u[5];
    dUk[0] = correction(s, k, u) + (ck[0] + dck[0]) / s.mu - Uk[0];
    for (Index i = 1; i < s.rows; ++i) dUk[0] += u[i - 1] * (ck[i] + dck[i]);
    for (Index i = 1; i < s.rows; ++i) dUk[i] = ck[i] + dck[i] - Uk[i];
  });
}

// Step length to the boundary.
template <class Operator>
double InteriorPoint<Operator>::max_step_to_boundary() const {
  double t = HUGE_VAL;
  const auto limit = [&](double a, double d) { t = d < 0 ? std::min(t, -a / d) : t; };
  G.for_each([&](const Block& s, Index) {
    const double *yk = y + s.first, *Uk = U + s.first, *top = upper + s.first;
    const double *dyk = dy + s.first, *dUk = dU + s.first, *dtop = dupper + s.first;
    if (s.is_cone()) {
      t = std::min(t, within_cone(s.mu * yk[0], yk + 1, s.mu * dyk[0], dyk + 1, s.rows - 1));
      t = std::min(t, within_cone(Uk[0], Uk + 1, dUk[0], dUk + 1, s.rows - 1));
      return;
    }
    for (Index i = 0; i < s.rows; ++i) {
      if (Uk[i] > 0) limit(Uk[i], dUk[i]), limit(yk[i] - s.lower, dyk[i]);
      if (top[i] > 0) limit(top[i], dtop[i]), limit(s.upper - yk[i], -dyk[i]);
    }
  });
  return t;
}

template <class Operator>
bool InteriorPoint<Operator>::step() {
  using namespace tuning::interior;
  sigma = complementarity();
  if (!factorize()) return false;
  direction_to(0);
  const double left = 1 - std::min(1.0, max_step_to_boundary());  // sigma that an affine step would leave
  direction_to(sigma * left * left * left);
  const double t = std::min(1.0, to_boundary * max_step_to_boundary());
  if (!(t > 0) || !std::all_of(dc, dc + n, [](double change) { return std::isfinite(change); })) return false;
  for (Index i = 0; i < n; ++i) y[i] += t * dy[i], c[i] += t * dc[i], U[i] += t * dU[i], upper[i] += t * dupper[i];
  short_steps = t < short_step ? short_steps + 1 : 0;
  return short_steps < max_short_steps;
}

}  // namespace dyn::solver
