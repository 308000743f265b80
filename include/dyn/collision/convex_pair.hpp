// Any two convex shapes: GJK when their cores are apart, EPA when they meet, Newton's method on the normal to finish where shapes are
// curved. The answer is measured before it is given: its residual is the gap between the distance of its witness points and the lower
// bound that the supporting planes of its normal give.
#pragma once

#include "dyn/collision/epa.hpp"
#include "dyn/collision/gjk.hpp"
#include "dyn/collision/polish.hpp"

namespace dyn::collision {

// Of the cores, in the frame of A.
struct Cores {
  Vec normal, a, b;
  double distance, residual;
  Index iterations;
  bool unique;
};

template <class D>
inline Cores apart(const D& d, const GjkResult& g, const Options& options) {
  const double wanted = options.tolerance * d.small + d.rounding();
  Cores c = {g.v * (-1 / g.norm), g.simplex.point_a(), g.simplex.point_b(), g.norm, g.gap, g.iterations, true};
  if constexpr (D::curved) {
    const Polished p = polish(d, c.normal, wanted * 1e-2);
    const double gap = std::sqrt(p.distance * p.distance + p.slope * p.slope) - p.distance;
    if (p.distance > 0 && gap < c.residual) c.normal = p.normal, c.a = p.top.a, c.b = p.top.b, c.distance = p.distance, c.residual = gap;
  }
  c.unique = !d.parallel(c.normal);
  return c;
}

template <class D>
inline Cores meeting(const D& d, const Simplex& s, EpaWorkspace& workspace, const Options& options, Index iterations) {
  const EpaResult e = epa(d, s, workspace, options);
  const double wanted = options.tolerance * d.small + d.rounding();
  Cores c = {e.normal, e.a, e.b, -e.upper, e.upper - e.lower, iterations + e.iterations, e.unique};
  if constexpr (D::curved) {
    const Polished p = polish(d, c.normal, wanted * 1e-2);
    if (p.maximum && p.slope <= wanted && p.distance >= c.distance - wanted) {
      c.normal = p.normal, c.a = p.top.a, c.b = p.top.b, c.distance = p.distance, c.residual = std::max(0.0, -p.distance - e.lower);
    }
  }
  c.unique = c.unique && !d.parallel(c.normal);
  return c;
}

// of the rounded shapes, in the frame of A
inline Result rounded(const Cores& c, double radius_a, double radius_b, double size, const Options& options) {
  Result r;
  r.normal = c.normal, r.iterations = c.iterations, r.unique = c.unique, r.residual = c.residual;
  r.distance = c.distance - radius_a - radius_b;
  r.point_a = c.a + c.normal * radius_a, r.point_b = c.b - c.normal * radius_b;
  const double touching = options.touching * size;
  r.status = !(c.residual <= options.accepted * size) ? Status::Failed
             : r.distance > touching                  ? Status::Separated
             : r.distance >= -touching                ? Status::Touching
                                                      : Status::Penetrating;
  return r;
}

template <class A, class B>
inline Result convex_pair(const A& a, const B& b, const Pose& X, EpaWorkspace& workspace, const Options& options) {
  const Difference<A, B> d(a, b, X);
  const GjkResult g = gjk(d, -X.p, options);
  const Cores c = g.apart ? apart(d, g, options) : meeting(d, g.simplex, workspace, options, g.iterations);
  return rounded(c, a.radius, b.radius, d.small, options);
}

}  // namespace dyn::collision
