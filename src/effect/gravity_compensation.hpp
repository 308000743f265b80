// Gravity compensation of a link: the force -m g at its centre of mass, with its share of m.
#pragma once

#include "effect/effect.hpp"
#include "spatial/mat3.hpp"
#include "spatial/motion.hpp"

namespace dyn::effect {

struct GravityCompensation : Listed<GravityCompensation> {
  static constexpr std::uint32_t bit = DYN_EFFECT_GRAVITY_COMPENSATION;
  static constexpr const char* absent = "no link's weight is held";
  static constexpr bool needs_velocity = false;
  DYN_EFFECT_WORK(wrenches)
  template <class M>
  static auto records(const M& m) { return std::span(m.gravity_compensations(), std::size_t(m.n.gravity_compensations)); }
  template <class T, class M, class D, class R>
  static Force<T> wrench(const M&, const D& d, const R& x) {
    const Vec3<T> force = load3(d.world_gravity) * T(-x.mass);
    return {force, cross(d.R[x.body] * cast<T>(x.at), force)};
  }
};

}  // namespace dyn::effect
