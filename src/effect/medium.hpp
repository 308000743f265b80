// Velocity of what is on a link relative to the medium (dyn_builder_set_medium).
#pragma once

#include "spatial/mat3.hpp"
#include "spatial/motion.hpp"

namespace dyn::effect {

// World axes, at the origin of x.body: law(v, w) is the force in the axes of x.X, about its origin, which moves with v, w.
template <class T, class M, class D, class R, class Law>
Force<T> wrench_of_medium(const M& m, const D& d, const R& x, Law&& law) {
  const Mat3<T> R_WX = d.R[x.body] * cast<T>(x.X.R);
  const Vec3<T> arm = d.R[x.body] * cast<T>(x.X.p), wind = Vec3<T>::make(T(m.wind[0]), T(m.wind[1]), T(m.wind[2]));
  const Vec3<T> v = d.vel[x.body] + cross(d.omega[x.body], arm) - wind;
  const Force<T> f = law(transpose_times(R_WX, v), transpose_times(R_WX, d.omega[x.body]));
  const Vec3<T> force = R_WX * f.linear;
  return {force, R_WX * f.angular + cross(arm, force)};
}

}  // namespace dyn::effect
