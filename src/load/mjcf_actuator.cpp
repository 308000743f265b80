// <actuator>: motors, servos and affine laws on joints. Other transmissions and laws are reported.
#include <algorithm>
#include <iterator>
#include <sstream>
#include <utility>

#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

// Returns the joint of that name, or null if none has been read.
MjcfJoint* find_joint(MjcfRobot& robot, const std::string& name) {
  for (MjcfBody& b : robot.bodies)
    for (MjcfJoint& j : b.joints)
      if (j.spec.name == name) return &j;
  return nullptr;
}

// Sets component and gear of the driven degree of freedom. Returns the reason if there is not exactly one.
const char* transmission(const MjcfJoint& j, const std::vector<double>& gear, dynActuator& a) {
  if (j.spec.type == DYN_JOINT_TYPE_REVOLUTE || j.spec.type == DYN_JOINT_TYPE_PRISMATIC)
    return a.gear = gear.empty() ? 1 : gear[0], nullptr;
  const size_t first = 0, count = j.spec.type == DYN_JOINT_TYPE_FREE_FLYER ? 6 : 3;
  int driven = 0;
  for (size_t k = first; k < std::min(count, gear.size()); ++k)
    if (gear[k] != 0) ++driven, a.component = int(k), a.gear = gear[k];
  if (driven != 1) return "it drives a direction across several degrees of freedom";
  return count == 6 && a.component < 3 ? "it pushes a free joint along an axis of the world" : nullptr;
}

void read_range(const Reader& reader, const Element& e, const char* attribute, const char* limited, bool autolimits,
                double (&out)[2]) {
  const auto pair = reader.numbers(e, attribute, 2);
  const auto on = read_switch(reader, e, limited, std::nullopt);
  if (!pair && on.value_or(false)) reader.fail(DYN_ERROR_INVALID, e, std::string(limited) + "=\"true\" needs " + attribute);
  if (!pair || !on.value_or(autolimits && ((*pair)[0] != 0 || (*pair)[1] != 0))) return;
  if (!((*pair)[0] <= (*pair)[1])) reader.bad_numbers(e, attribute, "the lower end is above the upper one");
  for (size_t k = 0; k < 2; ++k)  // the largest double stands for no bound
    if (std::abs((*pair)[k]) < std::numeric_limits<double>::max()) out[k] = (*pair)[k];
}

// gainprm, biasprm, dynprm: missing numbers keep MuJoCo's defaults.
double parameter(const Reader& reader, const Element& e, const char* attribute, size_t k, double missing) {
  const auto given = reader.numbers(e, attribute);
  return given && k < given->size() ? (*given)[k] : missing;
}

// Reads the law of a <general> actuator. Returns the reason if it is not supported.
const char* law(const Reader& reader, const Element& e, MjcfActuator& actuator) {
  dynActuator& a = actuator.spec;
  a.type = DYN_ACTUATOR_TYPE_AFFINE;
  const std::string_view kind = e.Name(), dynamics = e.Attribute("dyntype") ? e.Attribute("dyntype") : "none",
                         gain = e.Attribute("gaintype") ? e.Attribute("gaintype") : "fixed",
                         bias = e.Attribute("biastype") ? e.Attribute("biastype") : "none";
  if (dynamics == "filter" || dynamics == "filterexact") a.time_constant = parameter(reader, e, "dynprm", 0, 1);
  else if (dynamics == "integrator") a.integrates = 1;
  else if (dynamics != "none") return "its activation is neither a first-order filter nor an integrator";
  a.gain = parameter(reader, e, "gainprm", 0, 1);
  if (gain == "affine" && (parameter(reader, e, "gainprm", 1, 0) != 0 || parameter(reader, e, "gainprm", 2, 0) != 0))
    return "its gain depends on length or speed";
  if (gain != "fixed" && gain != "affine") return "its gain is not a constant";
  if (kind == "motor") a.type = DYN_ACTUATOR_TYPE_MOTOR, a.gain = 0;
  if (bias == "none") return nullptr;
  if (bias != "affine") return "its bias is not affine";
  for (size_t k = 0; k < 3; ++k) a.bias[k] = parameter(reader, e, "biasprm", k, 0);
  if (a.bias[2] > 0 && a.gain > 0 && a.gain == -a.bias[1])
    actuator.damping_ratio = std::exchange(a.bias[2], 0);  // MuJoCo's rule for servos
  const bool servo = kind == "position" || kind == "intvelocity";
  if (servo || kind == "velocity") {
    a.type = servo ? DYN_ACTUATOR_TYPE_POSITION : DYN_ACTUATOR_TYPE_VELOCITY;
    a.kp = servo ? a.gain : 0, a.kv = -a.bias[2], a.gain = a.bias[1] = a.bias[2] = 0;
  }
  return nullptr;
}

