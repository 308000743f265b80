// The shape contract. A shape is a convex core and a rounding radius: all points within that radius of the core. A sphere is a
// point, a capsule a segment; every shape may be rounded. Each shape is one file; list.hpp lists them.
//
// A shape S derives from Solid<S>, is constructed from Shape, and holds `radius`. In its own frame, for its core, it has
//   type
//   id                        its dynShapeType
//   size_names                names of the sizes that users give, which are lengths; default: none
//   store(size, out)          writes those sizes into the stored Shape
//   mjcf, urdf                the shape in robot files (FileForm); default: the format lacks it
//   from_surface              it is made of a mesh
//   curved                    the core's boundary is curved; then also
//   support_on_piece(from, n) support point along n on the smooth piece of the boundary that holds the support point `from`
//   curvature_radii(from, n, u, v)  its derivative by n along u and v, both perpendicular to n
//   has_faces                 it has few flat faces; then also face(n) and under_face(n, p)
//   short_nearest             nearest has a short closed form
//   support(d)                the farthest point along d (d of any length but zero)
//   nearest(p)                the nearest boundary point to p (see Nearest)
//   flat(n)                   straight directions of the feature that faces n
//   facing(n, band, feature)  the feature that faces n (feature.hpp). Of several at the support point, the one with most corners
//                             within `band` of the support plane. Default: the support point
//   extent()                  distance of the farthest point from the frame's origin, m, no less by rounding
//   solid()                   mass, first and second moments about the origin at density 1, rounding included
// It may replace bounds(R) and ray(origin, direction) of Solid by faster ones.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dyn.h"
#include "shape/feature.hpp"
#include "spatial/inertia.hpp"

namespace dyn::shape {

#define DYN_SHAPES(X) X(HalfSpace) X(Sphere) X(Capsule) X(Box) X(Cylinder) X(Cone) X(Ellipsoid) X(Convex)
// surfaces, which are not convex (surface.hpp)
#define DYN_SURFACES(X) X(Triangles) X(HeightField)

#define DYN_NAME(S) S,
enum class Type : Index { DYN_SHAPES(DYN_NAME) DYN_SURFACES(DYN_NAME) };
#undef DYN_NAME

struct Hull;
struct TriangleTree;
struct Grid;

// One shape as plain values. Each type's file says what `size` means.
struct Shape {
  Type type;
  double radius;      // rounding, m
  Vec3<double> size;  // m
  const Hull* hull;   // Convex only
  const TriangleTree* triangles = nullptr;  // Triangles only
  const Grid* grid = nullptr;               // HeightField only
  const Index* vertex_faces = nullptr;      // Convex only: the faces around each vertex (list_vertex_faces); null: not listed
};

using Vec = Vec3<double>;
using Mat = Mat3<double>;
using Pose = SE3<double>;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

// Position of a point relative to a shape. distance < 0 inside. normal: unit, outward. p = point + distance normal. unique: no
// other boundary point is as near.
struct Nearest {
  Vec point, normal;
  double distance;
  bool unique;
};

// An axis-aligned box.
struct Bounds {
  Vec lower, upper;
};

// First hit of a ray, at origin + t direction; normal is outward. A ray from inside hits at t = 0. No hit: t infinite.
struct Hit {
  double t;
  Vec normal;
};

// Straight directions (unit, orthogonal) of a face (dimension 2), an edge (1) or a vertex (0).
struct Flat {
  int dimension;
  Vec u, v;
};

// Symmetric form on the plane across n: its entries for two directions u and v.
struct CurvatureRadii {
  double uu, uv, vv;
};

DYN_INLINE double norm(const Vec& a) { return std::sqrt(dot(a, a)); }
DYN_INLINE double length2(double x, double y) { return std::sqrt(x * x + y * y); }
DYN_INLINE Vec axis(int i) { return Vec::make(i == 0, i == 1, i == 2); }
// component by component
DYN_INLINE Vec lesser(const Vec& a, const Vec& b) {
  return Vec::make(std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2]));
}
DYN_INLINE Vec greater(const Vec& a, const Vec& b) {
  return Vec::make(std::max(a[0], b[0]), std::max(a[1], b[1]), std::max(a[2], b[2]));
}
DYN_INLINE double smallest(const Vec& a) { return std::min(std::min(a[0], a[1]), a[2]); }
DYN_INLINE double largest(const Vec& a) { return std::max(std::max(a[0], a[1]), a[2]); }
// a unit vector perpendicular to n
DYN_INLINE Vec across(const Vec& n) {
  const Vec s = sizes(n);
  const Vec c = cross(n, axis(s[0] <= s[1] && s[0] <= s[2] ? 0 : s[1] <= s[2] ? 1 : 2));
  return c * (1 / norm(c));
}
// components of size with the signs of d
DYN_INLINE Vec with_sign(const Vec& size, const Vec& d) {
  return Vec::make(std::copysign(size[0], d[0]), std::copysign(size[1], d[1]), std::copysign(size[2], d[2]));
}

