// Lanes in another order.
#pragma once

#include "base/simd.hpp"

namespace dyn {

namespace detail {
// the register of index k
template <class T, int N>
DYN_INLINE const auto& part(const Simd<T, N>& a, int k) {
  if constexpr (is_vector<T, N>) return a;
  else return a.x[k];
}
}  // namespace detail

// The lanes i of a and b together: those of a are 0 .. N - 1, those of b N .. 2 N - 1.
template <int... i, class T, int N>
DYN_INLINE Simd<T, int(sizeof...(i))> shuffle(const Simd<T, N>& a, const Simd<T, N>& b) {
  using Result = Simd<T, int(sizeof...(i))>;
  if constexpr (detail::is_vector<T, N> && detail::is_vector<T, Result::lanes>) {
    return Result::of(__builtin_shufflevector(a.x, b.x, i...));
  } else if constexpr (detail::part_lanes<T> == 2) {
    constexpr int from[] = {i...};
    const auto two = [&]<int first, int second>() DYN_INLINE_LAMBDA {
      const auto part = [&](int k) DYN_INLINE_LAMBDA { return detail::part(k < N ? a : b, k % N / 2).x; };
      return Simd<T, 2>::of(__builtin_shufflevector(part(first), part(second), first % 2, 2 + second % 2));
    };
    if constexpr (Result::lanes == 2) {
      return two.template operator()<from[0], from[1]>();
    } else {
      Result r;
      [&]<std::size_t... k>(std::index_sequence<k...>) DYN_INLINE_LAMBDA {
        ((r.x[k] = two.template operator()<from[2 * k], from[2 * k + 1]>()), ...);
      }(std::make_index_sequence<Result::parts>{});
      return r;
    }
  } else {
    return Result((i < N ? a[i % N] : b[i % N])...);
  }
}
template <int... i, class T, int N>
DYN_INLINE Simd<T, int(sizeof...(i))> shuffle(const Simd<T, N>& a) {
  return shuffle<i...>(a, a);
}
// one lane everywhere
template <int lane, class T>
DYN_INLINE Simd<T, 4> broadcast(const Simd<T, 4>& a) {
  return shuffle<lane, lane, lane, lane>(a);
}
// the first count lanes of a, the others of b
template <int count, class T>
DYN_INLINE Simd<T, 4> blend(const Simd<T, 4>& a, const Simd<T, 4>& b) {
  return shuffle<(count > 0 ? 0 : 4), (count > 1 ? 1 : 5), (count > 2 ? 2 : 6), (count > 3 ? 3 : 7)>(a, b);
}
// the four lanes from first on
template <int first, class T, int N>
DYN_INLINE Simd<T, 4> slice4(const Simd<T, N>& a) {
  constexpr int part = detail::part_lanes<T>;
  if constexpr (N == 4) return a;
  else if constexpr (detail::is_vector<T, N> || part == 1) return shuffle<first, first + 1, first + 2, first + 3>(a);
  else if constexpr (part == 2) return shuffle<0, 1, 2, 3>(a.x[first / 2], a.x[first / 2 + 1]);
  else return slice4<first % part>(a.x[first / part]);
}
// Rows of a 4 x 4 matrix from its columns.
template <class T>
DYN_INLINE void transpose4(const Simd<T, 4>& a, const Simd<T, 4>& b, const Simd<T, 4>& c, const Simd<T, 4>& d, Simd<T, 4>& x,
                           Simd<T, 4>& y, Simd<T, 4>& z, Simd<T, 4>& w) {
  const Simd<T, 4> ab0 = shuffle<0, 4, 2, 6>(a, b), ab1 = shuffle<1, 5, 3, 7>(a, b), cd0 = shuffle<0, 4, 2, 6>(c, d),
                   cd1 = shuffle<1, 5, 3, 7>(c, d);
  x = shuffle<0, 1, 4, 5>(ab0, cd0), y = shuffle<0, 1, 4, 5>(ab1, cd1), z = shuffle<2, 3, 6, 7>(ab0, cd0),
  w = shuffle<2, 3, 6, 7>(ab1, cd1);
}

}  // namespace dyn
