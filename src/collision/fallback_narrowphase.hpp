// Interface of a fallback method for overlapping shapes. The caller passes it in the options, because it may allocate
// (src/collision/ccd). Its result is verified before use.
#pragma once

#include "shape/shape.hpp"

namespace dyn::collision {

// Overlap found by another engine, in the world. Moved by depth along the normal, B just touches A at the position.
struct FallbackResult {
  shape::Vec normal, position;
  double depth;
};

// Returns false if no overlap was found.
using FallbackMethod = bool (*)(const shape::Shape& a, const shape::Pose& X_WA, const shape::Shape& b, const shape::Pose& X_WB,
                                double tolerance, FallbackResult& out);

}  // namespace dyn::collision
