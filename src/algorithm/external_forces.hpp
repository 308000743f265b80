// External forces on links in a step: applied wrenches, and the effects on links (src/effect).
#pragma once

#include "algorithm/actuators.hpp"
#include "algorithm/declarations.hpp"
#include "algorithm/forward_dynamics.hpp"
#include "effect/list.hpp"

namespace dyn {

// Returns the external forces on the joints' bodies in joint frames at the state in d, or nullptr if there are none.
template <class T>
const T* forces_on_bodies(const Model& m, Data<T>& d) {
  if (!(d.acting & (link_effects | acting_wrenches))) return nullptr;
  if (d.acting & fast_link_effects) forward_kinematics<1>(m, d);
  else forward_kinematics<0>(m, d);
  std::fill_n(d.step_fext, 6 * std::ptrdiff_t(m.n.joints), T(0));
  // f: world axes, at the body's origin
  const auto add = [&](Index j, Index body, const Force<T>& f) {
    const Mat3<T> R = d.R[body] * cast<T>(m.joints()[j].C);
    const Vec3<T> force = transpose_times(R, f.linear), moment = transpose_times(R, f.angular);
    for (int k = 0; k < 3; ++k) d.step_fext[6 * j + k] += force[k], d.step_fext[6 * j + 3 + k] += moment[k];
  };
  if (d.acting & acting_wrenches)
    for (Index j = 1; j < m.n.joints; ++j) {
      const Index body = m.joints()[j].last_body;
      add(j, body, d.wrenches[j].at(d.R[body], d.p[body]));
    }
  for_each_effect([&]<class E>() {
    if constexpr (effect::OnLinks<E>) {
      if (!(d.acting & E::bit)) return;
      for (const auto& x : E::records(m))
        if (d.effects[x.joint] & E::bit) add(x.joint, x.body, E::template wrench<T>(m, d, x));
    }
  });
  return d.step_fext;
}

}  // namespace dyn
