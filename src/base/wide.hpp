// Four numbers as one: a scalar for the templates that computes four things of a kind side by side, each as it would be by itself. (Eight, where one
// instruction takes as many, are no faster.)
#pragma once

#include <cmath>
#include <cstring>

#include "base/types.hpp"

namespace dyn {

struct Wide {
  static constexpr int lanes = 4;
  typedef double Lanes __attribute__((vector_size(8 * lanes)));
  typedef std::int64_t Mask __attribute__((vector_size(8 * lanes)));  // of a lane all bits, or none
  Lanes x;

  Wide() = default;
  DYN_INLINE Wide(double a) : x(Lanes{} + a) {}
  explicit DYN_INLINE Wide(Lanes a) : x(a) {}
  friend DYN_INLINE Wide operator+(const Wide& a, const Wide& b) { return Wide(a.x + b.x); }
  friend DYN_INLINE Wide operator-(const Wide& a, const Wide& b) { return Wide(a.x - b.x); }
  friend DYN_INLINE Wide operator*(const Wide& a, const Wide& b) { return Wide(a.x * b.x); }
  friend DYN_INLINE Wide operator/(const Wide& a, const Wide& b) { return Wide(a.x / b.x); }
  friend DYN_INLINE Mask operator<(const Wide& a, const Wide& b) { return a.x < b.x; }
  friend DYN_INLINE Mask operator>(const Wide& a, const Wide& b) { return a.x > b.x; }
  DYN_INLINE double operator[](int lane) const { return x[lane]; }
};

DYN_INLINE Wide select(const Wide::Mask& m, const Wide& a, const Wide& b) { return Wide(m ? a.x : b.x); }
DYN_INLINE Wide min(const Wide& a, const Wide& b) { return Wide(a.x < b.x ? a.x : b.x); }
DYN_INLINE Wide max(const Wide& a, const Wide& b) { return Wide(a.x < b.x ? b.x : a.x); }
// A bit for each lane.
DYN_INLINE unsigned bits_of(const Wide::Mask& m) {
#if defined(__AVX__)
  return unsigned(__builtin_ia32_movmskpd256((Wide::Lanes)m));
#else
  unsigned bits = 0;
  for (int k = 0; k < Wide::lanes; ++k) bits |= unsigned(m[k] & 1) << k;
  return bits;
#endif
}
// f(lane) for each bit
template <class F>
DYN_INLINE void for_each_bit(unsigned bits, F&& f) {
  for (; bits; bits &= bits - 1) f(int(__builtin_ctz(bits)));
}
DYN_INLINE bool any(const Wide::Mask& m) { return bits_of(m) != 0; }
DYN_INLINE Wide load_wide(const double* p) {
  Wide a;
  std::memcpy(&a.x, p, sizeof a.x);
  return a;
}
DYN_INLINE Wide sqrt(const Wide& a) {
  Wide b;
  for (int k = 0; k < Wide::lanes; ++k) b.x[k] = std::sqrt(a.x[k]);
  return b;
}

namespace detail {

// Rows of a 4 x 4 matrix from its columns.
DYN_INLINE void transpose4(Wide::Lanes (&a)[4]) {
  const Wide::Lanes ab02 = __builtin_shufflevector(a[0], a[1], 0, 4, 2, 6), ab13 = __builtin_shufflevector(a[0], a[1], 1, 5, 3, 7);
  const Wide::Lanes cd02 = __builtin_shufflevector(a[2], a[3], 0, 4, 2, 6), cd13 = __builtin_shufflevector(a[2], a[3], 1, 5, 3, 7);
  a[0] = __builtin_shufflevector(ab02, cd02, 0, 1, 4, 5), a[1] = __builtin_shufflevector(ab13, cd13, 0, 1, 4, 5);
  a[2] = __builtin_shufflevector(ab02, cd02, 2, 3, 6, 7), a[3] = __builtin_shufflevector(ab13, cd13, 2, 3, 6, 7);
}

}  // namespace detail

// The n numbers from base + at[lane] on, n from 4 to 8.
template <int n>
DYN_INLINE void gather(const double* base, const Index* at, Wide* out) {
  const auto four = [&](int first) DYN_INLINE_LAMBDA {
    Wide::Lanes rows[4];
    for (int l = 0; l < 4; ++l) std::memcpy(&rows[l], base + at[l] + first, sizeof rows[l]);
    detail::transpose4(rows);
    for (int k = 0; k < 4; ++k) out[first + k] = Wide(rows[k]);
  };
  four(0);
  if constexpr (n > 4) four(n - 4);
}
// f(lane, its a, b, c, d)
template <class F>
DYN_INLINE void for_each_lane(const Wide& a, const Wide& b, const Wide& c, const Wide& d, F&& f) {
  Wide::Lanes rows[4] = {a.x, b.x, c.x, d.x};
  detail::transpose4(rows);
  for (int l = 0; l < 4; ++l) f(l, rows[l]);
}

}  // namespace dyn
