// Actuators in an Euler step of h, which takes their force at its end. With K = max(0, -bias1), D = max(0, -bias2) and l'' = gear
// ddq:
//   f_end = f - h K l' - (h D + h^2 K) l''
//   (M + gear^2 (h D + h^2 K)) ddq = tau + gear (f - h K l') - nle
// Actuators that this drives beyond their range are then fixed at its end. Those on paths, and tendons: path_forces.hpp.
#pragma once

#include "simulation/adhesion.hpp"
#include "simulation/path_forces.hpp"

namespace dyn::simulation {

// Sleeping actuators keep their force. What a path moves does not sleep.
template <class T>
bool sleeps(const Model& m, const Data<T>& d, const ActuatorRecord& r) {
  if constexpr (std::is_same_v<T, double>) return r.v >= 0 && d.step->sleep.sleeps(m.joints()[r.spec.joint].last_body);
  return false;
}

// Gains of an actuator on a coordinate, as a spring and a damper.
inline double stiffness_of(const ActuatorRecord& r) { return r.q >= 0 ? std::max(0.0, -r.bias[1]) : 0; }
inline double damping_of(const ActuatorRecord& r) { return std::max(0.0, -r.bias[2]); }
// Its force at the end of the step, from that at the beginning, dq/dt there, and d2q/dt2.
template <class T>
T force_at_end(const ActuatorRecord& r, T force, T v, T ddq, T h) {
  const T gear = T(r.spec.gear), K = T(stiffness_of(r)), D = T(damping_of(r));
  return force - h * K * gear * v - (h * D + h * h * K) * gear * ddq;
}

// Actuators of an implicit Euler step.
template <class T>
class ImplicitActuators {
 public:
  ImplicitActuators(const Model& model, Data<T>& data, T step) : m(model), d(data), h(step) {
    if (m.n.paths > 0) begin_with_paths();
    else each([&](const ActuatorRecord& r, Index k) { begin(r, k); });
  }
  // Adds the implicit terms to d.armature and returns tau of the trees `part` with the forces.
  template <class Part>
  const T* apply(const Part& part, const T* tau) {
    part.for_each_group(m, [&](const Trees& t) { std::copy(tau + t.v, tau + t.v_end, d.step_tau + t.v); });
    each([&](const ActuatorRecord& r, Index k) {
      if (r.v < 0) return add_explicit(m, d, actuator_row(m, r), r.path, d.step_tau);
      const T gear = T(r.spec.gear);
      T f = d.actuator_force[k];
      if (!d.saturated[k]) d.armature[r.v] += gear * gear * (h * D(r) + h * h * K(r)), f -= h * K(r) * gear * d.v[r.v];
      d.step_tau[r.v] += gear * f;
    });
    for_each_tendon(m, d, [&](const dynTendon&, Index k, T, T) { add_explicit(m, d, spring_row(k), k, d.step_tau); });
    return d.step_tau;
  }
  // After forward dynamics: returns whether any actuator reached the end of its range.
  bool saturate(const T* ddq) {
    bool any = false;
    each([&](const ActuatorRecord& r, Index k) {
      if (d.saturated[k] || r.v < 0) return;
      const T f = force_at_end(r, d.actuator_force[k], d.v[r.v], ddq[r.v], h);
      if (const T held = clamp_to(f, r.spec.force_range); held != f) d.actuator_force[k] = held, d.saturated[k] = 1, any = true;
    });
    return any;
  }

 private:
  void begin(const ActuatorRecord& r, Index k) {
    const T w = r.act < 0 ? command(r, d) : acts_late(r, d) ? d.act[r.act] : activation_after(r, d, d.act[r.act], h);
    d.saturated[k] = 0;
    d.actuator_force[k] = unbounded_force(r, d, w, r.q >= 0 ? d.q[r.q] : T(0), d.v[r.v]);
  }
  void begin_with_paths() {
    place_paths(m, d);
    if constexpr (std::is_same_v<T, double>) measure_adhesions(m, d);
    each([&](const ActuatorRecord& r, Index k) {
      if (r.v >= 0) return begin(r, k);
      d.saturated[k] = 0;
      set_path_force(m, d, actuator_row(m, r), r.path, h, path_force_in_step(r, d, h));
    });
    for_each_tendon(m, d, [&](const dynTendon& t, Index k, T length, T rate) {
      PathForce<T> x = path_force_of(t, length, rate);
      if constexpr (std::is_same_v<T, double>)
        if (t.armature > 0) [[unlikely]] x.force -= t.armature * bias_in_step(m, d, k);
      set_path_force(m, d, spring_row(k), k, h, x);
    });
    if (m.n.force_limits > 0) limit_path_forces(m, d);
  }
  template <class F>
  void each(F&& f) {
    for_each_actuator(m, d, [&](const ActuatorRecord& r, Index k) {
      if (!sleeps(m, d, r)) f(r, k);
    });
  }
  static T K(const ActuatorRecord& r) { return T(stiffness_of(r)); }
  static T D(const ActuatorRecord& r) { return T(damping_of(r)); }
  const Model& m;
  Data<T>& d;
  T h;
};

}  // namespace dyn::simulation
