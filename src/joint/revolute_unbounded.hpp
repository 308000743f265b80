// Rotation about z stored as q = (cos, sin) of any non-zero norm. S = [0; z].
#pragma once

#include "base/portable.hpp"
#include "joint/revolute.hpp"

namespace dyn {

struct RevoluteUnbounded : AboutZ<RevoluteUnbounded> {
  static constexpr int nq = 2;

  template <class T>
  static DYN_INLINE void unit(const T* q, T& c, T& s) {
    using std::abs;
    using std::max;
    using std::sqrt;
    const T big = max(abs(q[0]), abs(q[1]));
    const T x = q[0] / big, y = q[1] / big, n = sqrt(x * x + y * y);
    c = x / n, s = y / n;
  }
  template <class T>
  static DYN_INLINE void place(const Body&, const T* q, T, T, SE3<T>& X) {
    T c, s;
    unit(q, c, s);
    X.R = rotate_z(X.R, c, s);
  }
  template <class T>
  static void neutral(T* q) {
    q[0] = T(1), q[1] = T(0);
  }
  template <class T>
  static void integrate(const T* q, const T* v, T* out) {
    using math::cos;
    using math::sin;
    T c, s;
    unit(q, c, s);
    const T cv = cos(v[0]), sv = sin(v[0]);
    out[0] = c * cv - s * sv, out[1] = s * cv + c * sv;
    normalize(out);
  }
  template <class T>
  static void difference(const Body&, const T* q0, const T* q1, T* v) {
    using math::atan2;
    T c0, s0, c1, s1;
    unit(q0, c0, s0), unit(q1, c1, s1);
    v[0] = atan2(c0 * s1 - s0 * c1, c0 * c1 + s0 * s1);
  }
  template <class T>
  static void normalize(T* q) {
    T c, s;
    unit(q, c, s);
    q[0] = c, q[1] = s;
  }
  template <class T>
  static T norm_error(const T* q) {
    using std::abs;
    using std::sqrt;
    return abs(sqrt(q[0] * q[0] + q[1] * q[1]) - T(1));
  }
  template <class T>
  static bool zero_norm(const T* q) {
    return q[0] == T(0) && q[1] == T(0);
  }
  static void random(Random& g, const double*, const double*, double* q) {
    const double angle = g.uniform(-3.141592653589793, 3.141592653589793);
    q[0] = math::cos(angle), q[1] = math::sin(angle);
  }
};

namespace kind {

struct RevoluteUnbounded : Kind<RevoluteUnbounded> {
  static constexpr dynJointType type = DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED;
  static constexpr int nq = 2, nv = 1;
  static constexpr Elements elements(const JointGeometry& g) {
    return chain(Element{BodyType::RevoluteUnbounded, g.axis});
  }
};

}  // namespace kind

}  // namespace dyn
