// Translation along z by q. S = [z; 0].
#pragma once

#include "joint/joint.hpp"
#include "joint/kind.hpp"

namespace dyn {

struct Prismatic : Joint<Prismatic> {
  static constexpr int nq = 1, nv = 1;
  static constexpr bool rotates = false, translates = true;

  template <class T>
  static DYN_INLINE void place(const Body&, const T* q, T, T, SE3<T>& X) {
    X.p += X.R.z * q[0];
  }
  template <class T>
  static DYN_INLINE Motion<T> velocity(const Body&, const Mat3<T>& R, const T* v) {
    return {R.z * v[0], Vec3<T>::zero()};
  }
  template <class T>
  static DYN_INLINE Motion<T> acceleration(const Body&, const Mat3<T>& R, const T*, const T* a) {
    return {R.z * a[0], Vec3<T>::zero()};
  }
  template <class T>
  static DYN_INLINE Motion<T> column(const Body&, const Mat3<T>& R, int) {
    return {R.z, Vec3<T>::zero()};
  }
  template <class T>
  static DYN_INLINE void project(const Body&, const Mat3<T>& R, const Force<T>& f, T* tau) {
    tau[0] = dot(R.z, f.linear);
  }
};

namespace kind {

struct Prismatic : Kind<Prismatic> {
  static constexpr dynJointType type = DYN_JOINT_TYPE_PRISMATIC;
  static constexpr int nq = 1, nv = 1;
  static constexpr Elements elements(const JointGeometry& g) {
    return chain(Element{BodyType::Prismatic, g.axis});
  }
};

}  // namespace kind

}  // namespace dyn
