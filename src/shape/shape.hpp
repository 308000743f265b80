// The shape contract. A shape is a convex core and a rounding radius: the set of points within that radius of the core. A sphere
// is a point, a capsule a segment; every shape may be rounded. Each is one file; list.hpp names them.
//
// A shape S derives from Solid<S>, is made from the stored Shape, holds `radius`, and gives, all about its core and in its own frame,
//   type, name
//   curved                    the core's boundary bends; then also
//   slide(from, n)            the support point along n on the smooth piece of the boundary that the support point `from` lies on
//   bend(from, n, u, v)       its derivative by n, u and v across n: radii of curvature
//   faced                     it has few flat faces; then also face(n) and under_face(n, p)
//   support(d)                the point farthest along d (of any length but zero)
//   nearest(p)                the boundary point nearest to p (see Nearest)
//   flat(n)                   the straight directions of the feature that faces n
//   facing(n, band, feature)  the feature that faces n (feature.hpp); of several through the support point the one with most corners within
//                             band of the support plane; Solid: the support point
//   extent()                  a length that says how large it is: the farthest point from the frame's origin
//   solid()                   mass, first and second moment about the origin at density 1, rounding included
// and may give, where it knows better than Solid, bounds(R) and ray(origin, direction).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "shape/feature.hpp"
#include "spatial/inertia.hpp"

namespace dyn::shape {

// surfaces (surface.hpp) come last
enum class Type : Index { HalfSpace, Sphere, Capsule, Box, Cylinder, Cone, Ellipsoid, Convex, Triangles, HeightField };

struct Hull;
struct TriangleTree;
struct Grid;

// One shape as plain values. The meaning of `size` is the type's: see its file.
struct Shape {
  Type type;
  double radius;      // rounding, m
  Vec3<double> size;  // m
  const Hull* hull;   // Convex alone
  const TriangleTree* triangles = nullptr;  // Triangles alone
  const Grid* grid = nullptr;               // HeightField alone
};

using Vec = Vec3<double>;
using Mat = Mat3<double>;
using Pose = SE3<double>;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

// Where a point stands to a shape: distance < 0 inside. normal is the unit outward direction that separates the two, so that
// p = point + distance normal. Not unique: another boundary point is as near.
struct Nearest {
  Vec point, normal;
  double distance;
  bool unique;
};

// An axis-aligned box.
struct Bounds {
  Vec lower, upper;
};

// First point of a ray on a solid, at origin + t direction; normal is outward. A ray from the inside hits at t = 0. No hit: t infinite.
struct Hit {
  double t;
  Vec normal;
};

// Straight directions (unit, orthogonal) of a face (2), an edge (1) or a vertex (0).
struct Flat {
  int dimension;
  Vec u, v;
};

// Of a symmetric form on the plane across n: its entries along two directions u and v there.
struct CurvatureRadii {
  double uu, uv, vv;
};

DYN_INLINE double norm(const Vec& a) { return std::sqrt(dot(a, a)); }
DYN_INLINE double length2(double x, double y) { return std::sqrt(x * x + y * y); }
DYN_INLINE Vec axis(int i) { return Vec::make(i == 0, i == 1, i == 2); }
// component by component
DYN_INLINE Vec lesser(const Vec& a, const Vec& b) { return Vec::make(std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2])); }
DYN_INLINE Vec greater(const Vec& a, const Vec& b) { return Vec::make(std::max(a[0], b[0]), std::max(a[1], b[1]), std::max(a[2], b[2])); }
DYN_INLINE double largest(const Vec& a) { return std::max(std::max(a[0], a[1]), a[2]); }
// a unit vector across n
DYN_INLINE Vec across(const Vec& n) {
  const Vec s = sizes(n);
  const Vec c = cross(n, axis(s[0] <= s[1] && s[0] <= s[2] ? 0 : s[1] <= s[2] ? 1 : 2));
  return c * (1 / norm(c));
}
// each component of size with the sign of d
DYN_INLINE Vec with_sign(const Vec& size, const Vec& d) {
  return Vec::make(std::copysign(size[0], d[0]), std::copysign(size[1], d[1]), std::copysign(size[2], d[2]));
}

// A flat face whose normal is within 25 degrees of the direction asked for, if there is one.
struct Face {
  bool exists;
  Vec normal;
};
inline constexpr double face_cosine = 0.9;

// What every shape has.
template <class S>
struct Solid {
  static constexpr bool curved = false;
  static constexpr bool has_faces = false;

  // the rounded shape's box at a pose
  Bounds bounds(const Pose& X) const {
    const Bounds b = self().bounds(X.R);
    const Vec r = Vec::make(self().radius, self().radius, self().radius);
    return {X.p + b.lower - r, X.p + b.upper + r};
  }
  // the core's box in turned axes: six support points
  Bounds bounds(const Mat& R) const {
    const Mat Rt = transpose(R);
    auto extreme = [&](int i, double sign) { return dot(Rt[i], self().support(Rt[i] * sign)); };
    return {Vec::make(extreme(0, -1), extreme(1, -1), extreme(2, -1)), Vec::make(extreme(0, 1), extreme(1, 1), extreme(2, 1))};
  }
  void facing(const Vec& n, double, Feature& f) const { f.add(self().support(n), 0); }
  // of the rounded shape
  Nearest signed_distance(const Vec& p) const {
    const Nearest n = self().nearest(p);
    return {n.point + n.normal * self().radius, n.normal, n.distance - self().radius, n.unique};
  }
  Inertia<double> mass_properties(double density) const {
    const Inertia<double> Y = self().solid();
    return {Y.m * density, Y.h * density, Y.I * density};
  }
  double volume() const { return self().solid().m; }

  // Along a line the signed distance to a convex set is a convex function of t: Newton's method from outside comes nearer and never passes.
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

// A direction is taken as straight in a face when its slope to the normal is below this.
inline constexpr double flat_slope = 1e-9;

}  // namespace dyn::shape
