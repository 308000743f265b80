// libccd as the second method: its GJK and EPA (github.com/danfis/libccd). It allocates, has no distance for shapes apart, and is opened
// on first use: libdyn does without it.
#pragma once

#include "collision/fallback_narrowphase.hpp"

namespace dyn::collision {

bool ccd_available();
bool ccd_overlap(const shape::Shape& a, const shape::Pose& X_WA, const shape::Shape& b, const shape::Pose& X_WB, double tolerance, FallbackResult& out);

}  // namespace dyn::collision
