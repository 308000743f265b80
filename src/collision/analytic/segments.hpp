// The nearest points of two segments.
// Source: Ericson, Real-Time Collision Detection, 2005, 5.1.9, with both clamped solutions compared.
#pragma once

#include "shape/shape.hpp"

namespace dyn::collision {

using shape::Vec;

// Nearest points s u and c + t v with |s| <= hs, |t| <= ht, u and v unit vectors.
struct SegmentPair {
  double s, t;
  bool parallel;  // and overlapping: other points are as near
};

inline SegmentPair nearest_on_segments(const Vec& u, double hs, const Vec& c, const Vec& v, double ht) {
  const Vec n = cross(u, v);
  const double uv = dot(u, v), uc = dot(u, c), vc = dot(v, c), nn = dot(n, n);
  SegmentPair p = {0, 0, false};
  if (nn <= 1e-20) {
    // middle of the overlap, in coordinates along u
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

}  // namespace dyn::collision
