// Result and options of a query between two shapes.
#pragma once

#include "collision/fallback_narrowphase.hpp"

namespace dyn::collision {

using shape::Mat;
using shape::Pose;
using shape::Vec;

enum class Status : Index {
  Separated,
  Touching,     // |distance| is within the tolerance of zero
  Penetrating,
  Failed,       // the residual exceeds `accepted`; the best result is given
};

// Normal and points are in the world. The distance is negative when overlapping: -distance is the length of the shortest
// separating translation of B, along the normal. point_b - point_a = distance normal.
struct Result {
  Status status;
  bool from_fallback;  // found by the fallback method
  bool unique;  // no other pair of points or normal is as good: the distance is differentiable (gradient.hpp)
  Index iterations;
  double distance;
  double residual;  // bound on the error of the distance; apart: upper less lower bound
  Vec normal;       // unit, from A to B
  Vec point_a, point_b;
};

// Tolerances are relative to the size of the smaller shape.
struct Options {
  double tolerance = 1e-10;  // required
  double accepted = 1e-6;    // larger residuals give Failed
  double touching = 1e-9;
  Index max_iterations = 128;
  bool says_unique = true;  // false: Result::unique is not wanted, and is false
  double max_distance = shape::infinity;  // m: a query may end beyond it, with a lower bound as its distance and other points
  FallbackMethod fallback = nullptr;  // used when the primary method fails, or
  bool fallback_first = false;      // first, for overlapping pairs without a closed form
};

}  // namespace dyn::collision
