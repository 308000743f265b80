// How a geom that tendons wrap around stands for a frame, in files that are read and written.
#pragma once

#include <cmath>
#include <string>

#include "spatial/se3.hpp"

namespace dyn::load {

inline constexpr int group_of_wraps = 5;      // of massless visual geoms that stand for the frame of a site and are no shapes
inline constexpr double same_pose = 1e-9;     // m and differences of axes
inline constexpr const char* wrap_ending = "_wrap";

inline bool is_same_pose(const SE3<double>& a, const SE3<double>& b) {
  const auto far = [](const Vec3<double>& x) { return std::sqrt(dot(x, x)); };
  return far(a.p - b.p) + far(a.R.x - b.R.x) + far(a.R.y - b.R.y) + far(a.R.z - b.R.z) < same_pose;
}

// Whether a frame of this name may be that of a geom of that name.
inline bool wraps_as(const std::string& geom, const std::string& frame) {
  return frame == geom || frame.starts_with(geom + wrap_ending);
}

}  // namespace dyn::load
