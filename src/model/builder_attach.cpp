// One robot on another: a model's world becomes what a new joint carries.
#include <algorithm>

#include "builder_impl.hpp"
#include "constraint/list.hpp"
#include "table/sensors.hpp"

namespace dyn {

namespace {

const char* kind_of(dynFrameType type) {
  switch (type) {
    case DYN_FRAME_TYPE_OP_FRAME: return "frame";
    case DYN_FRAME_TYPE_JOINT: return "joint";
    case DYN_FRAME_TYPE_FIXED_JOINT: return "fixed joint";
    case DYN_FRAME_TYPE_BODY: return "link";
    case DYN_FRAME_TYPE_SENSOR: return "sensor";
  }
  return "frame";
}

}  // namespace

void Builder::attach(const Model& model, const std::string& prefix, const JointSpec* joint) {
  if (prefix.find('\0') != std::string::npos) throw Error(DYN_ERROR_ARGUMENT, "attach: the prefix holds a zero byte");
  Builder added(model);
  Impl &other = *added.impl, next = *impl;
  const std::string who = "attach '" + other.name + "'";
  next.split_configurations();
  if (joint) next.add_joint(*joint);
  const FrameEntry carrier = joint ? next.frames.back() : next.frames.front();

  const int carrier_frame = joint ? int(next.frames.size()) - 1 : 0;
  // shapes of its world hang on a link, of the joint's name
  const bool shapes_of_world =
      std::any_of(other.shapes.begin(), other.shapes.end(), [](const ShapeEntry& s) { return s.frame == 0; });
  if (joint && shapes_of_world)
    next.add_frame(
        {joint->name, DYN_FRAME_TYPE_BODY, carrier.joint, carrier.X, Inertia<double>::zero(), 0, {}, {}, 0, carrier_frame}, who);
  const int world = joint && shapes_of_world ? carrier_frame + 1 : carrier_frame;
  const int before = int(next.joints.size()), frames_before = int(next.frames.size());
  const auto place = [&](int frame) {
    return frame == 0 ? world : frame + frames_before - 1;
  };  // the world's own frame does not come along
  for (JointEntry& e : other.joints) {
    e.spec.name = prefix + e.spec.name;
    if (!e.spec.mimic.empty()) e.spec.mimic = prefix + e.spec.mimic;
    if (e.parent < 0) e.parent = carrier.joint, e.placement = carrier.X * e.placement;
    else e.parent += before;
    next.joints.push_back(std::move(e));
  }
  for (std::size_t f = 1; f < other.frames.size(); ++f) {
    FrameEntry& e = other.frames[f];
    e.name = prefix + e.name;
    if (e.joint < 0) {
      e.joint = carrier.joint, e.X = carrier.X * e.X;
      e.Y = act(e.X, Inertia<double>::at_com(e.mass, load3(e.com.data()), load33(e.inertia.data())));
    } else {
      e.joint += before;
    }
    e.parent = place(e.parent);
    for (int k : next.frame_index[e.name]) {
      const FrameEntry& there = next.frames[std::size_t(k)];
      if (there.type == e.type || (there.type != DYN_FRAME_TYPE_BODY && e.type != DYN_FRAME_TYPE_BODY))
        throw Error(DYN_ERROR_NAME, who + ": its " + kind_of(e.type) + " and the " + kind_of(there.type) + " of '" + next.name +
                                        "' would both be named '" + e.name + "': give " + (prefix.empty() ? "a" : "another") +
                                        " prefix");
    }
    next.frame_index[e.name].push_back(int(next.frames.size()));
    next.frames.push_back(std::move(e));
  }
  const int shapes_before = int(next.shapes.size());  // added at the end, so that indices by name hold
  for (ShapeEntry& s : other.shapes) {
    if (!s.shape.name.empty()) s.shape.name = prefix + s.shape.name;
    s.frame = place(s.frame), s.shape.body = next.frames[std::size_t(s.frame)].name;
    next.shapes.push_back(std::move(s));
  }
  for (DisabledEntry& p : other.disabled) next.disabled.push_back({place(p.frame1), place(p.frame2), std::move(p.reason)});
  for (ConstraintEntry& c : other.constraints) {
    const int shift = between_joints(c.spec.type) ? before : frames_before - 1;
    c.first += shift;
    if (between_joints(c.spec.type) ? c.second >= 0 : c.second > 0) c.second += shift;
    else if (!between_joints(c.spec.type) && joint) {
      c.second = carrier_frame;  // what was tied to the world is tied to what carries it
    } else if (!between_joints(c.spec.type)) {
      c.second = 0;
    }
    c.name = prefix + c.name;
    next.check_constraint_name(c.name);
    next.constraints.push_back(std::move(c));
  }
  const int tendons_before = int(next.tendons.size());
  for (TendonEntry& t : other.tendons) {
    t.name = prefix + t.name;
    next.check_tendon_name(t.name);
    for (TendonElementEntry& e : t.elements) {
      if (e.type == DYN_TENDON_ELEMENT_TYPE_JOINT) e.id += before;
      else if (e.type != DYN_TENDON_ELEMENT_TYPE_PULLEY) e.id = place(e.id);
      if (e.side >= 0) e.side = place(e.side);
    }
    next.tendons.push_back(std::move(t));
  }
  for (TendonCoupling& c : other.couplings) {
    c.name = prefix + c.name;
    next.check_coupling_name(c.name);
    c.tendon1 += tendons_before, c.tendon2 += c.tendon2 >= 0 ? tendons_before : 0;
    next.couplings.push_back(std::move(c));
  }
  const int actuators_before = int(next.actuators.size());
  for (ActuatorEntry& a : other.actuators) {
    const dynTransmission by = a.spec.transmission;
    const bool joint = by == DYN_TRANSMISSION_JOINT || by == DYN_TRANSMISSION_AXES;
    a.target = joint ? a.target + before : by == DYN_TRANSMISSION_TENDON ? a.target + tendons_before : place(a.target);
    if (a.reference >= 0) a.reference = place(a.reference);
    a.name = prefix + a.name;
    next.check_actuator_name(a.name);
    next.actuators.push_back(std::move(a));
  }
  for (ForceLimitEntry& x : other.force_limits) {
    x.target += x.tendon ? tendons_before : before;
    next.force_limits.push_back(x);
  }
  for (SensorEntry& s : other.sensors) {
    const auto shift = [&](dynSide side, int& x) {
      if (x >= 0) x = side == DYN_SIDE_SHAPE ? x + shapes_before : place(x);
    };
    switch (sensor_row(s.spec.quantity).object) {
      case SensorObject::None: break;
      case SensorObject::Joint: s.object += before; break;
      case SensorObject::Tendon: s.object += tendons_before; break;
      case SensorObject::Actuator: s.object += actuators_before; break;
      case SensorObject::Frame:
      case SensorObject::Sides: shift(s.spec.side, s.object); break;
    }
    shift(s.spec.other_side, s.reference);
    s.name = prefix + s.name;
    next.check_sensor_name(s.name);
    next.sensors.push_back(std::move(s));
  }
  for (const PairEntry& p : other.pairs) 
    next.pairs.push_back({p.shape1 + shapes_before, p.shape2 + shapes_before, p.material, p.compliance});
  if (other.compliant && !next.compliant)
    next.compliant = true, next.impratio = other.impratio, next.pyramidal = other.pyramidal;
  next.allow_massless |= other.allow_massless;
  next.constraint_slots = std::max(next.constraint_slots, other.constraint_slots);
  if (next.contact_capacity > 0) next.contact_capacity = std::min(next.contact_capacity + other.contact_capacity, max_contacts);
  next.reports.insert(next.reports.end(), other.reports.begin(), other.reports.end());

  // configurations of one name are one; what only one of the two names is neutral in the other
  for (ConfigurationEntry& c : other.configurations) {
    const int known = next.names.configurations.find(next.configurations, c.name);
    if (known < 0) next.configurations.push_back({c.name, true, {}, {}});
    ConfigurationEntry* const at = known < 0 ? &next.configurations.back() : &next.configurations[std::size_t(known)];
    at->by_joint.resize(std::size_t(before));
    at->by_joint.insert(at->by_joint.end(), c.by_joint.begin(), c.by_joint.end());
    at->v_by_joint.resize(std::size_t(before));
    at->v_by_joint.insert(at->v_by_joint.end(), c.v_by_joint.begin(), c.v_by_joint.end());
    for (const auto& [actuator, state] : c.actuators) at->actuators[prefix + actuator] = state;
    for (const auto& [body, X] : c.mocaps) at->mocaps[prefix + body] = X;
    at->time = std::max(at->time, c.time);
  }
  if (next.initial == "neutral") next.initial = other.initial;
  *impl = std::move(next);
}

}  // namespace dyn
