// Smoothed projections onto bounds and onto second-order cones that are their own duals, |t| <= n, and their derivatives:
//   P(z) = sum g(z_i) e_i,  g(z) = (z + sqrt(z^2 + 4 eps^2)) / 2
// over the spectral decomposition of z (Chen and Harker 1993; Kanzow 1996; Fukushima, Luo and Tseng 2002).
#pragma once

#include "solver/block.hpp"

namespace dyn::solver {

struct Smoothed {
  double eps;

  struct Bounded {
    double value, slope;
  };
  // (normal, along t / |t|); d normal / d n = d along / d |t|: own; d normal / d |t|: mixed; along / |t|: across
  struct Projected {
    double direction[Block::max_rows - 1];
    double normal, along, own, mixed, across;
  };

  double plus(double z) const { return (z + std::sqrt(z * z + 4 * eps * eps)) / 2; }
  double slope(double z) const { return (1 + z / std::sqrt(z * z + 4 * eps * eps)) / 2; }
  Bounded bounded(double z, double lower, double upper) const {
    Bounded out{z, 1};
    if (!std::isinf(lower)) out = {lower + plus(z - lower), slope(z - lower)};
    if (!std::isinf(upper)) out.value -= plus(z - upper), out.slope -= slope(z - upper);
    return out;
  }
  DYN_INLINE Projected cone(const double* z, Index rows) const {
    Projected out;
    const double length = norm(z + 1, rows - 1);
    for (Index i = 1; i < rows; ++i) out.direction[i - 1] = length > 0 ? z[i] / length : i == 1;
    const double low = z[0] - length, high = z[0] + length, a = plus(low), b = plus(high);
    const double low_slope = slope(low), high_slope = slope(high);
    out.normal = (a + b) / 2, out.along = (b - a) / 2;
    out.own = (high_slope + low_slope) / 2, out.mixed = (high_slope - low_slope) / 2;
    out.across = length > tuning::epsilon * high ? out.along / length : out.own;
    return out;
  }
};

}  // namespace dyn::solver
