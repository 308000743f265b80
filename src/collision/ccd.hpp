// Fallback method: GJK and EPA of libccd (github.com/danfis/libccd). libccd allocates and has no distance for separated shapes.
// The library is opened on first use and is optional.
#pragma once

#include "collision/fallback_narrowphase.hpp"

namespace dyn::collision {

#if DYN_NO_HOST  // boards do without
inline bool ccd_available() { return false; }
inline constexpr decltype(Options::fallback) ccd_overlap = nullptr;
#else
bool ccd_available();
bool ccd_overlap(const shape::Shape& a, const shape::Pose& X_WA, const shape::Shape& b, const shape::Pose& X_WB, double tolerance,
                 FallbackResult& out);
#endif

}  // namespace dyn::collision
