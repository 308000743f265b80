// A second method for overlapping shapes, kept apart from the core: a function that the caller hands in with the options, for it may
// allocate (src/collision/ccd). What it finds is measured before it is believed.
#pragma once

#include "shape/shape.hpp"

namespace dyn::collision {

// An overlap as another engine sees it: moved by depth along the normal, B just touches A at the position. In the world.
struct FallbackResult {
  shape::Vec normal, position;
  double depth;
};

// false: it finds no overlap, or nothing at all
using FallbackMethod = bool (*)(const shape::Shape& a, const shape::Pose& X_WA, const shape::Shape& b, const shape::Pose& X_WB, double tolerance,
                              FallbackResult& out);

}  // namespace dyn::collision
