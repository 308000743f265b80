// Exponentials and logarithms of SO(3) and SE(3), and their Jacobians; right through the angles 0 and pi.
// Angles below one use the power series of each coefficient: the closed forms cancel there.
// Sources: Murray, Li, Sastry 1994, 2.3; Barfoot 2017, 7.1 (left Jacobians; here the right ones: arguments negated).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/portable.hpp"
#include "spatial/quaternion.hpp"
#include "spatial/se3.hpp"

namespace dyn {

namespace detail {

// Numbers of which sums of series are polynomials.
template <class T>
inline constexpr bool is_polynomial = std::is_same_v<T, double>;
template <int N>
inline constexpr bool is_polynomial<Simd<double, N>> = true;

// sum over k of (-x)^k c_k with c_0 = first and c_{k+1} / c_k = ratio(k), to the last bit
template <int, class T, class Ratio>
inline T alternating_series(T x, T first, Ratio ratio) requires(!is_polynomial<T>) {
  using std::abs;
  T term = first, sum = first;
  for (int k = 0; k < 60; ++k) {
    term = term * (-x * ratio(k));
    sum = sum + term;
    if (abs(term) <= std::numeric_limits<T>::epsilon() * T(0.125) * abs(sum)) break;
  }
  return sum;
}
// Of doubles a polynomial. Where the ratios fall like those of sines and cosines these degrees are enough:
inline constexpr int below_quarter = 7, below_one = 9, below_four = 14;
template <int degree, class T, class Ratio>
inline T alternating_series(T x, T first, Ratio) requires is_polynomial<T> {
  constexpr auto c = [] {
    std::array<double, degree + 1> a{1};
    for (int k = 0; k < degree; ++k) a[std::size_t(k + 1)] = -a[std::size_t(k)] * Ratio{}(k);
    return a;
  }();
  T sum = T(c[degree]);
#pragma GCC unroll 14
  for (int k = degree - 1; k >= 0; --k) sum = sum * x + T(c[std::size_t(k)]);
  return first * sum;
}

}  // namespace detail

// Coefficients of the rotation vector w, t = |w|, h = t / 2.
template <class T>
struct ExpCoefficients {
  T t2;
  T sinc;  // sin h / h
  T cos;   // cos h
  T a;     // sin t / t
  T b;     // (1 - cos t) / t^2
  T c;     // (t - sin t) / t^3
};

// sin h / h and cos h for |h| < 1/2
template <class T>
inline void half_angle_series(T h2, T& sinc, T& cos) {
  using namespace detail;
  using Number = std::conditional_t<is_polynomial<T>, double, T>;
  sinc = alternating_series<below_quarter>(h2, T(1), [](int k) { return Number(1) / Number((2 * k + 2) * (2 * k + 3)); });
  cos = T(1) -
        h2 * alternating_series<below_quarter>(h2, T(0.5), [](int k) { return Number(1) / Number((2 * k + 3) * (2 * k + 4)); });
}

template <class T>
inline ExpCoefficients<T> exp_coefficients(const Vec3<T>& w) {
  using math::cos;
  using math::sin;
  using std::sqrt;
  using namespace detail;
  ExpCoefficients<T> e;
  e.t2 = dot(w, w);
  const T h2 = e.t2 * T(0.25);
  if (e.t2 < T(1)) {
    half_angle_series(h2, e.sinc, e.cos);
    e.a = e.sinc * e.cos;
    e.c = alternating_series<below_one>(e.t2, T(1) / T(6), [](int k) { return T(1) / T((2 * k + 4) * (2 * k + 5)); });
  } else {
    const T h = sqrt(h2);
    e.sinc = sin(h) / h, e.cos = cos(h);
    e.a = e.sinc * e.cos;
    e.c = (T(1) - e.a) / e.t2;
  }
  e.b = e.sinc * e.sinc * T(0.5);
  return e;
}

// exp of w: a rotation by |w| about w
template <class T>
inline Quaternion<T> exp_quaternion(const Vec3<T>& w, const ExpCoefficients<T>& e) {
  return {w * (T(0.5) * e.sinc), e.cos};
}
template <class T>
inline Quaternion<T> exp_quaternion(const Vec3<T>& w) {
  return exp_quaternion(w, exp_coefficients(w));
}

template <class T>
inline Mat3<T> exp3(const Vec3<T>& w) {
  return rotation(exp_quaternion(w));
}

// A rotation vector, norm t in [0, pi], and what log_coefficient needs of it where t is not small.
template <class T>
struct RotationLog {
  Vec3<T> w;
  T half, cot;  // t / 2 and its cotangent
};
// Of a quaternion of any moderate norm. By atan2: right near 0 and near pi.
template <class T>
inline RotationLog<T> rotation_log(const Quaternion<T>& a) {
  using std::abs;
  using math::atan2;
  using std::sqrt;
  const T s = a.w < T(0) ? T(-1) : T(1), w = s * a.w;
  const T n2 = dot(a.v, a.v);
  T norm = sqrt(n2);
  if (!(n2 > T(1e-280))) [[unlikely]] {  // the largest component is divided out so that tiny rotations keep their direction
    const T big = std::max(abs(a.v[0]), std::max(abs(a.v[1]), abs(a.v[2])));
    if (big == T(0)) return {Vec3<T>::zero(), T(0), T(0)};
    const Vec3<T> u = Vec3<T>::make(a.v[0] / big, a.v[1] / big, a.v[2] / big);
    norm = sqrt(dot(u, u)) * big;
  }
  if (norm < T(1e-9) * w) return {a.v * (s * T(2) / w), norm / w, w / norm};
  const T half = atan2(norm, w), inverse = T(1) / norm;
  return {a.v * (s * T(2) * half * inverse), half, w * inverse};
}
template <class T>
inline Vec3<T> log_quaternion(const Quaternion<T>& a) {
  return rotation_log(a).w;
}

template <class T>
inline Vec3<T> log3(const Mat3<T>& R) {
  return log_quaternion(quaternion(R));
}

// Right Jacobian of exp: exp(w + dw) = exp(w) exp(Jexp3(w) dw). J = 1 - b [w] + c [w]^2
template <class T>
inline Mat3<T> Jexp3(const Vec3<T>& w) {
  const auto e = exp_coefficients(w);
  // [w]^2 = w w^T - t^2
  const T d = T(1) - e.c * e.t2;
  return Mat3<T>::diagonal(d, d, d) + outer(w, w) * e.c - skew(w) * e.b;
}

// (1 - h cot h) / t^2 with h = t / 2
template <class T>
inline T log_coefficient_series(T t2) {
  // (sin h - h cos h) / h^3 over 4 sin h / h: neither series cancels
  const T h2 = t2 * T(0.25);
  const T numerator = detail::alternating_series<detail::below_quarter>(
      h2, T(1) / T(3), [](int k) { return T(1) / T((2 * k + 2) * (2 * k + 5)); });
  const T sinc =
      detail::alternating_series<detail::below_quarter>(h2, T(1), [](int k) { return T(1) / T((2 * k + 2) * (2 * k + 3)); });
  return numerator / (T(4) * sinc);
}
template <class T>
inline T log_coefficient(const RotationLog<T>& log) {
  const T t2 = T(4) * log.half * log.half;
  return t2 < T(1) ? log_coefficient_series(t2) : (T(1) - log.half * log.cot) / t2;
}
template <class T>
inline T log_coefficient(T t2) {
  using std::sqrt;
  using math::tan;
  if (t2 < T(1)) return log_coefficient_series(t2);
  const T h = sqrt(t2) * T(0.5);
  return (T(1) - h / tan(h)) / t2;
}

// Inverse of Jexp3 at w = log3(R): Jlog = 1 + [w]/2 + k [w]^2
template <class T>
inline Mat3<T> Jlog3(const Vec3<T>& w) {
  const T t2 = dot(w, w), k = log_coefficient(t2), d = T(1) - k * t2;
  return Mat3<T>::diagonal(d, d, d) + outer(w, w) * k + skew(w) * T(0.5);
}

// Derivative of log_coefficient by t^2
template <class T>
inline T log_coefficient_rate(T t2) {
  using math::cos;
  using math::sin;
  using std::sqrt;
  if (t2 < T(1)) {
    // h cot h = 1 - 2 sum over n of zeta(2n) (h / pi)^2n: the closed form cancels. a_n = 2 zeta(2n) / pi^2n
    constexpr double a[] = {1. / 45,
                            2. / 945,
                            1. / 4725,
                            2. / 93555,
                            1382. / 638512875,
                            4. / 18243225,
                            3617. / 162820783125,
                            87734. / 38979295480125,
                            349222. / 1531329465290625};
    const T x = t2 * T(0.25);
    T sum = T(0);
    for (int n = 8; n >= 0; --n) sum = sum * x + T((n + 1) * a[n]);
    return sum * T(0.0625);
  }
  const T h = sqrt(t2) * T(0.5), s = sin(h);
  return (h * h / (s * s) + h * cos(h) / s - T(2)) / (T(2) * t2 * t2);
}

// Derivative of Jlog3(w)^T l by w.
template <class T>
inline Mat3<T> dJlog3(const Vec3<T>& w, const Vec3<T>& l) {
  const T t2 = dot(w, w), k = log_coefficient(t2), dk = log_coefficient_rate(t2), wl = dot(w, l);
  // Jlog3^T l = l + l x w / 2 + k (w (w . l) - t^2 l)
  return skew(l) * T(0.5) + (Mat3<T>::diagonal(wl, wl, wl) + outer(w, l) - outer(l, w) * T(2)) * k +
         outer(w * wl - l * t2, w) * (T(2) * dk);
}

// V m = (1 + b [w] + c [w]^2) m
template <class T>
inline Vec3<T> exp_translation(const Motion<T>& m, const ExpCoefficients<T>& e) {
  const Vec3<T> wv = cross(m.angular, m.linear);
  return m.linear + wv * e.b + cross(m.angular, wv) * e.c;
}
// exp of a twist [linear; angular]: the pose after one second of the constant body velocity m
template <class T>
inline SE3<T> exp6(const Motion<T>& m) {
  const auto e = exp_coefficients(m.angular);
  return {rotation(exp_quaternion(m.angular, e)), exp_translation(m, e)};
}

// Twist of a pose; angular part with norm in [0, pi].
template <class T>
inline Motion<T> log6(const Quaternion<T>& rotation, const Vec3<T>& p) {
  const RotationLog<T> log = rotation_log(rotation);
  const Vec3<T>& w = log.w;
  const T k = log_coefficient(log);
  const Vec3<T> wp = cross(w, p);
  return {p - wp * T(0.5) + cross(w, wp) * k, w};
}
template <class T>
inline Motion<T> log6(const SE3<T>& X) {
  return log6(quaternion(X.R), X.p);
}

// A 6 x 6 matrix in 3 x 3 blocks.
template <class T>
struct Mat6 {
  Mat3<T> ll, la, al, aa;  // linear-linear, linear-angular, angular-linear, angular-angular
  friend DYN_INLINE Motion<T> operator*(const Mat6& A, const Motion<T>& m) {
    return {A.ll * m.linear + A.la * m.angular, A.al * m.linear + A.aa * m.angular};
  }
};

namespace detail {

// The linear-angular block of the right Jacobian of exp6 (Barfoot 2017, 7.86, arguments negated).
template <class T>
inline Mat3<T> Jexp6_block(const Vec3<T>& rho, const Vec3<T>& w) {
  const auto e = exp_coefficients(w);
  T d, f;  // (t^2 + 2 cos t - 2) / (2 t^4) and (2 t - 3 sin t + t cos t) / (2 t^5)
  if (e.t2 < T(4)) {
    d = alternating_series<below_four>(e.t2, T(1) / T(24), [](int k) { return T(1) / T((2 * k + 5) * (2 * k + 6)); });
    // coefficients (k + 1) / (2 k + 5)!
    f = alternating_series<below_four>(e.t2, T(1) / T(120),
                                       [](int k) { return T(k + 2) / T((k + 1) * (2 * k + 6) * (2 * k + 7)); });
  } else {
    const T co = T(1) - e.b * e.t2;  // sin t = a t
    d = (e.t2 + T(2) * co - T(2)) / (T(2) * e.t2 * e.t2);
    f = (T(2) - T(3) * e.a + co) / (T(2) * e.t2 * e.t2);
  }
  const Mat3<T> W = skew(-w), P = skew(-rho);
  const Mat3<T> WP = W * P, PW = P * W, WPW = WP * W;
  return P * T(0.5) + (WP + PW + WPW) * e.c + (W * WP + PW * W - WPW * T(3)) * d + (WPW * W + W * WPW) * f;
}

}  // namespace detail

// Right Jacobian of exp6: exp6(m + dm) = exp6(m) exp6(Jexp6(m) dm).
template <class T>
inline Mat6<T> Jexp6(const Motion<T>& m) {
  const Mat3<T> J = Jexp3(m.angular);
  return {J, detail::Jexp6_block(m.linear, m.angular), Mat3<T>::zero(), J};
}

// Its inverse at m = log6(X).
template <class T>
inline Mat6<T> Jlog6(const Motion<T>& m) {
  const Mat3<T> J = Jlog3(m.angular);
  const Mat3<T> Q = detail::Jexp6_block(m.linear, m.angular);
  return {J, (J * Q * J) * T(-1), Mat3<T>::zero(), J};
}

}  // namespace dyn
