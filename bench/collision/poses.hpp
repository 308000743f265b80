// The poses that collision engines are timed on: every pair of shapes, apart, nearly touching (a gap of a thousandth of the size)
// and penetrating (by a twentieth of it), a thousand each.
#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

#include "collision/scene.hpp"

namespace dyn_bench {

using namespace dyn_test;

constexpr int poses = 1000, passes = 9;
enum Class { Apart, Near, Penetrating, classes };

// one pair of shapes of about unit size; hulls have 32 vertices
struct PairOfShapes {
  Solid a, b;
  std::vector<Scene> scenes[classes];
};

inline Solid typical(Type t, int which) {
  const double k = which ? 0.9 : 1;
  switch (t) {
    case Type::HalfSpace: return make(t, Vec::zero(), 0);
    case Type::Sphere: return sphere(0.5 * k);
    case Type::Capsule: return capsule(0.3 * k, 0.8);
    case Type::Box: return box(0.8, 0.6 * k, 1);
    case Type::Cylinder: return cylinder(0.4 * k, 0.9);
    case Type::Cone: return make(t, Vec::make(0.4 * k, 0.4 * k, 0.45), 0);
    case Type::Ellipsoid: return make(t, Vec::make(0.3, 0.4 * k, 0.5), 0);
    default: break;  // a hull
  }
  Chance g(std::uint64_t(which) + 1);
  std::vector<Vec> p;
  for (int i = 0; i < 32; ++i) p.push_back(g.direction() * (0.5 * k));
  return make_convex(p);
}

inline PairOfShapes make_pair(Type ta, Type tb) {
  PairOfShapes pair = {typical(ta, 0), typical(tb, 1), {}};
  for (int c = 0; c < classes; ++c)
    for (int i = 0; i < poses; ++i) {
      Chance g(std::uint64_t(i) * 64 + std::uint64_t(ta) * 8 + std::uint64_t(tb));
      Scene s = {pair.a, pair.b, {g.rotation(), g.direction()}, {g.rotation(), Vec::zero()}};
      s.B.p = s.A.p + g.direction() * 2.0;
      const double gap = c == Apart ? g.uniform(0.1, 1) : c == Near ? 1e-3 : -0.05;
      // along the normal of the shapes apart: a few steps lead to the gap
      for (int k = 0; k < 5; ++k) {
        const dyn_test::Result r = query(s);
        s.B.p -= r.normal * (r.distance - gap);
      }
      pair.scenes[c].push_back(s);
    }
  return pair;
}

// Shapes whose axes are parallel: most lie with a face on a face. They overlap by a ten thousandth.
inline std::vector<Scene> at_rest(const PairOfShapes& pair) {
  std::vector<Scene> out;
  for (int i = 0; i < poses; ++i) {
    Chance g(std::uint64_t(i) * 64 + 7);
    Scene s = {pair.a, pair.b, {g.rotation(), g.direction()}, {}};
    s.B.R = s.A.R * g.quarter_turns();
    const Vec along = s.A.R * shape::axis(pair.a.shape.type == Type::HalfSpace ? 2 : g.pick(3));
    s.B.p = s.A.p + along * 3.0 + s.A.R * (g.direction() * 0.1);
    for (int k = 0; k < 5; ++k) s.B.p -= along * (query(s).distance + 1e-4);
    out.push_back(s);
  }
  return out;
}

// median over the passes of the mean time of a query, ns
template <class F>
double time(const std::vector<Scene>& scenes, F&& f) {
  std::vector<double> t;
  for (int k = 0; k < passes; ++k) {
    const auto start = std::chrono::steady_clock::now();
    for (const Scene& s : scenes) f(s);
    t.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() * 1e9 / double(scenes.size()));
  }
  std::nth_element(t.begin(), t.begin() + passes / 2, t.end());
  return t[passes / 2];
}

}  // namespace dyn_bench
