// Distance of two separated convex cores by the iteration of Gilbert, Johnson, Keerthi (IEEE J. Robotics Automation 4(2), 1988).
// v is the nearest point of a simplex of D = A - B to the origin. |v| bounds the distance from above. The support point w along
// -v bounds it from below by v.w / |v|.
#pragma once

#include "collision/simplex.hpp"

namespace dyn::collision {

struct GjkResult {
  Simplex simplex;
  Vec v;         // nearest point of D, if apart
  double norm;   // |v|
  double gap;    // upper bound less lower bound
  Index iterations;
  bool apart;    // false: the cores overlap or touch
  bool beyond;   // the lower bound exceeds D's reach: no more is known
};

// guess: point of A minus point of B. finish(result) is called when the bounds are close, and again each time they are 100 times
// closer. GJK ends when it returns true, or when a direction separates the cores by more than their reach.
template <class D, class Finish>
inline GjkResult gjk(const D& difference, Vec guess, const Options& options, Finish&& finish) {
  const double rounding = difference.rounding();
  const double wanted = options.tolerance * difference.small + rounding, contact = 1e-10 * difference.small + rounding;
  double close = 0.03 * difference.small;
  GjkResult r, best;
  best.gap = shape::infinity;
  Simplex& s = r.simplex;
  r.beyond = best.beyond = false;
  s.size = 1, s.weight[0] = 1, s.p[0] = difference.support(dot(guess, guess) > 0 ? -guess : shape::axis(0));
  r.v = s.p[0].w;
  double vv = dot(r.v, r.v);
  int stalled = 0;
  for (r.iterations = 1;; ++r.iterations) {
    r.norm = std::sqrt(vv);
    r.apart = r.norm > contact;
    if (!r.apart) return r;
    const Vertex p = difference.support(-r.v);
    r.gap = r.norm - dot(r.v, p.w) / r.norm;
    if (difference.is_beyond(r.norm - r.gap)) return r.beyond = true, r;
    if (r.gap <= wanted) return r;
    if (r.iterations >= options.max_iterations || stalled > 3) return r.gap < best.gap ? r : best;
    if (r.gap <= close) {
      if (finish(r)) return r;
      close = r.gap * 1e-2;
    }
    if (stalled > 0 && r.gap < best.gap) best = r;
    s.p[s.size++] = p;
    if (!reduce(s, r.v)) {
      r.apart = false;
      return r;
    }
    // rounding hides progress of |v|, while the direction may still improve
    const double nn = dot(r.v, r.v);
    stalled += nn >= vv;
    vv = nn;
  }
}

}  // namespace dyn::collision
