// Projected block Gauss-Seidel: each block is solved exactly for the current impulses of the others.
// Operator: a Delassus operator G with
//   block(k)                   the block
//   velocity<rows>(k, y, c)    c = G y + g of block k, whose own impulses are y
//   change<rows>(k, by)        the impulses of block k change
//   set_cone(k, cone)          the cone of block k, if blocks may be without theirs
#pragma once

#include "solver/block.hpp"

namespace dyn::solver {

// One bounded row. Returns the change of its velocity by its own impulse.
template <int rows, class Operator>
DYN_INLINE double sweep_row(const Operator& G, const Block& s, Index k, Index r, double omega, double* y) {
  double c[rows], by[rows] = {};
  G.template velocity<rows>(k, y, c);
  const double to = std::clamp(y[r] - omega * s.response[r] * c[r], s.lower, s.upper);
  by[r] = to - y[r];
  if (by[r] == 0) return 0;
  y[r] = to;
  G.template change<rows>(k, by);
  return std::abs(by[r]) * s.per_speed[r];
}

// A friction cone; own solves its block. Returns the largest change of a row's velocity by its own impulse.
template <int rows, class Operator, class Cone>
DYN_INLINE double sweep_cone(const Operator& G, const Block& s, Cone& own, Index k, double omega, double* y) {
  double b[rows], to[rows], by[rows], most = 0;
  G.template velocity<rows>(k, y, b);
  own.template leave_out<rows>(y, b);
  own.solve(s.mu, b, to);
  if (omega != 1) {
    for (int i = 0; i < rows; ++i) to[i] = (1 - omega) * y[i] + omega * to[i];
    project_cone(s.mu, rows, to, to);
  }
  for (int i = 0; i < rows; ++i) {
    by[i] = to[i] - y[i], y[i] = to[i];
    most = std::max(most, std::abs(by[i]) * s.per_speed[i]);
  }
  if (most > 0) G.template change<rows>(k, by);
  return most;
}

// One sweep over all blocks, over-relaxed by omega. Returns the largest change of a row's velocity by its own impulse.
template <class Operator>
double sweep(const Operator& G, double omega, double* y) {
  double most = 0;
  for (Index k = 0; k < G.size(); ++k) {
    Block& s = G.block(k);
    double* const own = y + s.first;
    if (s.kind == Block::Kind::point) most = std::max(most, sweep_cone<3>(G, s, s.point, k, omega, own));
    else
      with_row_count(s.rows, [&]<int rows>() {
        if (s.kind == Block::Kind::cone) {
          if constexpr (requires(LocalCone c) { G.set_cone(k, c); })
            if (!s.cone) {
              LocalCone cone;
              G.set_cone(k, cone);
              return void(most = std::max(most, sweep_cone<rows>(G, s, cone, k, omega, own)));
            }
          most = std::max(most, sweep_cone<rows>(G, s, *s.cone, k, omega, own));
        } else
          for (Index r = 0; r < rows; ++r) most = std::max(most, sweep_row<rows>(G, s, k, r, omega, own));
      });
  }
  return most;
}

}  // namespace dyn::solver
