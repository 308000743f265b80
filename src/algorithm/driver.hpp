// Force and states of actuators of type PID and DC_MOTOR (dyn.h has the formulas). States are in the order s, z of the
// controller, temperature, z of the friction, current, as far as there are any.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/portable.hpp"
#include "model/data.hpp"

namespace dyn {

// Force of an actuator on a path and what it loses by length and by rate, both >= 0; beside: what no range limits.
template <class T>
struct PathLaw {
  T force, stiffness, damping, beside;
};

template <class T>
T clamp_to(T x, const double (&range)[2]) {
  return std::min(std::max(x, T(range[0])), T(range[1]));
}

namespace driver {

struct Slots {
  int slew = -1, integral = -1, temperature = -1, bristle = -1, current = -1;
  explicit Slots(const dynActuator& a) {
    int count = 0;
    const bool motor = a.type == DYN_ACTUATOR_TYPE_DC_MOTOR;
    if (a.slew > 0) slew = count++;
    if (a.ki > 0) integral = count++;
    if (motor && a.motor.thermal_resistance > 0) temperature = count++;
    if (motor && a.motor.bristle_stiffness > 0) bristle = count++;
    if (motor && a.motor.time_constant > 0) current = count++;
  }
};

template <class T>
struct Inputs {
  T position, velocity, force, voltage;
};
template <class T>
Inputs<T> inputs_of(const ActuatorRecord& r, const Data<T>& d) {
  const dynActuator& a = r.spec;
  const T* u = d.ctrl + a.idx_u;
  Inputs<T> out{T(0), T(0), T(0), T(0)};
  if (a.inputs & DYN_INPUT_POSITION) out.position = clamp_to(*u++, a.control_range);
  if (a.inputs & DYN_INPUT_VELOCITY) out.velocity = clamp_to(*u++, a.velocity_range);
  if (a.inputs & DYN_INPUT_FORCE) out.force = clamp_to(*u++, a.feedforward_range);
  if (a.inputs & DYN_INPUT_VOLTAGE) out.voltage = a.inputs == DYN_INPUT_VOLTAGE ? clamp_to(*u, a.control_range) : *u;
  return out;
}

// The representative of x nearest to y among those a period apart.
template <class T>
T nearest(T x, T y, double period) {
  using std::remainder;
  return period > 0 ? y + remainder(x - y, T(period)) : x;
}

template <class T>
struct Driver {
  const ActuatorRecord& r;
  const dynActuator& a;
  const dynDcMotor& x;
  const T *w, l, v;  // states, length and rate with the gear
  Slots slot;
  Inputs<T> u;
  T target;  // s

  Driver(const ActuatorRecord& record, const Data<T>& d, const T* states, T length, T rate)
      : r(record), a(r.spec), x(a.motor), w(states), l(length), v(rate), slot(a), u(inputs_of(r, d)),
        target(slot.slew >= 0 ? w[slot.slew] : u.position) {}

  bool is_motor() const { return a.type == DYN_ACTUATOR_TYPE_DC_MOTOR; }
  bool has_controller() const { return (a.inputs & ~std::uint32_t(DYN_INPUT_VOLTAGE)) != 0; }
  T integral() const { return slot.integral >= 0 ? w[slot.integral] : T(0); }
  T resistance() const {
    const T above = slot.temperature >= 0 ? w[slot.temperature] : T(0);
    if (slot.temperature < 0) return T(x.resistance);
    return T(x.resistance) * (T(1) + T(x.temperature_coefficient) * (above + T(x.ambient - x.reference)));
  }
  struct Voltage {
    T value;
    bool controlled;  // it follows length and rate
  };
  Voltage voltage() const {
    if (!has_controller()) return {u.voltage, false};
    const T torque = T(x.kp) * (target - l) + T(x.kd) * (u.velocity - v) + T(a.ki) * integral() + u.force;
    const T wanted = T(x.resistance / x.constant) * torque + T(x.constant) * v, most = T(x.voltage_limit);
    const bool within = x.voltage_limit == 0 || (wanted >= -most && wanted <= most);
    return {(within ? wanted : std::clamp(wanted, -most, most)) + u.voltage, within};
  }
  T stribeck() const {
    using math::exp;
    const T ratio = v / T(std::max(x.stribeck, 1e-15));
    return T(x.coulomb) + T(x.breakaway - x.coulomb) * exp(-ratio * ratio);
  }
  T bristle_decay() const {
    using std::abs;
    return T(x.bristle_stiffness) * abs(v) / std::max(stribeck(), T(1e-15));
  }
  T bristle_rate() const { return v - bristle_decay() * w[slot.bristle]; }
  T current_rate(T V, T R) const {
    const T rate = ((V - T(x.constant) * v) / R - w[slot.current]) / T(x.time_constant);
    return x.rate > 0 ? std::clamp(rate, T(-x.rate), T(x.rate)) : rate;
  }
  T integral_rate() const {
    const T error = nearest(target - l, T(0), is_motor() ? 0 : r.period), z = integral(), most = T(a.integral_limit);
    if (a.integral_limit > 0 && z >= most) return std::min(error, T(0));
    if (a.integral_limit > 0 && z <= -most) return std::max(error, T(0));
    return error;
  }

