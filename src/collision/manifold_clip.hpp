// Clips two facing features, seen along their common normal n. Each is a flat polygon whose height along n is linear. The gap is
// linear over the overlap of both polygons, so its corners bound the gap: they are the contact points. Clipping: Sutherland,
// Hodgman, CACM 17(1), 1974.
#pragma once

#include "collision/result.hpp"

namespace dyn::collision {

// Tolerances relative to the size of the smaller shape: of lines and planes, and of points that are one.
inline constexpr double coincident = 1e-7, same_point = 1e-5;

// A point of the overlap: height of A's surface, gap to B's surface, and the features it lies on (Contact).
struct ClipPoint {
  double x, y, high, gap;
  std::uint64_t feature;

  ClipPoint() = default;
  ClipPoint(double x, double y, double high, double gap) : x(x), y(y), high(high), gap(gap) {}
};

struct Corner {
  double x, y;
  std::uint16_t id;
};

// A feature projected along n: height(x, y) = h + gx x + gy y.
struct PlanarFeature {
  int count = 0;
  Corner p[shape::Feature::most];
  double h, gx, gy;

  double height(double x, double y) const { return h + gx * x + gy * y; }
};

// Frame across n with its origin near the contact, which keeps precision far from the world's origin.
struct ContactPlane {
  Vec n, u, v, origin;

  ContactPlane(const Vec& normal, const Vec& origin) : n(normal), u(shape::across(normal)), v(cross(normal, u)), origin(origin) {}
};

// Corners of a feature of the shape at X. towards: +1 if the other shape lies along n, -1 if against n. A face seen edge-on
// becomes its edge, a line seen end-on its end.
inline void project(const shape::Feature& f, const Pose& X, const ContactPlane& plane, double towards, PlanarFeature& out) {
  constexpr double steep = 0.05;  // cosine to n
  const Vec offset = X.p - plane.origin;
  Vec p[shape::Feature::most];
  p[0] = Vec::zero();
  for (int k = 0; k < f.count; ++k) p[k] = offset + X.R * f.p[k];
  int first = 0, count = f.count;
  Vec normal = plane.n;
  if (count > 2) {
    normal = Vec::zero();
    for (int k = 1; k + 1 < count; ++k) normal += cross(p[k] - p[0], p[k + 1] - p[0]);
    if (std::abs(dot(normal, plane.n)) < steep * shape::norm(normal) || !(dot(normal, normal) > 0)) {
      double highest = -shape::infinity;
      for (int k = 0; k < count; ++k) {
        const double high = towards * dot(plane.n, p[k] + p[k + 1 < count ? k + 1 : 0]);
        if (high > highest) highest = high, first = k;
      }
      count = 2;
    }
  }
  auto at = [&](int k) { return first + k < f.count ? first + k : first + k - f.count; };
  if (count == 2) {
    const Vec e = p[at(1)] - p[at(0)];
    const double along = dot(e, plane.n), length2 = dot(e, e);
    if (length2 - along * along < steep * steep * length2) {
      if (towards * along > 0) first = at(1);
      count = 1;
    } else {
      normal = plane.n * length2 - e * along;  // of the plane through the line with the line's slope
    }
  }
  if (count == 1) normal = plane.n;
  for (int k = 0; k < count; ++k) out.p[k] = {dot(plane.u, p[at(k)]), dot(plane.v, p[at(k)]), f.id[at(k)]};
  out.count = count;
  const double nn = dot(normal, plane.n);
  out.gx = -dot(normal, plane.u) / nn, out.gy = -dot(normal, plane.v) / nn;
  out.h = dot(plane.n, p[first]) - out.gx * out.p[0].x - out.gy * out.p[0].y;
}

// Names the part a point lies on by two numbers of 16 bits: a corner (equal), an edge (ascending), or the inside.
inline std::uint32_t part_of(const PlanarFeature& f, double x, double y, double eps) {
  auto name = [](std::uint32_t i, std::uint32_t j) { return std::min(i, j) << 16 | std::max(i, j); };
  const double square = eps * eps;
  for (int k = 0; k < f.count; ++k) {
    const double rx = f.p[k].x - x, ry = f.p[k].y - y;
    if (rx * rx + ry * ry <= square) return name(f.p[k].id, f.p[k].id);
  }
  for (int k = 0; k < f.count && f.count > 1; ++k) {
    const Corner &a = f.p[k], &b = f.p[k + 1 < f.count ? k + 1 : 0];
    const double ex = b.x - a.x, ey = b.y - a.y, rx = x - a.x, ry = y - a.y, length2 = ex * ex + ey * ey,
                 along = ex * rx + ey * ry, beside = ex * ry - ey * rx;
    if (beside * beside <= square * length2 && along >= 0 && along <= length2) return name(a.id, b.id);
  }
  return 0xffffffff;
}

inline std::uint64_t feature_of(const PlanarFeature& a, const PlanarFeature& b, const ClipPoint& p, double eps) {
  return std::uint64_t(part_of(a, p.x, p.y, eps)) << 32 | part_of(b, p.x, p.y, eps);
}

// Makes the corners counter-clockwise, as clipping needs them.
inline void orient(PlanarFeature& f) {
  double area = 0;
  for (int k = 1; k + 1 < f.count; ++k)
    area += (f.p[k].x - f.p[0].x) * (f.p[k + 1].y - f.p[0].y) - (f.p[k].y - f.p[0].y) * (f.p[k + 1].x - f.p[0].x);
  if (area < 0) std::reverse(f.p, f.p + f.count);
}

// Points of an overlap, in order around it.
struct Overlap {
  static constexpr int most = 2 * shape::Feature::most + 1;
  int count = 0;
  ClipPoint p[most];

