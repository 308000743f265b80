// Minkowski difference D = A - B of two convex cores, in the frame of A. The cores overlap where D contains the origin. The
// nearest point of D to the origin is the shortest vector between them.
#pragma once

#include "base/portable.hpp"
#include "collision/result.hpp"
#include "collision/workspace.hpp"

namespace dyn::collision {

template <class A, class B>
struct Difference {
  using First = A;
  using Second = B;
  const A& A_;
  const B& B_;
  Pose X;   // pose of B in A
  Mat Rt;   // axes of A in B
  double small, large;  // size of the smaller and of the larger shape
  double reach = shape::infinity;  // m: no more is asked of cores farther apart

  DYN_INLINE Difference(const A& a, const B& b, const Pose& X) : A_(a), B_(b), X(X), Rt(transpose(X.R)) {
    const double sa = a.extent() + a.radius, sb = b.extent() + b.radius;
    small = std::min(sa, sb), large = std::max(sa, sb);
  }

  // Sets the reach for the limit of the rounded shapes' distance, by more than rounding.
  void limit(double distance) {
    if (!(distance < shape::infinity)) return;
    reach = std::max(0.0, distance + A_.radius + B_.radius) + 1e-12 * (large + shape::norm(X.p));
  }

  // Whether a lower bound of the cores' distance is all that is asked.
  bool is_beyond(double bound) const { return bound > reach; }

  static constexpr bool curved = A::curved || B::curved;

  DYN_INLINE Vertex support(const Vec& d) const {
    const Vec a = A_.support(d), b = X.act(B_.support(Rt * -d));
    return {a - b, a, b};
  }
  // Support point on the smooth piece of the boundary that holds p. m: -n in B.
  DYN_INLINE Vertex support_on_piece(const Vertex& p, const Vec& n, const Vec& m) const {
    Vertex q = p;
    if constexpr (A::curved) q.a = A_.support_on_piece(p.a, n);
    if constexpr (B::curved) q.b = X.act(B_.support_on_piece(X.act_inverse(p.b), m));
    q.w = q.a - q.b;
    return q;
  }
  // Derivative of the support point, as a weighted sum over several pieces.
  DYN_INLINE shape::CurvatureRadii curvature_radii(const Vertex* p, const double* weight, int count, const Vec& n, const Vec& u,
                                                   const Vec& v) const {
    shape::CurvatureRadii sum = {0, 0, 0};
    auto add = [&](const shape::CurvatureRadii& k, double w) { sum = {sum.uu + k.uu * w, sum.uv + k.uv * w, sum.vv + k.vv * w}; };
    if constexpr (A::curved)
      for (int i = 0; i < count; ++i) add(A_.curvature_radii(p[i].a, n, u, v), weight[i]);
    if constexpr (B::curved) {
      const Vec m = Rt * -n, s = Rt * u, t = Rt * v;
      for (int i = 0; i < count; ++i) add(B_.curvature_radii(X.act_inverse(p[i].b), m, s, t), weight[i]);
    }
    return sum;
  }
  // Size of rounding errors in this pair's distances.
  double rounding() const { return 1e-15 * (large + shape::norm(X.p)); }

  // Returns whether other pairs of points are as near as one with the normal n. True where straight features of both shapes face
  // each other and share a direction.
  bool parallel(const Vec& n) const {
    const shape::Flat fa = A_.flat(n);
    if (fa.dimension == 0) return false;
    const shape::Flat fb = B_.flat(Rt * -n);
    if (fb.dimension == 0) return false;
    if (fa.dimension + fb.dimension > 2) return true;
    return shape::norm(cross(fa.u, X.R * fb.u)) <= 1e-7;
  }

  // For touching cores: returns whether the origin is at an edge or a corner of D, where other normals hold it as well. Tests
  // support planes tilted by a thousandth: across an edge, which has no radius of curvature, they do not rise.
  bool sharp(const Vec& n) const {
    constexpr int directions = 16;
    constexpr double tilt = 1e-3, radius = 1e-3, turn = 6.2831853071795865 / directions;
    const Vec u = shape::across(n), v = cross(n, u);
    auto height = [&](double angle) {
      const Vec m = n + u * (tilt * math::cos(angle)) + v * (tilt * math::sin(angle));
      return dot(m, support(m).w);
    };
    double around[directions], least = shape::infinity;
    for (int i = 0; i < directions; ++i) around[i] = height(turn * i);
    for (int i = 0; i < directions; ++i) {
      double h = around[i], angle = turn * i;
      if (h > around[(i + 1) % directions] || h > around[(i + directions - 1) % directions]) continue;
      for (double step = turn / 2; step > 1e-8; step /= 2)
        for (const double side : {angle - step, angle + step})
          if (const double at = height(side); at < h) h = at, angle = side;
      least = std::min(least, h);
    }
    return least - dot(n, support(n).w) <= 0.5 * tilt * tilt * radius * small;
  }
};

}  // namespace dyn::collision
