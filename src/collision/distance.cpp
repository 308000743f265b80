// Table of pairs: the method for each pair of types. The other half of the table exchanges A and B.
//               half-space   sphere     capsule     box       cylinder   others
//   half-space  planes       deepest    deepest     deepest   deepest    deepest    deepest point below the plane
//   sphere                   nearest    nearest     nearest   nearest    nearest    nearest point to the sphere's centre
//   capsule                             segments    axes      sums       gjk
//   box                                             axes      sums       gjk        separating axes if they overlap, else sums
//   cylinder                                                  sums       gjk        Minkowski sums if separated, else gjk
//   others                                                               gjk        GJK, EPA, Newton
// A capsule and a box first try a face of the box, a separated capsule and cone the ends of the capsule. Before EPA, the deepest
// point of one shape in the other is tried (deepest_point.hpp). Surfaces search for the nearest piece: surface_distance.cpp.
#include "collision/distance.hpp"

#include "collision/analytic/boxes.hpp"
#include "collision/analytic/capsules.hpp"
#include "collision/analytic/half_space.hpp"
#include "collision/analytic/half_spaces.hpp"
#include "collision/analytic/sphere.hpp"
#include "collision/surface_distance.hpp"
#include "shape/list.hpp"

#include "convex_methods.hpp"

