// Impulses of compliant rows as MuJoCo defines them: the minimum of a convex function,
//   lambda = argmin over the cones of 1/2 lambda' (G + S) lambda + lambda' g,   S > 0 the compliance
// Sliding contacts then open at mu times their slip, which Coulomb's law does not ask for (Anitescu 2006). In u = G y + g it is
//   y = lambda(u),   lambda(u) = argmax over the cones of -lambda' u - 1/2 lambda' S lambda
// solved by Newton's method with the laws H = -d lambda / du and a line search (MuJoCo's primal solver, in impulses).
#include <limits>

#include "simulation/newton.hpp"

namespace dyn::simulation {

namespace {

class Convex : public Newton {
 public:
  using Newton::Newton;
  // The island's lambda. report.residual: by how much velocities differ from those of lambda, over the speed.
  void run(dynContactReport& report);

 private:
  double *u = before + 5 * room, *lambda = u + room, *du = lambda + room, *there = du + room, *known = there + room,
         *G_known = known + room;

  // Rows that are rigid have the least.
  static double softness(const Block& s, Index i) { return std::max(solver::tuning::proximal, s.soft[i]); }
  void impulses(const Block& s, const double* at, double* out, State* state) const;
  void find_impulses(const double* at, double* out, bool laws) const;
  double slope(double t);
  double line_search();
};

// lambda(u) of a block, and its law where a state is given.
void Convex::impulses(const Block& s, const double* at, double* out, State* state) const {
  if (!s.is_cone()) {
    for (Index i = 0; i < s.rows; ++i) {
      const double soft = softness(s, i), free = -at[i] / soft;
      out[i] = std::clamp(free, s.lower, s.upper);
      if (state)
        for (Index j = 0; j < s.rows; ++j) state->law[i][j] = i == j && out[i] == free ? 1 / soft : 0;
    }
    return;
  }
  const Index m = s.rows - 1;
  const double normal = softness(s, 0), across = softness(s, 1), slip = solver::norm(at + 1, m);
  const auto clear = [&] {
    for (Index i = 0; i < s.rows; ++i)
      for (Index j = 0; j < s.rows; ++j) state->law[i][j] = 0;
  };
  if (state) clear();
  if (at[0] >= s.mu * slip) return void(std::fill_n(out, s.rows, 0.0));  // open
  if (slip * normal <= -s.mu * at[0] * across) {                         // sticks
    for (Index i = 0; i < s.rows; ++i) out[i] = -at[i] / (i ? across : normal);
    if (state)
      for (Index i = 0; i < s.rows; ++i) state->law[i][i] = 1 / (i ? across : normal);
    return;
  }
  const double q = normal + s.mu * s.mu * across;
  out[0] = (s.mu * slip - at[0]) / q;
  double a[solver::Block::max_rows] = {1};  // along the edge
  for (Index i = 1; i <= m; ++i) a[i] = -s.mu * at[i] / slip, out[i] = out[0] * a[i];
  if (!state) return;
  const double turn = s.mu * out[0] / slip, square = s.mu * s.mu;
  for (Index i = 0; i < s.rows; ++i)
    for (Index j = 0; j < s.rows; ++j)
      state->law[i][j] = a[i] * a[j] / q + (i && j ? turn * ((i == j) - a[i] * a[j] / square) : 0);
}

// out = lambda(u) of all.
void Convex::find_impulses(const double* at, double* out, bool laws) const {
  for_each([&](const Block& s, State& state, Index k) {
    impulses(s, at + s.first, out + s.first, laws ? &state : nullptr);
    if (laws) state.acts = true, activate(k);
  });
}

// Of the function along the step, at t.
double Convex::slope(double t) {
  for (Index i = 0; i < x.rows; ++i) there[i] = u[i] + t * du[i];
  find_impulses(there, c, false);
  double sum = 0;
  for (Index i = 0; i < x.rows; ++i) sum += du[i] * (y[i] + t * dy[i] - c[i]);
  return sum;
}

// Where the slope, which grows along the step, is at most half of that at the beginning: the next step finds the rest.
double Convex::line_search() {
  const double first = slope(0);
  double low = 0, at_low = first, high = 1, at_high = slope(1);
  if (!(first < 0)) return 1;
  const auto is_low = [&](double slope) { return 2 * std::abs(slope) <= -first; };
  const int most = std::numeric_limits<double>::digits;  // doublings, or halvings
  for (int k = 0; k < most && at_high < 0 && !is_low(at_high); ++k)
    low = high, at_low = at_high, high *= 2, at_high = slope(high);
  if (is_low(at_high)) return high;
  double t = high;
  for (int k = 0; k < most; ++k) {
    const double secant = low - at_low * (high - low) / (at_high - at_low), middle = 0.5 * (low + high);
    t = k % 3 == 2 || !(secant > low && secant < high) ? middle : secant;
    const double now = slope(t);
    if (is_low(now)) break;
    (now < 0 ? (low = t, at_low = now) : (high = t, at_high = now));
  }
  return t;
}

void Convex::run(dynContactReport& report) {
  const double fastest = x.fastest > 0 ? x.fastest : 1;
  const auto without_softness = [&](const double* of, double* G_of) {
    for_each([&](const Block& s, State&, Index) {
      for (Index i = 0; i < s.rows; ++i) G_of[s.first + i] -= s.soft[i] * of[s.first + i];
    });
  };
  report.residual = HUGE_VAL;
  while (x.within_budget(report)) {
    times(y, u), without_softness(y, u);
    for (Index i = 0; i < x.rows; ++i) u[i] += g[i];
    std::fill_n(w.newton_acts, e.size, false);
    find_impulses(u, lambda, true);
    for (Index i = 0; i < x.rows; ++i) known[i] = lambda[i] - y[i];
    times(known, G_known), without_softness(known, G_known);
    double wrong = 0;
    for_each([&](const Block& s, State&, Index) {
      for (Index i = 0; i < s.rows; ++i) wrong = std::max(wrong, std::abs(G_known[s.first + i]) * s.per_speed[i]);
    });
    if (wrong / fastest < report.residual) report.residual = wrong / fastest, std::copy_n(lambda, x.rows, best);
    if (report.residual <= x.tolerance) break;
    if (!factorize_laws(true)) break;
    ++report.newton_steps;
    for (Index i = 0; i < x.rows; ++i) method.rhs[i] = -G_known[i];
    solve_laws(method.rhs, dy, dc, 0), without_softness(dy, dc);
    for (Index i = 0; i < x.rows; ++i) dy[i] += known[i], du[i] = dc[i] + G_known[i];
    const double t = line_search();
    for (Index i = 0; i < x.rows; ++i) y[i] += t * dy[i];
  }
  G.write(best);
}

}  // namespace

bool Island::solve_as_file(dynContactReport& report) {
  if (!has_runs() || !ordered()) return false;
  build_rows();
  Convex(*this).run(report);
  return true;
}

}  // namespace dyn::simulation
