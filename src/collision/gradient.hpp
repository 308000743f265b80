// Derivative of the distance by the motion of the shapes. By the envelope theorem (Danskin 1967) only the motion of the witness
// points along the normal counts:
//   d(distance) = n.(v_B + w_B x (p_b - o_B)) - n.(v_A + w_A x (p_a - o_A))
// o are the origins of the shapes' frames, v and w their linear and angular velocities in world axes. It holds apart, touching
// and penetrating where Result::unique is true. Elsewhere the distance has a kink, and this is a one-sided slope.
#pragma once

#include "collision/result.hpp"
#include "spatial/motion.hpp"

namespace dyn::collision {

// Covectors on the velocities [linear; angular] of both frames, LOCAL_WORLD_ALIGNED.
struct Gradient {
  Force<double> a, b;
};

inline Gradient gradient(const Result& r, const Vec& origin_a, const Vec& origin_b) {
  return {{-r.normal, cross(r.point_a - origin_a, -r.normal)}, {r.normal, cross(r.point_b - origin_b, r.normal)}};
}

}  // namespace dyn::collision
