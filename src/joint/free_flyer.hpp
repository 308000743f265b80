// Free body: q = [position; quaternion], v = [linear; angular] in body axes. S = 1.
#pragma once

#include "joint/spherical.hpp"

namespace dyn {

struct FreeFlyer : Joint<FreeFlyer> {
  static constexpr int nq = 7, nv = 6;
  static constexpr bool rotates = true, translates = true;
  static constexpr bool rotates_at(int k) { return k >= 3; }
  static constexpr bool translates_at(int k) { return k < 3; }

  template <class T>
  static DYN_INLINE void place(const Body&, const T* q, T, T, SE3<T>& X) {
    X.p += X.R * load3(q);
    X.R = X.R * rotation(load_quaternion(q + 3));
  }
  template <class T>
  static DYN_INLINE Motion<T> velocity(const Body&, const Mat3<T>& R, const T* v) {
    return {R * load3(v), R * load3(v + 3)};
  }
  // the linear part is the derivative of R v in the joint frame
  template <class T>
  static DYN_INLINE Motion<T> acceleration(const Body&, const Mat3<T>& R, const T* v, const T* a) {
    return {R * (load3(a) + cross(load3(v + 3), load3(v))), R * load3(a + 3)};
  }
  template <class T>
  static DYN_INLINE Motion<T> column(const Body&, const Mat3<T>& R, int k) {
    return k < 3 ? Motion<T>{R[k], Vec3<T>::zero()} : Motion<T>{Vec3<T>::zero(), R[k - 3]};
  }
  template <class T>
  static DYN_INLINE void project(const Body&, const Mat3<T>& R, const Force<T>& f, T* tau) {
    store3(transpose_times(R, f.linear), tau);
    store3(transpose_times(R, f.angular), tau + 3);
  }

  template <class T>
  static void neutral(T* q) {
    store3(Vec3<T>::zero(), q);
    Spherical::neutral(q + 3);
  }
  template <class T>
  static void integrate(const T* q, const T* v, T* out) {
    const Motion<T> m = load_motion(v);
    const auto e = exp_coefficients(m.angular);
    const Quaternion<T> a = load_quaternion(q + 3);
    store3(load3(q) + rotation(a) * exp_translation(m, e), out);
    store(normalized(no_overflow(a) * exp_quaternion(m.angular, e)), out + 3);
  }
  // pose of q1 in q0
  template <class T>
  static Motion<T> log_relative(const T* q0, const T* q1, Quaternion<T>& e, Vec3<T>& p) {
    e = Spherical::relative(q0 + 3, q1 + 3);
    p = transpose_times(rotation(load_quaternion(q0 + 3)), load3(q1) - load3(q0));
    return log6(e, p);
  }
  template <class T>
  static void difference(const Body&, const T* q0, const T* q1, T* v) {
    Quaternion<T> e;
    Vec3<T> p;
    store6(log_relative(q0, q1, e, p), v);
  }
  template <class T>
  static void normalize(T* q) {
    Spherical::normalize(q + 3);
  }
  template <class T>
  static T norm_error(const T* q) {
    return Spherical::norm_error(q + 3);
  }
  template <class T>
  static bool zero_norm(const T* q) {
    return Spherical::zero_norm(q + 3);
  }
  static void random(Random& g, const double* lower, const double* upper, double* q) {
    for (int i = 0; i < 3; ++i) q[i] = bounded(g, lower[i], upper[i], default_range);
    Spherical::random(g, lower + 3, upper + 3, q + 3);
  }
  template <class T>
  static void set_block6(Block<T> B, const Mat6<T>& A) {
    set_block(B, 0, 0, A.ll), set_block(B, 0, 3, A.la), set_block(B, 3, 0, A.al), set_block(B, 3, 3, A.aa);
  }
  // the motion transform from here to a pose X away
  template <class T>
  static Mat6<T> action_inverse(const SE3<T>& X) {
    const Mat3<T> Rt = transpose(X.R);
    return {Rt, (Rt * skew(X.p)) * T(-1), Mat3<T>::zero(), Rt};
  }
  template <class T>
  static void integrate_jacobians(const T*, const T* v, Block<T> dq, Block<T> dv) {
    const Motion<T> m = load_motion(v);
    set_block6(dq, action_inverse(exp6(m)));
    set_block6(dv, Jexp6(m));
  }
  template <class T>
  static void difference_jacobians(const Body&, const T* q0, const T* q1, Block<T> d0, Block<T> d1) {
    Quaternion<T> e;
    Vec3<T> p;
    const Mat6<T> J = Jlog6(log_relative(q0, q1, e, p));
    const Mat6<T> A = action_inverse(SE3<T>{rotation(e), p});
    set_block6(d1, J);
    set_block6(d0, {J.ll * A.ll * T(-1), (J.ll * A.la + J.la * A.aa) * T(-1), Mat3<T>::zero(), J.aa * A.aa * T(-1)});
  }
  template <class T>
  static void chart_rate(const T* u, const T* v, T* du) {
    store6(Jlog6(load_motion(u)) * load_motion(v), du);
  }
};

namespace kind {

struct FreeFlyer : Kind<FreeFlyer> {
  static constexpr dynJointType type = DYN_JOINT_TYPE_FREE_FLYER;
  static constexpr int nq = 7, nv = 6;
  static constexpr Elements elements(const JointGeometry&) {
    return chain(Element{BodyType::FreeFlyer, z_axis});
  }
};

}  // namespace kind

}  // namespace dyn
