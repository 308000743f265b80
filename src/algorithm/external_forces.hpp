// External forces in a step: actuators, applied wrenches, gravity compensation, drag of a medium.
#pragma once

#include "algorithm/declarations.hpp"
#include "algorithm/forward_dynamics.hpp"
#include "algorithm/actuators.hpp"

namespace dyn {

inline constexpr std::uint32_t on_bodies = DYN_EFFECT_FLUID | DYN_EFFECT_GRAVITY_COMPENSATION | acting_wrenches;

// Drag of the medium on a box that moves with v, w relative to it, in the box's axes (model of dyn_builder_set_medium).
template <class T>
Force<T> drag(const Model& m, const DragBox& box, const Vec3<T>& v, const Vec3<T>& w) {
  using std::abs;
  constexpr double pi = 3.14159265358979323846;
  const double mean = (box.half[0] + box.half[1] + box.half[2]) / 3;
  T force[3], moment[3];
  for (int i = 0; i < 3; ++i) {
    const double r = box.half[i], a = box.half[(i + 1) % 3], b = box.half[(i + 2) % 3];
    const T vi = v[i], wi = w[i];
    force[i] = -(T(2 * m.density * a * b) * abs(vi) + T(6 * pi * m.viscosity * mean)) * vi;
    moment[i] = -(T(0.5 * m.density * r * (a * a * a * a + b * b * b * b)) * abs(wi) + T(8 * pi * m.viscosity * mean * mean * mean)) * wi;
  }
  return {load3(force), load3(moment)};
}

// Returns the external forces on the joints' bodies in joint frames at the state in d, or nullptr if there are none.
template <class T>
const T* forces_on_bodies(const Model& m, Data<T>& d) {
  if (!(d.acting & on_bodies)) return nullptr;
  if (d.acting & DYN_EFFECT_FLUID) forward_kinematics<1>(m, d);
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
  if (d.acting & DYN_EFFECT_GRAVITY_COMPENSATION)
    for (Index k = 0; k < m.n.gravity_compensations; ++k) {
      const GravityCompensation& x = m.gravity_compensations()[k];
      if (!(d.effects[x.joint] & DYN_EFFECT_GRAVITY_COMPENSATION)) continue;
      const Vec3<T> force = load3(d.world_gravity) * T(-x.mass);
      add(x.joint, x.body, {force, cross(d.R[x.body] * cast<T>(x.at), force)});
    }
  if (d.acting & DYN_EFFECT_FLUID)
    for (Index k = 0; k < m.n.drag_boxes; ++k) {
      const DragBox& x = m.drag_boxes()[k];
      if (!(d.effects[x.joint] & DYN_EFFECT_FLUID)) continue;
      const Mat3<T> R = d.R[x.body] * cast<T>(x.X.R);
      const Vec3<T> arm = d.R[x.body] * cast<T>(x.X.p), wind = Vec3<T>::make(T(m.wind[0]), T(m.wind[1]), T(m.wind[2]));
      const Vec3<T> v = d.u[x.body] + cross(d.w[x.body], arm) - wind;
      const Force<T> f = drag(m, x, transpose_times(R, v), transpose_times(R, d.w[x.body]));
      const Vec3<T> force = R * f.linear;
      add(x.joint, x.body, {force, R * f.angular + cross(arm, force)});
    }
  return d.step_fext;
}

}  // namespace dyn
