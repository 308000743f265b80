#include "solver/pgs.hpp"

namespace dyn::solver {

namespace {

using namespace tuning::pgs;

// Eigenvectors (columns of q) and eigenvalues of a symmetric matrix by cyclic Jacobi rotations.
void eigen(double (*a)[5], Index m, double (*q)[5], double* e) {
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < m; ++j) q[i][j] = i == j;
  for (int sweep = 0; sweep < jacobi_sweeps; ++sweep) {
    double off = 0, on = 0;
    for (Index i = 0; i < m; ++i)
      for (Index j = 0; j < m; ++j) (i == j ? on : off) += a[i][j] * a[i][j];
    if (off <= jacobi_tolerance * on) break;
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

// The cone's impulse for the velocity b. m: its size - 1.
template <int m>
void solve(const Cone& cone, LocalCone& l, double Gnn, const double* b, double* y) {
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
    slope = cone.mu * (dn - n * dl * per) * per;
    return cone.mu * n * per - 1;  // not negative: inside the cone
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
      if (!(change < warm_change * a)) return false;
      l.resistance = a = next;
      if (change < warm_enough * a) break;
    }
    at(a);
    return true;
  };
  if (!slid_on() && !stuck()) {
    double low = 0, high = 0, a = l.resistance;
    if (a == 0) a = norm(bt, m) * Gnn / (cone.mu * -b[0]);  // solution if only the resistance acted: mu lambda_n = |lambda_t|
    for (int k = 0; k < root_steps; ++k) {
      const double f = at(a);
      if (std::fabs(f) <= root_tolerance) break;
      (f < 0 ? low : high) = a;
      double next = a - f / slope;
      if (!(next > low && (high == 0 || next < high))) next = high == 0 ? root_growth * a : 0.5 * (low + high);
      if (std::fabs(next - a) <= root_width * a) break;
      a = next;
    }
    l.resistance = a;
  }
  y[0] = n;
  for (int i = 0; i < m; ++i)
    for (int k = 0; k < m; ++k) y[1 + i] += l.q[i][k] * yt[k];
}

// Updates the cone's impulse and c.
template <int m>
void sweep_cone(const Problem& p, const Cone& cone, LocalCone& l, double omega, double* y, double* c) {
  constexpr int size = m + 1;
  double v[size], to[size], change[size], *mine = y + cone.row;
  const double* column[size];
  for (int i = 0; i < size; ++i) column[i] = p.G.column(cone.row + i);
  for (int i = 0; i < size; ++i) {
    v[i] = c[cone.row + i];
    for (int j = 0; j < size; ++j) v[i] -= column[j][cone.row + i] * mine[j];
  }
  solve<m>(cone, l, column[0][cone.row], v, to);
  for (int i = 0; i < size; ++i) to[i] = omega == 1 ? to[i] : (1 - omega) * mine[i] + omega * to[i];
  project_cone(cone.mu, size, to, to);  // relaxation and round-off leave it
  bool moves = false;
  for (int i = 0; i < size; ++i) {
    change[i] = to[i] - mine[i], mine[i] = to[i];
    moves = moves || change[i] != 0;
  }
  if (!moves) return;
  for (Index r = 0; r < p.n; ++r) {
    double sum = c[r];
    for (int i = 0; i < size; ++i) sum += column[i][r] * change[i];
    c[r] = sum;
  }
}
// Calls f.template operator()<m>() for a cone of m + 1 rows.
template <class F>
void by_size(Index size, F&& f) {
  switch (size) {
    case 1: return f.template operator()<0>();
    case 2: return f.template operator()<1>();
    case 3: return f.template operator()<2>();
    case 4: return f.template operator()<3>();
    case 5: return f.template operator()<4>();
    default: return f.template operator()<5>();
  }
}

}  // namespace

LocalCone local_cone(const Problem& p, const Cone& cone) {
  LocalCone l;
  l.resistance = 0;
  const Index n = cone.row, t = n + 1, m = cone.size - 1;
  const double Gnn = p.G(n, n);
  double S[5][5];
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < m; ++j) S[i][j] = p.G(t + i, t + j) - (Gnn > 0 ? p.G(t + i, n) * p.G(t + j, n) / Gnn : 0);
  eigen(S, m, l.q, l.e);
  double largest = 0;
  for (Index i = 0; i < cone.size; ++i) largest = std::max(largest, p.G(n + i, n + i));
  for (Index k = 0; k < m; ++k) {
    l.e[k] = l.e[k] > tiny * largest ? l.e[k] : 0;
    l.coupling[k] = 0;
    for (Index i = 0; i < m; ++i) l.coupling[k] += l.q[i][k] * p.G(t + i, n);
    // an impulse that moves nothing and lies in the cone: rounding of b would make it as large as can be
    if (l.e[k] == 0 && cone.mu * std::fabs(l.coupling[k]) >= Gnn) l.e[k] = HUGE_VAL;
  }
  return l;
}

void solve_cone(const Cone& cone, LocalCone& l, double Gnn, const double* b, double* y) {
  by_size(cone.size, [&]<int m>() { solve<m>(cone, l, Gnn, b, y); });
  project_cone(cone.mu, cone.size, y, y);  // round-off leaves it
}

void prepare_sweeps(Workspace& w) {
  for (Index k = 0; k < w.problem.cones; ++k) w.local[k] = local_cone(w.problem, w.problem.cone[k]);
}

void sweep(const Workspace& w, double omega, double* y, double* c) {
  const Problem& p = w.problem;
  const auto move = [&](Index i, double to) {
    const double change = to - y[i];
    if (change == 0) return;
    y[i] = to;
    axpy(change, p.G.column(i), c, p.n);
  };
  for (Index i = 0; i < p.boxes; ++i)
    if (const double G = p.G(i, i); G > tiny) move(i, project_box(p, i, y[i] - omega * c[i] / G));
  for (Index k = 0; k < p.cones; ++k)
    by_size(p.cone[k].size, [&]<int m>() { sweep_cone<m>(p, p.cone[k], w.local[k], omega, y, c); });
}

void pgs(Workspace& w, Budget& b) {
  const Problem& p = w.problem;
  double *y = w.x, *c = w.v;
  std::copy_n(w.y, p.n, y), std::copy_n(w.c, p.n, c);
  prepare_sweeps(w);
  while (!b.spent()) {
    ++b.iterations;
    sweep(w, b.relaxation > 0 ? b.relaxation : b.iterations == 1 ? 1 : relaxation, y, c);  // one sweep solves a single contact
    if (residual(p, y, c).residual > b.tolerance && b.iterations % tuning::sweeps_a_check != 0 && b.iterations < b.max_iterations)
      continue;
    times(p.G, y, p.g, c, p.n);  // without accumulated round-off
    if (keep_best(w, b, y, c)) return;
  }
}

}  // namespace dyn::solver
