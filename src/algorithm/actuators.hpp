// Actuator forces (dynActuator). With the length l = gear q of a coordinate or a path (algorithm/paths.hpp):
//   f = gain . (w, u1, u2) + bias . (1, l, l'), clamped to the force range      tau += gear J^T f, J = dq/d(degrees of freedom)
#pragma once

#include <algorithm>
#include <cmath>

#include "algorithm/driver.hpp"
#include "algorithm/force_limits.hpp"
#include "algorithm/paths.hpp"
#include "base/portable.hpp"
#include "effect/list.hpp"
#include "effect/muscle.hpp"

namespace dyn {

inline dynActuator default_actuator(dynActuatorType type) {
  dynActuator a{};
  a.struct_size = sizeof a, a.type = type, a.gear = 1;
  a.muscle = {1, {0.75, 1.05}, {0, 1}, 0.5, 1.6, 1.5, 1.3, 1.2, 0.01, 0.04, 0};
  a.tendon = a.frame = a.reference = -1;
  for (double* range : {a.control_range, a.force_range, a.act_range, a.velocity_range, a.feedforward_range})
    range[0] = -HUGE_VAL, range[1] = HUGE_VAL;
  a.idx_act = -1, a.inputs = type == DYN_ACTUATOR_TYPE_DC_MOTOR ? DYN_INPUT_VOLTAGE : DYN_INPUT_POSITION;
  a.motor.resistance = a.motor.constant = 1;
  return a;
}

template <class T>
T command(const ActuatorRecord& r, const Data<T>& d) {
  return clamp_to(d.ctrl[r.spec.idx_u], r.spec.control_range);
}

inline bool is_muscle(const ActuatorRecord& r) { return r.spec.type == DYN_ACTUATOR_TYPE_MUSCLE; }

// Excitation of a muscle, and the time constant of its activation.
template <class T>
T excitation(const ActuatorRecord& r, const Data<T>& d) { return std::clamp(command(r, d), T(0), T(1)); }

// Activation after h: exact for filters and integrators, because the control is constant over the step. A muscle's time constant
// is that of the beginning.
template <class T>
T activation_after(const ActuatorRecord& r, const Data<T>& d, T w, T h) {
  using math::exp;
  if (is_muscle(r)) {
    const T u = excitation(r, d);
    return clamp_to(u + (w - u) * exp(-h / muscle::time_constant(r.spec.muscle, u, w)), r.spec.act_range);
  }
  const T u = command(r, d);
  return clamp_to(r.spec.integrates ? w + h * u : u + (w - u) * exp(-h / T(r.spec.time_constant)), r.spec.act_range);
}
// dw/dt
template <class T>
T activation_rate(const ActuatorRecord& r, const Data<T>& d, T w) {
  if (is_muscle(r)) return (excitation(r, d) - w) / muscle::time_constant(r.spec.muscle, excitation(r, d), w);
  const T u = command(r, d);
  return r.spec.integrates ? u : (u - w) * T(1 / r.spec.time_constant);
}

// The same of all its states; paths must have been measured.
template <class T>
void activations_after(const ActuatorRecord& r, const Data<T>& d, const T* w, T h, T* out) {
  if (!has_driver(r.spec)) out[0] = activation_after(r, d, w[0], h);
  else driver::Driver<T>(r, d, w, T(r.spec.gear) * d.path_length[r.path], T(r.spec.gear) * d.path_velocity[r.path]).after(h, out);
}
template <class T>
void activation_rates(const ActuatorRecord& r, const Data<T>& d, const T* w, T* out) {
  if (!has_driver(r.spec)) out[0] = activation_rate(r, d, w[0]);
  else driver::Driver<T>(r, d, w, T(r.spec.gear) * d.path_length[r.path], T(r.spec.gear) * d.path_velocity[r.path]).rates(out);
}

// What an actuator acts on, before its gear: q and its rate v.
template <class T>
struct Stroke {
  T q, v;
};
template <class T>
DYN_INLINE Stroke<T> stroke_of(const ActuatorRecord& r, const Data<T>& d) {
  if (r.q >= 0) [[likely]] return {d.q[r.q], d.v[r.v]};
  return r.path >= 0 ? Stroke<T>{d.path_length[r.path], d.path_velocity[r.path]} : Stroke<T>{T(0), d.v[r.v]};
}

// Of an actuator on a coordinate.
template <class T>
T unbounded_force(const ActuatorRecord& r, const Data<T>& d, T w, T q, T v) {
  T f = T(r.bias[0]) + T(r.gain[0]) * w + T(r.bias[2] * r.spec.gear) * v;
  if (r.q >= 0) f += T(r.bias[1] * r.spec.gear) * q;
  if (r.spec.controls == 3) f += T(r.gain[1]) * d.ctrl[r.spec.idx_u + 1] + T(r.gain[2]) * d.ctrl[r.spec.idx_u + 2];
  return f;
}

// Of one on a path, before its gear, with what drives it: w, of a driver its states.
template <class T>
PathLaw<T> path_law(const ActuatorRecord& r, const Data<T>& d, const T* w) {
  const dynActuator& a = r.spec;
  const T l = T(a.gear) * d.path_length[r.path], v = T(a.gear) * d.path_velocity[r.path];
  if (is_muscle(r)) {
    const muscle::Force<T> f = muscle::force(a.muscle, *w, l, v);
    return {f.force, f.stiffness, f.damping, T(0)};
  }
  if (has_driver(a)) return driver::Driver<T>(r, d, w, l, v).force();
  const T x = driver::nearest(*w, l, r.period);
  const T by_l = T(r.bias[1]) + T(a.gain_slope[0]) * x, by_v = T(r.bias[2]) + T(a.gain_slope[1]) * x;
  T f = T(r.bias[0]) + T(r.gain[0]) * x + by_l * l + by_v * v;
  if (a.controls == 3) f += T(r.gain[1]) * d.ctrl[a.idx_u + 1] + T(r.gain[2]) * d.ctrl[a.idx_u + 2];
  return {f, std::max(T(0), -by_l), std::max(T(0), -by_v), T(0)};
}

// What drives an actuator on a path at the activations in d: its states, or a command that is put into w.
template <class T>
const T* driving(const ActuatorRecord& r, const Data<T>& d, T& w) {
  if (r.act >= 0) return d.act + r.act;
  if (r.spec.controls > 0) w = command(r, d);
  return &w;
}

// At the state and the activations in d; paths must have been placed, and limits of sums taken (take_limits).
template <class T>
T actuator_force(const ActuatorRecord& r, const Data<T>& d) {
  T w = T(0);
  if (r.path >= 0) {
    const PathLaw<T> x = path_law(r, d, driving(r, d, w));
    const T f = r.limit >= 0 && on_tendon(r) ? d.force_sums[2 * r.limit] * x.force : x.force;
    return clamp_to(f, r.spec.force_range) + x.beside;
  }
  w = r.act >= 0 ? d.act[r.act] : command(r, d);
  const Stroke<T> s = stroke_of(r, d);
  return clamp_to(unbounded_force(r, d, w, s.q, s.v), r.spec.force_range);
}

// Limits of sums at the state and the activations in d.
template <class T>
void take_limits(const Model& m, Data<T>& d) {
  if (m.n.force_limits > 0)
    take_force_limits(m, d, [&](const ActuatorRecord& r, Index) {
      T w = T(0);
      return on_tendon(r) ? path_law(r, d, driving(r, d, w)).force : T(r.spec.gear) * actuator_force(r, d);
    });
}

// tau += gear J^T f
template <class T>
DYN_INLINE void add_actuator_force(const Model& m, const Data<T>& d, const ActuatorRecord& r, T f, T* tau) {
  if (r.v >= 0) [[likely]] tau[r.v] += T(r.spec.gear) * f;
  else add_path_force(m, d, r.path, T(r.spec.gear) * f, tau);
}

// Calls f(tendon, number, length, rate) for those with a force of their own that are switched on.
template <class T, class F>
void for_each_tendon(const Model& m, const Data<T>& d, F&& f) {
  if (!(d.acting & DYN_EFFECT_TENDONS)) return;
  for (Index k = 0; k < m.n.tendons; ++k)
    if (d.effects[m.paths()[k].joint] & DYN_EFFECT_TENDONS) f(m.tendons()[k].spec, k, d.path_length[k], d.path_velocity[k]);
}

// Of the springs of tendons, J; paths must have been measured.
template <class T>
T tendon_energy(const Model& m, const Data<T>& d) {
  T sum = T(0);
  for_each_tendon(m, d, [&](const dynTendon& t, Index, T length, T) { sum += effect::Tendons::energy(t, length); });
  return sum;
}

// Kinetic energy of what moves with tendons, J; paths must have been measured.
template <class T>
T tendon_kinetic_energy(const Model& m, const Data<T>& d) {
  T twice = T(0);
  for_each_tendon(m, d, [&](const dynTendon& t, Index, T, T rate) { twice += T(t.armature) * rate * rate; });
  return T(0.5) * twice;
}

// Returns tau plus the forces of all actuators and tendons at the state in d.
template <class T>
const T* actuated(const Model& m, Data<T>& d, const T* tau) {
  std::copy_n(tau, m.n.nv, d.step_tau);
  if (m.n.paths > 0) {
    place_paths(m, d);
    for (Index k = 0; k < m.n.path_rows; ++k) d.path_forces[k].acts = 0;
    take_limits(m, d), add_beyond_limits(m, d, d.step_tau);
  }
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index) { add_actuator_force(m, d, r, actuator_force(r, d), d.step_tau); });
  for_each_tendon(m, d, [&](const dynTendon& t, Index k, T length, T rate) {
    add_path_force(m, d, k, effect::Tendons::force(t, length, rate), d.step_tau);
  });
  return d.step_tau;
}

// Replaces the activations in d by those a time h after the values w.
template <class T>
void advance_activations(const Model& m, Data<T>& d, const T* w, T h) {
  for (Index k = 0; k < (m.n.na > 0 ? m.n.actuators : 0); ++k)
    if (const ActuatorRecord& r = m.actuators()[k]; r.act >= 0)
      activations_after(r, d, w + r.act, h, d.act + r.act);
}

template <class T>
void record_forces(const Model& m, Data<T>& d) {
  if (m.n.paths > 0) place_paths(m, d), take_limits(m, d);
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index k) { d.actuator_force[k] = actuator_force(r, d); });
}

}  // namespace dyn
