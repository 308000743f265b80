// Four lanes in memory: the first ones alone, or numbers at four places.
#pragma once

#include "base/simd_shuffle.hpp"

namespace dyn {

#if defined(__AVX__) && DYN_LANES == 4
namespace detail {
// A mask of the first count lanes.
DYN_INLINE Simd<long long, 4>::Vector first_lanes(int count) {
  return reinterpret<long long>(Simd<std::int64_t, 4>(0, 1, 2, 3) < count).x;
}
}  // namespace detail
#endif

// The first count lanes. Loaded, the others are zero.
template <class T>
DYN_INLINE Simd<T, 4> load_partial(const T* p, int count) {
#if defined(__AVX__) && DYN_LANES == 4
  if constexpr (std::is_same_v<T, double>)
    return Double4::of(__builtin_ia32_maskloadpd256(reinterpret_cast<const Double4::Vector*>(p), detail::first_lanes(count)));
#endif
  Simd<T, 4> a;
  for (int k = 0; k < 4; ++k) a.set(k, k < count ? p[k] : T(0));
  return a;
}
template <class T>
DYN_INLINE void store_partial(const Simd<T, 4>& a, T* p, int count) {
#if defined(__AVX__) && DYN_LANES == 4
  if constexpr (std::is_same_v<T, double>)
    return __builtin_ia32_maskstorepd256(reinterpret_cast<Double4::Vector*>(p), detail::first_lanes(count), a.x);
#endif
  for (int k = 0; k < count; ++k) p[k] = a[k];
}

// The same for a count known to the compiler, in pieces that are read back as fast as they are written.
template <int count, class T>
DYN_INLINE Simd<T, 4> load_partial(const T* p) {
  if constexpr (count == 4) {
    return Simd<T, 4>::load(p);
  } else if constexpr (detail::has_vectors<T>) {
    using Two = Simd<T, 2>;
    const Two low = count == 1 ? Two(p[0], T(0)) : Two::load(p), high = count == 3 ? Two(p[2], T(0)) : Two::zero();
    return shuffle<0, 1, 2, 3>(low, high);
  } else {
    return load_partial(p, count);
  }
}
template <int count, class T>
DYN_INLINE void store_partial(const Simd<T, 4>& a, T* p) {
  if constexpr (count == 4) {
    a.store(p);
  } else if constexpr (detail::has_vectors<T>) {
    const Simd<T, 2> low = shuffle<0, 1>(a);
    if constexpr (count > 1) low.store(p);
    if constexpr (count != 2) p[count - 1] = a[count - 1];
  } else {
    for (int k = 0; k < count; ++k) p[k] = a[k];
  }
}

// out[k]: the numbers at base + at[lane] + k for k < n, n from 4 to 8
template <int n>
DYN_INLINE void gather(const double* base, const Index* at, Double4* out) {
  const auto four = [&](int first) DYN_INLINE_LAMBDA {
    const auto row = [&](int lane) DYN_INLINE_LAMBDA { return Double4::load(base + at[lane] + first); };
    transpose4(row(0), row(1), row(2), row(3), out[first], out[first + 1], out[first + 2], out[first + 3]);
  };
  four(0);
  if constexpr (n > 4) four(n - 4);
}
// f(lane, its a, b, c, d)
template <class F>
DYN_INLINE void for_each_lane(const Double4& a, const Double4& b, const Double4& c, const Double4& d, F&& f) {
  Double4 x, y, z, w;
  transpose4(a, b, c, d, x, y, z, w);
  f(0, x), f(1, y), f(2, z), f(3, w);
}

}  // namespace dyn
