// Newton's method for the separating normal of curved shapes. The signed distance is the largest of f(n) = -h(n) over unit normals n,
// with h the support function of D = A - B and s(n) its support point: f = -n.s. On the sphere the gradient of f is the part of -s
// across n, its second derivative -(H + f 1), H the curvature of h. Where a straight feature touches, h has a kink and this fails.
#pragma once

#include "dyn/collision/difference.hpp"

namespace dyn::collision {

struct Polished {
  Vec normal;
  Vertex top;         // support point along the normal
  double distance;    // f
  double slope;       // |gradient|: how far the witness points lie apart across the normal
  bool maximum;       // the second derivative is negative
};

// From a normal close to the solution. It never ends with a larger slope than it began with.
template <class D>
inline Polished polish(const D& d, const Vec& normal, double wanted) {
  auto at = [&](const Vec& n) {
    Polished p = {n, d.support(n), 0, 0, false};
    p.distance = -dot(n, p.top.w);
    p.slope = shape::norm(p.top.w + n * p.distance);
    return p;
  };
  Polished best = at(normal);
  for (int i = 0; i < 8 && (best.slope > wanted || !best.maximum); ++i) {
    const Vec n = best.normal, u = shape::across(n), v = cross(n, u);
    const Sym3<double> H = d.curvature(n);
    const Vec Hu = H * u, Hv = H * v;
    const double a = dot(u, Hu) + best.distance, b = dot(u, Hv), c = dot(v, Hv) + best.distance, det = a * c - b * b;
    best.maximum = det > 0 && a + c > 0;
    if (!best.maximum || best.slope <= wanted) break;
    const double gu = -dot(u, best.top.w), gv = -dot(v, best.top.w);
    const Vec step = n + u * ((c * gu - b * gv) / det) + v * ((a * gv - b * gu) / det);
    const Polished next = at(step * (1 / shape::norm(step)));
    if (!(next.slope < best.slope)) break;
    best = next;
  }
  return best;
}

}  // namespace dyn::collision
