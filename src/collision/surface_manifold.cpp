#include "collision/surface_manifold.hpp"

#include "collision/surface_distance.hpp"

#include "shape/list.hpp"

namespace dyn::collision {

namespace {

using namespace shape;

constexpr double steep = 0.05;  // cosine to the normal below which a triangle is seen edge-on and its neighbours count
constexpr double flat = 1e-6;   // slope below which a triangle is level
constexpr Bounds everywhere = {Vec::make(-infinity, -infinity, -infinity), Vec::make(infinity, infinity, infinity)};

Bounds grown(const Bounds& b, double by) {
  const Vec r = Vec::make(by, by, by);
  return {b.lower - r, b.upper + r};
}

// f(feature) of triangles in a region of the surface's frame that face the other shape and reach `level` along the normal.
// towards: +1 if the other shape lies along the normal, -1 if against.
template <class S, class F>
void planar_triangles(const S& s, const Pose& X, const ContactPlane& plane, double towards, double level, const Bounds& region,
                      F&& f) {
  const Vec n = transpose_times(X.R, plane.n) * towards;
  const double origin = towards * dot(plane.n, X.p - plane.origin) + s.radius;
  const bool everything = region.upper[0] == infinity;
  const double limit = 0;
  auto lower = [&](const auto& node) {
    const Bounds box = s.box(node);
    const bool out = origin + support_height(box, s.slab(node), n) < level || (!everything && distance_between(box, region) > 0);
    return out ? infinity : 0;
  };
  auto leaf = [&](auto node) {
    for (Index i = 0, count = s.pieces(node); i < count; ++i) {
      Vec corner[3];
      s.triangle(node, i, corner);
      const Vec normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
      const double facing = dot(normal, n);
      if ((s.closed() ? facing : std::abs(facing)) <= steep * norm(normal)) continue;
      const Bounds box = {lesser(lesser(corner[0], corner[1]), corner[2]), greater(greater(corner[0], corner[1]), corner[2])};
      if (!everything && distance_between(box, region) > 0) continue;
      if (origin + std::max({dot(n, corner[0]), dot(n, corner[1]), dot(n, corner[2])}) < level) continue;
      Feature feature;
      for (int k = 0; k < 3; ++k) feature.add(corner[k], s.number(node, i, k));
      PlanarFeature figure;
      project(feature, X, plane, towards, figure);
      orient(figure);
      figure.h += towards * s.radius;
      f(figure, box);
    }
  };
  search(s, limit, lower, leaf);
}

Bounds bounds_in(const Pose& X_WS, const Shape& other, const Pose& X_WO) {
  const Mat Rt = transpose(X_WS.R);
  const Pose X = {Rt * X_WO.R, Rt * (X_WO.p - X_WS.p)};
  Bounds b = everywhere;
  visit(other, [&]<class S>(const S& s) {
    if constexpr (S::type != Type::HalfSpace) b = s.bounds(X);
  });
  return b;
}
Bounds transformed(const Bounds& b, const Pose& X) {
  const Vec c = X.act(middle(b)), h = half_of(b), r = sizes(X.R.x) * h[0] + sizes(X.R.y) * h[1] + sizes(X.R.z) * h[2];
  return {c - r, c + r};
}

// Drops the surface's part of the name, so a corner keeps its name when it slides over a floor's edges.
std::uint64_t corner_alone(std::uint64_t feature) {
  constexpr std::uint64_t inside = 0xffffffff;
  auto corner = [](std::uint64_t part) { return part != inside && part >> 16 == (part & 0xffff); };
  const std::uint64_t a = feature >> 32, b = feature & inside;
  if (corner(a) && !corner(b)) return a << 32 | inside;
  if (corner(b) && !corner(a)) return inside << 32 | b;
  return feature;
}

// Collects the points of all overlaps.
struct Gathered {
  const ContactSearch& s;
  Overlap& out;

  // level: the triangle is perpendicular to the normal at the witness point. Points of level triangles beyond the margin count in
  // the hull too, so coplanar triangles act as one face.
  void take(const Overlap& part, const PlanarFeature& a, const PlanarFeature& b, bool level) {
    for (int i = 0; i < part.count; ++i) {
      ClipPoint p = part.p[i];
      if (!(level || p.gap <= s.margin) || p.gap < s.nearest.distance - s.eps) continue;
      p.feature = feature_of(a, b, p, s.same);
      if (level) p.feature = corner_alone(p.feature);
      if (out.count == Overlap::most - 1) merge(out, s.same), hull(out, s.eps), reduce_points(out, Overlap::most / 2, s.eps);
      out.add(p);
    }
  }
};

}  // namespace

void surface_overlap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, const ContactSearch& s, Overlap& out) {
  Gathered all = {s, out};
  const double wide = s.band + s.margin + s.eps;
  // heights are relative to A's witness point
  const double level_a = -s.band, level_b = -s.nearest.distance - s.band;
  auto over_all_of = [&](const Shape& surface, const Pose& X, double towards, double level, const Bounds& region, auto&& f) {
    visit(surface, [&]<class S>(const S& x) {
      if constexpr (is_surface(S::type)) planar_triangles(x, X, s.plane, towards, level, region, f);
    });
  };
  auto clip = [&](const PlanarFeature& fa, double curvature_a, const PlanarFeature& fb, double curvature_b, bool level) {
    Overlap part;
    overlap_of(fa, curvature_a, fb, curvature_b, s.eps, part);
    all.take(part, fa, fb, level);
  };
  auto is_level = [&](const PlanarFeature& f, double height) {
    return std::max(std::abs(f.gx), std::abs(f.gy)) <= flat && std::abs(f.h - height) <= s.eps;
  };
  auto against = [&](const Shape& surface, const Pose& X, const Shape& other, const Pose& X_O, double towards, double level) {
    Feature feature;
    PlanarFeature of_other;
    const bool plane = other.type == Type::HalfSpace;
    if (!plane) planar_feature_of(other, X_O, s.plane, -towards, s.band, feature, of_other);
    if (of_other.count > 2) orient(of_other);
    const double curvature_radius = feature.curvature_radius + other.radius;
    over_all_of(surface, X, towards, level, grown(bounds_in(X, other, X_O), wide), [&](const PlanarFeature& f, const Bounds&) {
      if (plane) {
        Overlap part;
        clip_against_plane(f, towards > 0 ? s.nearest.distance : 0, towards < 0, part);
        towards > 0 ? all.take(part, f, of_other, false) : all.take(part, of_other, f, false);
      } else if (towards > 0) {
        clip(f, 0, of_other, curvature_radius, is_level(f, 0));
      } else {
        clip(of_other, curvature_radius, f, 0, is_level(f, s.nearest.distance));
      }
    });
  };
  if (!is_surface(b.type)) {
    against(a, X_WA, b, X_WB, 1, level_a);
  } else if (!is_surface(a.type)) {
    against(b, X_WB, a, X_WA, -1, level_b);
  } else {
    const Mat Rt = transpose(X_WB.R);
    const Pose X_BA = {Rt * X_WA.R, Rt * (X_WA.p - X_WB.p)};
    over_all_of(a, X_WA, 1, level_a, grown(bounds_in(X_WA, b, X_WB), wide), [&](const PlanarFeature& fa, const Bounds& box) {
      over_all_of(b, X_WB, -1, level_b, grown(transformed(box, X_BA), wide + a.radius + b.radius),
                  [&](const PlanarFeature& fb, const Bounds&) { clip(fa, 0, fb, 0, false); });
    });
  }
  merge(out, s.same);
  hull(out, s.eps);
}

}  // namespace dyn::collision
