// Roll, pitch and yaw about fixed axes: R = Rz(yaw) Ry(pitch) Rx(roll), as in URDF.
#pragma once

#include "base/portable.hpp"
#include "spatial/mat3.hpp"

namespace dyn {

inline Mat3<double> rotation_of_rpy(double roll, double pitch, double yaw) {
  const double cr = math::cos(roll), sr = math::sin(roll), cp = math::cos(pitch), sp = math::sin(pitch), cy = math::cos(yaw),
               sy = math::sin(yaw);
  return {Vec3<double>::make(cy * cp, sy * cp, -sp),
          Vec3<double>::make(cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr),
          Vec3<double>::make(cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr)};
}

// Pitch in [-pi/2, pi/2]. At its ends roll and yaw turn about one axis: roll is 0 there.
inline Vec3<double> roll_pitch_yaw(const Mat3<double>& R) {
  const double level = math::hypot(R(0, 0), R(1, 0));
  const double roll = level < 1e-12 ? 0 : math::atan2(R(2, 1), R(2, 2)), c = math::cos(roll), s = math::sin(roll);
  // yaw from R Rx(-roll): the angles fit each other where cos(pitch) is small. Adding 0 makes -0 to 0.
  return Vec3<double>::make(roll, math::atan2(-R(2, 0), level),
                            math::atan2(s * R(0, 2) - c * R(0, 1), c * R(1, 1) - s * R(1, 2))) +
         Vec3<double>::zero();
}

}  // namespace dyn
