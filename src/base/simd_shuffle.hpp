// Lanes in another order.
#pragma once

#include "base/simd.hpp"

namespace dyn {

namespace detail {
// the register of lane k
template <int k, class T, int N>
DYN_INLINE const auto& register_of(const Simd<T, N>& a) {
  if constexpr (is_vector<T, N>)
    return a;
  else if constexpr (k < N / 2)
    return register_of<k>(a.low);
  else
    return register_of<k - N / 2>(a.high);
}
}  // namespace detail

// The lanes i of a and b together: those of a are 0 .. N - 1, those of b N .. 2 N - 1.
template <int... i, class T, int N>
DYN_INLINE Simd<T, int(sizeof...(i))> shuffle(const Simd<T, N>& a, const Simd<T, N>& b) {
  using Result = Simd<T, int(sizeof...(i))>;
  constexpr int from[] = {i...};
  if constexpr (detail::is_vector<T, N> && detail::is_vector<T, Result::lanes>) {
    return Result::of(__builtin_shufflevector(a.x, b.x, i...));
  } else if constexpr (detail::is_halved<T, Result::lanes>) {
    return [&]<std::size_t... k>(std::index_sequence<k...>) DYN_INLINE_LAMBDA {
      return Result::of(shuffle<from[k]...>(a, b), shuffle<from[Result::half + k]...>(a, b));
    }(std::make_index_sequence<Result::half>{});
  } else if constexpr (detail::is_halved<T, N> && Result::lanes == 2) {
    const auto& first = detail::register_of<from[0] % N>(from[0] < N ? a : b);
    const auto& second = detail::register_of<from[1] % N>(from[1] < N ? a : b);
    constexpr int lanes = std::remove_cvref_t<decltype(first)>::lanes;
    return Result::of(__builtin_shufflevector(first.x, second.x, from[0] % lanes, lanes + from[1] % lanes));
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
  if constexpr (N == 4)
    return a;
  else if constexpr (!detail::is_halved<T, N>)
    return shuffle<first, first + 1, first + 2, first + 3>(a);
  else if constexpr (first % (N / 2) <= N / 2 - 4)
    return slice4<first % (N / 2)>(first < N / 2 ? a.low : a.high);
  else
    return shuffle<first, first + 1, first + 2, first + 3>(a);
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
