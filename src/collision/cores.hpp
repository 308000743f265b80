// Result of a query for the cores of two shapes, without their rounding.
#pragma once

#include "collision/difference.hpp"

namespace dyn::collision {

// Result for the cores, in the frame of A.
struct Cores {
  Vec normal, a, b;
  double distance, residual;
  Index iterations;
  bool unique;
};

}  // namespace dyn::collision
