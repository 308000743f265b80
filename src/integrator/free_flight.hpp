// Free flyers in an Euler step. Their velocity is in body axes and changes without any force; to first order that change would
// add momentum. So a step integrates the centre of mass c and its momentum in fixed axes, and expresses them in the body's axes
// at the end:
//   v_c' = v_c + h a_c      R' = R exp(h w')      L_c' = L_c + h t_c, with L_c = R I_c w (of a body without children)
// A body in free flight keeps its momentum to rounding.
#pragma once

#include <limits>

#include "algorithm/configuration.hpp"
#include "spatial/explog.hpp"

namespace dyn::integrator {

// Calls f(body, number of the body, centre of mass).
template <class T, class Part, class F>
void for_each_free_flyer(const Model& m, const Part& part, F&& f) {
  for (Index k = 0; k < part.manifold_joint_count(m); ++k) {
    const Index i = part.manifold_joints(m)[k];
    const Body& b = m.bodies()[i];
    if (b.type == BodyType::FreeFlyer) f(b, i, b.m > 0 ? cast<T>(b.h) * T(1 / b.m) : Vec3<T>::zero());
  }
}

// Inertia about the centre of mass.
template <class T>
Mat3<T> central_inertia(const Body& b, const Vec3<T>& c) {
  const Mat3<T> I = cast<T>(b.I), one = Mat3<T>::identity();
  const T m = T(b.m), square = dot(c, c);
  return {I.x - (one.x * square - c * c[0]) * m, I.y - (one.y * square - c * c[1]) * m, I.z - (one.z * square - c * c[2]) * m};
}

// x = A^-1 b by Cramer's rule.
template <class T>
Vec3<T> solve3(const Mat3<T>& A, const Vec3<T>& b) {
  const Vec3<T> yz = cross(A.y, A.z), zx = cross(A.z, A.x), xy = cross(A.x, A.y);
  return Vec3<T>::make(dot(b, yz), dot(b, zx), dot(b, xy)) * (T(1) / dot(A.x, yz));
}

// Square of the rounding of a rotated vector, relative.
template <class T>
constexpr T rounding_square() {
  const T rounding = 4 * std::numeric_limits<T>::epsilon();
  return rounding * rounding;
}

// Solves I w' = exp(-h w') L by Newton's method, for large rotations in a step:
//   (I - h [y] J(h w)) dw = y - I w with y = exp(-h w) L
// Beyond a full turn Newton may stop at a local minimum: then at least |L| is kept.
template <class T>
[[gnu::cold, gnu::noinline]] Vec3<T> implicit_angular_velocity_newton(const Mat3<T>& I, const Vec3<T>& L, T h,
                                                                      const Vec3<T>& guess) {
  const auto left = [&](const Vec3<T>& w) { return exp3(w * -h) * L - I * w; };
  Vec3<T> w = guess, r = left(w);
  const T enough = rounding_square<T>() * dot(L, L);
  for (int k = 0; k < std::numeric_limits<T>::digits && dot(r, r) > enough; ++k) {
    const Vec3<T> dw = solve3(I - skew(r + I * w) * Jexp3(w * h) * h, r);
    T part = T(1);
    Vec3<T> next = w + dw, r_next = left(next);
    for (; !(dot(r_next, r_next) < dot(r, r)) && part > std::numeric_limits<T>::epsilon(); r_next = left(next))
      part = part * T(0.5), next = w + dw * part;
    if (!(dot(r_next, r_next) < dot(r, r))) break;
    w = next, r = r_next;
  }
  return solve3(I, exp3(w * -h) * L);
}

// Solves I w' = exp(-h w') L: by a fixed point, and Newton's method where that is slow.
template <class T>
Vec3<T> implicit_angular_velocity(const Mat3<T>& I, const Vec3<T>& L, T h, const Vec3<T>& guess) {
  Vec3<T> w = guess;
  bool changes = true, halves = true;
  for (T last = std::numeric_limits<T>::infinity(); changes && halves;) {  // fixed point, while each change is half the last
    const Vec3<T> next = solve3(I, exp3(w * -h) * L), change = next - w;
    const T square = dot(change, change);
    w = next, changes = square > rounding_square<T>() * dot(w, w);
    halves = 4 * square < last, last = square;
  }
  if (changes) w = implicit_angular_velocity_newton(I, L, h, guess);
  return dot(w, w) < std::numeric_limits<T>::infinity() ? w : guess;
}

// v holds v0 + h ddq. It becomes the velocity after all forces, still in the axes before the step.
// plain: as MuJoCo, which moves the origin with its acceleration at the beginning of the step, and turns in the same way.
template <bool plain, class T, class Part>
void free_flight(const Model& m, const Part& part, const T* v0, const T* ddq, T h, T* v) {
  for_each_free_flyer<T>(m, part, [&](const Body& b, Index i, const Vec3<T>& center) {
    const Vec3<T> c = plain ? Vec3<T>::zero() : center;
    const Vec3<T> u = load3(v0 + b.user_v), w = load3(v0 + b.user_v + 3), dw = load3(ddq + b.user_v + 3);
    const Vec3<T> a = load3(ddq + b.user_v) + cross(w, u) + cross(dw, c) + cross(w, cross(w, c));
    Vec3<T> w1 = w + dw * h;
    if (!plain && m.subtree_end()[i] == i + 1 && b.m > 0) {
      const Mat3<T> I = central_inertia(b, c);
      w1 = implicit_angular_velocity(I, I * w1 + cross(w, I * w) * h, h, w1);
    }
    store3(u + cross(w, c) + a * h - cross(w1, c), v + b.user_v);
    store3(w1, v + b.user_v + 3);
  });
}

// After q = q0 (+) (h v + correction): moves the centre of mass by its own velocity and expresses v in the axes at the end.
// correction: nullptr if there is none.
template <bool plain, class T, class Part>
void end_flight(const Model& m, const Part& part, const T* q0, T h, const T* correction, T* q, T* v) {
  for_each_free_flyer<T>(m, part, [&](const Body& b, Index, const Vec3<T>& center) {
    const Vec3<T> c = plain ? Vec3<T>::zero() : center;
    const Mat3<T> R0 = rotation(load_quaternion(q0 + b.user_q + 3)), R = rotation(load_quaternion(q + b.user_q + 3));
    const Vec3<T> w = load3(v + b.user_v + 3), vc = load3(v + b.user_v) + cross(w, c);
    Vec3<T> moved = vc * h;
    if (correction) moved = moved + load3(correction + b.user_v) + cross(load3(correction + b.user_v + 3), c);
    store3(load3(q0 + b.user_q) + R0 * (c + moved) - R * c, q + b.user_q);
    store3(transpose_times(R, R0 * vc) - cross(w, c), v + b.user_v);
  });
}

}  // namespace dyn::integrator
