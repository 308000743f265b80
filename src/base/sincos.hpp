// sin and cos of many angles in one vectorised sweep.
// Method: Cody-Waite reduction by pi/2 in three parts of 33 bits with a compensated remainder, then the minimax kernels
// of fdlibm (Sun Microsystems, k_sin.c and k_cos.c: coefficients). Below one unit in the last place; arguments beyond
// 2^20 are reduced as integers (portable.hpp).
#pragma once

#include "base/portable.hpp"
#include "base/simd.hpp"

namespace dyn {

// Room that the arrays of a sweep over n angles need.
inline constexpr Index padded_sweep(Index n) { return (n + 7) / 8 * 8; }

// c[i], s[i] = cos, sin of x[i]
template <class T>
inline void sincos_sweep(const T* x, Index n, T* c, T* s) {
  using math::cos;
  using math::sin;
  for (Index i = 0; i < n; ++i) c[i] = cos(x[i]), s[i] = sin(x[i]);
}

namespace detail {

inline constexpr double sweep_reach = 0x1p20;
inline constexpr int sweep_lanes = DYN_SIMD ? 4 : 1;  // eight, where there are, are slower: they slow down everything about them
using Angles = Simd<double, sweep_lanes>;
using AngleBits = Simd<std::int64_t, sweep_lanes>;

DYN_INLINE void two_sum(Angles a, Angles b, Angles& sum, Angles& error) {
  sum = a + b;
  const Angles bb = sum - a;
  error = (a - (sum - bb)) + (b - bb);
}

// Of x = r + y + k pi/2, |r| <= pi/4, y what r does not hold of it.
DYN_INLINE void sincos_reduced(Angles r, Angles y, AngleBits k, Angles& c, Angles& s) {
  const Angles z = r * r;
  const Angles ps = 8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04 + z * (2.75573137070700676789e-06 +
                    z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
  const Angles v = z * r;
  const Angles half_y = 0.5 * y;  // GCC contracts the product that it meets first
  const Angles sine = r - ((z * (half_y - v * ps) - y) + v * 1.66666666666666324348e-01);
  const Angles pc = z * (4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * (2.48015872894767294178e-05 +
                    z * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
  const Angles hz = 0.5 * z, w = 1.0 - hz;
  const Angles zpc = z * pc;
  const Angles cosine = w + (((1.0 - w) - hz) + (zpc - r * y));
  // quadrant: odd exchanges sine and cosine; signs from bits 1 of k and k + 1
  const AngleBits odd = -(k & 1), negative_s = (k & 2) << 62, negative_c = ((k + 1) & 2) << 62;
  const AngleBits cosine_bits = reinterpret<std::int64_t>(cosine), sine_bits = reinterpret<std::int64_t>(sine);
  s = reinterpret<double>(((cosine_bits & odd) | (sine_bits & ~odd)) ^ negative_s);
  c = reinterpret<double>(((sine_bits & odd) | (cosine_bits & ~odd)) ^ negative_c);
}

DYN_INLINE void sincos_lanes(Angles x, Angles& c, Angles& s) {
  const Angles magic = Angles(0x1.8p52);  // adding it rounds to an integer in the low bits
  const Angles kd = x * 0x1.45f306dc9c883p-1 + magic;
  const AngleBits k = reinterpret<std::int64_t>(kd);
  const Angles n = kd - magic;
  // pi/2 = P1 + P2 + P3 + P4, 33 bits each: n times a part is exact for |n| <= 2^20
  Angles r, r_error, t, t_error;
  two_sum(x - n * 0x1.921fb544p+0, -(n * 0x1.0b4611a6p-34), t, t_error);
  two_sum(t, -(n * 0x1.3198a2ep-69), r, r_error);
  const Angles y = t_error + r_error - n * 0x1.b839a252049c1p-104;
  sincos_reduced(r, y, k, c, s);
}

// Those of x beyond the reach of the reduction.
[[gnu::cold, gnu::noinline]] inline void sincos_far(const double* x, Index n, double* c, double* s) {
  for (Index i = 0; i < n; ++i)
    if (!(std::abs(x[i]) <= sweep_reach)) c[i] = portable::cos(x[i]), s[i] = portable::sin(x[i]);
}

}  // namespace detail

// x, c and s must have room for a multiple of sweep_lanes numbers.
template <>
inline void sincos_sweep(const double* x, Index n, double* c, double* s) {
  using namespace detail;
  auto within = abs(Angles::zero()) <= sweep_reach;
  for (Index i = 0; i < n; i += sweep_lanes) {
    const Angles X = Angles::load(x + i);
    Angles C, S;
    sincos_lanes(X, C, S);
    C.store(c + i), S.store(s + i);
    within &= abs(X) <= sweep_reach;
  }
  if (!all(within)) [[unlikely]]
    sincos_far(x, n, c, s);
}

}  // namespace dyn
