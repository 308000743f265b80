// A segment apart from a convex shape whose nearest point is known in closed form. The distance along the segment is convex: where it
// does not fall from an end on, that end is the nearest.
#pragma once

#include "collision/convex_pair.hpp"

namespace dyn::collision {

// A: a segment of length 2 half about z. false: neither end is surely the nearest, or the two are not clearly apart.
template <class D>
inline bool capsule_end_pair(const D& d, double half, Cores& c) {
  const Vec across = d.Rt.z * half, center = d.X.act_inverse(Vec::zero());  // of the segment, in B
  // first the end that is nearer to B's origin
  const double first = dot(across, center) > 0 ? -1 : 1;
  for (const double end : {first, -first}) {
    const shape::Nearest near = d.B_.nearest(center + across * end);
    if (near.distance <= 1e-6 * d.small) return false;
    if (-end * dot(near.normal, across) <= 1e-6 * half) continue;
    c = {d.X.R * -near.normal, shape::axis(2) * (half * end), d.X.act(near.point), near.distance, 0, 0, near.unique};
    return true;
  }
  return false;
}

}  // namespace dyn::collision