// Reflects the motor's armature and damping to the joint, times gear^2.
void add_motor_inertia(const Reader& reader, const Element& e, const MjcfActuator& actuator, MjcfJoint& joint) {
  for (const auto& [attribute, values] : {std::pair{"armature", &joint.spec.armature}, {"damping", &joint.spec.damping}}) {
    const auto given = reader.numbers(e, attribute);
    if (!given || given->empty()) continue;
    if (!((*given)[0] >= 0)) reader.bad_numbers(e, attribute, "it is negative");
    (*values)[size_t(actuator.spec.component)] += actuator.spec.gear * actuator.spec.gear * (*given)[0];
    if (std::any_of(given->begin() + 1, given->end(), [](double x) { return x != 0; }))
      actuator.place.physics(std::string(attribute) + " that depends on speed is not supported: its first number is used");
  }
}

// Some that are not supported have several controls.
size_t controls_of(const Element& e) {
  const std::string kind = e.Name(), input = attribute(e, "input");
  if (kind == "orientation") return input == "quat" ? 4 : 3;
  if (kind != "pid" && kind != "dcmotor") return 1;
  if (input.empty()) return kind == "pid" ? 2 : 1;
  std::istringstream words(input);
  return input == "none" ? 0 : size_t(std::distance(std::istream_iterator<std::string>(words), {}));
}

}  // namespace

