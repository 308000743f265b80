#include "simulation/smoothing.hpp"

namespace dyn::simulation {

using namespace solver::tuning::smoothing;
using solver::Progress;

bool Smoothing::factorize() {
  std::fill_n(w.newton_acts, e.size, false);
  for_each([&](const Block&, const State& s, Index k) {
    if (s.acts) activate(k);
  });
  return factorize_laws(false);
}

// (1 + Y K Y^T) z = Y left,  dy = left - K Y^T z
void Smoothing::solve(const double* of, double* step, double* G_step) const {
  G.clear();
  for_each([&](const Block& b, const State&, Index k) {
    solver::by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA { G.scatter<rows>(k, of + b.first); });
  });
  factor.solve(w.by_segment);
  for_each([&](const Block& b, const State& s, Index k) {
    solver::by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
      double v[rows], by[rows] = {};
      G.gather<rows>(k, v);
      if (s.acts) apply<rows>(s, v, by);
      for (int i = 0; i < rows; ++i) step[b.first + i] = of[b.first + i] - by[i];
    });
  });
  times(step, G_step);
}

void Smoothing::run(Index max_steps, dynContactReport& report) {
  w.limit.expect(solver::TimeLimit::Unit::Segments, x.rows);
  std::copy_n(before, x.rows, y), candidate(y), velocities(y, c);
  const auto may_step = [&] { return x.within_budget(report) && ++report.newton_steps; };
  std::copy_n(y, x.rows, best), least = report.residual = residual(best);
  double mark = least, first = 0;  // first: eps
  int idle = 0;
  const auto accept = [&] {
    first = std::max(first, path.smooth.eps);
    if (take(report) <= x.tolerance) return Progress::solved;
    if (least < stall_progress * mark) mark = least, idle = 0;
    else ++idle;
    return x.large() && path.smooth.eps < stall_eps * first && idle >= stall_steps ? Progress::stuck : Progress::going;
  };
  path.run(max_steps, may_step, accept);
  G.write(best);
}

}  // namespace dyn::simulation
