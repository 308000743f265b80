// Index of the largest of many numbers, eight at a time.
#pragma once

#include <cstdint>

#include "base/types.hpp"

namespace dyn::shape {

struct Lanes {
  static constexpr int count = 8;
  typedef double Numbers __attribute__((vector_size(8 * count)));

  // at(i) returns eight numbers from the i-th on. n >= 1. Padding must not exceed the real maximum.
  template <class F>
  DYN_INLINE static std::int64_t largest(std::int64_t n, F&& at) {
    typedef std::int64_t Ids __attribute__((vector_size(8 * count)));
    typedef double Half __attribute__((vector_size(4 * count)));
    typedef std::int64_t HalfIds __attribute__((vector_size(4 * count)));
    Numbers most;
    at(0, most);
    Ids base = {0, 1, 2, 3, 4, 5, 6, 7}, id = base;
    for (std::int64_t i = count; i < n; i += count) {
      Numbers x;
      at(i, x);
      base += count;
      const Ids more = x > most;
      most = more ? x : most;
      id = more ? base : id;
    }
    // reduce the halves, then the quarters
    const Half low = __builtin_shufflevector(most, most, 0, 1, 2, 3), high = __builtin_shufflevector(most, most, 4, 5, 6, 7);
    const HalfIds id_low = __builtin_shufflevector(id, id, 0, 1, 2, 3), id_high = __builtin_shufflevector(id, id, 4, 5, 6, 7), above = high > low;
    const Half m = above ? high : low;
    const HalfIds k = above ? id_high : id_low;
    const int a = m[1] > m[0] ? 1 : 0, b = m[3] > m[2] ? 3 : 2;
    return m[b] > m[a] ? k[b] : k[a];
  }
};

}  // namespace dyn::shape
