// Eight boxes tested at once. Single precision, rounded outward: boxes that do not overlap here do not overlap at all.
#pragma once

#include <cfloat>

#include "shape/shape.hpp"

namespace dyn::collision {

typedef float Float8 __attribute__((vector_size(32)));
typedef std::int32_t Int8 __attribute__((vector_size(32)));

// One bit for each true lane.
DYN_INLINE unsigned lanes_of(Int8 m) {
#if defined(__AVX__)
  return unsigned(__builtin_ia32_movmskps256((Float8)m));
#else
  unsigned bits = 0;
  for (int k = 0; k < 8; ++k) bits |= unsigned(m[k] & 1) << k;
  return bits;
#endif
}

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
  static constexpr Index lanes = 8;
  Float8 lower[3], upper[3];

  // Empty lanes, which overlap no box.
  void clear() {
    for (int i = 0; i < 3; ++i) lower[i] = Float8{} + FLT_MAX, upper[i] = Float8{} - FLT_MAX;
  }
  void set(Index k, const Box& b) {
    for (int i = 0; i < 3; ++i) lower[i][k] = b.lower[i], upper[i][k] = b.upper[i];
  }
  void clear(Index k) {
    for (int i = 0; i < 3; ++i) lower[i][k] = FLT_MAX, upper[i][k] = -FLT_MAX;
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
    return lanes_of((lower[0] <= b.upper[0]) & (upper[0] >= b.lower[0]) & (lower[1] <= b.upper[1]) & (upper[1] >= b.lower[1]) &
                    (lower[2] <= b.upper[2]) & (upper[2] >= b.lower[2]));
  }
};

// calls f(k) for each set bit
template <class F>
DYN_INLINE void for_each_lane(unsigned bits, F&& f) {
  for (; bits; bits &= bits - 1) f(Index(__builtin_ctz(bits)));
}

}  // namespace dyn::collision
