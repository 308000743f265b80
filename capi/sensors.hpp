// Sensors of rollouts: what they read of a data after a step.
#pragma once

#include "guard.hpp"

namespace dyn::capi {

struct Sensors {
  const dynSensorType* type;
  const std::int32_t* frame;
  int count;
};

int sensor_size(dynSensorType type);  // 0: there is none
std::ptrdiff_t size_of(Sensors sensors);
bool reads_acceleration(Sensors sensors);
dynStatus check_sensors(const Model& m, Sensors sensors, const char* function);
// acceleration: nv, or nullptr where no sensor reads it.
dynStatus read_sensors(const dynModel* m, dynData* d, Sensors sensors, const double* acceleration, double* out);

}  // namespace dyn::capi