// A flat face whose normal is within 25 degrees of the given direction.
struct Face {
  bool exists;
  Vec normal;
};
inline constexpr double face_cosine = 0.9;

// A shape in a robot file. The numbers of its attributes are the sizes times `factor`: one number each, or all in a single
// attribute.
struct FileForm {
  const char* name = nullptr;  // of the element or type; null: the format lacks the shape
  std::array<const char*, 3> attribute = {};
  std::array<double, 3> factor = {1, 1, 1};
  bool standard = true;  // false: an extension of the format
};

// Defaults of all shapes.
template <class S>
struct Solid {
  static constexpr std::array<const char*, 0> size_names = {};
  static constexpr FileForm mjcf = {}, urdf = {};
  static constexpr bool from_surface = false;
  static void store(const double*, Shape&) {}
  static constexpr bool curved = false;
  static constexpr bool has_faces = false;
  static constexpr bool short_nearest = false;

  // Box of the rounded shape at a pose.
  Bounds bounds(const Pose& X) const {
    const Bounds b = self().bounds(X.R);
    const Vec r = Vec::make(self().radius, self().radius, self().radius);
    return {X.p + b.lower - r, X.p + b.upper + r};
  }
  // Box of the core in rotated axes, by six support points.
  Bounds bounds(const Mat& R) const {
    const Mat Rt = transpose(R);
    auto extreme = [&](int i, double sign) { return dot(Rt[i], self().support(Rt[i] * sign)); };
    return {Vec::make(extreme(0, -1), extreme(1, -1), extreme(2, -1)), Vec::make(extreme(0, 1), extreme(1, 1), extreme(2, 1))};
  }
  void facing(const Vec& n, double, Feature& f) const { f.add(self().support(n), 0); }
  // The same where the last support point that was asked for is that of n, at top.
  void facing_at(const Vec&, const Vec& n, double band, Feature& f) const { self().facing(n, band, f); }
  // Signed distance of the rounded shape.
  Nearest signed_distance(const Vec& p) const {
    const Nearest n = self().nearest(p);
    return {n.point + n.normal * self().radius, n.normal, n.distance - self().radius, n.unique};
  }
  Inertia<double> mass_properties(double density) const {
    const Inertia<double> Y = self().solid();
    return {Y.m * density, Y.h * density, Y.I * density};
  }
  double volume() const { return self().solid().m; }

  // The signed distance to a convex set is convex along a line, so Newton's method from outside approaches and never passes.
  Hit ray(const Vec& origin, const Vec& direction) const {
    double t = 0;
    const double enough = 1e-15 * (self().extent() + self().radius + norm(origin));
    for (int i = 0; i < 100; ++i) {
      const Nearest n = self().signed_distance(origin + direction * t);
      const double slope = dot(n.normal, direction);
      if (n.distance <= enough) return {t, n.normal};
      if (slope >= 0) break;
      const double step = -n.distance / slope;
      if (t + step == t) return {t, n.normal};
      t += step;
    }
    return {infinity, Vec::zero()};
  }

 private:
  const S& self() const { return static_cast<const S&>(*this); }
};

// A direction lies in a face if its slope to the normal is below this.
inline constexpr double flat_slope = 1e-9;

}  // namespace dyn::shape