  void add(const ClipPoint& x) {
    if (count < most) p[count++] = x;
  }
  // Inserts where the perimeter grows least.
  void insert(const ClipPoint& x) {
    auto far = [](const ClipPoint& a, const ClipPoint& b) { return shape::length2(a.x - b.x, a.y - b.y); };
    int at = 0;
    double least = shape::infinity;
    for (int i = 0; i < count; ++i) {
      const ClipPoint &l = p[i], &r = p[(i + 1) % count];
      const double longer = far(l, x) + far(x, r) - far(l, r);
      if (longer < least) least = longer, at = i + 1;
    }
    if (count == most) return;
    std::copy_backward(p + at, p + count, p + count + 1);
    p[at] = x, ++count;
  }
};

// The line through two corners.
struct Edge {
  double x, y, ex, ey, length;

  Edge(const Corner& a, const Corner& b) : x(a.x), y(a.y), ex(b.x - a.x), ey(b.y - a.y), length(shape::length2(ex, ey)) {}
  // Signed distance of a point, positive inside.
  double inner(double px, double py) const { return (ex * (py - y) - ey * (px - x)) / length; }
};

// Corners of the overlap of two faces, or of a line and a face (swapped: the line is B's).
void clip_faces(const PlanarFeature& a, const PlanarFeature& b, double eps, Overlap& out);
void clip_line(const PlanarFeature& line, const PlanarFeature& face, double eps, bool swapped, Overlap& out);
// Two lines on surfaces with these radii of curvature: the ends of one over the surface of the other.
void clip_lines(const PlanarFeature& a, const PlanarFeature& b, double curvature_a, double curvature_b, double eps, Overlap& out);
// Feature of a convex shape that faces the other one. towards: +1 if the other lies along the plane's normal, -1 if against.
void planar_feature_of(const shape::Shape& s, const Pose& X, const ContactPlane& plane, double towards, double band,
                       shape::Feature& feature, PlanarFeature& out);
// Any two features, faces counter-clockwise. A single point has no overlap.
void overlap_of(const PlanarFeature& a, double curvature_a, const PlanarFeature& b, double curvature_b, double eps, Overlap& out);
// All corners over a plane at that height. swapped: they are B's.
void clip_against_plane(const PlanarFeature& f, double plane, bool swapped, Overlap& out);
// Convex hull of the points, plus the deepest if it is deeper by more than eps.
void hull(Overlap& overlap, double eps);
// Merges points within eps; the deepest stays.
void merge(Overlap& overlap, double eps);
// Reduces to `most` points. Removes the point with the smallest triangle to its neighbours (Visvalingam, Whyatt, Cartographic
// Journal 30(1), 1993). Never removes a point deeper than all others by more than eps.
void reduce_points(Overlap& overlap, int most, double eps);

}  // namespace dyn::collision
