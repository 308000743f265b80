// A box with half extents `size`.
#pragma once

#include "shape/shape.hpp"

namespace dyn::shape {

struct Box : Solid<Box> {
  static constexpr Type type = Type::Box;
  static constexpr dynShapeType id = DYN_SHAPE_TYPE_BOX;
  static constexpr std::array size_names = {"length along x", "length along y", "length along z"};
  static constexpr FileForm mjcf = {"box", {"size"}, {0.5, 0.5, 0.5}}, urdf = {"box", {"size"}};
  static void store(const double* size, Shape& out) { out.size = load3(size) * 0.5; }
  static constexpr bool has_faces = true, short_nearest = true;
  Vec half;
  double radius;

  explicit Box(const Shape& s) : half(s.size), radius(s.radius) {}

  Vec support(const Vec& d) const { return with_sign(half, d); }
  Nearest nearest(const Vec& p) const {
    const Vec depth = half - sizes(p);
    if (depth[0] >= 0 && depth[1] >= 0 && depth[2] >= 0) return nearest_face(p, depth);
    const Vec c =
        Vec::make(std::clamp(p[0], -half[0], half[0]), std::clamp(p[1], -half[1], half[1]), std::clamp(p[2], -half[2], half[2]));
    const Vec r = p - c;
    const double d = norm(r);
    return {c, r * (1 / d), d, true};
  }
  Flat flat(const Vec& n) const {
    const Vec s = sizes(n);
    Flat f = {0, Vec::zero(), Vec::zero()};
    for (int i = 0; i < 3; ++i)
      if (s[i] <= flat_slope) (f.dimension++ == 0 ? f.u : f.v) = axis(i);
    return f;
  }
  Face face(const Vec& n) const {
    const Vec s = sizes(n);
    const int i = s[0] > face_cosine ? 0 : s[1] > face_cosine ? 1 : 2;
    return {s[i] > face_cosine, axis(i) * std::copysign(1.0, n[i])};
  }
  bool under_face(const Vec& n, const Vec& p) const {
    const Vec over = sizes(p) - half;
    for (int i = 0; i < 3; ++i)
      if (n[i] == 0 && over[i] > 0) return false;
    return true;
  }
  // The face that faces n. Corners are numbered by their signs.
  void facing(const Vec& n, double, Feature& f) const {
    const Vec s = sizes(n);
    const int i = s[0] >= s[1] && s[0] >= s[2] ? 0 : s[1] >= s[2] ? 1 : 2, j = (i + 1) % 3, k = (i + 2) % 3;
    static constexpr int corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (const auto& c : corners) {
      const int number = int(n[i] > 0) << i | c[0] << j | c[1] << k;
      f.add(Vec::make(number & 1 ? half[0] : -half[0], number & 2 ? half[1] : -half[1], number & 4 ? half[2] : -half[2]), number);
    }
  }
  double extent() const { return norm(half); }

  using Solid::bounds;
  Bounds bounds(const Mat& R) const {
    const Vec h = sizes(R.x) * half[0] + sizes(R.y) * half[1] + sizes(R.z) * half[2];
    return {-h, h};
  }
  // Slab test for a box without rounding.
  Hit ray(const Vec& origin, const Vec& direction) const {
    if (radius > 0) return Solid::ray(origin, direction);
    double enter = 0, leave = infinity;
    Vec normal = Vec::zero();
    for (int i = 0; i < 3; ++i) {
      const double d = direction[i], o = std::copysign(1.0, d) * origin[i];
      if (d == 0 && std::abs(o) > half[i]) return {infinity, Vec::zero()};
      if (d == 0) continue;
      const double t = (-half[i] - o) / std::abs(d);
      if (t > enter) enter = t, normal = axis(i) * std::copysign(1.0, -d);
      leave = std::min(leave, (half[i] - o) / std::abs(d));
    }
    if (enter > leave) return {infinity, Vec::zero()};
    return {enter, enter > 0 ? normal : nearest(origin).normal};
  }
  Inertia<double> solid() const;

 private:
  Nearest nearest_face(const Vec& p, const Vec& depth) const {
    const int i = depth[0] <= depth[1] && depth[0] <= depth[2] ? 0 : depth[1] <= depth[2] ? 1 : 2;
    const Vec n = axis(i) * std::copysign(1.0, p[i]);
    int as_near = 0;
    for (int j = 0; j < 3; ++j) as_near += (depth[j] == depth[i]) + (depth[j] == depth[i] && p[j] == 0);
    return {p + n * depth[i], n, -depth[i], as_near == 1};
  }
};

// A rounded box is its core, six slabs on the faces, four quarter cylinders along each of three edges, and eight octants of a
// ball. The quarters along an edge make one cylinder, the octants one ball.
inline Inertia<double> Box::solid() const {
  const double r = radius, pi = 3.14159265358979324;
  // volume and second moments (integrals of x^2, y^2, z^2) add up
  double m = 8 * half[0] * half[1] * half[2];
  double q[3] = {m * half[0] * half[0] / 3, m * half[1] * half[1] / 3, m * half[2] * half[2] / 3};
  const double ball = 4 * pi / 3 * r * r * r;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double a = half[i], b = half[j], c = half[k];
    // two slabs across axis i: from a to a + r
    const double slabs = 8 * r * b * c;
    m += slabs;
    q[i] += slabs * (a * a + a * r + r * r / 3), q[j] += slabs * b * b / 3, q[k] += slabs * c * c / 3;
    // four quarter cylinders along axis i
    const double tube = pi * r * r * 2 * a, centroid = 4 * r / (3 * pi);
    m += tube;
    q[i] += tube * a * a / 3, q[j] += tube * (b * b + 2 * b * centroid + r * r / 4),
        q[k] += tube * (c * c + 2 * c * centroid + r * r / 4);
    // eight octants
    q[i] += ball * (a * a + 2 * a * 3 * r / 8 + r * r / 5);
  }
  m += ball;
  return {m, Vec::zero(), Sym3<double>::diagonal(q[1] + q[2], q[2] + q[0], q[0] + q[1])};
}

}  // namespace dyn::shape
