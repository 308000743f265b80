// What follows from an actuator's type alone: its controls and its numbers of state.
#pragma once

#include <bit>

#include "dyn.h"

namespace dyn {

inline constexpr int max_activations = 5;  // of an actuator

// Those of PID and DC_MOTOR: algorithm/driver.hpp.
inline int activations_of(const dynActuator& a) {
  const dynDcMotor& x = a.motor;
  switch (a.type) {
    case DYN_ACTUATOR_TYPE_PID: return (a.slew > 0) + (a.ki > 0);
    case DYN_ACTUATOR_TYPE_DC_MOTOR:
      return (a.slew > 0) + (a.ki > 0) + (x.thermal_resistance > 0) + (x.bristle_stiffness > 0) + (x.time_constant > 0);
    default: return a.time_constant > 0 || a.integrates || a.type == DYN_ACTUATOR_TYPE_MUSCLE;
  }
}
inline bool has_driver(const dynActuator& a) {
  return a.type == DYN_ACTUATOR_TYPE_PID || a.type == DYN_ACTUATOR_TYPE_DC_MOTOR;
}
inline int controls_of(const dynActuator& a) {
  return has_driver(a) ? std::popcount(a.inputs) : a.type == DYN_ACTUATOR_TYPE_PD ? 3 : 1;
}
// Those whose law is more than gain and bias act through a path, on joints too.
inline bool has_general_law(const dynActuator& a) {
  return a.type == DYN_ACTUATOR_TYPE_MUSCLE || has_driver(a) || a.gain_slope[0] != 0 || a.gain_slope[1] != 0;
}

}  // namespace dyn
