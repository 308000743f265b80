// The table of pairs. Which method answers which pair (the other half is exchanged):
//               half-space   sphere     capsule     box       others
//   half-space  planes       deepest    deepest     deepest   deepest    point below the plane
//   sphere                   nearest    nearest     nearest   nearest    point to the sphere's centre
//   capsule                             segments    axes      gjk
//   box                                             axes      gjk        separating axes when they meet, else GJK
//   others                                                    gjk        GJK, EPA, Newton
// Surfaces are searched for the nearest piece: surface_distance.cpp.
#include "dyn/collision/distance.hpp"

#include "dyn/collision/analytic/boxes.hpp"
#include "dyn/collision/analytic/capsules.hpp"
#include "dyn/collision/analytic/half_space.hpp"
#include "dyn/collision/analytic/half_spaces.hpp"
#include "dyn/collision/analytic/sphere.hpp"
#include "dyn/collision/convex_pair.hpp"
#include "dyn/collision/surface_distance.hpp"
#include "dyn/shape/list.hpp"

namespace dyn::collision {
namespace {

using namespace shape;
using Method = Result (*)(const Shape&, const Shape&, const Pose&, Workspace&, const Options&);

template <class A, class B>
Result finish(const Cores& c, const A& a, const B& b, const Options& options) {
  return rounded(c, a.radius, b.radius, std::min(a.extent() + a.radius, b.extent() + b.radius), options);
}

Result half_spaces(const Shape& a, const Shape& b, const Pose& X, Workspace&, const Options& o) {
  return finish(half_space_pair(HalfSpace(a), HalfSpace(b), X), HalfSpace(a), HalfSpace(b), o);
}
template <class B>
Result half_space(const Shape& a, const Shape& b, const Pose& X, Workspace&, const Options& o) {
  return finish(half_space_pair(HalfSpace(a), B(b), X), HalfSpace(a), B(b), o);
}
template <class A>
Result sphere(const Shape& a, const Shape& b, const Pose& X, Workspace&, const Options& o) {
  return finish(sphere_pair(A(a), Sphere(b), X), A(a), Sphere(b), o);
}
Result capsules(const Shape& a, const Shape& b, const Pose& X, Workspace&, const Options& o) {
  return finish(capsule_pair(Capsule(a), Capsule(b), X), Capsule(a), Capsule(b), o);
}
// of shapes with straight features, which may be parallel
template <class A, class B, class F>
Result general(const Shape& shape_a, const Shape& shape_b, const Pose& X, const Options& o, F&& method) {
  const A a(shape_a);
  const B b(shape_b);
  const Difference<A, B> d(a, b, X);
  Cores c = method(d);
  c.unique = c.unique && !d.parallel(c.normal);
  return rounded(c, a.radius, b.radius, d.small, o);
}
Result boxes(const Shape& a, const Shape& b, const Pose& X, Workspace& w, const Options& o) {
  return general<Box, Box>(a, b, X, o, [&](const auto& d) { return box_pair(d, a.size, b.size, w, o); });
}
Result box_capsule(const Shape& a, const Shape& b, const Pose& X, Workspace& w, const Options& o) {
  return general<Box, Capsule>(a, b, X, o, [&](const auto& d) { return box_pair(d, a.size, axis(2) * b.size[2], w, o); });
}
template <class A, class B>
Result convex(const Shape& a, const Shape& b, const Pose& X, Workspace& w, const Options& o) {
  return general<A, B>(a, b, X, o, [&](const auto& d) { return convex_pair(d, w, o); });
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
  else if constexpr (A::type == Type::HalfSpace)
    return {half_space<B>, false};
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

constexpr Pair table[type_count][type_count] = {
#define DYN_ROW(A) {pair<A, HalfSpace>(), pair<A, Sphere>(), pair<A, Capsule>(), pair<A, Box>(), \
                    pair<A, Cylinder>(), pair<A, Cone>(), pair<A, Ellipsoid>(), pair<A, Convex>()},
    DYN_SHAPES(DYN_ROW)
#undef DYN_ROW
};

// B in the frame of A: positions are subtracted first, so that a pair far from the world's origin loses nothing.
Pose relative(const Pose& A, const Pose& B) {
  const Mat Rt = transpose(A.R);
  return {Rt * B.R, Rt * (B.p - A.p)};
}

}  // namespace

Result distance(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, Workspace& workspace, const Options& options) {
  if (is_surface(a.type) || is_surface(b.type)) return surface_distance(a, X_WA, b, X_WB, workspace, options);
  const Pair pair = table[Index(a.type)][Index(b.type)];
  const Pose& X_W1 = pair.exchanged ? X_WB : X_WA;
  Result r = pair.exchanged ? pair.method(b, a, relative(X_WB, X_WA), workspace, options)
                            : pair.method(a, b, relative(X_WA, X_WB), workspace, options);
  r.normal = X_W1.R * r.normal, r.point_a = X_W1.act(r.point_a), r.point_b = X_W1.act(r.point_b);
  if (pair.exchanged) r.normal = -r.normal, std::swap(r.point_a, r.point_b);
  return r;
}

double reach(const Shape& s) {
  double r = 0;
  visit(s, [&](const auto& x) { r = x.extent() + x.radius; });
  return r;
}

}  // namespace dyn::collision
