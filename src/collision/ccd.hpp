// Fallback method: GJK and EPA of libccd (github.com/danfis/libccd). libccd allocates and has no distance for separated shapes.
// The library is opened on first use and is optional.
#pragma once

#include "collision/fallback_narrowphase.hpp"

namespace dyn::collision {

bool ccd_available();
bool ccd_overlap(const shape::Shape& a, const shape::Pose& X_WA, const shape::Shape& b, const shape::Pose& X_WB, double tolerance,
                 FallbackResult& out);

}  // namespace dyn::collision
