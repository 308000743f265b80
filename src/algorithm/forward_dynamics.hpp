// Forward dynamics of any model: ABA, or with mimic joints (whose M does not follow the tree) by the factor of M.
#pragma once

#include "algorithm/aba.hpp"
#include "algorithm/factor_inverse.hpp"
#include "algorithm/configuration.hpp"
#include "algorithm/crba.hpp"

namespace dyn {

// The joint that a degree of freedom belongs to.
inline Index joint_of(const Model& m, Index dof) {
  for (Index j = 1; j < m.n.joints; ++j)
    if (m.joints()[j].idx_v <= dof && dof < m.joints()[j].idx_v + m.joints()[j].nv) return j;
  return 1;
}

// ddq for the user's v and tau; q is d.q. Returns 0 or the joint at which M is not positive (ddq is then undefined). Part: of
// some of the trees, where no joint follows another.
template <class T, class Part>
Index forward_dynamics(const Model& m, Data<T>& d, const Part& part, const T* v, const T* tau, const T* fext, T* ddq) {
  if (!m.has_mimic) {
    if constexpr (branches_by_state<T>)
      if (resists(d)) {
        for_each_dof_range(m, part, [&](Index first, Index end) { std::fill(d.net + first, d.net + end, T(0)); });
        add_resistance(m, d, v, d.net, part);
        for_each_dof_range(m, part, [&](Index first, Index end) {
          for (Index k = first; k < end; ++k) d.net[k] = tau[k] - d.net[k];
        });
        tau = d.net;
      }
    const Index body = aba(m, d, v, tau, fext, ddq, part);
    return body ? m.bodies()[body].joint : 0;
  }
  inverse_dynamics(m, d, v, static_cast<const T*>(d.zero), fext, ddq);
  for (Index k = 0; k < m.n.nv; ++k) ddq[k] = tau[k] - ddq[k];
  crba(m, d);
  if (const Index failed = factorize(m, d)) return joint_of(m, failed - 1);
  solve(m, d, ddq, ddq, ddq);
  return 0;
}
template <class T>
Index forward_dynamics(const Model& m, Data<T>& d, const T* v, const T* tau, const T* fext, T* ddq) {
  return forward_dynamics(m, d, WholeModel{}, v, tau, fext, ddq);
}

}  // namespace dyn
