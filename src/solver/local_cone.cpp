#include "solver/local_cone.hpp"

#include <limits>

#include "solver/bracketed_newton.hpp"

namespace dyn::solver {

namespace {

using namespace tuning::pgs;

// Eigenvectors (columns of q) and eigenvalues of a symmetric matrix by cyclic Jacobi rotations.
void eigen(double (*a)[5], Index m, double (*q)[5], double* e) {
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < m; ++j) q[i][j] = i == j;
  const double rounding = tuning::epsilon / 2;  // of one operation
  double before = HUGE_VAL;
  for (int sweep = 0; sweep < std::numeric_limits<double>::digits; ++sweep) {  // of numbers near overflow they may not converge
    double off = 0, on = 0;
    for (Index i = 0; i < m; ++i)
      for (Index j = 0; j < m; ++j) (i == j ? on : off) += a[i][j] * a[i][j];
    if (off <= rounding * rounding * on || !(off < before)) break;  // each sweep squares what is left
    before = off;
    for (Index i = 0; i < m; ++i)
      for (Index j = i + 1; j < m; ++j) {
        if (a[i][j] == 0) continue;
        const double theta = (a[j][j] - a[i][i]) / (2 * a[i][j]);
        const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::sqrt(theta * theta + 1)),
                     c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (Index k = 0; k < m; ++k) {
          const double x = a[k][i], y = a[k][j];
          a[k][i] = c * x - s * y, a[k][j] = s * x + c * y;
        }
        for (Index k = 0; k < m; ++k) {
          const double x = a[i][k], y = a[j][k];
          a[i][k] = c * x - s * y, a[j][k] = s * x + c * y;
        }
        for (Index k = 0; k < m; ++k) {
          const double x = q[k][i], y = q[k][j];
          q[k][i] = c * x - s * y, q[k][j] = s * x + c * y;
        }
      }
  }
  for (Index i = 0; i < m; ++i) e[i] = a[i][i];
}

// m: tangential rows
template <int m>
void solve_cone(LocalCone& l, double mu, const double* b, double* y) {
  const double Gnn = l.G[0][0];
  std::fill_n(y, m + 1, 0.0);
  if (b[0] >= 0 || Gnn == 0) return;
  const double inverse_Gnn = 1 / Gnn;
  double bt[m + 1], yt[m + 1];
  for (int k = 0; k < m; ++k) {
    bt[k] = -l.coupling[k] * b[0] * inverse_Gnn;
    for (int i = 0; i < m; ++i) bt[k] += l.q[i][k] * b[1 + i];
  }
  const auto noise = [&] { return tuning::round_off * (std::fabs(b[0]) + norm(b + 1, m)); };
  // lambda_n, |lambda_t|, and d/da of mu lambda_n / |lambda_t|
  double n = 0, length = 0, slope = 0;
  const auto at = [&](double a) {
    double dn = 0, dl = 0;
    n = -b[0];
    for (int k = 0; k < m; ++k) {
      const double stiffness = l.e[k] + a, give = 1 / stiffness;
      yt[k] = stiffness > 0 ? -bt[k] * give : std::fabs(bt[k]) <= noise() ? 0.0 : std::copysign(HUGE_VAL, -bt[k]);
      n -= l.coupling[k] * yt[k];
      dn += l.coupling[k] * yt[k] * give, dl -= yt[k] * yt[k] * give;
    }
    length = norm(yt, m);
    const double per = 1 / length;
    n *= inverse_Gnn, dn *= inverse_Gnn, dl *= per;
    slope = mu * (dn - n * dl * per) * per;
    return mu * n * per - 1;  // not negative: inside the cone
  };
  const auto stuck = [&] {
    const double f = at(0);
    return length == 0 || f >= 0;
  };
  // a contact that slipped before usually slips again: one Newton step suffices if its resistance hardly changed
  const auto slid_on = [&] {
    double a = l.resistance;
    if (a == 0) return false;
    for (int k = 0; k < warm_steps; ++k) {
      const double f = at(a), next = a - f / slope, change = std::fabs(next - a);
      if (!(change < a)) return false;  // not positive, or far away
      l.resistance = a = next;
      if (change < warm_enough * a) break;
    }
    at(a);
    return true;
  };
  if (!slid_on() && !stuck()) {
    double a = l.resistance;
    if (a == 0) a = norm(bt, m) * Gnn / (mu * -b[0]);  // solution if only the resistance acted: mu lambda_n = |lambda_t|
    l.resistance = bracketed_newton(at, slope, a, tuning::round_off);
  }
  y[0] = n;
  for (int i = 0; i < m; ++i)
    for (int k = 0; k < m; ++k) y[1 + i] += l.q[i][k] * yt[k];
}

}  // namespace

void LocalCone::find_eigenvectors(double mu) {
  const Index m = rows - 1;
  const double Gnn = G[0][0];
  double S[5][5], largest = 0;
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < m; ++j) S[i][j] = G[1 + i][1 + j] - (Gnn > 0 ? G[1 + i][0] * G[1 + j][0] / Gnn : 0);
  eigen(S, m, q, e);
  for (Index i = 0; i < rows; ++i) largest = std::max(largest, G[i][i]);
  for (Index k = 0; k < m; ++k) {
    e[k] = e[k] > tiny * largest ? e[k] : 0;
    coupling[k] = 0;
    for (Index i = 0; i < m; ++i) coupling[k] += q[i][k] * G[1 + i][0];
    // an impulse that moves nothing and lies in the cone: rounding of b would make it as large as can be
    if (e[k] == 0 && mu * std::fabs(coupling[k]) >= Gnn) e[k] = HUGE_VAL;
  }
  decomposed = true;
}

void LocalCone::solve(double mu, const double* b, double* y) {
  if (!decomposed) find_eigenvectors(mu);
  switch (rows) {
    case 1: solve_cone<0>(*this, mu, b, y); break;
    case 2: solve_cone<1>(*this, mu, b, y); break;
    case 3: solve_cone<2>(*this, mu, b, y); break;
    case 4: solve_cone<3>(*this, mu, b, y); break;
    case 5: solve_cone<4>(*this, mu, b, y); break;
    default: solve_cone<5>(*this, mu, b, y);
  }
  project_cone(mu, rows, y, y);  // round-off leaves it
}

}  // namespace dyn::solver
