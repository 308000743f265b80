#include "collision/manifold.hpp"

#include "collision/ascending.hpp"
#include "collision/box_manifold.hpp"
#include "collision/capsule_manifold.hpp"
#include "collision/plane_manifold.hpp"
#include "collision/sphere_manifold.hpp"
#include "collision/surface_distance.hpp"
#include "collision/surface_manifold.hpp"
#include "shape/list.hpp"

namespace dyn::collision {

namespace {

double size_of(const shape::Shape& s) {
  double size = 0;
  shape::visit(s, [&](const auto& x) { size = x.extent() + x.radius; });
  return size;
}

// Returns whether a tangent plane of an ellipsoid proves that the point p is farther from it than reach.
bool is_clear(const shape::Ellipsoid& s, const Vec& p, double reach) {
  const double away = std::max(0.0, reach + s.radius) + 1e-12 * (shape::norm(p) + s.extent());
  const Vec& a = s.semi;
  Vec n = Vec::make(p[0] / (a[0] * a[0]), p[1] / (a[1] * a[1]), p[2] / (a[2] * a[2]));  // where the radius to p leaves it
  if (!(dot(n, n) > 0)) return false;
  for (int i = 0; i < 4; ++i) {
    const Vec e = hadamard(a, n);
    const double height = shape::norm(e), gap = dot(n, p) - height;
    if (gap > 0 && gap * gap > away * away * dot(n, n)) return true;
    const Vec top = hadamard(a, e) * (1 / height), way = p - top;
    if (dot(way, way) <= away * away) return false;  // a point within reach
    // from the centre of a ball of the mean radius of curvature at the top (the trace of Ellipsoid::curvature_radii)
    n = way + n * ((dot(a, a) - dot(top, top)) / (2 * height));
  }
  return false;
}

// Contact points without a distance query. Returns false where there is no closed form.
using ClosedForm = bool (*)(const shape::Shape& a, const Pose& XA, const shape::Shape& b, const Pose& XB, double margin,
                            Manifold& out);

bool spheres(const shape::Shape& a, const Pose& XA, const shape::Shape& b, const Pose& XB, double margin, Manifold& out) {
  const Vec way = XB.p - XA.p;
  const double between = shape::norm(way), distance = between - a.radius - b.radius;
  clear(out);
  if (!(distance <= margin)) return true;
  out.normal = between > 0 ? way * (1 / between) : shape::axis(2);
  out.points[out.count++] = {XA.p + out.normal * (a.radius + distance / 2), distance, 0};
  return true;
}
bool capsules(const shape::Shape& a, const Pose& XA, const shape::Shape& b, const Pose& XB, double margin, Manifold& out) {
  return capsule_contacts(shape::Capsule(a), XA, shape::Capsule(b), XB, margin, out);
}
void clipped(const shape::Shape& a, const Pose& XA, const shape::Shape& b, const Pose& XB, const Result& r, double margin,
             Manifold& out);
bool boxes(const shape::Shape& a, const Pose& XA, const shape::Shape& b, const Pose& XB, double margin, Manifold& out) {
  Result overlap;
  const BoxContacts found = box_contacts(shape::Box(a), XA, shape::Box(b), XB, margin, out, overlap);
  if (found == BoxContacts::Overlap && overlap.distance <= margin) clear(out), clipped(a, XA, b, XB, overlap, margin, out);
  return found != BoxContacts::Unknown;
}
bool half_spaces(const shape::Shape&, const Pose&, const shape::Shape&, const Pose&, double, Manifold& out) {
  return clear(out), true;
}
template <class S, bool plane_is_a>
bool plane(const shape::Shape& a, const Pose& XA, const shape::Shape& b, const Pose& XB, double margin, Manifold& out) {
  const bool found = plane_is_a ? plane_contacts(shape::HalfSpace(a), XA, S(b), XB, true, margin, out)
                                : plane_contacts(shape::HalfSpace(b), XB, S(a), XA, false, margin, out);
  if (found && out.count == 0) out.normal = Vec::zero();
  return found;
}
template <class S, bool sphere_is_a>
bool sphere(const shape::Shape& a, const Pose& XA, const shape::Shape& b, const Pose& XB, double margin, Manifold& out) {
  return sphere_is_a ? sphere_contact(S(b), XB, XA.p, a.radius, true, margin, out)
                     : sphere_contact(S(a), XA, XB.p, b.radius, false, margin, out);
}
// Says alone that there is no contact.
template <bool sphere_is_a>
bool ellipsoid_sphere(const shape::Shape& a, const Pose& XA, const shape::Shape& b, const Pose& XB, double margin, Manifold& out) {
  const shape::Shape &s = sphere_is_a ? b : a, &ball = sphere_is_a ? a : b;
  const Vec p = sphere_is_a ? XB.act_inverse(XA.p) : XA.act_inverse(XB.p);
  if (!is_clear(shape::Ellipsoid(s), p, ball.radius + margin)) return false;
  return clear(out), true;
}

template <class A, class B>
constexpr ClosedForm closed_form_of() {
  using shape::Type;
  constexpr auto simple = [](Type t) { return t == Type::Box || t == Type::Capsule || t == Type::Cylinder; };
  if constexpr (A::type == Type::HalfSpace && B::type == Type::HalfSpace) return half_spaces;
  else if constexpr (A::type == Type::HalfSpace) return plane<B, true>;
  else if constexpr (B::type == Type::HalfSpace) return plane<A, false>;
  else if constexpr (A::type == Type::Sphere && B::type == Type::Sphere) return spheres;
  else if constexpr (A::type == Type::Sphere && simple(B::type)) return sphere<B, true>;
  else if constexpr (B::type == Type::Sphere && simple(A::type)) return sphere<A, false>;
  else if constexpr (A::type == Type::Sphere && B::type == Type::Ellipsoid) return ellipsoid_sphere<true>;
  else if constexpr (B::type == Type::Sphere && A::type == Type::Ellipsoid) return ellipsoid_sphere<false>;
  else if constexpr (A::type == Type::Capsule && B::type == Type::Capsule) return capsules;
  else if constexpr (A::type == Type::Box && B::type == Type::Box) return boxes;
  else return nullptr;
}

// Part of a shape that the nearest point to a sphere lies on. A hull's corner needs no face around it.
std::uint32_t nearest_part(const shape::Shape& s, const Pose& X, bool sphere_is_a, const Result& r, double same, double band) {
  const double towards = sphere_is_a ? -1 : 1;
  const Vec n = transpose_times(X.R, r.normal * towards);
  shape::Feature feature;
  if (s.type == shape::Type::Convex) {
    const shape::Convex hull(s);
    const Vec top = hull.support(n), way = top - X.act_inverse(sphere_is_a ? r.point_b : r.point_a);
    const double high = dot(way, n);
    if (dot(way, way) - high * high <= same * same) return detail::edge_part(hull.support_number(), hull.support_number());
    hull.facing_at(top, n, band, feature);
  } else {
    shape::visit(s, [&]<class S>(const S& x) {
      if constexpr (S::type != shape::Type::HalfSpace) x.facing(n, band, feature);
    });
  }
  PlanarFeature f;
  project(feature, X, ContactPlane(r.normal, r.point_a), towards, f);
  return part_of(f, 0, 0, same);
}
// Contact points of a sphere: its nearest point alone.
void sphere_point(const shape::Shape& s, const Pose& X, bool sphere_is_a, const Result& r, double same, double band,
                  Manifold& out) {
  const std::uint64_t part = nearest_part(s, X, sphere_is_a, r, same, band);
  out.points[out.count++] = {r.point_a + r.normal * (r.distance / 2), r.distance, sphere_is_a ? part : part << 32};
}

// General case, of shapes that are no farther apart than the margin.
[[gnu::noinline]] void clipped(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, const Result& r,
                               double margin, Manifold& out) {
  const bool plane_a = a.type == shape::Type::HalfSpace, plane_b = b.type == shape::Type::HalfSpace;
  const bool surface = is_surface(a.type) || is_surface(b.type);
  out.normal = r.normal;
  const double size = std::min(size_of(a), size_of(b)), eps = coincident * size, same = same_point * size;
  const double band = std::max(margin - r.distance, 0.0) + eps;
  if (!surface && !plane_a && b.type == shape::Type::Sphere) return sphere_point(a, X_WA, false, r, same, band, out);
  if (!surface && !plane_b && a.type == shape::Type::Sphere) return sphere_point(b, X_WB, true, r, same, band, out);
  const ContactPlane plane(r.normal, r.point_a);
  ClipPoint witness(0, 0, 0, r.distance);
  witness.feature = ~std::uint64_t(0);
  Overlap overlap;
  PlanarFeature fa, fb;
  if (surface) {
    surface_overlap(a, X_WA, b, X_WB, {r, margin, band, eps, same, plane}, overlap);
  } else {
    shape::Feature feature_a, feature_b;
    if (!plane_a) planar_feature_of(a, X_WA, plane, 1, band, feature_a, fa);
    if (!plane_b) planar_feature_of(b, X_WB, plane, -1, band, feature_b, fb);
    if (plane_a)
      clip_against_plane(fb, 0, true, overlap);
    else if (plane_b)
      clip_against_plane(fa, r.distance, false, overlap);
    else
      overlap_of(fa, feature_a.curvature_radius + a.radius, fb, feature_b.curvature_radius + b.radius, eps, overlap);
  }

  // keep points within the margin, and the witness points if they are deeper than all of these
  int kept = 0;
  double deepest = shape::infinity;
  for (int i = 0; i < overlap.count; ++i) {
    if (!(overlap.p[i].gap <= margin)) continue;
    deepest = std::min(deepest, overlap.p[i].gap);
    overlap.p[kept++] = overlap.p[i];
  }
  overlap.count = kept;
  merge(overlap, same);
  if (deepest > r.distance + eps) overlap.insert(witness);
  reduce_points(overlap, Manifold::most, eps);
  std::uint64_t feature[Manifold::most];
  int place[Manifold::most];
  for (int i = 0; i < overlap.count; ++i)
    feature[i] = surface ? overlap.p[i].feature : feature_of(fa, fb, overlap.p[i], same);
  ascending(feature, overlap.count, place);
  out.count = overlap.count;
  for (int i = 0; i < overlap.count; ++i) {
    const ClipPoint& p = overlap.p[i];
    out.points[place[i]] = {plane.origin + plane.u * p.x + plane.v * p.y + plane.n * (p.high + p.gap / 2), p.gap, feature[i]};
  }
}

// What the general case is given: a distance, or what a query for it needs.
struct Given {
  const Result* distance;
  Workspace* workspace;
  const Options* options;
};
[[gnu::noinline]] void general(const shape::Shape& a, const Pose& XA, const shape::Shape& b, const Pose& XB, double margin,
                               Manifold& out, const Given& given) {
  Result found;
  if (!given.distance) {
    Options limited = *given.options;
    limited.says_unique = false, limited.max_distance = margin;
    found = distance(a, XA, b, XB, *given.workspace, limited);
  }
  const Result& r = given.distance ? *given.distance : found;
  clear(out);
  if (r.distance <= margin) clipped(a, XA, b, XB, r, margin, out);
}

using Method = decltype(&general);
template <ClosedForm closed_form>
void closed_or_general(const shape::Shape& a, const Pose& XA, const shape::Shape& b, const Pose& XB, double margin, Manifold& out,
                       const Given& given) {
  if (!closed_form(a, XA, b, XB, margin, out)) general(a, XA, b, XB, margin, out, given);
}
struct Methods {
  static constexpr int types = int(shape::Type::HeightField) + 1;
  Method at[types][types];
};
constexpr Methods methods = [] {
  Methods t;
  for (auto& row : t.at)
    for (Method& m : row) m = general;
  shape::each_shape([&]<class A>() {
    shape::each_shape([&]<class B>() {
      constexpr ClosedForm f = closed_form_of<A, B>();
      if constexpr (f != nullptr) t.at[Index(A::type)][Index(B::type)] = closed_or_general<f>;
    });
  });
  return t;
}();

}  // namespace

void contacts(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, double margin,
              Workspace& workspace, Manifold& out, const Options& options) {
  methods.at[Index(a.type)][Index(b.type)](a, X_WA, b, X_WB, margin, out, {nullptr, &workspace, &options});
}

void contacts(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, const Result& r, double margin,
              Manifold& out) {
  clear(out);
  // what rounding may decide is decided as without a known distance
  if (r.distance > margin) {
    const Vec sum = sizes(X_WB.p - X_WA.p) + sizes(r.point_a - X_WA.p) + sizes(r.point_b - X_WB.p);
    if (r.distance - margin > 1e-12 * (sum[0] + sum[1] + sum[2])) return;
  }
  // boxes on planes and on boxes: the work of steps is stated for the rounding of the general case
  using shape::Type;
  const auto flat = [](Type t) { return t == Type::HalfSpace || t == Type::Box; };
  const bool is_general = flat(a.type) && flat(b.type) && (a.type == Type::Box || b.type == Type::Box);
  const Method method = is_general ? general : methods.at[Index(a.type)][Index(b.type)];
  method(a, X_WA, b, X_WB, margin, out, {&r, nullptr, nullptr});
}

}  // namespace dyn::collision
