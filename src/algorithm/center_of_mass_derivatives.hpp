// Derivatives of the velocity of the centre of mass on the tangent space: by v it is Jcom. A step of q along the column S of a
// body turns the momentum P of what the body carries (mass m, first moment h), and carries it on through the motion of the parent
// p:
//   m_all dvcom/dq = w_S x P + m dV_linear + dV_angular x h,   dV = V_p x S,   at the body's origin
#pragma once

#include "algorithm/center_of_mass.hpp"

namespace dyn {

// d.dvcom_dq and d.Jcom, 3 x nv; and d.com, d.vcom.
template <class T>
void center_of_mass_velocity_derivatives(const Model& m, Data<T>& d) {
  center_of_mass(m, d, 1);
  const T inverse = d.msub[0] > T(0) ? T(1) / d.msub[0] : T(0);
  for (Index i = 0; i < m.n.bodies; ++i) d.psub[i] = Vec3<T>::zero();
  for (T* X : {d.dvcom_dq, d.Jcom}) std::fill_n(X, 3 * std::ptrdiff_t(m.n.nv), T(0));
  auto add = [](T* column, const Vec3<T>& x) DYN_INLINE_LAMBDA {
    for (int c = 0; c < 3; ++c) column[c] += x[c];
  };
  backward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Vec3<T> P = d.psub[i] + d.vel[i] * T(b.m) + cross(d.omega[i], d.R[i] * cast<T>(b.h)), h = d.hsub[i];
    const Motion<T> Vp = shift(Motion<T>{d.vel[b.parent], d.omega[b.parent]}, d.r[i]);
    const T mass = d.msub[i], factor = inverse * T(b.ratio);
    for (int k = 0; k < J::nv; ++k) {
      const std::ptrdiff_t at = 3 * (b.user_v + k);
      const Motion<T> S = J::column(b, d.R[i], k), dV = cross(Vp, S);
      add(d.Jcom + at, (S.linear * mass + cross(S.angular, h)) * factor);
      add(d.dvcom_dq + at, (cross(S.angular, P) + dV.linear * mass + cross(dV.angular, h)) * factor);
    }
    d.psub[b.parent] += P;
  });
  d.mark_fresh(Stage::Jcom), d.mark_fresh(Stage::ComDerivatives);
}

}  // namespace dyn
