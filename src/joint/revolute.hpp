// Rotation about z by the angle q. S = [0; z].
#pragma once

#include "joint/joint.hpp"
#include "joint/kind.hpp"

namespace dyn {

// What does not depend on how the angle is stored.
template <class J>
struct AboutZ : Joint<J> {
  static constexpr int nv = 1;
  static constexpr bool rotates = true, translates = false;

  template <class T>
  static DYN_INLINE Motion<T> velocity(const Body&, const Mat3<T>& R, const T* v) {
    return {Vec3<T>::zero(), R.z * v[0]};
  }
  template <class T>
  static DYN_INLINE Motion<T> acceleration(const Body&, const Mat3<T>& R, const T*, const T* a) {
    return {Vec3<T>::zero(), R.z * a[0]};
  }
  template <class T>
  static DYN_INLINE Motion<T> column(const Body&, const Mat3<T>& R, int) {
    return {Vec3<T>::zero(), R.z};
  }
  template <class T>
  static DYN_INLINE void project(const Body&, const Mat3<T>& R, const Force<T>& f, T* tau) {
    tau[0] = dot(R.z, f.angular);
  }
};

struct Revolute : AboutZ<Revolute> {
  static constexpr int nq = 1;
  static constexpr bool angle = true;
  static constexpr double default_range = 3.141592653589793;

  template <class T>
  static DYN_INLINE void place(const Body&, const T*, T c, T s, SE3<T>& X) {
    X.R = rotate_z(X.R, c, s);
  }
  // a continuous joint goes the short way round: (-pi, pi]
  template <class T>
  static void difference(const Body& b, const T* q0, const T* q1, T* v) {
    v[0] = q1[0] - q0[0];
    if (b.wraps) {
      using std::remainder;
      const double two_pi = 6.283185307179586477;
      v[0] = remainder(v[0], T(two_pi));
      if (v[0] <= T(-two_pi / 2)) v[0] = v[0] + T(two_pi);
    }
  }
};

namespace kind {

struct Revolute : Kind<Revolute> {
  static constexpr dynJointType type = DYN_JOINT_TYPE_REVOLUTE;
  static constexpr int nq = 1, nv = 1;
  static constexpr Elements elements(const JointGeometry& g) {
    return chain(Element{BodyType::Revolute, g.axis});
  }
};

}  // namespace kind

}  // namespace dyn
