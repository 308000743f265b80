// Applied wrenches on a body, summed so that memory does not depend on their number.
#pragma once

#include "spatial/mat3.hpp"
#include "spatial/motion.hpp"

namespace dyn {

// Bits of Data::acting beside DYN_EFFECT_... The second: dry friction of joints is rows, as an MJCF file has it
// (simulation/compliant_rows.cpp), instead of the law of effect/friction.hpp.
inline constexpr unsigned acting_wrenches = 1u << 31, acting_friction_rows = 1u << 30;

template <class T>
struct AppliedWrench {
  Force<T> local;    // body axes, at its origin
  Force<T> aligned;  // world axes: forces, and moments that came with points of application
  Mat3<T> arm;       // sum of point force^T (body axes by world axes): the moment is that of R arm
  Force<T> world;    // world axes, moment about the world's origin

  static DYN_INLINE AppliedWrench none() {
    const Force<T> zero{Vec3<T>::zero(), Vec3<T>::zero()};
    return {zero, zero, {Vec3<T>::zero(), Vec3<T>::zero(), Vec3<T>::zero()}, zero};
  }
  // Returns the sum in world axes at the body's origin p.
  DYN_INLINE Force<T> at(const Mat3<T>& R, const Vec3<T>& p) const {
    const Mat3<T> B = R * arm;
    const Vec3<T> moment = Vec3<T>::make(B(1, 2) - B(2, 1), B(2, 0) - B(0, 2), B(0, 1) - B(1, 0));
    return {R * local.linear + aligned.linear + world.linear,
            R * local.angular + aligned.angular + moment + world.angular - cross(p, world.linear)};
  }
};

}  // namespace dyn
