// Random shapes of every type, in ordinary and adversarial poses.
#pragma once

#include <cstdlib>
#include <memory>
#include <string>

#include "collision/hull.hpp"
#include "common/eigen.hpp"
#include "collision/distance.hpp"
#include "joint/spherical.hpp"
#include "shape/list.hpp"
#include "table/names.hpp"

namespace dyn_test {

using collision::Result;
using collision::Status;
using shape::Pose;
using shape::Shape;
using shape::Type;
using shape::Vec;

inline Pose at(double x, double y, double z) { return {Mat3<double>::identity(), Vec::make(x, y, z)}; }

// Number of samples: DYN_COLLISION_SAMPLES, or as many as take seconds.
inline int samples(int usual) {
  const char* s = std::getenv("DYN_COLLISION_SAMPLES");
  return s ? std::atoi(s) : usual;
}

inline const char* name_of(Type t) {
  Shape s{};
  s.type = t;
  Hull h{};
  s.hull = &h;
  const char* name = "";
  shape::visit(s, [&]<class S>(const S&) { name = dyn::name_of(S::id); });
  return name;
}

// A stored shape with its hull.
struct Solid {
  Shape shape{};
  std::shared_ptr<HullData> hull;
};

inline Solid make(Type t, const Vec& size, double radius) {
  Solid s;
  s.shape = {t, radius, size, nullptr};
  return s;
}
inline Solid make_convex(const std::vector<Vec>& points, double radius = 0) {
  Solid s;
  s.hull = std::make_shared<HullData>(points);
  s.shape = {Type::Convex, radius, Vec::zero(), &s.hull->hull};
  if (!s.hull->vertex_faces.empty()) s.shape.vertex_faces = s.hull->vertex_faces.data();
  return s;
}
inline Solid box(double x, double y, double z) { return make(Type::Box, Vec::make(x / 2, y / 2, z / 2), 0); }
inline std::vector<Vec> corners(double x, double y, double z) {
  std::vector<Vec> p;
  for (int i = 0; i < 8; ++i) p.push_back(Vec::make(i & 1 ? x / 2 : -x / 2, i & 2 ? y / 2 : -y / 2, i & 4 ? z / 2 : -z / 2));
  return p;
}
inline Solid sphere(double r) { return make(Type::Sphere, Vec::zero(), r); }
inline Solid capsule(double r, double length) { return make(Type::Capsule, Vec::make(0, 0, length / 2), r); }
inline Solid cylinder(double r, double length) { return make(Type::Cylinder, Vec::make(r, r, length / 2), 0); }

struct Chance {
  Random g;
  explicit Chance(std::uint64_t seed) : g{seed * 0x9e3779b97f4a7c15u + 1} {}
  double uniform(double a, double b) { return g.uniform(a, b); }
  int pick(int n) { return int(g.uniform() * n); }
  Vec direction() {
    Vec d;
    do d = Vec::make(g.normal(), g.normal(), g.normal());
    while (shape::norm(d) < 1e-3);
    return d * (1 / shape::norm(d));
  }
  Mat3<double> rotation() {
    double q[4];
    Spherical::random(g, nullptr, nullptr, q);
    return dyn::rotation(load_quaternion(q));
  }
  // one of the 24 that map the axes to each other
  Mat3<double> quarter_turns() {
    const int i = pick(3), j = (i + 1 + pick(2)) % 3;
    const Vec x = shape::axis(i) * (pick(2) ? 1.0 : -1.0), y = shape::axis(j) * (pick(2) ? 1.0 : -1.0);
    return {x, y, cross(x, y)};
  }
  Solid shape(Type t, double scale, double thin = 1) {
    const double rounding = t == Type::Sphere || t == Type::Capsule ? scale * uniform(0.1, 0.6)
                            : pick(4) == 0                          ? scale * uniform(0.01, 0.3)
                                                                    : 0;
    if (t != Type::Convex) {
      double s[3] = {scale * uniform(0.2, 1), scale * uniform(0.2, 1), scale * uniform(0.2, 1)};
      s[pick(3)] *= thin;
      if (t == Type::Cylinder || t == Type::Cone) s[1] = s[0];
      return make(t, load3(s), thin == 1 || t == Type::Sphere ? rounding : rounding * thin);
    }
    const int n = 4 + pick(16);
    const double a = scale * uniform(0.4, 1), b = scale * uniform(0.4, 1), c = scale * uniform(0.4, 1) * thin;
    std::vector<Vec> p;
    for (int i = 0; i < n; ++i) p.push_back(hadamard(direction(), Vec::make(a, b, c)));
    if (n > 17) p = corners(a, b, c);
    return make_convex(p, thin == 1 ? rounding : 0);
  }
};

inline double size_of(const Solid& s) {
  double r = 0;
  shape::visit(s.shape, [&](const auto& x) { r = x.extent() + x.radius; });
  return r == shape::infinity ? 1 : r;
}

// Support function of the rounded shape at a pose along the world's direction n.
inline double reach(const Solid& s, const Pose& X, const Vec& n) {
  double h = 0;
  const Vec d = transpose_times(X.R, n);
  shape::visit(s.shape, [&]<class S>(const S& x) {
    if constexpr (S::type == Type::HalfSpace)
      h = d[2] > 1 - 1e-9 ? x.radius : shape::infinity;
    else
      h = dot(d, x.support(d)) + x.radius;
  });
  return h + dot(n, X.p);
}
// Signed distance of a point to the rounded shape.
inline double outside(const Solid& s, const Pose& X, const Vec& p) {
  double d = 0;
  shape::visit(s.shape, [&](const auto& x) { d = x.signed_distance(X.act_inverse(p)).distance; });
  return d;
}

struct Scene {
  Solid a, b;
  Pose A, B;
};

inline collision::Workspace& workspace() {
  static collision::Workspace w;
  return w;
}
inline Result query(const Scene& s, const collision::Options& o = {}) {
  return collision::distance(s.a.shape, s.A, s.b.shape, s.B, workspace(), o);
}

enum class Case { Random, Touching, NearlyTouching, Aligned, Coincident, Ratio, Thin, Far, Deep, count };
inline const char* name_of(Case c) {
  static const char* names[] = {"random", "touching", "nearly touching", "aligned", "coincident", "ratio", "thin", "far", "deep"};
  return names[int(c)];
}

inline Scene scene(Type ta, Type tb, Case c, std::uint64_t seed) {
  Chance g(seed * 1000 + std::uint64_t(ta) * 100 + std::uint64_t(tb) * 10 + std::uint64_t(c) * 7919);
  Scene s;
  const bool large_a = g.pick(2), thin_a = g.pick(2);
  const double ratio = std::pow(10.0, g.uniform(3, 6));
  s.a = g.shape(ta, c == Case::Ratio && large_a ? ratio : 1, c == Case::Thin && thin_a ? 1e-4 : 1);
  s.b = g.shape(tb, c == Case::Ratio && !large_a ? ratio : 1, c == Case::Thin && (!thin_a || g.pick(2)) ? 1e-4 : 1);
  const double reach_ab = size_of(s.a) + size_of(s.b);
  const bool turned = c == Case::Aligned || (c == Case::Coincident && g.pick(2));
  s.A.R = turned ? g.quarter_turns() : g.rotation();
  s.B.R = turned ? g.quarter_turns() : g.rotation();
  s.A.p = g.direction() * g.uniform(0, 2);
  double apart = g.uniform(0, 1.2) * reach_ab;
  if (c == Case::Deep) apart = g.uniform(0, 0.2) * reach_ab;
  if (c == Case::Coincident) {
    const int zeros = g.pick(5);
    apart = zeros == 0 ? 0 : reach_ab * std::pow(10.0, -4 * zeros);
  }
  Vec along = g.direction();
  if (c == Case::Aligned) {
    // faces, edges or corners that meet, at multiples of the sizes
    double p[3];
    for (int i = 0; i < 3; ++i) {
      const Vec n = shape::axis(i);
      const double step = ta == Type::HalfSpace || tb == Type::HalfSpace
                              ? 1
                              : reach(s.a, {s.A.R, Vec::zero()}, n) + reach(s.b, {s.B.R, Vec::zero()}, -n);
      const double steps[] = {0, 1, -1, 0.5, 1 + 1e-9, 1 - 1e-12, 1.5, g.uniform(-1, 1)};
      p[i] = step * steps[g.pick(8)];
    }
    s.B.p = s.A.p + load3(p);
    return s;
  }
  s.B.p = s.A.p + along * apart;
  if (c == Case::Touching || c == Case::NearlyTouching || c == Case::Ratio) {
    // along the result's own normal, which leads to the adversarial pose
    const Result r = query(s);
    double gap = 0;
    if (c == Case::NearlyTouching) gap = (g.pick(2) ? 1 : -1) * std::pow(10.0, -g.uniform(2, 15));
    if (c == Case::Ratio) gap = g.pick(2) ? g.uniform(-1, 1) : 0;
    if (std::isfinite(r.distance)) s.B.p -= r.normal * (r.distance - gap);
  }
  if (c == Case::Far) {
    const Vec far = g.direction() * 1000.0;
    s.A.p += far, s.B.p += far;
  }
  return s;
}

}  // namespace dyn_test
