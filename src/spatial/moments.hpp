// The mass distribution of a moving body about a point of the world, and how it is moving, as integrals over its points x:
// sums over bodies are sums of members.
#pragma once

#include "spatial/mat3.hpp"
#include "spatial/motion.hpp"

namespace dyn {

// tr(A) w - A w: with A the integral of a b^T dm it is the integral of b x (w x a) dm
template <class T>
DYN_INLINE Vec3<T> turn(const Mat3<T>& A, const Vec3<T>& w) {
  return hadamard(trace3(A), w) - A * w;
}

// Second moments instead of the inertia I = tr(P) 1 - P (Wensing, Kim, Slotine 2018): new axes and a new origin take two
// products.
template <class T>
struct Moments {
  T m;        // integral of dm
  Vec3<T> h;  // of x dm
  Mat3<T> P;  // of x x^T dm

  // of a body with moments about its own origin in its own axes, at the pose (R, p)
  static DYN_INLINE Moments posed(T m, const Vec3<T>& h, const Mat3<T>& I, const Mat3<T>& R, const Vec3<T>& p) {
    const Mat3<T> P = Mat3<T>::identity() * ((I.x[0] + I.y[1] + I.z[2]) / T(2)) - I;
    const Mat3<T> A = R * P + outer(p, h);
    const Vec3<T> g = R * h + p * m;
    return {m, g, times_transpose(A, R) + outer(g, p)};
  }
  friend DYN_INLINE Force<T> operator*(const Moments& Y, const Motion<T>& s) {
    return {s.linear * Y.m + cross(s.angular, Y.h), cross(Y.h, s.linear) + turn(Y.P, s.angular)};
  }
};

// First derivatives in time. Velocities are x' = u + w x x for the motion (u, w).
template <class T>
struct MomentRates {
  Vec3<T> p;  // of x' dm: momentum
  Mat3<T> V;  // of x' x^T dm

  static DYN_INLINE MomentRates of(const Moments<T>& Y, const Motion<T>& v) {
    return {v.linear * Y.m + cross(v.angular, Y.h), cross(v.angular, Y.P) + outer(v.linear, Y.h)};
  }
  friend DYN_INLINE MomentRates operator+(const MomentRates& a, const MomentRates& b) { return {a.p + b.p, a.V + b.V}; }
  // of x' dm and of x x x' dm
  DYN_INLINE Force<T> momentum() const { return {p, Vec3<T>::make(V.y[2] - V.z[1], V.z[0] - V.x[2], V.x[1] - V.y[0])}; }
  // Coriolis forces: of 2 s x x' dm on points that move with x', turned on by the motion s. In Echeandia and Wensing (2021) and
  // Singh, Russell, Wensing (2022) this is 2 B s; B has but these twelve numbers.
  DYN_INLINE Force<T> coriolis(const Motion<T>& s) const { return {cross(s.angular, p) * T(2), turn(V, s.angular) * T(2)}; }
  // angular part of 2 B^T s; its linear part is zero
  DYN_INLINE Vec3<T> coriolis_transposed(const Motion<T>& s) const {
    return (cross(p, s.linear) + hadamard(trace3(V), s.angular) - transpose_times(V, s.angular)) * T(2);
  }
};

// The force that the motion takes: of x'' dm, x'' = a + dw x x + w x x', and its moment.
template <class T>
DYN_INLINE Force<T> newton_euler(const Moments<T>& Y, const MomentRates<T>& rates, const Motion<T>& v, const Motion<T>& a) {
  const Force<T> f = Y * a;
  return {f.linear + cross(v.angular, rates.p), f.angular + turn(rates.V, v.angular)};
}

}  // namespace dyn
