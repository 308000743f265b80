// How the distance changes when the shapes move: by the theorem of the envelope (Danskin 1967) only the motion of the witness points
// along the normal counts,
//   d(distance) = n.(v_B + w_B x (p_b - o_B)) - n.(v_A + w_A x (p_a - o_A)),
// with o the origins of the shapes' frames, v their velocities and w the angular ones, in the world's axes. It holds apart, touching and
// penetrating, where Result::unique says that the witness points and the normal are the only ones. Where they are not, the distance has a
// kink, and this is one of its one-sided slopes.
#pragma once

#include "collision/result.hpp"
#include "spatial/motion.hpp"

namespace dyn::collision {

// A covector on velocities [linear; angular] of each frame: LOCAL_WORLD_ALIGNED.
struct Gradient {
  Force<double> a, b;
};

inline Gradient gradient(const Result& r, const Vec& origin_a, const Vec& origin_b) {
  return {{-r.normal, cross(r.point_a - origin_a, -r.normal)}, {r.normal, cross(r.point_b - origin_b, r.normal)}};
}

}  // namespace dyn::collision
