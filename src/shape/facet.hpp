// One piece of a surface as a convex shape: a triangle, or the prism under it. Its hull lies about its own origin, which keeps
// precision far from the surface's frame.
#pragma once

#include "shape/convex.hpp"

namespace dyn::shape {

struct Facet {
  Hull hull;
  Vec origin;

  Facet() = default;
  Facet(const Facet&) = delete;  // the hull points to its own arrays
  Facet& operator=(const Facet&) = delete;

  Vec corner(int i) const { return origin + hull.vertex(i); }
  Shape shape(double radius) const { return {Type::Convex, radius, Vec::zero(), &hull}; }

  // A flat triangle with two faces, one for each side.
  void triangle(const Vec& a, const Vec& b, const Vec& c) {
    origin = (a + b + c) * (1.0 / 3);
    const Vec corners[] = {a - origin, b - origin, c - origin};
    set(corners, 3, 2, triangle_topology);
  }
  // Prism from a, b, c (counter-clockwise seen from above) down to z = bottom.
  void prism(const Vec& a, const Vec& b, const Vec& c, double bottom) {
    origin = (a + b + c) * (1.0 / 3);
    Vec corners[6] = {a - origin, b - origin, c - origin};
    for (int i = 0; i < 3; ++i) corners[3 + i] = Vec::make(corners[i][0], corners[i][1], bottom - origin[2]);
    set(corners, 6, 5, prism_topology);
  }

 private:
  alignas(64) double x_[Hull::lanes], y_[Hull::lanes], z_[Hull::lanes];
  double planes_[4 * 5];

  struct Topology {
    Index face_start[6], face_vertices[18], neighbour_start[7], neighbours[18];
  };
  static constexpr Topology triangle_topology = {{0, 3, 6}, {0, 1, 2, 0, 2, 1}, {0, 2, 4, 6}, {1, 2, 2, 0, 0, 1}};
  static constexpr Topology prism_topology = {{0, 3, 6, 10, 14, 18},
                                              {0, 1, 2, 3, 5, 4, 3, 4, 1, 0, 4, 5, 2, 1, 5, 3, 0, 2},
                                              {0, 3, 6, 9, 12, 15, 18},
                                              {1, 2, 3, 0, 2, 4, 0, 1, 5, 0, 4, 5, 1, 3, 5, 2, 3, 4}};

  void set(const Vec* corners, Index n, Index faces, const Topology& t) {
    hull.vertices = n, hull.faces = faces, hull.corners = t.face_start[faces];
    hull.center = Vec::zero(), hull.extent = 0;
    for (Index i = 0; i < Hull::lanes; ++i) {
      const Vec& p = corners[std::min(i, n - 1)];
      x_[i] = p[0], y_[i] = p[1], z_[i] = p[2];
    }
    for (Index i = 0; i < n; ++i) hull.center += corners[i] * (1.0 / n), hull.extent = std::max(hull.extent, norm(corners[i]));
    for (Index f = 0; f < faces; ++f) {
      const Index* at = t.face_vertices + t.face_start[f];
      const Vec normal = cross(corners[at[1]] - corners[at[0]], corners[at[2]] - corners[at[0]]),
                unit = normal * (1 / norm(normal));
      for (int k = 0; k < 3; ++k) planes_[4 * f + k] = unit[k];
      planes_[4 * f + 3] = dot(unit, corners[at[0]]);
    }
    hull.x = x_, hull.y = y_, hull.z = z_, hull.planes = planes_;
    hull.face_start = t.face_start, hull.face_vertices = t.face_vertices;
    hull.neighbour_start = t.neighbour_start, hull.neighbours = t.neighbours;
  }
};

// Nearest point of a triangle to p (Ericson, Real-Time Collision Detection, 5.1.5).
inline Vec nearest_of_triangle(const Vec& a, const Vec& b, const Vec& c, const Vec& p) {
  const Vec ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  const Vec cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const Vec n = cross(ab, ac);
  return p - n * (dot(n, ap) / dot(n, n));
}

}  // namespace dyn::shape
