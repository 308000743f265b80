// Sensors of rollouts: one row for each value of dynSensorType, in its order.
#include "sensors.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "simulation/workspace.hpp"
#include "spatial/quaternion.hpp"
#include "reflection.hpp"

namespace dyn::capi {

namespace {

using Vector = Vec3<double>;

// Columns of the rotation of a placement.
Mat3<double> rotation_of(const double* X) { return {load3(X), load3(X + 3), load3(X + 6)}; }

dynStatus placement(const dynModel* m, dynData* d, int frame, double* out) {
  double X[12];
  const dynStatus s = dyn_frame_placement(m, d, frame, X);
  if (s != DYN_OK) return s;
  std::copy_n(X + 9, 3, out);
  store(quaternion(rotation_of(X)), out + 3);
  return DYN_OK;
}

dynStatus velocity(const dynModel* m, dynData* d, int frame, double* out) {
  return dyn_frame_velocity(m, d, frame, DYN_REFERENCE_LOCAL, out);
}

dynStatus imu(const dynModel* m, dynData* d, int frame, double* out) {
  double X[12], a[6], v[6];
  dynStatus s = dyn_frame_placement(m, d, frame, X);
  if (s == DYN_OK) s = dyn_frame_classical_acceleration(m, d, frame, DYN_REFERENCE_LOCAL, a);
  if (s == DYN_OK) s = dyn_frame_velocity(m, d, frame, DYN_REFERENCE_LOCAL, v);
  if (s != DYN_OK) return s;
  store3(load3(a) - transpose_times(rotation_of(X), load3(d->body->d.world_gravity)), out);
  std::copy_n(v + 3, 3, out + 3);
  return DYN_OK;
}

dynStatus force(const dynModel* m, dynData* d, int frame, double* out) {
  double X[12];
  const dynStatus s = dyn_frame_placement(m, d, frame, X);
  if (s != DYN_OK) return s;
  Vector sum = Vector::zero(), moment = Vector::zero();
  const auto on = [&](std::int32_t shape) { return shape >= 0 && m->m->shapes()[shape].frame == frame; };
  simulation::for_each_contact(*d->body->d.step, [&](const dynContactForce& f) {
    const int sign = int(on(f.contact.shape_b)) - int(on(f.contact.shape_a));
    if (sign == 0) return;
    const Vector on_b = load3(f.force_on_b);
    sum = sum + on_b * sign;
    moment = moment + (load3(f.moment_on_b) + cross(load3(f.contact.position) - load3(X + 9), on_b)) * sign;
  });
  store3(sum, out), store3(moment, out + 3);
  return DYN_OK;
}

dynStatus com(const dynModel* m, dynData* d, int, double* out) {
  return dyn_com(m, d, d->body->d.q, d->body->d.v, nullptr, out, out + 3, nullptr);
}

dynStatus energy(const dynModel* m, dynData* d, int, double* out) { return dyn_energy(m, d, nullptr, nullptr, out, out + 1); }

struct Row {
  int size;
  bool of_frame;  // reads forward kinematics
  dynStatus (*read)(const dynModel*, dynData*, int, double*);
};

constexpr Row rows[] = {{7, true, placement}, {6, true, velocity}, {6, true, imu},
                        {6, true, force},     {6, false, com},     {2, false, energy}};
static_assert(sizeof rows / sizeof rows[0] == Members<dynSensorType>::count);

template <class F>
bool any(Sensors sensors, F&& f) {
  return std::any_of(sensors.type, sensors.type + sensors.count, f);
}

}  // namespace

int sensor_size(dynSensorType type) { return is_value(type) ? rows[raw(type)].size : 0; }

std::ptrdiff_t size_of(Sensors sensors) {
  std::ptrdiff_t size = 0;
  for (int k = 0; k < sensors.count; ++k) size += sensor_size(sensors.type[k]);
  return size;
}

bool reads_acceleration(Sensors sensors) {
  return any(sensors, [](dynSensorType t) { return t == DYN_SENSOR_TYPE_IMU; });
}

dynStatus check_sensors(const Model& m, Sensors sensors, const char* function) {
  if (sensors.count < 0) return fail(DYN_ERROR_ARGUMENT, "%s: sensors is %d: give 0 or more", function, sensors.count);
  if (sensors.count == 0) return DYN_OK;
  if (!sensors.type) return fail(DYN_ERROR_ARGUMENT, "%s: sensor is NULL, but sensors is %d", function, sensors.count);
  for (int k = 0; k < sensors.count; ++k) {
    const dynSensorType type = sensors.type[k];
    char name[40];
    write_text(name, sizeof name, "sensor[%d]", k);
    if (const dynStatus s = check_value(type, function, name)) return s;
    if (!rows[raw(type)].of_frame) continue;
    if (!sensors.frame) return fail(DYN_ERROR_ARGUMENT, "%s: sensor_frame is NULL, but sensor[%d] has a frame", function, k);
    const int frame = sensors.frame[k];
    if (frame < 0 || frame >= m.n.frames)
      return fail(DYN_ERROR_ARGUMENT, "%s: sensor_frame[%d] is %d: frames go from 0 to %d", function, k, frame, m.n.frames - 1);
    if (type == DYN_SENSOR_TYPE_FORCE && m.frames()[frame].type != DYN_FRAME_TYPE_BODY && frame != 0)
      return fail(DYN_ERROR_ARGUMENT, "%s: sensor_frame[%d] is '%s', which is no link: a force is that on the shapes of a link",
                  function, k, m.string(m.frames()[frame].name));
  }
  return DYN_OK;
}

dynStatus read_sensors(const dynModel* m, dynData* d, Sensors sensors, const double* acceleration, double* out) {
  if (any(sensors, [](dynSensorType t) { return rows[raw(t)].of_frame; }))
    if (const dynStatus s = dyn_forward_kinematics(m, d, d->body->d.q, d->body->d.v, acceleration)) return s;
  for (int k = 0; k < sensors.count; ++k) {
    const Row& row = rows[raw(sensors.type[k])];
    if (const dynStatus s = row.read(m, d, row.of_frame ? sensors.frame[k] : 0, out)) return s;
    out += row.size;
  }
  return DYN_OK;
}

}  // namespace dyn::capi
