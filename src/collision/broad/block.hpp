// Eight boxes tested at once. Single precision, rounded outward: boxes that do not overlap here do not overlap at all.
#pragma once

#include <cfloat>

#include "base/simd.hpp"
#include "shape/shape.hpp"

namespace dyn::collision {

using Floats = Simd<float, 8>;

struct Box {
  float lower[3], upper[3];

  static float down(double x) {
    const float f = float(std::clamp(x, -1e30, 1e30));
    return f - (std::abs(f) * FLT_EPSILON + FLT_MIN);
  }
  static float up(double x) { return -down(-x); }
  static Box of(const shape::Bounds& b, double margin) {
    Box out;
    for (int i = 0; i < 3; ++i) out.lower[i] = down(b.lower[i] - margin), out.upper[i] = up(b.upper[i] + margin);
    return out;
  }
  bool contains(const Box& b) const {
    bool in = true;
    for (int i = 0; i < 3; ++i) in &= lower[i] <= b.lower[i] && b.upper[i] <= upper[i];
    return in;
  }
};

struct Block {
  static constexpr Index lanes = Floats::lanes;
  Floats lower[3], upper[3];

  // Empty lanes, which overlap no box.
  void clear() {
    for (int i = 0; i < 3; ++i) lower[i] = FLT_MAX, upper[i] = -FLT_MAX;
  }
  void set(Index k, const Box& b) {
    for (int i = 0; i < 3; ++i) lower[i].set(k, b.lower[i]), upper[i].set(k, b.upper[i]);
  }
  void clear(Index k) {
    for (int i = 0; i < 3; ++i) lower[i].set(k, FLT_MAX), upper[i].set(k, -FLT_MAX);
  }
  Box box(Index k) const {
    return {{lower[0][k], lower[1][k], lower[2][k]}, {upper[0][k], upper[1][k], upper[2][k]}};
  }
  Box hull() const {
    Box b = box(0);
    for (Index k = 1; k < lanes; ++k)
      for (int i = 0; i < 3; ++i) b.lower[i] = std::min(b.lower[i], lower[i][k]), b.upper[i] = std::max(b.upper[i], upper[i][k]);
    return b;
  }
  DYN_INLINE unsigned overlaps(const Box& b) const {
    return bits_of((lower[0] <= b.upper[0]) & (upper[0] >= b.lower[0]) & (lower[1] <= b.upper[1]) & (upper[1] >= b.lower[1]) &
                   (lower[2] <= b.upper[2]) & (upper[2] >= b.lower[2]));
  }
};

}  // namespace dyn::collision
