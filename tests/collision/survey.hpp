// Properties of every result, by any method, and the least depth by brute force.
#pragma once

#include "collision/scene.hpp"

namespace dyn_test {

// Overlap of the two along n.
inline double overlap(const Scene& s, const Vec& n) { return reach(s.a, s.A, n) + reach(s.b, s.B, -n); }

// Least overlap over all directions: a grid on the sphere, then pattern search from each local minimum. Never less than the true
// depth.
class BruteForce {
 public:
  explicit BruteForce(const Scene& s) : s_(s) {}
  double depth() const {
    double h[6][side][side], least = shape::infinity;
    for (int f = 0; f < 6; ++f)
      for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) h[f][i][j] = overlap(s_, at(f, i, j));
    for (int f = 0; f < 6; ++f)
      for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
          bool lowest = true;
          for (int k = std::max(0, i - 1); k <= std::min(side - 1, i + 1); ++k)
            for (int l = std::max(0, j - 1); l <= std::min(side - 1, j + 1); ++l) lowest = lowest && h[f][i][j] <= h[f][k][l];
          if (lowest && h[f][i][j] < shape::infinity) least = std::min(least, descend(at(f, i, j), h[f][i][j]));
        }
    return least;
  }
  // from one direction
  double descend(Vec n, double h) const {
    double step = 2.0 / side;
    for (int k = 0; step > 1e-10 && k < 400; ++k) {
      const Vec u = shape::across(n), v = cross(n, u);
      const double h0 = h;
      const Vec n0 = n;
      for (int i = 0; i < 8; ++i) {
        const double angle = 0.78539816339744831 * i + k;
        Vec m = n0 + u * (step * std::cos(angle)) + v * (step * std::sin(angle));
        m = m * (1 / shape::norm(m));
        const double hm = overlap(s_, m);
        if (hm < h) h = hm, n = m;
      }
      step *= h < h0 ? 1.5 : 0.5;
    }
    return h;
  }

 private:
  static constexpr int side = 14;
  const Scene& s_;

  static Vec at(int face, int i, int j) {
    const double x = std::tan(0.78539816339744831 * ((2 * i + 1.0) / side - 1)),
                 y = std::tan(0.78539816339744831 * ((2 * j + 1.0) / side - 1));
    const double c[3] = {1, x, y};
    const int k = face / 2;
    const Vec d = Vec::make(c[(3 - k) % 3], c[(4 - k) % 3], c[(5 - k) % 3]);
    return d * ((face % 2 ? -1 : 1) / shape::norm(d));
  }
};

// Violations relative to the size of the smaller shape, beyond rounding of the poses.
struct Faults {
  bool failed;      // by its status, or not finite
  double witness;   // distance of its points from the shapes, and from where distance and normal put them
  double plane;     // separation along the normal less the distance, if negative
  double depth;     // excess over the least depth, relative to that depth
};

inline double smaller(const Scene& s) { return std::min(size_of(s.a), size_of(s.b)); }

inline Faults faults(const Scene& s, const Result& r, bool brute = true) {
  Faults f = {r.status == Status::Failed, 0, 0, 0};
  if (r.distance == -shape::infinity) return f;  // half-spaces
  f.failed = f.failed || !std::isfinite(r.distance) || !(std::abs(shape::norm(r.normal) - 1) < 1e-12) ||
             !std::isfinite(dot(r.point_a, r.point_b));
  if (f.failed) return f;
  const double small = smaller(s), rounding = 2e-15 * (size_of(s.a) + size_of(s.b) + shape::norm(s.A.p) + shape::norm(s.B.p));
  auto beyond_rounding = [&](double error) { return std::max(0.0, error - rounding) / small; };
  f.witness = beyond_rounding(std::max(
      {outside(s.a, s.A, r.point_a), outside(s.b, s.B, r.point_b), shape::norm(r.point_b - r.point_a - r.normal * r.distance)}));
  f.plane = beyond_rounding(r.distance + overlap(s, r.normal));
  if (brute && r.distance < -1e-6 * small && s.a.shape.type != Type::HalfSpace && s.b.shape.type != Type::HalfSpace) {
    const double least = BruteForce(s).depth();
    f.depth = std::max(0.0, -r.distance - least - 1e-9 * small - rounding) / least;
  }
  return f;
}

}  // namespace dyn_test
