#include "simulation/proximal.hpp"

namespace dyn::simulation {

using namespace tuning::proximal;

// at = y_k - (c + t dc + correction) / compliance. Rows that are compliant themselves add to eps. Returns the compliance.
template <int rows>
DYN_INLINE double Proximal::aim(const Block& b, const State& s, double t, double* at) const {
  double soft = 0;
  for (int i = 0; i < rows; ++i) soft = std::max(soft, b.soft[i]);
  const double compliance = eps + soft, per = 1 / compliance;
  for (int i = 0; i < rows; ++i) {
    const Index k = b.first + i;
    at[i] = center[k] - per * (c[k] + t * dc[k] + b.soft[i] * center[k]);
  }
  if (b.is_cone()) at[0] -= per * s.correction;
  return compliance;
}

// law = P'(at) / compliance
void Proximal::set_law(const Block& b, State& s, double compliance, const double* at) const {
  const double K = 1 / compliance;
  for (Index i = 0; i < b.rows; ++i)
    for (Index j = 0; j < b.rows; ++j) s.law[i][j] = 0;
  s.acts = true;
  if (!b.is_cone()) {
    s.acts = false;
    for (Index i = 0; i < b.rows; ++i)
      if (at[i] >= b.lower && at[i] <= b.upper) s.law[i][i] = K, s.acts = true;
    return;
  }
  const double length = solver::norm(at + 1, b.rows - 1);
  if (length <= b.mu * at[0]) {
    for (Index i = 0; i < b.rows; ++i) s.law[i][i] = K;
  } else if (b.mu * length <= -at[0]) {
    s.acts = false;
  } else {
    const double along = K / (1 + b.mu * b.mu), across = along * b.mu * (at[0] + b.mu * length) / length;
    s.law[0][0] = along;
    for (Index i = 1; i < b.rows; ++i) {
      const double ti = at[i] / length;
      s.law[0][i] = s.law[i][0] = along * b.mu * ti;
      for (Index j = 1; j < b.rows; ++j)
        s.law[i][j] = along * b.mu * b.mu * ti * at[j] / length + across * ((i == j) - ti * at[j] / length);
    }
  }
}

void Proximal::hold_correction() {
  for_each([&](const Block& b, State& s, Index) {
    if (b.is_cone()) s.correction = b.mu * solver::norm(c + b.first + 1, b.rows - 1);
  });
}

// left = y - a and the laws. Returns |left|^2.
double Proximal::prepare() {
  double sum = 0;
  std::fill_n(w.newton_acts, e.size, false);
  for_each([&](const Block& b, State& s, Index n) {
    const Index first = b.first;
    solver::by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
      double at[rows], to[rows] = {};
      const double compliance = aim<rows>(b, s, 0, at);
      b.project(at, to), set_law(b, s, compliance, at);
      for (int i = 0; i < rows; ++i) left[first + i] = to[i] - a[first + i], sum += left[first + i] * left[first + i];
    });
    if (s.acts) activate(n);
  });
  return sum;
}

// Derivative of the function along dz, at z + t dz.
double Proximal::slope(double t) const {
  double sum = 0;
  for_each([&](const Block& b, const State& s, Index) {
    const Index first = b.first;
    solver::by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
      double at[rows], to[rows] = {};
      aim<rows>(b, s, t, at), b.project(at, to);
      for (int i = 0; i < rows; ++i) sum += dc[first + i] * (a[first + i] + t * da[first + i] - to[i]);
    });
  });
  return sum;
}

// Zero of the slope, by regula falsi that bisects where it would creep. first: slope(0).
// A full step is taken unless it goes too far.
double Proximal::line_search(double first) const {
  double before = first, after = slope(1), low = 0, high = 1, t = 1;
  for (int k = 0; k < searches && after > 0 && std::abs(t == high ? after : before) > flat * -first; ++k) {
    t = (low * after - high * before) / (after - before);
    if (const double edge = creep * (high - low); !(t > low + edge && t < high - edge)) t = (low + high) / 2;
    const double here = slope(t);
    if (here > 0) high = t, after = here;
    else low = t, before = here;
  }
  return t;
}

// One Newton step. Returns the share of it that was taken; 0 if the matrix is singular.
double Proximal::step() {
  if (!factorize_laws(true)) return 0;
  G.clear();
  for_each([&](const Block& b, const State&, Index n) {
    solver::by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA { G.scatter<rows>(n, left + b.first); });
  });
  factor.solve(w.by_segment);
  double first_slope = 0;
  for_each([&](const Block& b, const State& s, Index n) {
    const Index first = b.first;
    solver::by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
      double by[rows] = {};
      G.gather<rows>(n, dc + first);
      if (s.acts) apply<rows>(s, dc + first, by);
      for (int i = 0; i < rows; ++i) da[first + i] = left[first + i] - by[i], first_slope -= dc[first + i] * left[first + i];
    });
  });
  const double t = line_search(first_slope);
  for (Index i = 0; i < x.rows; ++i) a[i] += t * da[i], c[i] += t * dc[i];
  std::fill_n(dc, x.rows, 0.0);
  return t;
}

// y = P(...) at z
void Proximal::end_step() {
  for_each([&](const Block& b, const State& s, Index) {
    solver::by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
      double at[rows];
      aim<rows>(b, s, 0, at), b.project(at, y + b.first);
    });
  });
}

void Proximal::run(Index max_steps, dynContactReport& report) {
  w.limit.expect(solver::TimeLimit::Unit::Segments, x.rows);
  std::copy_n(before, x.rows, y), candidate(y), velocities(y, c);
  std::copy_n(y, x.rows, best), std::copy_n(y, x.rows, a);
  report.residual = residual(best);
  hold_correction();
  for_each([&](const Block& b, const State&, Index) {
    for (Index i = 0; i < b.rows; ++i) c[b.first + i] -= b.soft[i] * y[b.first + i];
  });
  std::fill_n(dc, x.rows, 0.0);
  for (Index steps = 0; steps < max_steps && report.residual > x.tolerance && x.within_budget(report);) {
    std::copy_n(y, x.rows, center);
    const double far = prepare();
    double shortest = 1;
    Index taken = 0;
    do {
      ++taken, ++steps, ++report.newton_steps;
      const double t = step();
      if (t == 0) return G.write(best);
      shortest = std::min(shortest, t);
    } while (taken < inner_steps && steps < max_steps && prepare() > solved * far);
    end_step();
    double largest = 0;
    for (Index i = 0; i < x.rows; ++i) largest = std::max(largest, std::abs(y[i]));
    const double found = largest <= bound ? residual(y) : HUGE_VAL;  // rounding of larger ones hides any velocity
    std::fill_n(dc, x.rows, 0.0);
    if (found < report.residual) report.residual = found, std::copy_n(y, x.rows, best);
    hold_correction();
    if (taken == 1 && shortest == 1) eps = std::max(least_compliance, eps * less);
    else if (taken == inner_steps || shortest < short_step) eps = std::min(most_compliance, eps * more);
  }
  G.write(best);
}

}  // namespace dyn::simulation
