// Limits of joints: in steps they are rows of the contact problem (simulation/find_constraints.cpp).
#pragma once

#include "effect/effect.hpp"

namespace dyn::effect {

struct Limits : Listed<Limits> {
  static constexpr std::uint32_t bit = DYN_EFFECT_LIMITS;
  static constexpr const char* absent = "no joint has limits";
  static constexpr dynParts part = 0;
  template <class M>
  static auto records(const M& m) { return std::span(m.limits(), std::size_t(m.n.limits)); }
  template <class M, class R>
  static Index joint(const M& m, const R& record) { return m.bodies()[record.body].joint; }
};

}  // namespace dyn::effect
