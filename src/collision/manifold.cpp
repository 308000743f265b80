#include "collision/manifold.hpp"

#include "collision/surface_distance.hpp"
#include "collision/surface_manifold.hpp"
#include "shape/list.hpp"

namespace dyn::collision {

namespace {

// relative to the size of the smaller shape
constexpr double coincident = 1e-7, same_point = 1e-5;

double size_of(const shape::Shape& s) {
  double size = 0;
  shape::visit(s, [&](const auto& x) { size = x.extent() + x.radius; });
  return size;
}

}  // namespace

void contacts(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, double margin,
              Workspace& workspace, Manifold& out, const Options& options) {
  contacts(a, X_WA, b, X_WB, distance(a, X_WA, b, X_WB, workspace, options), margin, out);
}

void contacts(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, const Result& r, double margin,
              Manifold& out) {
  out.count = 0, out.normal = Vec::zero();
  const bool plane_a = a.type == shape::Type::HalfSpace, plane_b = b.type == shape::Type::HalfSpace;
  if ((plane_a && plane_b) || !(r.distance <= margin)) return;
  out.normal = r.normal;
  // two spheres, or a sphere on a plane, have a single point
  const bool round_a = a.type == shape::Type::Sphere, round_b = b.type == shape::Type::Sphere;
  if ((round_a || plane_a) && (round_b || plane_b)) {
    constexpr std::uint64_t corner = 0, inside = 0xffffffff;
    out.points[out.count++] = {r.point_a + r.normal * (r.distance / 2), r.distance,
                               (plane_a ? inside : corner) << 32 | (plane_b ? inside : corner)};
    return;
  }

  const double size = std::min(size_of(a), size_of(b)), eps = coincident * size, same = same_point * size;
  const double band = std::max(margin - r.distance, 0.0) + eps;
  const ContactPlane plane(r.normal, r.point_a);
  ClipPoint witness = {0, 0, 0, r.distance};
  Overlap overlap;
  if (is_surface(a.type) || is_surface(b.type)) {
    surface_overlap(a, X_WA, b, X_WB, {r, margin, band, eps, same, plane}, overlap);
  } else {
    shape::Feature feature_a, feature_b;
    PlanarFeature fa, fb;
    if (!plane_a) fa = planar_feature_of(a, X_WA, plane, 1, band, feature_a);
    if (!plane_b) fb = planar_feature_of(b, X_WB, plane, -1, band, feature_b);
    if (plane_a)
      clip_against_plane(fb, 0, true, overlap);
    else if (plane_b)
      clip_against_plane(fa, r.distance, false, overlap);
    else
      overlap_of(fa, feature_a.curvature_radius + a.radius, fb, feature_b.curvature_radius + b.radius, eps, overlap);
    for (int i = 0; i < overlap.count; ++i) overlap.p[i].feature = feature_of(fa, fb, overlap.p[i], same);
    witness.feature = feature_of(fa, fb, witness, same);
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
  for (int i = 0; i < overlap.count; ++i) {
    const ClipPoint& p = overlap.p[i];
    out.points[out.count++] = {plane.origin + plane.u * p.x + plane.v * p.y + plane.n * (p.high + p.gap / 2), p.gap, p.feature};
  }
  std::sort(out.points, out.points + out.count, [](const Contact& x, const Contact& y) { return x.feature < y.feature; });
}

}  // namespace dyn::collision
