#include "collision/manifold.hpp"

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

void clear(Manifold& out) { out.count = 0, out.normal = Vec::zero(); }

// Returns whether a tangent plane of an ellipsoid proves that the point p is farther from it than reach.
bool is_clear(const shape::Ellipsoid& s, const Vec& p, double reach) {
  const double away = std::max(0.0, reach + s.radius) + 1e-12 * (shape::norm(p) + s.extent());
  const auto clear = [&](const Vec& n) {
    const double gap = dot(n, p) - shape::norm(hadamard(s.semi, n));
    return gap > 0 && gap * gap > away * away * dot(n, n);
  };
  const Vec& a = s.semi;
  const Vec n = Vec::make(p[0] / (a[0] * a[0]), p[1] / (a[1] * a[1]), p[2] / (a[2] * a[2]));  // where the radius to p leaves it
  return dot(n, n) > 0 && (clear(n) || clear(p - s.support(n)));
}

bool spheres(const Vec& a, double ra, const Vec& b, double rb, double margin, Manifold& out) {
  const Vec way = b - a;
  const double between = shape::norm(way), distance = between - ra - rb;
  out.count = 0, out.normal = Vec::zero();
  if (!(distance <= margin)) return true;
  out.normal = between > 0 ? way * (1 / between) : shape::axis(2);
  out.points[out.count++] = {a + out.normal * (ra + distance / 2), distance, 0};
  return true;
}

// Contact points without a distance query. Returns false where there is no closed form.
bool closed_form(const shape::Shape& a, const Pose& XA, const shape::Shape& b, const Pose& XB, double margin, Manifold& out) {
  using namespace shape;
  const bool plane_a = a.type == Type::HalfSpace, plane_b = b.type == Type::HalfSpace;
  if (plane_a || plane_b) {
    const Shape& s = plane_a ? b : a;
    const Pose &P = plane_a ? XA : XB, &X = plane_a ? XB : XA;
    const HalfSpace plane(plane_a ? a : b);
    bool found = false;
    switch (s.type) {
      case Type::Sphere: found = plane_contacts(plane, P, Sphere(s), X, plane_a, margin, out); break;
      case Type::Box: found = plane_contacts(plane, P, Box(s), X, plane_a, margin, out); break;
      case Type::Capsule: found = plane_contacts(plane, P, Capsule(s), X, plane_a, margin, out); break;
      case Type::Cylinder: found = plane_contacts(plane, P, Cylinder(s), X, plane_a, margin, out); break;
      case Type::Cone: found = plane_contacts(plane, P, Cone(s), X, plane_a, margin, out); break;
      case Type::Ellipsoid: found = plane_contacts(plane, P, Ellipsoid(s), X, plane_a, margin, out); break;
      case Type::Convex: found = plane_contacts(plane, P, Convex(s), X, plane_a, margin, out); break;
      case Type::HalfSpace: out.count = 0, found = true; break;
      default: break;
    }
    if (found && out.count == 0) out.normal = Vec::zero();
    return found;
  }
  if (a.type == Type::Capsule && b.type == Type::Capsule)
    return capsule_contacts(Capsule(a), XA, Capsule(b), XB, margin, out);
  if (a.type == Type::Box && b.type == Type::Box) return box_contacts(Box(a), XA, Box(b), XB, margin, out);
  const bool round_a = a.type == Type::Sphere;
  if (!round_a && b.type != Type::Sphere) return false;
  const Shape& s = round_a ? b : a;
  const Pose& X = round_a ? XB : XA;
  const Vec& center = round_a ? XA.p : XB.p;
  const double radius = round_a ? a.radius : b.radius;
  switch (s.type) {
    case Type::Sphere: return spheres(XA.p, a.radius, XB.p, b.radius, margin, out);
    case Type::Box: return sphere_contact(Box(s), X, center, radius, round_a, margin, out);
    case Type::Capsule: return sphere_contact(Capsule(s), X, center, radius, round_a, margin, out);
    case Type::Cylinder: return sphere_contact(Cylinder(s), X, center, radius, round_a, margin, out);
    case Type::Ellipsoid: return is_clear(Ellipsoid(s), X.act_inverse(center), radius + margin) && (clear(out), true);
    default: return false;
  }
}

// Contact points of a sphere: its nearest point alone.
void sphere_point(const shape::Shape& s, const Pose& X, bool sphere_is_a, const Result& r, double same, double band,
                  const ContactPlane& plane, Manifold& out) {
  shape::Feature feature;
  PlanarFeature f;
  planar_feature_of(s, X, plane, sphere_is_a ? -1 : 1, band, feature, f);
  const std::uint64_t part = part_of(f, 0, 0, same);
  out.points[out.count++] = {r.point_a + r.normal * (r.distance / 2), r.distance, sphere_is_a ? part : part << 32};
}

// General case, of shapes that are no farther apart than the margin.
void clipped(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, const Result& r, double margin,
             Manifold& out) {
  const bool plane_a = a.type == shape::Type::HalfSpace, plane_b = b.type == shape::Type::HalfSpace;
  const bool surface = is_surface(a.type) || is_surface(b.type);
  out.normal = r.normal;
  const double size = std::min(size_of(a), size_of(b)), eps = coincident * size, same = same_point * size;
  const double band = std::max(margin - r.distance, 0.0) + eps;
  const ContactPlane plane(r.normal, r.point_a);
  if (!surface && !plane_a && b.type == shape::Type::Sphere) return sphere_point(a, X_WA, false, r, same, band, plane, out);
  if (!surface && !plane_b && a.type == shape::Type::Sphere) return sphere_point(b, X_WB, true, r, same, band, plane, out);
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
  // order by feature
  int order[Manifold::most];
  for (int i = 0; i < overlap.count; ++i) {
    if (!surface) overlap.p[i].feature = feature_of(fa, fb, overlap.p[i], same);
    int at = i;
    for (; at > 0 && overlap.p[order[at - 1]].feature > overlap.p[i].feature; --at) order[at] = order[at - 1];
    order[at] = i;
  }
  for (int i = 0; i < overlap.count; ++i) {
    const ClipPoint& p = overlap.p[order[i]];
    out.points[out.count++] = {plane.origin + plane.u * p.x + plane.v * p.y + plane.n * (p.high + p.gap / 2), p.gap, p.feature};
  }
}

}  // namespace

void contacts(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, double margin,
              Workspace& workspace, Manifold& out, const Options& options) {
  if (closed_form(a, X_WA, b, X_WB, margin, out)) return;
  Options as_far = options;
  as_far.says_unique = false, as_far.max_distance = margin;
  const Result r = distance(a, X_WA, b, X_WB, workspace, as_far);
  out.count = 0, out.normal = Vec::zero();
  if (r.distance <= margin) clipped(a, X_WA, b, X_WB, r, margin, out);
}

void contacts(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, const Result& r, double margin,
              Manifold& out) {
  if (closed_form(a, X_WA, b, X_WB, margin, out)) return;
  out.count = 0, out.normal = Vec::zero();
  if (r.distance <= margin) clipped(a, X_WA, b, X_WB, r, margin, out);
}

}  // namespace dyn::collision
