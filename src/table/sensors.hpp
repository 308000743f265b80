// Sensors of a model: one row for each value of dynQuantity, in its order.
#pragma once

#include <cstdint>
#include <iterator>

#include "dyn.h"
#include "table/enums.hpp"

namespace dyn {

// Sides: of dynSensor.side and other_side.
enum class SensorObject { None, Joint, Tendon, Actuator, Frame, Sides };

struct SensorRow {
  SensorObject object;
  int size;       // unless values or count say otherwise (size_of)
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
    {SensorObject::Joint, 1, 2, false, DYN_PART_SIMULATION},
    {SensorObject::Tendon, 1, 2, false, DYN_PART_SIMULATION},
    {SensorObject::Frame, 1, 0, false, DYN_PART_COLLISION},
    {SensorObject::Sides, 1, 0, true, DYN_PART_COLLISION},
    {SensorObject::Sides, 3, 0, true, DYN_PART_COLLISION},
    {SensorObject::Sides, 6, 0, true, DYN_PART_COLLISION},
    {SensorObject::Sides, 1, 2, true, DYN_PART_SIMULATION},
    {SensorObject::None, 1, 0, false, 0},
};
static_assert(sizeof sensor_rows / sizeof sensor_rows[0] == Members<dynQuantity>::count);

inline const SensorRow& sensor_row(dynQuantity quantity) { return sensor_rows[raw(quantity)]; }

// Values by the bits of DYN_VALUE_..., and those that each quantity has.
inline constexpr int value_sizes[] = {1, 3, 3, 1, 3, 3, 3, 3, 3, 1};
inline constexpr std::uint32_t contact_values = 0x7f,
                               ray_values = DYN_VALUE_DISTANCE | DYN_VALUE_DIRECTION | DYN_VALUE_ORIGIN | DYN_VALUE_POSITION |
                                            DYN_VALUE_NORMAL | DYN_VALUE_DEPTH;
inline std::uint32_t values_of(const dynSensor& s) {
  if (s.values) return s.values;
  return s.quantity == DYN_QUANTITY_CONTACT ? DYN_VALUE_FOUND : s.quantity == DYN_QUANTITY_RANGEFINDER ? DYN_VALUE_DISTANCE : 0;
}
// Of one contact or ray.
inline int values_size(const dynSensor& s) {
  int size = 0;
  for (std::uint32_t k = 0; k < std::size(value_sizes); ++k)
    if (values_of(s) >> k & 1) size += value_sizes[k];
  return size;
}
inline int size_of(const dynSensor& s) {
  switch (s.quantity) {
    case DYN_QUANTITY_RANGEFINDER: return values_size(s);
    case DYN_QUANTITY_CONTACT: return values_size(s) * (s.reduction == DYN_REDUCTION_NETFORCE ? 1 : s.count);
    case DYN_QUANTITY_USER: return s.count;
    default: return sensor_row(s.quantity).size;
  }
}
inline constexpr int max_sensor_count = 100000;

}  // namespace dyn
