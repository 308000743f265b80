// Actuators: their law is that of dynActuator (algorithm/actuators.hpp). Euler steps take their gains at the end of the step.
#pragma once

#include "effect/effect.hpp"

namespace dyn::effect {

struct Actuators : Listed<Actuators> {
  static constexpr std::uint32_t bit = DYN_EFFECT_ACTUATORS;
  static constexpr const char* absent = "the file has none";
  static constexpr Implicit implicit = Implicit::Always;
  DYN_EFFECT_WORK(actuators)
  template <class M>
  static auto records(const M& m) { return std::span(m.actuators(), std::size_t(m.n.actuators)); }
  template <class M, class R>
  static Index joint(const M&, const R& record) { return record.spec.joint; }
};

}  // namespace dyn::effect
