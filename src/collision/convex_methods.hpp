// Pairs of convex shapes without a closed form. distance.cpp lists them in its table. Each pair instantiates GJK, EPA and
// Newton's method, so the instances are spread over convex_*.cpp.
#pragma once

#include "collision/analytic/capsule_end.hpp"
#include "collision/analytic/minkowski_segments.hpp"
#include "collision/convex_pair.hpp"
#include "shape/list.hpp"

namespace dyn::collision {

using namespace shape;

// Pose of B in the frame of A. Positions are subtracted first, which keeps precision far from the world's origin.
inline Pose relative(const Pose& A, const Pose& B) {
  const Mat Rt = transpose(A.R);
  return {Rt * B.R, Rt * (B.p - A.p)};
}
// From the frame of A to the world.
inline Result in_world(Result r, const Pose& XA) {
  r.normal = XA.R * r.normal, r.point_a = XA.act(r.point_a), r.point_b = XA.act(r.point_b);
  return r;
}
// Clears `unique` where straight features of both shapes are parallel.
template <class A, class B, class F>
Result convex_result(const Shape& shape_a, const Pose& XA, const Shape& shape_b, const Pose& XB, const Options& o, F&& method) {
  const A a(shape_a);
  const B b(shape_b);
  Difference<A, B> d(a, b, relative(XA, XB));
  d.limit(o.max_distance);
  Cores c;
  if (!apart_along_centers(d, c)) c = method(d);
  c.unique = o.says_unique && c.unique && !d.parallel(c.normal) && !(std::abs(c.distance) <= 1e-6 * d.small && d.sharp(c.normal));
  return in_world(rounded(c, a.radius, b.radius, d.small, o), XA);
}
// By the methods of all pairs.
template <class A, class B>
Cores general_pair(const Difference<A, B>& d, const Shape& a, const Shape& b, Workspace& w, const Options& o) {
  if constexpr (takes_any_core) {
    using Core = AnyCore<A::curved || B::curved>;
    const Core any_a(a), any_b(b);
    Difference<Core, Core> any(any_a, any_b, d.X);
    any.reach = d.reach;
    return convex_pair(any, w, o);
  } else {
    return convex_pair(d, w, o);
  }
}
template <class A, class B>
Result convex(const Shape& a, const Pose& XA, const Shape& b, const Pose& XB, Workspace& w, const Options& o) {
  return convex_result<A, B>(a, XA, b, XB, o, [&](const auto& d) {
    if constexpr (is_segment_sum<A> && is_segment_sum<B>) {
      Cores c;
      if (minkowski_pair(d, d.X.p, wanted(d, o), c)) return c;
      // nearly certain to overlap. Rounding leaves normals of sizes that differ much uncertain.
      if constexpr (A::type != Type::Capsule)
        if (d.large < 100 * d.small && lie_flat(d) && deepest_point_pair(d, start_between(d), c)) return c;
    }
    if constexpr (A::type == Type::Capsule && B::type == Type::Cone) {
      Cores c;
      if (capsule_end_pair(d, d.A_.half, c)) return c;
    }
    return general_pair(d, a, b, w, o);
  });
}

// F(A, B) of pairs, by the file that instantiates them. Pairs that no list names are instantiated in distance.cpp.
#define DYN_CONVEX_STRAIGHT(F) \
  F(Capsule, Cylinder)         \
  F(Capsule, Cone) F(Capsule, Ellipsoid) F(Capsule, Convex) F(Box, Cylinder) F(Box, Cone) F(Box, Ellipsoid) F(Box, Convex)
#define DYN_CONVEX_CYLINDER(F) F(Cylinder, Cylinder) F(Cylinder, Cone) F(Cylinder, Ellipsoid) F(Cylinder, Convex)
#define DYN_CONVEX_OTHER(F) \
  F(Cone, Cone) F(Cone, Ellipsoid) F(Cone, Convex) F(Ellipsoid, Ellipsoid) F(Ellipsoid, Convex) F(Convex, Convex)
#define DYN_CONVEX_INSTANCE(A, B) \
  template Result convex<A, B>(const Shape&, const Pose&, const Shape&, const Pose&, Workspace&, const Options&);
#define DYN_CONVEX_ELSEWHERE(A, B) extern DYN_CONVEX_INSTANCE(A, B)
DYN_CONVEX_STRAIGHT(DYN_CONVEX_ELSEWHERE)
DYN_CONVEX_CYLINDER(DYN_CONVEX_ELSEWHERE)
DYN_CONVEX_OTHER(DYN_CONVEX_ELSEWHERE)

}  // namespace dyn::collision
