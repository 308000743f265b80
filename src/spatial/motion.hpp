// Spatial motions (velocities, accelerations) and forces, [linear; angular]: two types, so that one can't pass for the other.
#pragma once

#include "spatial/vec3.hpp"

namespace dyn {

template <class T>
struct Motion {
  Vec3<T> linear, angular;
  static DYN_INLINE Motion zero() { return {Vec3<T>::zero(), Vec3<T>::zero()}; }
  friend DYN_INLINE Motion operator+(const Motion& a, const Motion& b) { return {a.linear + b.linear, a.angular + b.angular}; }
  friend DYN_INLINE Motion operator-(const Motion& a, const Motion& b) { return {a.linear - b.linear, a.angular - b.angular}; }
  friend DYN_INLINE Motion operator*(const Motion& a, T s) { return {a.linear * s, a.angular * s}; }
};

template <class T>
struct Force {
  Vec3<T> linear, angular;
  static DYN_INLINE Force zero() { return {Vec3<T>::zero(), Vec3<T>::zero()}; }
  friend DYN_INLINE Force operator+(const Force& a, const Force& b) { return {a.linear + b.linear, a.angular + b.angular}; }
  friend DYN_INLINE Force operator-(const Force& a, const Force& b) { return {a.linear - b.linear, a.angular - b.angular}; }
  friend DYN_INLINE Force operator*(const Force& a, T s) { return {a.linear * s, a.angular * s}; }
};

template <class T>
DYN_INLINE bool is_zero(const Motion<T>& m) {
  const Vec3<T> s = sizes(m.linear) + sizes(m.angular);
  return s[0] + s[1] + s[2] == T(0);
}
// power
template <class T>
DYN_INLINE T dot(const Motion<T>& m, const Force<T>& f) {
  return dot(m.linear, f.linear) + dot(m.angular, f.angular);
}
// v x m (Featherstone 2008, 2.31, in this order of components)
template <class T>
DYN_INLINE Motion<T> cross(const Motion<T>& v, const Motion<T>& m) {
  return {cross(v.angular, m.linear) + cross(v.linear, m.angular), cross(v.angular, m.angular)};
}
// v x* f (Featherstone 2008, 2.32)
template <class T>
DYN_INLINE Force<T> cross(const Motion<T>& v, const Force<T>& f) {
  return {cross(v.angular, f.linear), cross(v.angular, f.angular) + cross(v.linear, f.linear)};
}
// a moved from its point to the point that lies at r from it: velocities, and accelerations without their centripetal part
template <class T>
DYN_INLINE Motion<T> shift(const Motion<T>& m, const Vec3<T>& r) {
  return {m.linear + cross(m.angular, r), m.angular};
}
// f at a point, referred to the point from which r leads to it
template <class T>
DYN_INLINE Force<T> shift(const Force<T>& f, const Vec3<T>& r) {
  return {f.linear, f.angular + cross(r, f.linear)};
}
template <class T>
DYN_INLINE Motion<T> load_motion(const T* x) {
  return {load3(x), load3(x + 3)};
}
template <class T>
DYN_INLINE Force<T> load_force(const T* x) {
  return {load3(x), load3(x + 3)};
}
template <class T>
DYN_INLINE void store6(const Motion<T>& m, T* x) {
  store3(m.linear, x), store3(m.angular, x + 3);
}
template <class T>
DYN_INLINE void store6(const Force<T>& f, T* x) {
  store3(f.linear, x), store3(f.angular, x + 3);
}

}  // namespace dyn
