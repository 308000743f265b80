// Actuator forces (dynActuator). With the length l = gear q of a coordinate:
//   f = gain . (w, u1, u2) + bias . (1, l, l'), clamped to the force range      tau += gear f
// An Euler step takes f at its end. With K = max(0, -bias1), D = max(0, -bias2) and l'' = gear ddq:
//   f_end = f - h K l' - (h D + h^2 K) l''
//   (M + gear^2 (h D + h^2 K)) ddq = tau + gear (f - h K l') - nle
// Actuators that this drives beyond their range are then fixed at its end.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/portable.hpp"
#include "model/data.hpp"

namespace dyn::simulation {

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

// Sleeping actuators keep their force.
template <class T>
bool sleeps(const Model& m, const Data<T>& d, const ActuatorRecord& r) {
  if constexpr (std::is_same_v<T, double>) return d.step->sleep.sleeps(m.joints()[r.spec.joint].last_body);
  return false;
}

// Actuators of an implicit Euler step.
template <class T>
class ImplicitActuators {
 public:
  ImplicitActuators(const Model& model, Data<T>& data, T step) : m(model), d(data), h(step) {
    each([&](const ActuatorRecord& r, Index k) {
      const T w = r.act >= 0 ? activation_after(r, d, d.act[r.act], h) : command(r, d);
      d.actuator_force[k] = unbounded_force(r, d, w, r.q >= 0 ? d.q[r.q] : T(0), d.v[r.v]);
      d.saturated[k] = 0;
    });
  }
  // Adds the implicit terms to d.armature and returns tau with the forces.
  const T* apply(const T* tau) {
    std::copy_n(tau, m.n.nv, d.step_tau);
    each([&](const ActuatorRecord& r, Index k) {
      const T gear = T(r.spec.gear);
      T f = d.actuator_force[k];
      if (!d.saturated[k]) d.armature[r.v] += gear * gear * (h * D(r) + h * h * K(r)), f -= h * K(r) * gear * d.v[r.v];
      d.step_tau[r.v] += gear * f;
    });
    return d.step_tau;
  }
  // After forward dynamics: returns whether any actuator reached the end of its range.
  bool saturate(const T* ddq) {
    bool any = false;
    each([&](const ActuatorRecord& r, Index k) {
      if (d.saturated[k]) return;
      const T gear = T(r.spec.gear), f = d.actuator_force[k] - h * K(r) * gear * d.v[r.v] - (h * D(r) + h * h * K(r)) * gear * ddq[r.v];
      if (const T held = clamp_to(f, r.spec.force_range); held != f) d.actuator_force[k] = held, d.saturated[k] = 1, any = true;
    });
    return any;
  }

 private:
  template <class F>
  void each(F&& f) {
    for_each_actuator(m, d, [&](const ActuatorRecord& r, Index k) {
      if (!sleeps(m, d, r)) f(r, k);
    });
  }
  static T K(const ActuatorRecord& r) { return r.q >= 0 ? T(std::max(0.0, -r.bias[1])) : T(0); }
  static T D(const ActuatorRecord& r) { return T(std::max(0.0, -r.bias[2])); }
  const Model& m;
  Data<T>& d;
  T h;
};

}  // namespace dyn::simulation
