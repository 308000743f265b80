// Ball joint: q a quaternion (x, y, z, w) of any non-zero norm, v the angular velocity in body axes. S = [0; 1].
#pragma once

#include "joint/joint.hpp"
#include "joint/kind.hpp"

namespace dyn {

struct Spherical : Joint<Spherical> {
  static constexpr int nq = 4, nv = 3;
  static constexpr bool rotates = true, translates = false;

  template <class T>
  static DYN_INLINE void place(const Body&, const T* q, T, T, SE3<T>& X) {
    X.R = X.R * rotation(load_quaternion(q));
  }
  template <class T>
  static DYN_INLINE Motion<T> velocity(const Body&, const Mat3<T>& R, const T* v) {
    return {Vec3<T>::zero(), R * load3(v)};
  }
  template <class T>
  static DYN_INLINE Motion<T> acceleration(const Body&, const Mat3<T>& R, const T*, const T* a) {
    return {Vec3<T>::zero(), R * load3(a)};
  }
  template <class T>
  static DYN_INLINE Motion<T> column(const Body&, const Mat3<T>& R, int k) {
    return {Vec3<T>::zero(), R[k]};
  }
  template <class T>
  static DYN_INLINE void project(const Body&, const Mat3<T>& R, const Force<T>& f, T* tau) {
    store3(transpose_times(R, f.angular), tau);
  }

  template <class T>
  static void neutral(T* q) {
    store(Quaternion<T>::identity(), q);
  }
  template <class T>
  static void integrate(const T* q, const T* v, T* out) {
    store(normalized(no_overflow(load_quaternion(q)) * exp_quaternion(load3(v))), out);
  }
  // not normalised
  template <class T>
  static Quaternion<T> relative(const T* q0, const T* q1) {
    return no_overflow(load_quaternion(q0)).conjugate() * no_overflow(load_quaternion(q1));
  }
  template <class T>
  static void difference(const Body&, const T* q0, const T* q1, T* v) {
    store3(log_quaternion(relative(q0, q1)), v);
  }
  template <class T>
  static void normalize(T* q) {
    store(normalized(load_quaternion(q)), q);
  }
  template <class T>
  static T norm_error(const T* q) {
    using std::abs;
    return abs(norm(load_quaternion(q)) - T(1));
  }
  template <class T>
  static bool zero_norm(const T* q) {
    return q[0] == T(0) && q[1] == T(0) && q[2] == T(0) && q[3] == T(0);
  }
  // uniform on the sphere: a normal vector in four dimensions, normalised
  static void random(Random& g, const double*, const double*, double* q) {
    do
      for (int i = 0; i < 4; ++i) q[i] = g.normal();
    while (norm(load_quaternion(q)) < 1e-6);
    normalize(q);
  }
  template <class T>
  static void integrate_jacobians(const T*, const T* v, Block<T> dq, Block<T> dv) {
    const Vec3<T> w = load3(v);
    set_block(dq, 0, 0, transpose(exp3(w)));
    set_block(dv, 0, 0, Jexp3(w));
  }
  template <class T>
  static void difference_jacobians(const Body&, const T* q0, const T* q1, Block<T> d0, Block<T> d1) {
    const Quaternion<T> e = relative(q0, q1);
    const Mat3<T> J = Jlog3(log_quaternion(e));
    set_block(d1, 0, 0, J);
    set_block(d0, 0, 0, (J * transpose(rotation(e))) * T(-1));
  }
  template <class T>
  static void chart_rate(const T* u, const T* v, T* du) {
    store3(Jlog3(load3(u)) * load3(v), du);
  }
};

namespace kind {

struct Spherical : Kind<Spherical> {
  static constexpr dynJointType type = DYN_JOINT_TYPE_SPHERICAL;
  static constexpr int nq = 4, nv = 3;
  static constexpr Elements elements(const JointGeometry&) {
    return chain(Element{BodyType::Spherical, z_axis});
  }
};

}  // namespace kind

}  // namespace dyn
