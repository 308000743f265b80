// A model's own unit of length: thresholds and bounds are this many of it, so that results do not depend on whether lengths are
// in metres.
#pragma once

#include <cmath>

#include "model/model.hpp"

namespace dyn {

// tr I / m of a body (m^2), or 0.
inline double square_size(const Body& b) { return b.m > 0 ? (b.I(0, 0) + b.I(1, 1) + b.I(2, 2)) / b.m : 0; }

// Five times the mean of what the bodies' inertias say of their sizes, sqrt(tr I / m): about 1 for cubes of 0.3 m; of points that
// turn nothing 1.
inline double own_length(const Model& m) {
  double sum = 0;
  Index count = 0;
  for (Index i = 1; i < m.n.bodies; ++i) {
    const double square = square_size(m.bodies()[i]);
    if (square > 0) sum += std::sqrt(square), ++count;
  }
  return count ? 5 * sum / double(count) : 1;
}

// Its relative change by those of the mass (kg) and tr I (kg m^2) of a body with mass.
inline double own_length_change(const Model& m, const Body& b, double mass, double trace) {
  double sum = 0;
  for (Index i = 1; i < m.n.bodies; ++i) sum += std::sqrt(square_size(m.bodies()[i]));
  const double square = square_size(b);
  return square > 0 ? (trace - square * mass) / (2 * std::sqrt(square) * b.m * sum) : 0;
}

}  // namespace dyn
