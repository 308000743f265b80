// What a query between two shapes answers.
#pragma once

#include "collision/fallback_narrowphase.hpp"

namespace dyn::collision {

using shape::Mat;
using shape::Pose;
using shape::Vec;

enum class Status : Index {
  Separated,
  Touching,     // |distance| within the tolerance of zero
  Penetrating,
  Failed,       // no answer within `accepted` of the truth was found; the best one is given, with its residual
};

// Normal and points are in the world. The distance is signed: below zero it is the depth, the length of the shortest translation that
// parts the two, and that translation of B is along the normal. point_b - point_a = distance normal.
struct Result {
  Status status;
  bool from_fallback;  // found by the second method
  bool unique;  // no other pair of points, and no other normal, is as good: the distance is differentiable (gradient.hpp)
  Index iterations;
  double distance;
  double residual;  // bound on the error of the distance: apart, between a lower and an upper bound of it
  Vec normal;       // unit, from A to B
  Vec point_a, point_b;
};

// Tolerances are relative to the size of the smaller shape.
struct Options {
  double tolerance = 1e-10;  // wanted
  double accepted = 1e-6;    // beyond: Failed
  double touching = 1e-9;
  Index max_iterations = 128;
  FallbackMethod fallback = nullptr;  // asked when the answer fails, or
  bool fallback_first = false;      // first, of pairs without a closed form that overlap
};

}  // namespace dyn::collision