void read_mjcf_actuator(MjcfFile& file, Element& e, const MjcfContext& context) {
  const std::string_view kind = e.Name();
  const std::string given = e.Attribute("name") ? e.Attribute("name") : "";
  const std::string name =
      context.name(given.empty() ? std::string(kind) + "_" + std::to_string(file.robot.actuators.size()) : given);
  const Reader reader = file.source.reader(e, "actuator " + load::in_quotes(name));
  const MjcfPlace place{&reader.report, line(e), reader.owner};
  MjcfActuator actuator{place, name, default_actuator(DYN_ACTUATOR_TYPE_MOTOR), ""};
  // the order and number of controls is the file's
  const auto keep_place = [&](const std::string& why) {
    place.physics(why + ": it keeps its control and exerts no force");
    const dynActuator read = actuator.spec;
    actuator.spec = default_actuator(DYN_ACTUATOR_TYPE_AFFINE);  // its gain is 0
    actuator.spec.gear = 0, actuator.inert = true, actuator.damping_ratio = 0;
    std::copy_n(read.control_range, 2, actuator.spec.control_range);
    for (size_t k = 0, n = controls_of(e); k < n; ++k, actuator.activations = 0) {
      if (k > 0) actuator.name = name + "_" + std::to_string(k);
      file.robot.actuators.push_back(actuator);
    }
  };
  const std::string_view dynamics_before = e.Attribute("dyntype") ? e.Attribute("dyntype") : "none";
  actuator.activations = kind == "muscle" || dynamics_before != "none";
  if (!is_actuator(e)) {
    read_range(reader, e, "ctrlrange", "ctrllimited", file.compiler.autolimits, actuator.spec.control_range);
    return keep_place("<" + std::string(kind.substr(0, 60)) + "> is not supported");
  }
  reader.unread(e, {"name",         "class",         "group",     "nsample",    "interp",   "delay",       "ctrllimited",
                    "forcelimited", "actlimited",    "ctrlrange", "forcerange", "actrange", "lengthrange", "gear",
                    "joint",        "jointinparent", "tendon",    "site",       "refsite",  "body",        "slidersite",
                    "cranksite",    "cranklength",   "user",      "actdim",     "dyntype",  "gaintype",    "biastype",
                    "dynprm",       "gainprm",       "biasprm",   "actearly",   "kp",       "kv",          "dampratio",
                    "timeconst",    "inheritrange",  "armature",  "damping",    "area",     "diameter",    "bias",        converted_from},
                {"plugin"});
  file.defaults.apply(file.source, e, "actuator", context.childclass);
  as_general(reader, e);
  const std::string_view dynamics = e.Attribute("dyntype") ? e.Attribute("dyntype") : "none";
  actuator.activations = dynamics != "none";
  if (actuator.activations && !read_switch(reader, e, "actearly", false).value_or(false))
    reader.report.count("<actuator>: activations act at the end of the step, as with actearly", line(e));
  read_range(reader, e, "ctrlrange", "ctrllimited", file.compiler.autolimits, actuator.spec.control_range);
  if (reader.optional_number(e, "delay").value_or(0) > 0) place.physics("its delay is not used: controls act at once");
  const char* joint_name = e.Attribute("joint");
  if (!joint_name && e.Attribute("jointinparent")) joint_name = e.Attribute("jointinparent");
  if (!joint_name) return keep_place("it drives no joint, and other transmissions are not supported");
  actuator.joint = file.copies.name(context, "joint", joint_name);
  MjcfJoint* const joint = find_joint(file.robot, actuator.joint);
  if (!joint && file.robot.has_lost(actuator.joint)) return keep_place("its joint is missing from the model");
  if (!joint && file.part) return place.info("its joint was not attached: left out");
  if (!joint) reader.fail(DYN_ERROR_NAME, e, "there is no joint " + load::in_quotes(actuator.joint));
  if (const char* why = transmission(*joint, reader.numbers(e, "gear").value_or(std::vector<double>()), actuator.spec))
    return keep_place(why);
  if (const char* why = law(reader, e, actuator)) return keep_place(why);
  if (actuator.spec.bias[1] != 0 || actuator.spec.kp != 0)
    if (joint_nq(joint->spec.type) != 1)
      return keep_place("it depends on the length of a " +
                        std::string(joint->spec.type == DYN_JOINT_TYPE_SPHERICAL ? "ball" : "free") +
                        " joint, which is not supported");
  read_range(reader, e, "forcerange", "forcelimited", file.compiler.autolimits, actuator.spec.force_range);
  if (actuator.spec.time_constant > 0 || actuator.spec.integrates)
    read_range(reader, e, "actrange", "actlimited", file.compiler.autolimits, actuator.spec.act_range);
  if (const double inherit = reader.optional_number(e, "inheritrange").value_or(0); inherit > 0 && !joint->spec.lower.empty()) {
    const double middle = (joint->spec.lower[0] + joint->spec.upper[0]) / 2,
                 half = inherit * (joint->spec.upper[0] - joint->spec.lower[0]) / 2;
    double (&range)[2] = kind == "intvelocity" ? actuator.spec.act_range : actuator.spec.control_range;
    range[0] = middle - half, range[1] = middle + half;
  }
  add_motor_inertia(reader, e, actuator, *joint);
  file.robot.actuators.push_back(std::move(actuator));
}

void limit_mjcf_actuators(MjcfRobot& robot) {
  for (MjcfBody& body : robot.bodies)
    for (MjcfJoint& j : body.joints) {
      if (!j.force) continue;
      std::vector<dynActuator*> all;
      for (MjcfActuator& a : robot.actuators)
        if (a.joint == j.spec.name && a.spec.gear != 0) all.push_back(&a.spec);
      if (all.size() > 1)
        j.place.physics("actuatorfrcrange is not used: " + std::to_string(all.size()) +
                        " actuators drive it, and their sum has no limit");
      if (all.size() != 1) continue;
      const double gear = all[0]->gear, ends[2] = {(*j.force)[gear < 0] / gear, (*j.force)[gear > 0] / gear};
      for (double& x : all[0]->force_range) x = std::min(std::max(x, ends[0]), ends[1]);
    }
}

void add_mjcf_actuators(Builder& builder, const MjcfRobot& robot) {
  const MjcfJoint* first = nullptr;  // those that are inert hang on it, with gear 0
  for (const MjcfBody& b : robot.bodies)
    for (const MjcfJoint& j : b.joints) first = first ? first : &j;
  constexpr double none = std::numeric_limits<double>::infinity();
  for (const MjcfActuator& a : robot.actuators) {
    if (a.inert && !first) continue;
    dynActuator spec = a.spec;
    if (!robot.control_ranges) spec.control_range[0] = -none, spec.control_range[1] = none;
    with_location(a.place, [&] { builder.actuator(a.name, spec, a.inert ? first->spec.name : a.joint); });
  }
}

}  // namespace dyn::load
