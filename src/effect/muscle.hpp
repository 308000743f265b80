// The force of a muscle (dynMuscle), and the rate of its activation. With x the normalised length, y the normalised velocity:
//   f = -force (w FL(x) FV(y) + FP(x))
#pragma once

#include <algorithm>
#include <cmath>

#include "dyn.h"
#include "base/portable.hpp"

namespace dyn::muscle {

// Active force by length: half parabolas from 0 at lmin to 1 at x = 1 and back to 0 at lmax.
template <class T>
T by_length(const dynMuscle& p, T x) {
  const T low = T(p.lmin), high = T(p.lmax), rise = (low + T(1)) / T(2), fall = (T(1) + high) / T(2);
  if (x < low || x > high) return T(0);
  const auto half = [](T y) { return T(0.5) * y * y; };
  if (x <= rise) return half((x - low) / (rise - low));
  if (x <= T(1)) return T(1) - half((T(1) - x) / (T(1) - rise));
  if (x <= fall) return T(1) - half((x - T(1)) / (fall - T(1)));
  return half((high - x) / (high - fall));
}

// Active force by velocity and its slope; y < 0 shortens.
template <class T>
struct Curve {
  T value, slope;
};
template <class T>
Curve<T> by_velocity(const dynMuscle& p, T y) {
  const T most = T(p.fvmax), end = most - T(1);
  if (y <= T(-1)) return {T(0), T(0)};
  if (y <= T(0)) return {(y + T(1)) * (y + T(1)), T(2) * (y + T(1))};
  if (y <= end) return {most - (end - y) * (end - y) / end, T(2) * (end - y) / end};
  return {most, T(0)};
}

// Passive force by length and its slope.
template <class T>
Curve<T> passive(const dynMuscle& p, T x) {
  const T half = (T(p.lmax) - T(1)) / T(2), most = T(p.fpmax);
  if (x <= T(1)) return {T(0), T(0)};
  const T y = (x - T(1)) / half;
  if (y <= T(1)) return {most * T(0.5) * y * y, most * y / half};
  return {most * (y - T(0.5)), most / half};
}

inline double optimum_length(const dynMuscle& p) {
  return (p.length_range[1] - p.length_range[0]) / (p.range[1] - p.range[0]);
}

// Force and what it loses by length and by its rate: -df/dl of the passive part, -df/dl', both >= 0.
template <class T>
struct Force {
  T force, stiffness, damping;
};
template <class T>
Force<T> force(const dynMuscle& p, T w, T length, T rate) {
  const T L0 = T(optimum_length(p)), x = T(p.range[0]) + (length - T(p.length_range[0])) / L0, speed = L0 * T(p.vmax);
  const Curve<T> fast = by_velocity(p, rate / speed), held = passive(p, x);
  const T active = T(p.force) * w * by_length(p, x);
  return {-(active * fast.value + T(p.force) * held.value), T(p.force) * held.slope / L0, active * fast.slope / speed};
}

// Time constant of the activation at w with the control u, both in [0, 1].
template <class T>
T time_constant(const dynMuscle& p, T u, T w) {
  using math::exp;
  const T within = std::clamp(w, T(0), T(1)), scale = T(0.5) + T(1.5) * within;
  const T rising = T(p.t_act) * scale, falling = T(p.t_deact) / scale;
  if (p.smoothing < 1e-15) return u > w ? rising : falling;
  // blends over |u - w| < smoothing / 2 by 6 s^5 - 15 s^4 + 10 s^3
  const T s = std::clamp((u - w) / T(p.smoothing) + T(0.5), T(0), T(1));
  return falling + (rising - falling) * (s * s * s * (T(6) * s * s - T(15) * s + T(10)));
}

}  // namespace dyn::muscle
