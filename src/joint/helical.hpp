// Screw about z: rotation by q and translation by h q, h the pitch in metres per radian. S = [h z; z].
#pragma once

#include "joint/joint.hpp"
#include "joint/kind.hpp"

namespace dyn {

struct Helical : Joint<Helical> {
  static constexpr int nq = 1, nv = 1;
  static constexpr bool angle = true, rotates = true, translates = true;
  static constexpr double default_range = 3.141592653589793;

  template <class T>
  static DYN_INLINE void place(const Body& b, const T* q, T c, T s, SE3<T>& X) {
    X.p += X.R.z * (T(b.pitch) * q[0]);
    X.R = rotate_z(X.R, c, s);
  }
  template <class T>
  static DYN_INLINE Motion<T> velocity(const Body& b, const Mat3<T>& R, const T* v) {
    return column(b, R, 0) * v[0];
  }
  template <class T>
  static DYN_INLINE Motion<T> acceleration(const Body& b, const Mat3<T>& R, const T*, const T* a) {
    return column(b, R, 0) * a[0];
  }
  template <class T>
  static DYN_INLINE Motion<T> column(const Body& b, const Mat3<T>& R, int) {
    return {R.z * T(b.pitch), R.z};
  }
  template <class T>
  static DYN_INLINE void project(const Body& b, const Mat3<T>& R, const Force<T>& f, T* tau) {
    tau[0] = dot(column(b, R, 0), f);
  }
};

namespace kind {

struct Helical : Kind<Helical> {
  static constexpr dynJointType type = DYN_JOINT_TYPE_HELICAL;
  static constexpr int nq = 1, nv = 1;
  static constexpr Elements elements(const JointGeometry& g) {
    return chain(Element{BodyType::Helical, g.axis, g.pitch});
  }
};

}  // namespace kind

}  // namespace dyn
