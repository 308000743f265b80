// Dry friction at joints, smoothed: r = c tanh(v / v_s), c in N m or N. Below v_s = DYN_FRICTION_VELOCITY it is nearly viscous.
#pragma once

#include <cmath>

#include "effect/effect.hpp"

namespace dyn::effect {

struct Friction : Coefficient<Friction> {
  static constexpr std::uint32_t bit = DYN_EFFECT_FRICTION;
  static constexpr const char* name = "a friction";
  static constexpr dynModelArray array = DYN_MODEL_ARRAY_FRICTION;
  static constexpr dynParameterGroup group = DYN_PARAMETER_GROUP_FRICTION;
  static constexpr const char *quantity = "dry friction", *absent = "no joint has dry friction", *mjcf = "frictionloss",
                              *urdf = "friction";
  static constexpr Implicit implicit = Implicit::Always;
  static constexpr bool bounded = true;
  static constexpr double rate = 1 / DYN_FRICTION_VELOCITY;
  DYN_EFFECT_COEFFICIENT(friction)
  DYN_EFFECT_WORK(friction)

  template <class T>
  static T force(T c, T v) {
    using math::tanh;
    return c * tanh(v * T(rate));
  }
  template <class T>
  static T slope(T c, T v) {
    using math::tanh;
    const T t = tanh(v * T(rate));
    return c * (T(1) - t * t) * T(rate);
  }
  template <class T>
  static T curvature(T c, T v) {
    using math::tanh;
    const T t = tanh(v * T(rate));
    return c * T(-2 * rate * rate) * t * (T(1) - t * t);
  }
  template <class T>
  static T secant(T c, T v) {
    using std::abs;
    using math::tanh;
    const T x = v * T(rate);
    return c * T(rate) * (abs(x) < T(1e-9) ? T(1) : tanh(x) / x);
  }
  // Derivative of secant by v.
  template <class T>
  static T secant_slope(T c, T v) {
    using std::abs;
    using math::tanh;
    const T x = v * T(rate), t = tanh(x);
    return c * T(rate * rate) * (abs(x) < T(1e-4) ? T(-2) / T(3) * x : (x * (T(1) - t * t) - t) / (x * x));
  }
  static double reflected(double ratio, double c) { return std::abs(ratio) * c; }
};

}  // namespace dyn::effect
