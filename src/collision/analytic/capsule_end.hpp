// A segment apart from a convex shape whose nearest point has a closed form. The distance is convex along the segment. If it does
// not decrease from an end inward, that end is nearest.
#pragma once

#include "collision/convex_pair.hpp"

namespace dyn::collision {

// A: a segment of length 2 half along z. Returns false if neither end is certain, or the gap is too small.
template <class D>
inline bool capsule_end_pair(const D& d, double half, Cores& c) {
  const Vec across = d.Rt.z * half, center = d.X.act_inverse(Vec::zero());  // of the segment, in B
  // first the end nearer to B's origin
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
