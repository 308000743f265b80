// Sensors of a model: one row for each value of dynQuantity, in its order.
#pragma once

#include "dyn.h"
#include "table/enums.hpp"

namespace dyn {

enum class SensorObject { None, Joint, Tendon, Actuator, Frame };

struct SensorRow {
  SensorObject object;
  int size;
  int order;      // 0 reads q, 1 reads v too, 2 acceleration or forces too
  bool refers;    // it may have a reference frame
  dynParts part;  // of data beside KINEMATICS
};

inline constexpr SensorRow sensor_rows[] = {
    {SensorObject::Joint, 1, 0, false, 0},
    {SensorObject::Joint, 1, 1, false, 0},
    {SensorObject::Joint, 1, 2, false, DYN_PART_SIMULATION},
    {SensorObject::Joint, 1, 0, false, 0},
    {SensorObject::Joint, 1, 1, false, 0},
    {SensorObject::Joint, 4, 0, false, 0},
    {SensorObject::Joint, 3, 1, false, 0},
    {SensorObject::Tendon, 1, 0, false, 0},
    {SensorObject::Tendon, 1, 1, false, 0},
    {SensorObject::Tendon, 1, 2, false, DYN_PART_SIMULATION},
    {SensorObject::Tendon, 1, 0, false, 0},
    {SensorObject::Tendon, 1, 1, false, 0},
    {SensorObject::Actuator, 1, 0, false, 0},
    {SensorObject::Actuator, 1, 1, false, 0},
    {SensorObject::Actuator, 1, 2, false, DYN_PART_SIMULATION},
    {SensorObject::Frame, 3, 0, true, 0},
    {SensorObject::Frame, 4, 0, true, 0},
    {SensorObject::Frame, 3, 0, true, 0},
    {SensorObject::Frame, 3, 0, true, 0},
    {SensorObject::Frame, 3, 0, true, 0},
    {SensorObject::Frame, 3, 1, true, 0},
    {SensorObject::Frame, 3, 1, true, 0},
    {SensorObject::Frame, 3, 2, false, 0},
    {SensorObject::Frame, 3, 2, false, 0},
    {SensorObject::Frame, 3, 2, false, 0},
    {SensorObject::Frame, 3, 1, false, 0},
    {SensorObject::Frame, 3, 1, false, 0},
    {SensorObject::Frame, 3, 0, false, 0},
    {SensorObject::Frame, 3, 2, false, DYN_PART_SIMULATION},
    {SensorObject::Frame, 3, 2, false, DYN_PART_SIMULATION},
    {SensorObject::Frame, 1, 2, false, DYN_PART_SIMULATION},
    {SensorObject::Frame, 3, 0, false, 0},
    {SensorObject::Frame, 3, 1, false, 0},
    {SensorObject::Frame, 3, 1, false, 0},
    {SensorObject::Frame, 1, 0, true, 0},
    {SensorObject::None, 1, 0, false, 0},
    {SensorObject::None, 1, 0, false, DYN_PART_ENERGY},
    {SensorObject::None, 1, 1, false, DYN_PART_ENERGY},
};
static_assert(sizeof sensor_rows / sizeof sensor_rows[0] == Members<dynQuantity>::count);

inline const SensorRow& sensor_row(dynQuantity quantity) { return sensor_rows[raw(quantity)]; }

}  // namespace dyn
