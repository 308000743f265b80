// An ellipsoid with semi-axes `size`.
#pragma once

#include "shape/shape.hpp"

namespace dyn::shape {

struct Ellipsoid : Solid<Ellipsoid> {
  static constexpr Type type = Type::Ellipsoid;
  static constexpr dynShapeType id = DYN_SHAPE_TYPE_ELLIPSOID;
  static constexpr std::array size_names = {"semi-axis along x", "semi-axis along y", "semi-axis along z"};
  static constexpr FileForm mjcf = {"ellipsoid", {"size"}};
  static void store(const double* size, Shape& out) { out.size = load3(size); }
  static constexpr bool curved = true;
  Vec semi;
  double radius;

  explicit Ellipsoid(const Shape& s) : semi(s.size), radius(s.radius) {}

  // Gradient of the support function h(d) = |A d|, A = diag(semi).
  Vec support(const Vec& d) const {
    const Vec e = hadamard(semi, d);
    return hadamard(semi, e) * (1 / norm(e));
  }
  Vec support_on_piece(const Vec&, const Vec& n) const { return support(n); }
  CurvatureRadii curvature_radii(const Vec&, const Vec& n, const Vec& u, const Vec& v) const {
    // Hessian of h: (A^2 - s s^T) / h
    const Vec e = hadamard(semi, n), au = hadamard(semi, u), av = hadamard(semi, v);
    const double scale = 1 / norm(e), su = dot(e, au) * scale, sv = dot(e, av) * scale;
    return {(dot(au, au) - su * su) * scale, (dot(au, av) - su * sv) * scale, (dot(av, av) - sv * sv) * scale};
  }
  Nearest nearest(const Vec& p) const;
  Flat flat(const Vec&) const { return {0, Vec::zero(), Vec::zero()}; }
  double extent() const { return largest(semi); }

  using Solid::bounds;
  Bounds bounds(const Mat& R) const {
    const Vec x = R.x * semi[0], y = R.y * semi[1], z = R.z * semi[2];
    const Vec h2 = hadamard(x, x) + hadamard(y, y) + hadamard(z, z);
    const Vec h = Vec::make(std::sqrt(h2[0]), std::sqrt(h2[1]), std::sqrt(h2[2]));
    return {-h, h};
  }
  Inertia<double> solid() const;
};

// Source: Eberly, "Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid", 2013. The foot is x_i = a_i^2 p_i /
// (t + a_i^2), with t the largest root of F(t) = sum (a_i p_i / (t + a_i^2))^2 - 1. F decreases and is convex there, so Newton's
// method from the left never passes the root. With s = t / a_min^2 + 1 > 0 nothing cancels near the poles.
inline Nearest Ellipsoid::nearest(const Vec& p) const {
  int least = 0;
  for (int i = 1; i < 3; ++i)
    if (semi[i] < semi[least]) least = i;
  const double a = semi[least];
  double g[3], z[3], excess[3];  // g_i = (a_i / a)^2; F = sum (g_i^(1/2) z_i / (s + g_i - 1))^2 - 1, z = p / a
  double inside = 0;
  for (int i = 0; i < 3; ++i) {
    const double ratio = semi[i] / a;
    g[i] = ratio * ratio, excess[i] = i == least ? 0 : (semi[i] - a) * (semi[i] + a) / (a * a);
    z[i] = std::abs(p[i]) / a;
    inside += z[i] * z[i] / g[i];
  }
  // if p has no component along the shortest axis, F may stay below 0 down to s = 0; the foot then leaves the plane of symmetry
  double at_pole = -1;
  for (int i = 0; i < 3; ++i)
    if (excess[i] > 0) at_pole += g[i] * z[i] * z[i] / (excess[i] * excess[i]);
  double across = 0;  // component of p along the shortest axes
  for (int i = 0; i < 3; ++i)
    if (excess[i] == 0) across += z[i] * z[i];
  double x[3];
  bool unique = true;
  if (across == 0 && at_pole <= 0) {
    for (int i = 0; i < 3; ++i) x[i] = excess[i] > 0 ? a * g[i] * z[i] / excess[i] : 0;
    x[least] = a * std::sqrt(-at_pole);
    unique = at_pole == 0;
  } else {
    double s = std::sqrt(across);
    for (int i = 0; i < 3; ++i) s = std::max(s, std::sqrt(g[i]) * z[i] - excess[i]);
    for (int k = 0; k < 100; ++k) {
      double F = -1, dF = 0;
      for (int i = 0; i < 3; ++i) {
        if (z[i] == 0) continue;
        const double u = 1 / (s + excess[i]), q = g[i] * z[i] * z[i] * u * u;
        F += q, dF -= 2 * q * u;
      }
      const double next = s - F / dF;
      if (!(next > s)) break;
      s = next;
    }
    for (int i = 0; i < 3; ++i) x[i] = z[i] == 0 ? 0 : a * g[i] * z[i] / (s + excess[i]);
  }
  const Vec foot = with_sign(Vec::make(x[0], x[1], x[2]), p);
  const Vec slope = Vec::make(foot[0] / (semi[0] * semi[0]), foot[1] / (semi[1] * semi[1]), foot[2] / (semi[2] * semi[2]));
  const Vec n = slope * (1 / norm(slope));
  return {foot, n, inside > 1 ? norm(p - foot) : -norm(p - foot), unique};
}

// Of the core alone: a rounded ellipsoid has no closed form.
inline Inertia<double> Ellipsoid::solid() const {
  const double m = 4.18879020478639098 * semi[0] * semi[1] * semi[2];
  const Vec q = hadamard(semi, semi) * (m / 5);
  return {m, Vec::zero(), Sym3<double>::diagonal(q[1] + q[2], q[2] + q[0], q[0] + q[1])};
}

}  // namespace dyn::shape
