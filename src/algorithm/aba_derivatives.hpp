// M^-1, and derivatives of forward dynamics from those of inverse dynamics at its result (Carpentier and Mansard 2018):
//   dddq/dq = -M^-1 dtau/dq    dddq/dv = -M^-1 dtau/dv    dddq/dtau = M^-1
#pragma once

#include "algorithm/articulated_solve.hpp"
#include "algorithm/factor_inverse.hpp"
#include "algorithm/forward_dynamics.hpp"
#include "algorithm/inverse_times.hpp"
#include "algorithm/rnea_derivatives.hpp"

namespace dyn {

// M^-1 comes from the factor of M, at a cost that grows with the depth of the tree, up to chains of some 40 joints; beyond, from
// articulated bodies. With mimic joints M does not follow the tree.
inline bool by_factor(const Model& m) {
  std::ptrdiff_t ancestors = 0;
  for (Index k = 0; k < m.n.nv; ++k) ancestors += m.dof_depth()[k];
  return m.has_mimic || ancestors <= 20 * std::ptrdiff_t(m.n.nv);
}

// d.Minv. Returns 0, or the joint that is singular.
template <class T>
Index minverse(const Model& m, Data<T>& d) {
  if (by_factor(m)) {
    crba(m, d);
    if (const Index failed = factorize(m, d)) return joint_of(m, failed - 1);
    invert(m, d);
    return 0;
  }
  if (const Index failed = aba(m, d, d.zero, d.zero, static_cast<const T*>(nullptr), d.discarded))
    return m.bodies()[failed].joint;
  articulated_columns(m, d);
  articulated_inverse(m, d);
  return 0;
}

// d.ddq, d.ddq_dq, d.ddq_dv, d.Minv. d.dtau_dq, d.dtau_dv, d.tau are left at a = ddq. Returns 0, or the joint that is singular.
template <class T>
Index aba_derivatives(const Model& m, Data<T>& d, const T* v, const T* tau, const T* fext) {
  if (const Index failed = forward_dynamics(m, d, v, tau, fext, d.ddq)) return failed;
  rnea_derivatives(m, d, v, d.ddq, fext);
  if (by_factor(m)) {
    if (const Index failed = factorize(m, d)) return joint_of(m, failed - 1);
    invert(m, d);
    minus_inverse_times(m, d.Minv, d.dtau_dq, d.dtau_dv, d.ddq_dq, d.ddq_dv);
    return 0;
  }
  articulated_columns(m, d);
  minus_articulated_solve(m, d, d.dtau_dq, d.ddq_dq);
  minus_articulated_solve(m, d, d.dtau_dv, d.ddq_dv);
  articulated_inverse(m, d);
  return 0;
}

}  // namespace dyn
