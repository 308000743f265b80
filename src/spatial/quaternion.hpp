// Unit quaternions (x, y, z, w).
#pragma once

#include <cmath>

#include "spatial/mat3.hpp"

namespace dyn {

template <class T>
struct Quaternion {
  Vec3<T> v;  // x, y, z
  T w;

  static DYN_INLINE Quaternion identity() { return {Vec3<T>::zero(), T(1)}; }
  friend DYN_INLINE Quaternion operator*(const Quaternion& a, const Quaternion& b) {
    return {b.v * a.w + a.v * b.w + cross(a.v, b.v), a.w * b.w - dot(a.v, b.v)};
  }
  DYN_INLINE Quaternion conjugate() const { return {-v, w}; }
};

template <class T>
DYN_INLINE Quaternion<T> load_quaternion(const T* q) {
  return {load3(q), q[3]};
}
template <class T>
DYN_INLINE void store(const Quaternion<T>& a, T* q) {
  store3(a.v, q), q[3] = a.w;
}

template <class T>
inline T norm(const Quaternion<T>& a) {
  using std::sqrt;
  return sqrt(dot(a.v, a.v) + a.w * a.w);
}

// a / |a| for every finite a != 0: scaled first where the square would overflow or lose digits.
template <class T>
inline Quaternion<T> normalized(const Quaternion<T>& a) {
  using std::abs;
  using std::sqrt;
  T n2 = dot(a.v, a.v) + a.w * a.w;
  if (n2 > T(1e-200) && n2 < T(1e200)) {
    const T r = T(1) / sqrt(n2);
    return {a.v * r, a.w * r};
  }
  T big = abs(a.w);
  for (int i = 0; i < 3; ++i)
    if (abs(a.v[i]) > big) big = abs(a.v[i]);
  const T x = a.v[0] / big, y = a.v[1] / big, z = a.v[2] / big, w = a.w / big;
  const T r = T(1) / sqrt(x * x + y * y + z * z + w * w);
  return {Vec3<T>::make(x * r, y * r, z * r), w * r};
}

// a, normalised only where squares of products with its like would overflow or lose digits.
template <class T>
inline Quaternion<T> no_overflow(const Quaternion<T>& a) {
  const T n2 = dot(a.v, a.v) + a.w * a.w;
  return n2 > T(1e-60) && n2 < T(1e60) ? a : normalized(a);
}

// Rotation matrix of u, s = 2 / |u|^2.
template <class T>
DYN_INLINE Mat3<T> rotation(const Quaternion<T>& u, T s) {
  const T x = u.v[0], y = u.v[1], z = u.v[2], w = u.w;
  const T x2 = x * s, y2 = y * s, z2 = z * s;
  return {Vec3<T>::make(T(1) - (y * y2 + z * z2), x * y2 + w * z2, x * z2 - w * y2),
           Vec3<T>::make(x * y2 - w * z2, T(1) - (x * x2 + z * z2), y * z2 + w * x2),
           Vec3<T>::make(x * z2 + w * y2, y * z2 - w * x2, T(1) - (x * x2 + y * y2))};
}
// Of a quaternion of any norm: 2 / |a|^2 is multiplied in, which takes no square root.
template <class T>
inline Mat3<T> rotation(const Quaternion<T>& a) {
  const T n2 = dot(a.v, a.v) + a.w * a.w;
  const bool no_overflow = n2 > T(1e-200) && n2 < T(1e200);
  return no_overflow ? rotation(a, T(2) / n2) : rotation(normalized(a), T(2));
}

// Quaternion of a rotation matrix, w >= 0: divides by the largest component (Shepperd 1978).
template <class T>
inline Quaternion<T> quaternion(const Mat3<T>& R) {
  using std::sqrt;
  const T t = R(0, 0) + R(1, 1) + R(2, 2);
  Quaternion<T> a;
  if (t > T(0)) {
    const T s = sqrt(T(1) + t), r = T(0.5) / s;
    a = {Vec3<T>::make((R(2, 1) - R(1, 2)) * r, (R(0, 2) - R(2, 0)) * r, (R(1, 0) - R(0, 1)) * r), T(0.5) * s};
  } else {
    const int i = R(0, 0) >= R(1, 1) ? (R(0, 0) >= R(2, 2) ? 0 : 2) : (R(1, 1) >= R(2, 2) ? 1 : 2);
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const T s = sqrt(T(1) + R(i, i) - R(j, j) - R(k, k)), r = T(0.5) / s;
    T x[3];
    x[i] = T(0.5) * s;
    x[j] = (R(j, i) + R(i, j)) * r;
    x[k] = (R(k, i) + R(i, k)) * r;
    a = {load3(x), (R(k, j) - R(j, k)) * r};
    if (a.w < T(0)) a = {-a.v, -a.w};
  }
  return normalized(a);
}

}  // namespace dyn
