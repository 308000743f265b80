#include "simulation/interior.hpp"

namespace dyn::simulation {

using namespace solver::tuning::interior;

bool Interior::factorize(bool symmetric) {
  for_each([&](const Block&, Index k) { w.newton[k].acts = true, activate(k); });
  return Newton::factorize(symmetric);
}

// By refinements: what G a misses of Y^T z is the next right side.
void Interior::solve(double* r, double* a, double* G_a) const {
  std::fill_n(a, x.rows, 0.0);
  for (int k = 0; k <= tuning::newton::refinements; ++k) {
    G.clear();
    Newton::for_each([&](const Block& b, const State& s, Index constraint) {
      G.by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
        double by[rows];
        apply<rows>(s, r + b.first, by), G.scatter<rows>(constraint, by);
      });
    });
    factor.solve(w.by_segment);
    Newton::for_each([&](const Block& b, const State& s, Index constraint) {
      G.by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
        double v[rows], by[rows];
        double *left = r + b.first, *to = a + b.first;
        G.gather<rows>(constraint, v);
        for (int i = 0; i < rows; ++i) left[i] -= v[i];
        apply<rows>(s, left, by);
        for (int i = 0; i < rows; ++i) to[i] += by[i], left[i] = v[i] + (k ? G_a[b.first + i] : 0);
      });
    });
    times(a, G_a);
    for (Index i = 0; i < x.rows; ++i) r[i] -= G_a[i];
  }
}

void Interior::start() {
  const double shift = inside * std::sqrt(error().own / x.rows);
  path.start_inside(shift, shift), velocities(y, c);
}

// Newton's method from here; if it fails, the iterate is restored.
bool Interior::newton_refine(Index most, dynContactReport& report) {
  std::copy_n(y, x.rows, y_here), std::copy_n(c, x.rows, c_here);
  if (Newton::run(most, 0, report)) return true;
  std::copy_n(y_here, x.rows, y), std::copy_n(c_here, x.rows, c);
  return false;
}

bool Interior::run(dynContactReport& report) {
  start();
  double tried = HUGE_VAL;
  for (Index k = 0; k < solver::tuning::interior::max_steps && x.within_budget(report) && step(report); ++k) {
    const Error now = error();
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
