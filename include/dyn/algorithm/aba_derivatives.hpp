// M^-1, and derivatives of forward dynamics from those of inverse dynamics at its result (Carpentier and Mansard 2018):
//   dddq/dq = -M^-1 dtau/dq    dddq/dv = -M^-1 dtau/dv    dddq/dtau = M^-1
#pragma once

#include "dyn/algorithm/articulated_solve.hpp"
#include "dyn/algorithm/factor_inverse.hpp"
#include "dyn/algorithm/forward_dynamics.hpp"
#include "dyn/algorithm/rnea_derivatives.hpp"

namespace dyn {

// d.Minv. Returns 0, or the joint that is singular.
template <class T>
Index minverse(const Model& m, Data<T>& d) {
  if (m.has_mimic || m.n.nv <= 64) {
    crba(m, d);
    if (const Index failed = factorize(m, d)) return joint_of(m, failed - 1);
    invert(m, d);
    return 0;
  }
  if (const Index failed = aba(m, d, d.zero, d.zero, static_cast<const T*>(nullptr), d.stepper)) return m.bodies()[failed].joint;
  articulated_columns(m, d);
  articulated_inverse(m, d);
  return 0;
}

// d.ddq, d.ddq_dq, d.ddq_dv, d.Minv. d.dtau_dq, d.dtau_dv, d.tau are left at a = ddq. Returns 0, or the joint that is singular.
template <class T>
Index aba_derivatives(const Model& m, Data<T>& d, const T* v, const T* tau, const T* fext) {
  if (const Index failed = forward_dynamics(m, d, v, tau, fext, d.ddq)) return failed;
  rnea_derivatives(m, d, v, d.ddq, fext);
  if (!m.has_mimic) {
    articulated_columns(m, d);
    minus_articulated_solve(m, d, d.dtau_dq, d.ddq_dq);
    minus_articulated_solve(m, d, d.dtau_dv, d.ddq_dv);
    articulated_inverse(m, d);
    return 0;
  }
  const std::ptrdiff_t n = m.n.nv;
  for (std::ptrdiff_t k = 0; k < n * n; ++k) d.ddq_dq[k] = -d.dtau_dq[k], d.ddq_dv[k] = -d.dtau_dv[k];
  for (std::ptrdiff_t k = 0; k < n; ++k) solve(m, d, d.ddq_dq + n * k), solve(m, d, d.ddq_dv + n * k);
  invert(m, d);
  return 0;
}

}  // namespace dyn
