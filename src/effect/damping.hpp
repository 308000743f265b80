// Viscous damping: r = c v, c in N m s/rad or N s/m.
#pragma once

#include "effect/effect.hpp"

namespace dyn::effect {

struct Damping : Coefficient<Damping> {
  static constexpr std::uint32_t bit = DYN_EFFECT_DAMPING;
  static constexpr const char* name = "a damping";
  static constexpr dynModelArray array = DYN_MODEL_ARRAY_DAMPING;
  static constexpr dynParameterGroup group = DYN_PARAMETER_GROUP_DAMPING;
  static constexpr const char *quantity = "damping", *absent = "no joint has damping", *mjcf = "damping", *urdf = "damping";
  static constexpr Implicit implicit = Implicit::Always;
  DYN_EFFECT_COEFFICIENT(damping)
  DYN_EFFECT_WORK(damping)

  template <class T> static T force(T c, T v) { return c * v; }
  template <class T> static T slope(T c, T) { return c; }
  template <class T> static T secant(T c, T) { return c; }
  template <class T> static T secant_slope(T, T) { return T(0); }
};

}  // namespace dyn::effect