namespace dyn::collision {
namespace {

using namespace shape;
// poses and result in the world
using Method = Result (*)(const Shape&, const Pose&, const Shape&, const Pose&, Workspace&, const Options&);

template <class A, class B>
Result finish(const Cores& c, const A& a, const B& b, const Options& options) {
  return rounded(c, a.radius, b.radius, std::min(a.extent() + a.radius, b.extent() + b.radius), options);
}

// Pairs without rotation: computed from A's origin in the world's axes.
Result translated(Result r, const Vec& origin) {
  r.point_a += origin, r.point_b += origin;
  return r;
}
Result spheres(const Shape& a, const Pose& XA, const Shape& b, const Pose& XB, Workspace&, const Options& o) {
  return translated(finish(point_sphere_pair(Vec::zero(), XB.p - XA.p, axis(2)), Sphere(a), Sphere(b), o), XA.p);
}
Result capsule_sphere(const Shape& a, const Pose& XA, const Shape& b, const Pose& XB, Workspace&, const Options& o) {
  const Capsule capsule(a);
  const Vec z = XA.R.z, p = XB.p - XA.p;
  return translated(
      finish(point_sphere_pair(z * std::clamp(dot(z, p), -capsule.half, capsule.half), p, XA.R.x), capsule, Sphere(b), o), XA.p);
}
Result capsules(const Shape& a, const Pose& XA, const Shape& b, const Pose& XB, Workspace&, const Options& o) {
  return translated(finish(capsule_pair(Capsule(a), Capsule(b), XA.R.z, XB.R.z, XB.p - XA.p), Capsule(a), Capsule(b), o), XA.p);
}
Result half_space_sphere(const Shape& a, const Pose& XA, const Shape& b, const Pose& XB, Workspace&, const Options& o) {
  const Vec n = XA.R.z, p = XB.p - XA.p;
  const double height = dot(n, p);
  return translated(finish(Cores{n, p - n * height, p, height, 0, 0, true}, HalfSpace(a), Sphere(b), o), XA.p);
}
template <class A>
Result sphere(const Shape& a, const Pose& XA, const Shape& b, const Pose& XB, Workspace&, const Options& o) {
  const Vec p = XA.act_inverse(XB.p);
  Result r;
  if constexpr (A::type == Type::Convex)
    r = finish(sphere_pair(A(a), Sphere(b), p, o), A(a), Sphere(b), o);
  else
    r = finish(sphere_pair(A(a), p), A(a), Sphere(b), o);
  r.normal = XA.R * r.normal, r.point_a = XA.act(r.point_a), r.point_b = XB.p - r.normal * b.radius;
  return r;
}

Result half_spaces(const Shape& a, const Pose& XA, const Shape& b, const Pose& XB, Workspace&, const Options& o) {
  return in_world(finish(half_space_pair(HalfSpace(a), HalfSpace(b), relative(XA, XB)), HalfSpace(a), HalfSpace(b), o), XA);
}
template <class B>
Result half_space(const Shape& a, const Pose& XA, const Shape& b, const Pose& XB, Workspace&, const Options& o) {
  return in_world(finish(half_space_pair(HalfSpace(a), B(b), relative(XA, XB), o.says_unique), HalfSpace(a), B(b), o), XA);
}
Result boxes(const Shape& a, const Pose& XA, const Shape& b, const Pose& XB, Workspace& w, const Options& o) {
  return convex_result<Box, Box>(a, XA, b, XB, o, [&](const auto& d) { return box_pair(d, a.size, b.size, w, o); });
}
Result box_capsule(const Shape& a, const Pose& XA, const Shape& b, const Pose& XB, Workspace& w, const Options& o) {
  return convex_result<Box, Capsule>(a, XA, b, XB, o, [&](const auto& d) {
    Cores c;
    return segment_over_face(d, a.size, b.size[2], wanted(d, o), c) ? c : box_pair(d, a.size, axis(2) * b.size[2], w, o);
  });
}
struct Pair {
  Method method;
  bool exchanged;
};

// rows and columns in the order of Type
template <class A, class B>
constexpr Pair pair() {
  if constexpr (A::type == Type::HalfSpace && B::type == Type::HalfSpace)
    return {half_spaces, false};
  else if constexpr (A::type == Type::HalfSpace && B::type == Type::Sphere)
    return {half_space_sphere, false};
  else if constexpr (A::type == Type::HalfSpace)
    return {half_space<B>, false};
  else if constexpr (A::type == Type::Sphere && B::type == Type::Sphere)
    return {spheres, false};
  else if constexpr (A::type == Type::Capsule && B::type == Type::Sphere)
    return {capsule_sphere, false};
  else if constexpr (B::type == Type::Sphere)
    return {sphere<A>, false};
  else if constexpr (A::type == Type::Capsule && B::type == Type::Capsule)
    return {capsules, false};
  else if constexpr (A::type == Type::Box && B::type == Type::Box)
    return {boxes, false};
  else if constexpr (A::type == Type::Box && B::type == Type::Capsule)
    return {box_capsule, false};
  else if constexpr (A::type == Type::Capsule && B::type == Type::Box)
    return {box_capsule, true};
  else if constexpr (A::type == Type::Sphere || A::type > B::type)
    return {pair<B, A>().method, true};
  else
    return {convex<A, B>, false};
}

struct Table {
  Pair at[type_count][type_count] = {};
};
constexpr Table table = [] {
  Table t;
  each_shape([&]<class A>() { each_shape([&]<class B>() { t.at[Index(A::type)][Index(B::type)] = pair<A, B>(); }); });
  return t;
}();
static_assert([] {
  bool seen[type_count] = {};
  each_shape([&]<class S>() { seen[Index(S::type)] = true; });
  for (const bool x : seen)
    if (!x) return false;
  return true;
}(), "two shapes have one type");

// Verifies the fallback's result: the depth along its normal, and the distances of its witness points from A and B.
bool fallback_distance(const Shape& a, const Pose& XA, const Shape& b, const Pose& XB, const Options& o, Result& r) {
  FallbackResult found;
  if (!o.fallback(a, XA, b, XB, o.tolerance, found)) return false;
  double support_sum = 0, small = infinity, outside = 0;
  r.point_a = found.position + found.normal * (found.depth / 2), r.point_b = found.position - found.normal * (found.depth / 2);
  auto measure = [&](const Shape& s, const Pose& X, const Vec& n, const Vec& witness) {
    visit(s, [&]<class S>(const S& x) {
      if constexpr (S::type != Type::HalfSpace) support_sum += dot(n, X.R * x.support(transpose_times(X.R, n))) + x.radius;
      small = std::min(small, x.extent() + x.radius);
      outside = std::max(outside, x.signed_distance(X.act_inverse(witness)).distance);
    });
  };
  measure(a, XA, found.normal, r.point_a), measure(b, XB, -found.normal, r.point_b);
  const double depth = support_sum - dot(found.normal, XB.p - XA.p);
  r.from_fallback = true, r.unique = false, r.iterations = 0, r.distance = -depth, r.normal = found.normal;
  r.residual = std::max(std::abs(depth - found.depth), outside);
  r.status = depth > o.touching * small ? Status::Penetrating : Status::Touching;
  return r.residual <= std::max(o.accepted, o.tolerance) * small;
}

// Returns whether the pair has no closed form and both shapes have support points.
bool has_no_closed_form(Type a, Type b) { return std::min(a, b) >= Type::Capsule && std::max(a, b) >= Type::Cylinder; }

inline Result primary_distance(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, Workspace& workspace,
                               const Options& options) {
  const Pair pair = table.at[Index(a.type)][Index(b.type)];
  if (!pair.exchanged) return pair.method(a, X_WA, b, X_WB, workspace, options);
  Result r = pair.method(b, X_WB, a, X_WA, workspace, options);
  r.normal = -r.normal, std::swap(r.point_a, r.point_b);
  return r;
}
[[gnu::noinline]] Result distance_with_fallback(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                                Workspace& workspace, const Options& options) {
  Result fallback;
  if (options.fallback_first && has_no_closed_form(a.type, b.type) && fallback_distance(a, X_WA, b, X_WB, options, fallback))
    return fallback;
  const Result first = primary_distance(a, X_WA, b, X_WB, workspace, options);
  if (first.status == Status::Failed && fallback_distance(a, X_WA, b, X_WB, options, fallback)) return fallback;
  return first;
}

}  // namespace

Result distance(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, Workspace& workspace,
                const Options& options) {
  if (is_surface(a.type) || is_surface(b.type)) return surface_distance(a, X_WA, b, X_WB, workspace, options);
  if (options.fallback) return distance_with_fallback(a, X_WA, b, X_WB, workspace, options);
  return primary_distance(a, X_WA, b, X_WB, workspace, options);
}

double bounding_radius(const Shape& s) {
  double r = 0;
  visit(s, [&](const auto& x) { r = x.extent() + x.radius; });
  return r;
}

}  // namespace dyn::collision
