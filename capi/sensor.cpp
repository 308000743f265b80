// Sensors of a model.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "collision/pairs.hpp"
#include "simulation/sensors.hpp"
#include "guard.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

dynSensor default_sensor(dynQuantity quantity) {
  dynSensor s{};
  s.struct_size = sizeof s, s.quantity = quantity, s.object = s.reference = -1;
  for (double* X : {s.placement, s.reference_placement}) X[0] = X[4] = X[8] = 1;
  s.count = 1, s.shape = DYN_SHAPE_TYPE_SPHERE, s.extent[0] = s.extent[1] = s.extent[2] = 0.005, s.field[1] = -0.5;
  return s;
}

// A well mixed function of its argument (Steele, Lea, Flood 2014, SplitMix64).
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u, x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}
double unit(std::uint64_t x) { return (double(x >> 11) + 0.5) * 0x1p-53; }

}  // namespace

template <>
dynSensor capi::defaults() {
  return default_sensor(DYN_QUANTITY_JOINTPOS);
}

extern "C" {

void(dyn_sensor_init)(dynSensor* sensor, uint32_t size, dynQuantity quantity) {
  initialize(sensor, size, default_sensor(quantity));
}

int dyn_model_nsensors(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.sensors) : -1; }
int dyn_model_nsensordata(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.sensor_values) : -1; }

const char* dyn_model_sensor_name(const dynModel* model, int sensor) {
  if (check(model) != DYN_OK || check_index("dyn_model_sensor_name", "sensor", sensor, model->m->n.sensors) != DYN_OK)
    return nullptr;
  return model->m->string(model->m->sensors()[sensor].name);
}

int dyn_model_sensor_id(const dynModel* model, const char* name) {
  if (check(model) != DYN_OK) return -1;
  const Model& m = *model->m;
  for (Index k = 0; name && k < m.n.sensors; ++k)
    if (std::strcmp(m.string(m.sensors()[k].name), name) == 0) return int(k);
  fail(DYN_ERROR_NAME, "there is no sensor '%.200s': the model has %d, see dyn_model_sensor_name", name ? name : "(NULL)",
       int(m.n.sensors));
  return -1;
}

dynStatus dyn_model_sensor_info(const dynModel* model, int sensor, dynSensor* out) {
  if (const dynStatus s = check(model)) return s;
  if (const dynStatus s = check_struct("dyn_model_sensor_info", "out", out)) return s;
  if (const dynStatus s = check_index("dyn_model_sensor_info", "sensor", sensor, model->m->n.sensors)) return s;
  write_struct(model->m->sensors()[sensor].spec, out);
  return DYN_OK;
}

dynStatus dyn_sensors(const dynModel* model, dynData* data, const double* q, const double* v, const double* a, double* values) {
  dynParts parts = DYN_PART_KINEMATICS;
  int order = 0;
  if (check(model) == DYN_OK)
    for (Index k = 0; k < model->m->n.sensors; ++k) {
      const SensorRow& row = sensor_row(model->m->sensors()[k].spec.quantity);
      parts |= row.part, order = row.order > order ? row.order : order;
    }
  Call call(model, data, parts, "dyn_sensors");
  if (!call || !call.inputs(q, v, a, nullptr)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  if (order == 2) ensure_acceleration(m, d);
  else if (order == 1) ensure_velocity(m, d);
  else ensure_position(m, d);
  if (m.n.paths > 0) measure_paths(m, d);
  if (d.force_sums) take_limits(m, d);
  if (parts & DYN_PART_COLLISION) collision::place_geoms(m, d);
  if (parts & DYN_PART_ENERGY) kinetic_energy(m, d), potential_energy(m, d);
  for (Index k = 0; k < m.n.sensors; ++k) {
    const dynSensor& s = m.sensors()[k].spec;
    sensors::read(m, d, s, d.sensor_data + s.idx);
  }
  if (!call.numeric(d.sensor_data, m.n.sensor_values, "sensors", Stage::Sensors)) return call.status;
  d.mark_fresh(Stage::Sensors);
  copy_out(d.sensor_data, m.n.sensor_values, values);
  return DYN_OK;
}

dynStatus dyn_sensor_noise(const dynModel* model, uint64_t seed, uint64_t count, double* values) {
  const DefaultFloatingPoint settings;
  if (const dynStatus s = check(model)) return s;
  const Model& m = *model->m;
  if (!values && m.n.sensor_values > 0) return fail(DYN_ERROR_ARGUMENT, "dyn_sensor_noise: values is NULL: it is required");
  for (Index k = 0; k < m.n.sensors; ++k) {
    const dynSensor& s = m.sensors()[k].spec;
    for (int i = s.idx; s.noise > 0 && i < s.idx + s.size; ++i) {
      const std::uint64_t x = mixed(mixed(mixed(seed) + count) + std::uint64_t(i));
      // Box and Muller 1958
      values[i] += s.noise * std::sqrt(-2 * std::log(unit(x))) * std::cos(6.283185307179586 * unit(mixed(x)));
    }
  }
  return DYN_OK;
}

dynStatus dyn_sensor_delay(const dynModel* model, const double* times, const double* readings, int64_t count, double time,
                           double* values) {
  constexpr const char* function = "dyn_sensor_delay";
  if (const dynStatus s = check(model)) return s;
  const Model& m = *model->m;
  if (count < 1)
    return fail(DYN_ERROR_ARGUMENT, "%s: count is %lld: give 1 reading or more", function, static_cast<long long>(count));
  if (!times || ((!readings || !values) && m.n.sensor_values > 0))
    return fail(DYN_ERROR_ARGUMENT, "%s: times, readings or values is NULL: they are required", function);
  for (std::int64_t k = 0; k < count; ++k)
    if (!std::isfinite(times[k]) || (k > 0 && times[k] < times[k - 1]))
      return fail(DYN_ERROR_ARGUMENT, "%s: times[%lld] is %g: give finite times that ascend", function, static_cast<long long>(k),
                  times[k]);
  for (Index k = 0; k < m.n.sensors; ++k) {
    const dynSensor& s = m.sensors()[k].spec;
    const double *const end = times + count, at = time - s.delay;
    const double* const after = std::upper_bound(times, end, at + 1e-9 * (1 + std::abs(at)));
    const std::ptrdiff_t row = after == times ? 0 : after - times - 1;
    std::copy_n(readings + row * m.n.sensor_values + s.idx, s.size, values + s.idx);
  }
  return DYN_OK;
}

}  // extern "C"
