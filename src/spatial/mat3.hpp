// 3 x 3 matrices by columns.
#pragma once

#include "spatial/vec3.hpp"

namespace dyn {

template <class T>
struct Mat3 {
  Vec3<T> x, y, z;  // columns; named, not an array, so that compilers keep them in registers

  static DYN_INLINE Mat3 zero() { return {Vec3<T>::zero(), Vec3<T>::zero(), Vec3<T>::zero()}; }
  static DYN_INLINE Mat3 identity() { return diagonal(T(1), T(1), T(1)); }
  static DYN_INLINE Mat3 diagonal(T x, T y, T z) {
    return {Vec3<T>::make(x, T(0), T(0)), Vec3<T>::make(T(0), y, T(0)), Vec3<T>::make(T(0), T(0), z)};
  }
  DYN_INLINE const Vec3<T>& operator[](int col) const { return col == 0 ? x : col == 1 ? y : z; }
  DYN_INLINE T operator()(int row, int col) const { return (*this)[col][row]; }

  friend DYN_INLINE Vec3<T> operator*(const Mat3& A, const Vec3<T>& x) { return A.x * x[0] + A.y * x[1] + A.z * x[2]; }
  friend DYN_INLINE Mat3 operator*(const Mat3& A, const Mat3& B) { return {A * B.x, A * B.y, A * B.z}; }
  friend DYN_INLINE Mat3 operator*(const Mat3& A, T s) { return {A.x * s, A.y * s, A.z * s}; }
  friend DYN_INLINE Mat3 operator+(const Mat3& A, const Mat3& B) { return {A.x + B.x, A.y + B.y, A.z + B.z}; }
  friend DYN_INLINE Mat3 operator-(const Mat3& A, const Mat3& B) { return {A.x - B.x, A.y - B.y, A.z - B.z}; }
};

template <class T>
DYN_INLINE Mat3<T> transpose(const Mat3<T>& A) {
  return {Vec3<T>::make(A(0, 0), A(0, 1), A(0, 2)), Vec3<T>::make(A(1, 0), A(1, 1), A(1, 2)),
          Vec3<T>::make(A(2, 0), A(2, 1), A(2, 2))};
}
#if DYN_LANES == 4
template <>
DYN_INLINE Mat3<double> transpose(const Mat3<double>& A) {
  const Double4 a = A.x.v, b = A.y.v, c = A.z.v, zero = Double4::zero();
  const Double4 ab02 = shuffle<0, 4, 2, 6>(a, b), ab13 = shuffle<1, 5, 3, 7>(a, b);        // a0 b0 a2 b2, a1 b1 . .
  const Double4 cz02 = shuffle<0, 4, 2, 6>(c, zero), cz13 = shuffle<1, 5, 3, 7>(c, zero);  // c0 0 c2 0, c1 0 . 0
  return {{shuffle<0, 1, 4, 5>(ab02, cz02)}, {shuffle<0, 1, 4, 5>(ab13, cz13)}, {shuffle<2, 3, 6, 7>(ab02, cz02)}};
}
#endif

// A^T x
template <class T>
DYN_INLINE Vec3<T> transpose_times(const Mat3<T>& A, const Vec3<T>& x) {
  return transpose(A) * x;
}
// the matrix of a x
template <class T>
DYN_INLINE Mat3<T> skew(const Vec3<T>& a) {
  return {Vec3<T>::make(T(0), a[2], -a[1]), Vec3<T>::make(-a[2], T(0), a[0]), Vec3<T>::make(a[1], -a[0], T(0))};
}
// a b^T
template <class T>
DYN_INLINE Mat3<T> outer(const Vec3<T>& a, const Vec3<T>& b) {
  return {a * b[0], a * b[1], a * b[2]};
}
// A B^T
template <class T>
DYN_INLINE Mat3<T> times_transpose(const Mat3<T>& A, const Mat3<T>& B) {
  return {A.x * B.x[0] + A.y * B.y[0] + A.z * B.z[0], A.x * B.x[1] + A.y * B.y[1] + A.z * B.z[1],
          A.x * B.x[2] + A.y * B.y[2] + A.z * B.z[2]};
}
// tr(A) (1, 1, 1)
template <class T>
DYN_INLINE Vec3<T> trace3(const Mat3<T>& A) {
  const T t = A.x[0] + A.y[1] + A.z[2];
  return Vec3<T>::make(t, t, t);
}
#if DYN_LANES == 4
template <>
DYN_INLINE Vec3<double> trace3(const Mat3<double>& A) {
  const Vec3<double> d{shuffle<0, 1, 6, 3>(shuffle<0, 5, 2, 3>(A.x.v, A.y.v), A.z.v)};
  return d + yzx(d) + zxy(d);
}
#endif
// [a]x B
template <class T>
DYN_INLINE Mat3<T> cross(const Vec3<T>& a, const Mat3<T>& B) {
  return {cross(a, B.x), cross(a, B.y), cross(a, B.z)};
}
// B [a]x
template <class T>
DYN_INLINE Mat3<T> times_skew(const Mat3<T>& B, const Vec3<T>& a) {
  return {B.y * a[2] - B.z * a[1], B.z * a[0] - B.x * a[2], B.x * a[1] - B.y * a[0]};
}
// A Rz(angle), given (cos, sin)
template <class T>
DYN_INLINE Mat3<T> rotate_z(const Mat3<T>& A, T c, T s) {
  return {A.x * c + A.y * s, A.y * c - A.x * s, A.z};
}
template <class To, class From>
DYN_INLINE decltype(auto) cast(const Mat3<From>& A) {
  if constexpr (std::is_same_v<To, From>)
    return (A);
  else
    return Mat3<To>{cast<To>(A.x), cast<To>(A.y), cast<To>(A.z)};
}
template <class T>
DYN_INLINE Mat3<T> load33(const T* p) {
  return {load3(p), load3(p + 3), load3(p + 6)};
}
template <class T>
DYN_INLINE void store33(const Mat3<T>& A, T* p) {
  store3(A.x, p), store3(A.y, p + 3), store3(A.z, p + 6);
}

}  // namespace dyn
