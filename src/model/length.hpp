// A model's own unit of length: thresholds and bounds are this many of it, so that results do not depend on whether lengths are
// in metres.
#pragma once

#include <cmath>

#include "model/model.hpp"

namespace dyn {

// Five times the mean of what the bodies' inertias say of their sizes, sqrt(tr I / m): about 1 for cubes of 0.3 m; of points that
// turn nothing 1.
inline double own_length(const Model& m) {
  double sum = 0;
  Index count = 0;
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    const double square = b.m > 0 ? (b.I(0, 0) + b.I(1, 1) + b.I(2, 2)) / b.m : 0;
    if (square > 0) sum += std::sqrt(square), ++count;
  }
  return count ? 5 * sum / double(count) : 1;
}

}  // namespace dyn
