// Placements, X_AB: the pose of frame B in frame A. A product reads X_AC = X_AB * X_BC.
#pragma once

#include "spatial/mat3.hpp"
#include "spatial/motion.hpp"

namespace dyn {

template <class T>
struct SE3 {
  Mat3<T> R;  // axes of B in A, by columns
  Vec3<T> p;  // origin of B in A

  static DYN_INLINE SE3 identity() { return {Mat3<T>::identity(), Vec3<T>::zero()}; }

  friend DYN_INLINE SE3 operator*(const SE3& X, const SE3& Y) { return {X.R * Y.R, X.p + X.R * Y.p}; }
  DYN_INLINE SE3 inverse() const {
    const Mat3<T> Rt = transpose(R);
    return {Rt, -(Rt * p)};
  }
  // coordinates in B to coordinates in A, and back
  DYN_INLINE Vec3<T> act(const Vec3<T>& x) const { return R * x + p; }
  DYN_INLINE Vec3<T> act_inverse(const Vec3<T>& x) const { return transpose_times(R, x - p); }
  DYN_INLINE Motion<T> act(const Motion<T>& m) const {
    const Vec3<T> w = R * m.angular;
    return {R * m.linear + cross(p, w), w};
  }
  DYN_INLINE Motion<T> act_inverse(const Motion<T>& m) const {
    return {transpose_times(R, m.linear - cross(p, m.angular)), transpose_times(R, m.angular)};
  }
  DYN_INLINE Force<T> act(const Force<T>& f) const {
    const Vec3<T> l = R * f.linear;
    return {l, R * f.angular + cross(p, l)};
  }
  DYN_INLINE Force<T> act_inverse(const Force<T>& f) const {
    return {transpose_times(R, f.linear), transpose_times(R, f.angular - cross(p, f.linear))};
  }
};

template <class T>
DYN_INLINE SE3<T> load_se3(const T* x) {
  return {load33(x), load3(x + 9)};
}
template <class T>
DYN_INLINE void store_se3(const SE3<T>& X, T* x) {
  store33(X.R, x), store3(X.p, x + 9);
}
template <class To, class From>
DYN_INLINE SE3<To> cast(const SE3<From>& X) {
  return {cast<To>(X.R), cast<To>(X.p)};
}

}  // namespace dyn
