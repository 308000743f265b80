// Inertia of rotors behind gears: added to the diagonal of M, kg m^2 or kg.
#pragma once

#include "effect/effect.hpp"

namespace dyn::effect {

struct Armature : Coefficient<Armature> {
  static constexpr std::uint32_t bit = DYN_EFFECT_ARMATURE;
  static constexpr const char* name = "an armature";
  static constexpr dynModelArray array = DYN_MODEL_ARRAY_ARMATURE;
  static constexpr dynParameterGroup group = DYN_PARAMETER_GROUP_ARMATURE;
  static constexpr const char *quantity = "armature", *absent = "no joint has armature", *mjcf = "armature", *urdf = nullptr;
  DYN_EFFECT_COEFFICIENT(armature)
  template <class Spec>
  static double own(const Spec& s) { return s.rotor_inertia * s.gear_ratio * s.gear_ratio + Coefficient::own(s); }
};

}  // namespace dyn::effect
