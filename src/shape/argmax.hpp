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
  // the largest of the two halves, of neighbours, of pairs; the first of equals, without a branch that depends on the numbers
  const Double4 low = slice4<0>(most), high = slice4<4>(most);
  const auto upper = high > low;
  const Double4 m = select(upper, high, low), beside = shuffle<1, 0, 3, 2>(m);
  const Simd<std::int64_t, 4> k = select(upper, slice4<4>(id), slice4<0>(id));
  const auto next = beside > m;
  const Double4 pair = select(next, beside, m);
  const Simd<std::int64_t, 4> of_pair = select(next, shuffle<1, 0, 3, 2>(k), k);
  return select(shuffle<2, 3, 0, 1>(pair) > pair, shuffle<2, 3, 0, 1>(of_pair), of_pair)[0];
}

}  // namespace dyn::shape
