// Distance of any two convex shapes: GJK for separated cores, EPA for overlapping ones, Newton's method on the normal for curved
// shapes. The residual is a measured bound: the distance of the witness points less the bound by the supporting planes.
#pragma once

#include "collision/analytic/deepest_point.hpp"
#include "collision/epa.hpp"
#include "collision/gjk.hpp"
#include "collision/newton_refine.hpp"

namespace dyn::collision {

// Cores that a direction separates by more than their reach. The distance is a lower bound.
inline Cores beyond(const Vec& normal, double distance) { return {normal, Vec::zero(), Vec::zero(), distance, 0, 0, false}; }

// Returns whether the line between the shapes' origins separates the cores by more than their reach.
template <class D>
DYN_INLINE bool apart_along_centers(const D& d, Cores& c) {
  const Vec& p = d.X.p;
  if (!(d.reach < shape::infinity) || !(dot(p, p) > d.reach * d.reach)) return false;
  const double square = dot(p, p), gap = -dot(p, d.support(p).w);
  if (!(gap > 0 && gap * gap > d.reach * d.reach * square)) return false;
  const double length = std::sqrt(square);
  c = beyond(p * (1 / length), gap / length);
  return true;
}

// Required accuracy of the distance, m.
template <class D>
inline double wanted(const D& d, const Options& options) {
  return options.tolerance * d.small + d.rounding();
}

// guess: point of A minus point of B
template <class D>
inline Cores cores(const D& d, const Vec& guess, EpaWorkspace& workspace, const Options& options) {
  const double enough = wanted(d, options);
  Refined p{};
  bool refined = false, overlap = false;  // overlap: Newton's method found a normal of overlapping shapes
  bool is_beyond = false;
  Cores deepest;
  bool is_deepest = false;
  auto finish = [&](const GjkResult& g) {
    // separated: the witness points give an upper bound, the supporting plane a lower one
    const Vec n = g.v * (-1 / g.norm);
    if constexpr (D::curved) {
      if (overlap) return false;
      const bool found = on_face(d, n, p) || newton_refine(d, g.simplex.p, g.simplex.weight, g.simplex.size, n, enough, p);
      const double between = shape::norm(p.b - p.a);
      if (found && d.is_beyond(p.distance)) return is_beyond = true;
      refined = found && p.distance > -enough && between - p.distance <= enough;
      overlap = found && p.distance <= -enough;
      if (overlap) return is_deepest = deepest_point_pair(d, p.normal, deepest);
    }
    // a result off its normal may improve when GJK has come closer
    return refined && p.unique;
  };
  GjkResult g = gjk(d, guess, options, finish);
  if (is_beyond) return beyond(p.normal, p.distance);
  if (!is_deepest && g.beyond) return beyond(g.v * (-1 / g.norm), g.norm - g.gap);
  if (!is_deepest && !refined && g.apart && g.gap > options.accepted * d.small) {
    // GJK stalled by rounding: start again from another direction
    const GjkResult other = gjk(d, shape::across(g.v * (1 / g.norm)), options, finish);
    if (!other.apart || other.gap < g.gap) g = other;
  }
  if (D::curved && !is_deepest && g.apart && !(refined && p.unique)) overlap = false, finish(g);
  if (is_deepest) return deepest;
  if (refined) return {p.normal, p.a, p.b, p.distance, p.residual, g.iterations, p.unique};
  // on a curved pair a gap g leaves the normal uncertain by sqrt(g)
  auto certain = [&](double gap, double radius) { return !D::curved || gap <= 1e-14 * radius; };
  if (g.apart)
    return {g.v * (-1 / g.norm), g.simplex.point_a(), g.simplex.point_b(), g.norm, g.gap, g.iterations, certain(g.gap, g.norm)};
  if (!overlap && deepest_point_pair(d, -guess, deepest)) return deepest;
  const EpaResult e = epa(d, g.simplex, workspace, options);
  return {e.normal,
          e.a,
          e.b,
          -e.upper,
          e.residual,
          g.iterations + e.iterations,
          e.unique && (e.refined || certain(e.residual, d.small))};
}

// From cores to rounded shapes, in the frame of A.
inline Result rounded(const Cores& c, double radius_a, double radius_b, double size, const Options& options) {
  Result r;
  r.from_fallback = false;
  r.normal = c.normal, r.iterations = c.iterations, r.unique = c.unique, r.residual = c.residual;
  r.distance = c.distance - radius_a - radius_b;
  r.point_a = c.a + c.normal * radius_a, r.point_b = c.b - c.normal * radius_b;
  const double touching = options.touching * size;
  r.status = !(c.residual <= std::max(options.accepted, options.tolerance) * size) ? Status::Failed
             : r.distance > touching                  ? Status::Separated
             : r.distance >= -touching                ? Status::Touching
                                                      : Status::Penetrating;
  return r;
}

template <class A, class B>
inline Cores convex_pair(const Difference<A, B>& d, EpaWorkspace& workspace, const Options& options) {
  return cores(d, -d.X.p, workspace, options);
}

}  // namespace dyn::collision
