// The closed list of effects. A new one is a file, a line here, and its bit in dyn.h.
#pragma once

#include "effect/actuators.hpp"
#include "effect/armature.hpp"
#include "effect/damping.hpp"
#include "effect/fluid.hpp"
#include "effect/fluid_ellipsoids.hpp"
#include "effect/friction.hpp"
#include "effect/gravity_compensation.hpp"
#include "effect/limits.hpp"
#include "effect/sleeping.hpp"
#include "effect/springs.hpp"
#include "effect/tendons.hpp"

namespace dyn {

#define DYN_EFFECTS(X) \
  X(Armature) X(Damping) X(Friction) X(Springs) X(Limits) X(Actuators) X(GravityCompensation) X(Fluid) X(FluidEllipsoids) \
  X(Sleeping) X(Tendons)

// f.template operator()<E>() for every effect.
template <class F>
DYN_INLINE constexpr void for_each_effect(F&& f) {
#define DYN_EFFECT_CALL(E) f.template operator()<effect::E>();
  DYN_EFFECTS(DYN_EFFECT_CALL)
#undef DYN_EFFECT_CALL
}

// f.template operator()<E>() for every effect with a coefficient for each degree of freedom.
template <class F>
DYN_INLINE constexpr void for_each_coefficient(F&& f) {
  for_each_effect([&]<class E>() {
    if constexpr (effect::HasCoefficient<E>) f.template operator()<E>();
  });
}

// Bits of the effects that has.template operator()<E>() is true of.
template <class F>
constexpr std::uint32_t effect_bits(F&& has) {
  std::uint32_t bits = 0;
  for_each_effect([&]<class E>() { bits |= has.template operator()<E>() ? E::bit : 0u; });
  return bits;
}
static_assert(effect_bits([]<class E>() { return true; }) == DYN_EFFECT_ALL, "each DYN_EFFECT_... is one file of src/effect");

inline constexpr std::uint32_t resisting_effects =
    effect_bits([]<class E>() { return effect::OfVelocity<E> || effect::OfConfiguration<E>; });
// Those that add to tau in steps.
inline constexpr std::uint32_t driving_effects = DYN_EFFECT_ACTUATORS | DYN_EFFECT_TENDONS;
inline constexpr std::uint32_t link_effects = effect_bits([]<class E>() { return effect::OnLinks<E>; });
inline constexpr std::uint32_t fast_link_effects = effect_bits([]<class E>() {
  if constexpr (effect::OnLinks<E>) return E::needs_velocity;
  else return false;
});
// Those that Euler steps take at their end.
constexpr std::uint32_t implicit_effects(bool implicit_fast) {
  return effect_bits([=]<class E>() {
    return E::implicit == effect::Implicit::Always || (implicit_fast && E::implicit == effect::Implicit::ImplicitFast);
  });
}

// Those that a model has.
template <class M>
std::uint32_t effects_of(const M& m) {
  return effect_bits([&]<class E>() { return E::present(m); });
}

}  // namespace dyn
