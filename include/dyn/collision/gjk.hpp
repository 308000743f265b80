// The distance of two convex cores apart: the point of D = A - B nearest to the origin, by the iteration of Gilbert, Johnson, Keerthi
// (IEEE J. Robotics Automation 4(2), 1988). v is the nearest point of a simplex of D: |v| bounds the distance from above, and the
// support point w in the direction -v bounds it from below by v.w / |v|. The two meet.
#pragma once

#include "dyn/collision/simplex.hpp"

namespace dyn::collision {

struct GjkResult {
  Simplex simplex;
  Vec v;         // apart: nearest point of D
  double norm;   // |v|
  double gap;    // upper less lower bound
  Index iterations;
  bool apart;    // otherwise the cores meet, or almost
};

// v: a guess of A's point less B's. finish(result) may end it early, once the bounds are close, and again whenever they are a hundred
// times closer.
template <class D, class Finish>
inline GjkResult gjk(const D& difference, Vec v, const Options& options, Finish&& finish) {
  GjkResult r;
  Simplex& s = r.simplex;
  const double rounding = difference.rounding();
  const double wanted = options.tolerance * difference.small + rounding, contact = 1e-10 * difference.small + rounding;
  if (dot(v, v) == 0) v = shape::axis(0);
  double close = 1e-1 * difference.small;
  s.size = 1, s.weight[0] = 1, s.p[0] = difference.support(-v);
  r.v = s.p[0].w;
  double vv = dot(r.v, r.v);
  for (r.iterations = 1;; ++r.iterations) {
    r.norm = std::sqrt(vv);
    r.apart = r.norm > contact;
    if (!r.apart) return r;
    const Vertex p = difference.support(-r.v);
    r.gap = r.norm - dot(r.v, p.w) / r.norm;
    if (r.gap <= wanted || r.iterations >= options.max_iterations) return r;
    if (r.gap <= close) {
      if (finish(r)) return r;
      close = r.gap * 1e-2;
    }
    const Simplex before = s;
    s.p[s.size++] = p;
    Vec next;
    if (!reduce(s, next)) {
      r.apart = false;
      return r;
    }
    const double nn = dot(next, next);
    if (nn >= vv) {  // rounding: no nearer
      s = before;
      return r;
    }
    r.v = next, vv = nn;
  }
}

}  // namespace dyn::collision
