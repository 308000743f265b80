// Index of the largest of many numbers, eight at a time.
#pragma once

#include "base/simd_shuffle.hpp"

namespace dyn::shape {

inline constexpr int argmax_lanes = 8;
using ArgmaxBlock = Simd<double, argmax_lanes>;

// Index of the largest of n >= 1 numbers. at(i) returns the eight numbers from i on. Padding must not exceed the largest number.
template <class F>
DYN_INLINE std::int64_t argmax(std::int64_t n, F&& at) {
  using Ids = Simd<std::int64_t, argmax_lanes>;
  ArgmaxBlock most = at(0);
  Ids base(0, 1, 2, 3, 4, 5, 6, 7), id = base;
  for (std::int64_t i = argmax_lanes; i < n; i += argmax_lanes) {
    const ArgmaxBlock x = at(i);
    base = base + argmax_lanes;
    const auto more = x > most;
    most = select(more, x, most), id = select(more, base, id);
  }
  // the largest of the two halves, then of pairs
  const Double4 low = slice4<0>(most), high = slice4<4>(most);
  const auto above = high > low;
  const Double4 m = select(above, high, low);
  const Simd<std::int64_t, 4> k = select(above, slice4<4>(id), slice4<0>(id));
  const int a = m[1] > m[0] ? 1 : 0, b = m[3] > m[2] ? 3 : 2;
  return m[b] > m[a] ? k[b] : k[a];
}

}  // namespace dyn::shape
