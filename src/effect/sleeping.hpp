// Sleeping: steps leave out trees at rest (simulation/sleep.hpp), in models where something can come to rest. No effect of the
// model itself.
#pragma once

#include "effect/effect.hpp"

namespace dyn::effect {

struct Sleeping {
  static constexpr std::uint32_t bit = DYN_EFFECT_SLEEPING;
  static constexpr const char* absent = "nothing can come to rest";
  static constexpr dynParts part = DYN_PART_SIMULATION;
  static constexpr Implicit implicit = Implicit::Never;
  template <class M>
  static bool present(const M&) { return false; }
  template <class M, class F>
  static void for_each_joint(const M& m, F&& f) {
    const bool rests = !m.has_mimic && m.n.slots + m.n.contacts + m.n.limits > 0;
    for (Index j = 1; rests && j < m.n.joints; ++j) f(j);
  }
};

}  // namespace dyn::effect
