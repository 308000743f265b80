// Two capsules: the nearest points of two segments.
// Source: Ericson, Real-Time Collision Detection, 2005, 5.1.9, with both clamped solutions compared.
#pragma once

#include "dyn/collision/convex_pair.hpp"
#include "dyn/shape/capsule.hpp"

namespace dyn::collision {

// Points s u and c + t v, |s| <= hs, |t| <= ht, u and v unit vectors.
struct SegmentPair {
  double s, t;
  bool parallel;  // and overlapping: other points are as near
};

inline SegmentPair nearest_on_segments(const Vec& u, double hs, const Vec& c, const Vec& v, double ht) {
  const Vec n = cross(u, v);
  const double uv = dot(u, v), uc = dot(u, c), vc = dot(v, c), nn = dot(n, n);
  SegmentPair p = {0, 0, false};
  if (nn <= 1e-20) {
    // the middle of the overlap, in coordinates along u
    const double low = std::max(-hs, uc - ht), high = std::min(hs, uc + ht);
    p.s = std::clamp((low + high) / 2, -hs, hs);
    p.parallel = low < high;
  } else {
    p.s = std::clamp(dot(cross(c, v), n) / nn, -hs, hs);
  }
  p.t = std::clamp(p.s * uv - vc, -ht, ht);
  p.s = std::clamp(p.t * uv + uc, -hs, hs);
  return p;
}

inline Cores capsule_pair(const shape::Capsule& a, const shape::Capsule& b, const Pose& X) {
  const Vec z = shape::axis(2);
  const SegmentPair p = nearest_on_segments(z, a.half, X.p, X.R.z, b.half);
  const Vec pa = z * p.s, pb = X.p + X.R.z * p.t, r = pb - pa;
  const double d = shape::norm(r);
  if (d > 1e-15 * (a.half + b.half)) return {r * (1 / d), pa, pb, d, 0, 0, !p.parallel};
  // the segments cross: either side across both is as good
  const Vec n = cross(z, X.R.z);
  const double sine = shape::norm(n);
  return {sine > 0 ? n * (1 / sine) : shape::axis(0), pa, pb, 0, 0, 0, false};
}

}  // namespace dyn::collision
