// Actuator forces (dynActuator). With the length l = gear q of a coordinate:
//   f = gain . (w, u1, u2) + bias . (1, l, l'), clamped to the force range      tau += gear f
#pragma once

#include <algorithm>
#include <cmath>

#include "base/portable.hpp"
#include "model/data.hpp"

namespace dyn {

inline dynActuator default_actuator(dynActuatorType type) {
  dynActuator a{};
  a.struct_size = sizeof a, a.type = type, a.gear = 1;
  for (double* range : {a.control_range, a.force_range, a.act_range}) range[0] = -HUGE_VAL, range[1] = HUGE_VAL;
  a.idx_act = -1;
  return a;
}

// Calls f(actuator, number) for those that are switched on.
template <class T, class F>
void for_each_actuator(const Model& m, const Data<T>& d, F&& f) {
  if (!(d.acting & DYN_EFFECT_ACTUATORS)) return;
  for (Index k = 0; k < m.n.actuators; ++k)
    if (d.effects[m.actuators()[k].spec.joint] & DYN_EFFECT_ACTUATORS) f(m.actuators()[k], k);
}

template <class T>
T clamp_to(T x, const double (&range)[2]) {
  return std::min(std::max(x, T(range[0])), T(range[1]));
}

template <class T>
T command(const ActuatorRecord& r, const Data<T>& d) {
  return clamp_to(d.ctrl[r.spec.idx_u], r.spec.control_range);
}

// Activation after h: exact, because the control is constant over the step.
template <class T>
T activation_after(const ActuatorRecord& r, const Data<T>& d, T w, T h) {
  using math::exp;
  const T u = command(r, d);
  return clamp_to(r.spec.integrates ? w + h * u : u + (w - u) * exp(-h / T(r.spec.time_constant)), r.spec.act_range);
}
// dw/dt
template <class T>
T activation_rate(const ActuatorRecord& r, const Data<T>& d, T w) {
  const T u = command(r, d);
  return r.spec.integrates ? u : (u - w) * T(1 / r.spec.time_constant);
}

template <class T>
T unbounded_force(const ActuatorRecord& r, const Data<T>& d, T w, T q, T v) {
  T f = T(r.bias[0]) + T(r.gain[0]) * w + T(r.bias[2] * r.spec.gear) * v;
  if (r.q >= 0) f += T(r.bias[1] * r.spec.gear) * q;
  if (r.spec.controls == 3) f += T(r.gain[1]) * d.ctrl[r.spec.idx_u + 1] + T(r.gain[2]) * d.ctrl[r.spec.idx_u + 2];
  return f;
}

// At the state and the activations in d.
template <class T>
T actuator_force(const ActuatorRecord& r, const Data<T>& d) {
  const T w = r.act >= 0 ? d.act[r.act] : command(r, d);
  return clamp_to(unbounded_force(r, d, w, r.q >= 0 ? d.q[r.q] : T(0), d.v[r.v]), r.spec.force_range);
}

// Returns tau plus all actuator forces at the state in d.
template <class T>
const T* actuated(const Model& m, Data<T>& d, const T* tau) {
  std::copy_n(tau, m.n.nv, d.step_tau);
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index) { d.step_tau[r.v] += T(r.spec.gear) * actuator_force(r, d); });
  return d.step_tau;
}

// Replaces the activations in d by those a time h after the values w.
template <class T>
void advance_activations(const Model& m, Data<T>& d, const T* w, T h) {
  for (Index k = 0; k < (m.n.na > 0 ? m.n.actuators : 0); ++k)
    if (const ActuatorRecord& r = m.actuators()[k]; r.act >= 0) d.act[r.act] = activation_after(r, d, w[r.act], h);
}

template <class T>
void record_forces(const Model& m, Data<T>& d) {
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index k) { d.actuator_force[k] = actuator_force(r, d); });
}

}  // namespace dyn
