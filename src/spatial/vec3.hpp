// 3-vectors. Vec3<double> fills four lanes (the fourth is always 0), so that a sum or a product by a scalar is one
// instruction; every other scalar (references in long double, __float128) uses three plain numbers.
#pragma once

#include <cmath>
#include <type_traits>

#include "base/simd_shuffle.hpp"

namespace dyn {

template <class T>
struct Vec3 {
  T v[3];

  static DYN_INLINE Vec3 zero() { return {{T(0), T(0), T(0)}}; }
  static DYN_INLINE constexpr Vec3 make(T x, T y, T z) { return {{x, y, z}}; }
  DYN_INLINE T operator[](int i) const { return v[i]; }

  friend DYN_INLINE Vec3 operator+(const Vec3& a, const Vec3& b) {
    return make(a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2]);
  }
  friend DYN_INLINE Vec3 operator-(const Vec3& a, const Vec3& b) {
    return make(a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2]);
  }
  friend DYN_INLINE Vec3 operator*(const Vec3& a, T s) { return make(a.v[0] * s, a.v[1] * s, a.v[2] * s); }
  friend DYN_INLINE Vec3 cross(const Vec3& a, const Vec3& b) {
    return make(a.v[1] * b.v[2] - a.v[2] * b.v[1], a.v[2] * b.v[0] - a.v[0] * b.v[2], a.v[0] * b.v[1] - a.v[1] * b.v[0]);
  }
  friend DYN_INLINE T dot(const Vec3& a, const Vec3& b) { return a.v[0] * b.v[0] + a.v[1] * b.v[1] + a.v[2] * b.v[2]; }
  // sizes of the components, their products, and the components in cyclic order
  friend DYN_INLINE Vec3 sizes(const Vec3& a) {
    using std::abs;
    return make(abs(a.v[0]), abs(a.v[1]), abs(a.v[2]));
  }
  friend DYN_INLINE Vec3 hadamard(const Vec3& a, const Vec3& b) {
    return make(a.v[0] * b.v[0], a.v[1] * b.v[1], a.v[2] * b.v[2]);
  }
  friend DYN_INLINE Vec3 yzx(const Vec3& a) { return make(a.v[1], a.v[2], a.v[0]); }
  friend DYN_INLINE Vec3 zxy(const Vec3& a) { return make(a.v[2], a.v[0], a.v[1]); }
};

#if DYN_LANES == 4
template <>
struct Vec3<double> {
  // Aligned as with AVX. A model's block is then the same on x86-64, on ARM and for every compiler (dynb.hpp).
  alignas(32) Double4 v;

  static DYN_INLINE Vec3 zero() { return {Double4::zero()}; }
  static DYN_INLINE constexpr Vec3 make(double x, double y, double z) { return {Double4(x, y, z, 0)}; }
  DYN_INLINE double operator[](int i) const { return v[i]; }

  friend DYN_INLINE Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.v + b.v}; }
  friend DYN_INLINE Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.v - b.v}; }
  friend DYN_INLINE Vec3 operator*(const Vec3& a, double s) { return {a.v * s}; }
  // a x b = (a * b_yzx - a_yzx * b)_yzx: three shuffles
  friend DYN_INLINE Vec3 cross(const Vec3& a, const Vec3& b) {
    const Double4 first = a.v * yzx(b).v;  // GCC contracts the product that it meets first
    return yzx(Vec3{first - yzx(a).v * b.v});
  }
  friend DYN_INLINE double dot(const Vec3& a, const Vec3& b) {
    const Double4 p = a.v * b.v;
    return p[0] + p[1] + p[2];
  }
  friend DYN_INLINE Vec3 sizes(const Vec3& a) { return {abs(a.v)}; }
  friend DYN_INLINE Vec3 hadamard(const Vec3& a, const Vec3& b) { return {a.v * b.v}; }
  friend DYN_INLINE Vec3 yzx(const Vec3& a) { return {shuffle<1, 2, 0, 3>(a.v)}; }
  friend DYN_INLINE Vec3 zxy(const Vec3& a) { return {shuffle<2, 0, 1, 3>(a.v)}; }
};
#endif

template <class T>
DYN_INLINE Vec3<T> operator*(T s, const Vec3<T>& a) {
  return a * s;
}
template <class T>
DYN_INLINE Vec3<T> operator-(const Vec3<T>& a) {
  return Vec3<T>::zero() - a;
}
template <class T>
DYN_INLINE Vec3<T>& operator+=(Vec3<T>& a, const Vec3<T>& b) {
  return a = a + b;
}
template <class T>
DYN_INLINE Vec3<T>& operator-=(Vec3<T>& a, const Vec3<T>& b) {
  return a = a - b;
}
template <class T>
DYN_INLINE Vec3<T> load3(const T* p) {
  return Vec3<T>::make(p[0], p[1], p[2]);
}
template <class T>
DYN_INLINE void store3(const Vec3<T>& a, T* p) {
  p[0] = a[0], p[1] = a[1], p[2] = a[2];
}
// In the same type a reference: components that are in memory can be broadcast by a load, those in a register take a shuffle.
template <class To, class From>
DYN_INLINE decltype(auto) cast(const Vec3<From>& a) {
  if constexpr (std::is_same_v<To, From>)
    return (a);
  else
    return Vec3<To>::make(To(a[0]), To(a[1]), To(a[2]));
}

}  // namespace dyn
