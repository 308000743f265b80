// State of a search through two surfaces, and bounds of pieces and boxes.
#pragma once

#include "collision/result.hpp"
#include "shape/triangles.hpp"

namespace dyn::collision {

using namespace shape;

// The nearest pair of pieces so far.
struct NearestPair {
  Result best{};
  double limit = infinity;  // pairs farther apart are skipped
  double tie, same;         // distances are equal within tie, points within same

  explicit NearestPair(double size) : tie(1e-9 * size), same(1e-5 * size) { best.distance = infinity, best.unique = true; }

  // Rounding made the guessed limit too low: search again without a limit.
  bool nothing() {
    if (best.distance < infinity) return false;
    limit = infinity;
    return true;
  }
  // Returns whether r is the new best.
  bool consider(const Result& r) {
    best.iterations += r.iterations;
    if (!(r.distance <= limit)) return false;
    const bool better = r.distance < best.distance, tied = std::abs(r.distance - best.distance) <= tie;
    const bool other = tied && (norm(r.point_a - best.point_a) > same || norm(r.normal - best.normal) > 1e-5);
    const bool unique = (r.unique || !(better || tied)) && (best.unique || !tied) && !other;
    if (better) {
      const Index iterations = best.iterations;
      best = r, best.iterations = iterations, limit = r.distance + tie;
    }
    best.unique = better || tied ? unique : best.unique;
    return better;
  }
};

inline Bounds transformed(const Bounds& b, const Pose& X) {
  const Vec c = X.act(middle(b)), h = half_of(b), r = sizes(X.R.x) * h[0] + sizes(X.R.y) * h[1] + sizes(X.R.z) * h[2];
  return {c - r, c + r};
}
constexpr Index max_pieces = TriangleTree::leaf_size;  // of a leaf

// Corners of a piece in some frame, its centre, and the normal of its triangle.
struct Corners {
  Vec at[6], center, normal;
  int count;
  Bounds box;

  Corners() = default;
  Corners(const Facet& f, const Pose& X) : center(X.act(f.origin)), normal(X.R * f.hull.normal(0)), count(f.hull.vertices) {
    const Vec first = X.act(f.corner(0));
    at[0] = first, box = {first, first};
    for (int k = 1; k < count; ++k) {
      const Vec p = X.act(f.corner(k));
      at[k] = p, box = {lesser(box.lower, p), greater(box.upper, p)};
    }
  }
  double support_height(const Vec& n) const {
    double most = dot(n, at[0]);
    for (int k = 1; k < count; ++k) most = std::max(most, dot(n, at[k]));
    return most;
  }
};

// Unit vector from p to q.
inline Vec toward(const Vec& p, const Vec& q) {
  const Vec d = q - p;
  const double length = norm(d);
  return length > 0 ? d * (1 / length) : axis(2);
}

// Support point of a shape along n; n and the point are in the frame that X leads to.
template <class B>
Vec farthest(const B& b, const Pose& X, const Vec& n) {
  return X.act(b.support(transpose_times(X.R, n))) + n * b.radius;
}

}  // namespace dyn::collision
