// Sensors.
#include <algorithm>
#include <cmath>

#include "builder_compile.hpp"
#include "table/sensors.hpp"

namespace dyn {

namespace {

bool is_zone(dynShapeType shape) {
  return shape == DYN_SHAPE_TYPE_BOX || shape == DYN_SHAPE_TYPE_SPHERE || shape == DYN_SHAPE_TYPE_CYLINDER ||
         shape == DYN_SHAPE_TYPE_CAPSULE || shape == DYN_SHAPE_TYPE_ELLIPSOID;
}

void check_numbers(const std::string& who, const dynSensor& s) {
  for (const double x : {s.cutoff, s.noise, s.delay})
    if (!(x >= 0) || std::isinf(x))
      refuse(DYN_ERROR_INVALID, who + ": cutoff, noise and delay are " + number(s.cutoff) + ", " + number(s.noise) + " and " +
                                    number(s.delay) + ": give finite numbers, at least 0");
  for (const double* x : {s.placement, s.reference_placement})
    for (int k = 0; k < 12; ++k)
      if (!std::isfinite(x[k])) refuse(DYN_ERROR_NONFINITE, who + ": a placement holds " + number(x[k]));
  for (const double y : s.field)
    if (!std::isfinite(y)) refuse(DYN_ERROR_NONFINITE, who + ": field holds " + number(y) + ": give a finite number");
  const bool contact = s.quantity == DYN_QUANTITY_CONTACT, ray = s.quantity == DYN_QUANTITY_RANGEFINDER;
  if (const std::uint32_t known = contact ? contact_values : ray ? ray_values : 0; s.values & ~known)
    refuse(DYN_ERROR_ARGUMENT, who + ": values is " + std::to_string(s.values) + ": its quantity has no such values");
  if (!is_value(s.reduction) || !is_value(s.side) || !is_value(s.other_side))
    refuse(DYN_ERROR_ARGUMENT, who + ": reduction or a side is not one of those that there are");
  if ((contact || s.quantity == DYN_QUANTITY_USER) && (s.count < 1 || s.count > max_sensor_count))
    refuse(DYN_ERROR_ARGUMENT, who + ": count is " + std::to_string(s.count) + ": give 1 to " + std::to_string(max_sensor_count));
  const bool zone = contact && s.side == DYN_SIDE_ZONE;
  if (s.quantity != DYN_QUANTITY_TOUCH && s.quantity != DYN_QUANTITY_INSIDESITE && !zone) return;
  if (!is_zone(s.shape)) refuse(DYN_ERROR_ARGUMENT, who + ": its zone is no box, sphere, cylinder, capsule or ellipsoid");
  for (const double x : s.extent)
    if (!(x >= 0) || std::isinf(x)) refuse(DYN_ERROR_INVALID, who + ": extent holds " + number(x) + ": give finite sizes");
}

void check_sides(const std::string& who, const dynSensor& s, const std::string& object, const std::string& reference) {
  if ((s.side == DYN_SIDE_ANY) != object.empty() || (s.other_side == DYN_SIDE_ANY) != reference.empty())
    refuse(DYN_ERROR_ARGUMENT, who + ": a side that is ANY has no name, and the others need one");
  const auto is_pair = [](dynSide side) { return side == DYN_SIDE_LINK || side == DYN_SIDE_SHAPE; };
  if (s.quantity != DYN_QUANTITY_CONTACT && (!is_pair(s.side) || !is_pair(s.other_side)))
    refuse(DYN_ERROR_INVALID, who + ": both sides must be LINK or SHAPE");
  if (s.other_side == DYN_SIDE_ZONE) refuse(DYN_ERROR_INVALID, who + ": the first side alone can be a zone");
}

}  // namespace

void Builder::Impl::check_sensor_name(const std::string& name) const {
  if (name.empty()) refuse(DYN_ERROR_ARGUMENT, "sensor has no name: give one");
  if (name.find('\0') != std::string::npos)
    refuse(DYN_ERROR_ARGUMENT, "sensor '" + std::string(name.c_str()) + "': the name holds a zero byte");
  if (names.sensors.find(sensors, name) >= 0)
    refuse(DYN_ERROR_NAME, "sensor '" + name + "' is there already: choose another name");
}

void Builder::sensor(const std::string& name, const dynSensor& spec, const std::string& object, const std::string& reference) {
  impl->check_sensor_name(name);
  const std::string who = "sensor '" + name + "'";
  if (!is_value(spec.quantity))
    refuse(DYN_ERROR_ARGUMENT, who + ": quantity " + std::to_string(int(spec.quantity)) + " is no dynQuantity");
  check_numbers(who, spec);
  const SensorRow& row = sensor_row(spec.quantity);
  SensorEntry entry{name, spec, -1, -1};
  const bool sides = row.object == SensorObject::Sides, nothing = row.object == SensorObject::None || (sides && object.empty());
  if (sides) check_sides(who, spec, object, reference);
  else entry.spec.side = entry.spec.other_side = DYN_SIDE_ANY;
  if (nothing != object.empty())
    refuse(DYN_ERROR_ARGUMENT, who + (object.empty() ? ": it is on nothing: name its object" : ": its quantity has no object"));
  if (!reference.empty() && !row.refers) refuse(DYN_ERROR_ARGUMENT, who + ": its quantity has no reference frame");
  if (reference.empty() && spec.quantity == DYN_QUANTITY_INSIDESITE)
    refuse(DYN_ERROR_ARGUMENT, who + ": its reference is missing: the frame of the zone");
  const auto frame = [&](const std::string& name, int type) {
    return type > 0 ? impl->find({name, dynFrameType(type)}, who) : impl->find_frame(name, who);
  };
  switch (row.object) {
    case SensorObject::None: break;
    case SensorObject::Joint: {
      entry.object = impl->find_joint(object);
      if (entry.object < 0) refuse(DYN_ERROR_NAME, who + ": there is no moving joint '" + object + "'");
      const JointEntry* const at = &impl->joints[std::size_t(entry.object)];
      const bool ball = spec.quantity == DYN_QUANTITY_BALLQUAT || spec.quantity == DYN_QUANTITY_BALLANGVEL;
      if (ball ? at->spec.type != DYN_JOINT_TYPE_SPHERICAL : spec_nq(at->spec) != 1)
        refuse(DYN_ERROR_INVALID,
               who + ": joint '" + object + (ball ? "' is not spherical" : "' has not one coordinate, as is needed"));
      break;
    }
    case SensorObject::Tendon: entry.object = impl->find_tendon(object, who); break;
    case SensorObject::Actuator: {
      entry.object = impl->names.actuators.find(impl->actuators, object);
      if (entry.object < 0) refuse(DYN_ERROR_NAME, who + ": there is no actuator '" + object + "': add it first");
      break;
    }
    case SensorObject::Sides: {
      const auto find = [&](dynSide side, const std::string& name) {
        if (side == DYN_SIDE_ANY) return -1;
        if (side == DYN_SIDE_ZONE) return impl->find_frame(name, who);
        if (side != DYN_SIDE_SHAPE && name == "universe") return 0;
        if (side != DYN_SIDE_SHAPE) return impl->find({name, DYN_FRAME_TYPE_BODY}, who);
        const int found = impl->find_shape(name, who);
        if (found < 0) refuse(DYN_ERROR_NAME, who + ": there is no collision shape '" + name + "': add it first");
        return found;
      };
      entry.object = find(spec.side, object), entry.reference = find(spec.other_side, reference);
      break;
    }
    case SensorObject::Frame: {
      const bool link = spec.quantity >= DYN_QUANTITY_SUBTREECOM && spec.quantity <= DYN_QUANTITY_SUBTREEANGMOM;
      entry.object = link ? impl->find({object, DYN_FRAME_TYPE_BODY}, who) : frame(object, spec.object);
      if (!reference.empty()) entry.reference = frame(reference, spec.reference);
      break;
    }
  }
  impl->sensors.push_back(std::move(entry));
}

void Compiler::add_sensors() {
  n.sensors = Index(in.sensors.size());
  for (const SensorEntry& e : in.sensors) {
    const SensorRow& row = sensor_row(e.spec.quantity);
    SensorRecord r{e.spec, text.add(e.name), 0};
    r.spec.struct_size = sizeof r.spec, r.spec.reference = e.reference;
    r.spec.object = row.object == SensorObject::Joint ? id[std::size_t(e.object)] : e.object;
    r.spec.idx = n.sensor_values, r.spec.size = size_of(r.spec), r.spec.order = row.order;
    r.spec.of_values = r.spec.quantity == DYN_QUANTITY_CONTACT ? values_size(r.spec) : 0;
    n.sensor_values += r.spec.size;
    a.sensors.push_back(r);
  }
}

}  // namespace dyn