  PathLaw<T> force() const {
    if (!is_motor()) {
      const T s = nearest(target, l, r.period);
      return {T(a.kp) * (s - l) + T(a.kv) * (u.velocity - v) + u.force + T(a.ki) * integral(), T(a.kp), T(a.kv), T(0)};
    }
    using math::sin;
    const T K = T(x.constant), R = resistance();
    PathLaw<T> out{T(0), T(0), T(0), T(0)};
    if (slot.current >= 0) {
      out.force = K * w[slot.current];
    } else {
      const Voltage V = voltage();
      const T scale = V.controlled ? T(x.resistance) / R : T(0);
      out.force = K / R * (V.value - K * v);
      out.stiffness = scale * T(x.kp), out.damping = V.controlled ? scale * T(x.kd) : K * K / R;
    }
    if (x.cogging[0] != 0) out.beside += T(x.cogging[0]) * sin(T(x.cogging[1]) * l + T(x.cogging[2]));
    if (slot.bristle >= 0) {
      out.beside -= T(x.bristle_stiffness) * w[slot.bristle] + T(x.bristle_damping) * bristle_rate();
      out.damping += T(x.bristle_damping);
    }
    return out;
  }

  // dw/dt. A target is reached within about a millisecond.
  void rates(T* out) const {
    constexpr double reached = 1e-3;
    const T R = resistance(), V = is_motor() ? voltage().value : T(0);
    if (slot.slew >= 0) out[slot.slew] = std::clamp((u.position - target) / T(reached), T(-a.slew), T(a.slew));
    if (slot.integral >= 0) out[slot.integral] = integral_rate();
    if (slot.temperature >= 0) {
      const T i = slot.current >= 0 ? w[slot.current] : (V - T(x.constant) * v) / R;
      out[slot.temperature] = (R * i * i - w[slot.temperature] / T(x.thermal_resistance)) / T(x.heat_capacity);
    }
    if (slot.bristle >= 0) out[slot.bristle] = bristle_rate();
    if (slot.current >= 0) out[slot.current] = current_rate(V, R);
  }

  // States after h at constant length, rate and controls. Exact for the friction; for the current unless its rate is limited.
  void after(T h, T* out) const {
    using math::exp;
    Driver moved = *this;
    if (slot.slew >= 0) {
      const T u_near = nearest(u.position, target, is_motor() ? 0 : r.period);
      moved.target = out[slot.slew] = std::clamp(u_near, target - h * T(a.slew), target + h * T(a.slew));
    }
    T rate[max_activations];
    moved.rates(rate);
    if (slot.integral >= 0) {
      out[slot.integral] = w[slot.integral] + h * rate[slot.integral];
      if (is_motor() && a.integral_limit > 0)
        out[slot.integral] = std::clamp(out[slot.integral], T(-a.integral_limit), T(a.integral_limit));
    }
    if (slot.temperature >= 0) out[slot.temperature] = w[slot.temperature] + h * rate[slot.temperature];
    if (slot.bristle >= 0) {
      const T decay = bristle_decay(), left = exp(-decay * h), taken = decay > T(1e-15) ? (T(1) - left) / decay : h;
      out[slot.bristle] = left * w[slot.bristle] + taken * v;
    }
    if (slot.current >= 0)
      out[slot.current] = w[slot.current] + rate[slot.current] * T(x.time_constant) * (T(1) - exp(-h / T(x.time_constant)));
  }
};

}  // namespace driver
}  // namespace dyn
