// Two capsules: the nearest points of two segments.
#pragma once

#include "collision/analytic/segments.hpp"
#include "collision/convex_pair.hpp"
#include "shape/capsule.hpp"

namespace dyn::collision {

// p: from A's centre to B's; za, zb: axes of the capsules
inline Cores capsule_pair(const shape::Capsule& a, const shape::Capsule& b, const Vec& za, const Vec& zb, const Vec& p) {
  const SegmentPair s = nearest_on_segments(za, a.half, p, zb, b.half);
  const Vec pa = za * s.s, pb = p + zb * s.t, r = pb - pa;
  const double d = shape::norm(r);
  if (d > 1e-15 * (a.half + b.half)) return {r * (1 / d), pa, pb, d, 0, 0, !s.parallel};
  // the segments cross: both normals are equally good
  const Vec n = cross(za, zb);
  const double sine = shape::norm(n);
  return {sine > 0 ? n * (1 / sine) : shape::across(za), pa, pb, 0, 0, 0, false};
}

}  // namespace dyn::collision
