// <actuator>: motors, servos, affine laws and muscles on joints, tendons and sites. Other transmissions and laws are reported.
#include <algorithm>
#include <iterator>
#include <sstream>
#include <utility>

#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

bool is_scalar(const MjcfJoint& j) { return joint_nq(j.spec.type) == 1; }

// Sets component and gear of the driven degree of freedom, or the axes of a ball or free joint.
void joint_transmission(const MjcfJoint& j, const std::vector<double>& gear, bool in_parent, dynActuator& a) {
  if (is_scalar(j)) return void(a.gear = gear.empty() ? 1 : gear[0]);
  const size_t count = j.spec.type == DYN_JOINT_TYPE_FREE_FLYER ? 6 : 3;
  double wrench[6] = {1};
  std::copy_n(gear.begin(), std::min(count, gear.size()), wrench);
  const auto driven = [](double x) { return x != 0; };
  const std::ptrdiff_t at = std::find_if(wrench, wrench + count, driven) - wrench;
  const bool one = std::count_if(wrench, wrench + count, driven) == 1, pushes = count == 6 && at < 3;
  if (one && !pushes && !in_parent) return void((a.component = int(at), a.gear = wrench[at]));
  a.transmission = DYN_TRANSMISSION_AXES, a.in_parent = in_parent;
  std::copy_n(wrench, 6, a.wrench);
}

// One that depends on a length has the axes of the joint.
void take_axes(const MjcfJoint& j, dynActuator& a) {
  if (is_scalar(j) || a.transmission != DYN_TRANSMISSION_JOINT) return;
  a.transmission = DYN_TRANSMISSION_AXES, a.wrench[a.component] = a.gear, a.gear = 1, a.component = 0;
}

// What an actuator acts through, as far as the model has it.
struct Transmission {
  MjcfJoint* joint = nullptr;
  MjcfTendon* tendon = nullptr;
  const char* not_attached = nullptr;  // a part that was not attached
  std::string why;                     // it is not supported
};

Transmission read_transmission(MjcfFile& file, const Reader& reader, const Element& e, const MjcfContext& context,
                               MjcfActuator& actuator) {
  Transmission out;
  dynActuator& a = actuator.spec;
  const std::vector<double> gear = reader.numbers(e, "gear").value_or(std::vector<double>());
  const auto missing = [&](const char* kind, const std::string& name, bool lost) {
    if (lost) out.why = std::string("its ") + kind + " is missing from the model";
    else if (file.part) out.not_attached = kind;
    else reader.fail(DYN_ERROR_NAME, e, std::string("there is no ") + kind + " " + load::in_quotes(name));
  };
  const auto named = [&](const char* kind, const char* attribute) {
    return file.copies.name(context, kind, reader.name(e, attribute));
  };
  if (e.Attribute("tendon")) {
    a.transmission = DYN_TRANSMISSION_TENDON, a.gear = gear.empty() ? 1 : gear[0];
    actuator.target = named("tendon", "tendon");
    out.tendon = find_tendon(file.robot, actuator.target);
    if (!out.tendon) missing("tendon", actuator.target, file.robot.lost_tendons.count(actuator.target) > 0);
  } else if (e.Attribute("site")) {
    a.transmission = DYN_TRANSMISSION_SITE, a.wrench[0] = 1;
    std::copy_n(gear.begin(), std::min<size_t>(gear.size(), 6), a.wrench);
    const auto site = [&](const char* attribute) {
      const std::string name = named("site", attribute);
      if (!find_site(file.robot, name)) missing("site", name, file.robot.has_lost(name));
      return name;
    };
    actuator.target = site("site");
    if (e.Attribute("refsite")) actuator.reference = site("refsite");
  } else if (const char* by = e.Attribute("joint") ? "joint" : "jointinparent"; e.Attribute(by)) {
    actuator.target = named("joint", by);
    out.joint = find_joint(file.robot, actuator.target);
    if (!out.joint) missing("joint", actuator.target, file.robot.has_lost(actuator.target));
    else joint_transmission(*out.joint, gear, !e.Attribute("joint"), a);
  } else if (e.Attribute("cranksite")) {
    a.transmission = DYN_TRANSMISSION_SLIDER_CRANK, a.gear = gear.empty() ? 1 : gear[0];
    a.rod = reader.optional_number(e, "cranklength").value_or(0);
    if (!(a.rod > 0)) reader.bad_numbers(e, "cranklength", "a positive length is expected");
    for (const auto& [attribute, to] : {std::pair{"cranksite", &actuator.target}, {"slidersite", &actuator.reference}}) {
      *to = named("site", attribute);
      if (!find_site(file.robot, *to)) missing("site", *to, file.robot.has_lost(*to));
    }
  } else if (e.Attribute("body")) {
    a.transmission = DYN_TRANSMISSION_BODY, actuator.target = named("body", "body");
    if (!find_body(file.robot, actuator.target)) missing("body", actuator.target, file.robot.has_lost(actuator.target));
  } else {
    out.why = "it drives no joint, tendon, site or body, which is not supported";
  }
  return out;
}

std::optional<std::array<double, 2>> range_of(const Transmission& by) {
  if (by.joint && is_scalar(*by.joint) && !by.joint->spec.lower.empty())
    return std::array<double, 2>{by.joint->spec.lower[0], by.joint->spec.upper[0]};
  if (by.tendon && std::isfinite(by.tendon->spec.range[0]) && std::isfinite(by.tendon->spec.range[1]))
    return std::array<double, 2>{by.tendon->spec.range[0], by.tendon->spec.range[1]};
  return std::nullopt;
}

// gainprm, biasprm, dynprm: missing numbers keep MuJoCo's defaults.
double parameter(const Reader& reader, const Element& e, const char* attribute, size_t k, double missing) {
  const auto given = reader.numbers(e, attribute);
  return given && k < given->size() ? (*given)[k] : missing;
}

// Parameters of a muscle: range, force, scale, lmin, lmax, vmax, fpmax, fvmax. Its bias has the passive force alone.
const char* read_muscle(const Reader& reader, const Element& e, const MjcfCompiler& compiler, MjcfActuator& actuator) {
  actuator.spec.type = DYN_ACTUATOR_TYPE_MUSCLE;
  dynMuscle& x = actuator.spec.muscle;
  const auto gain = [&](size_t k) { return parameter(reader, e, "gainprm", k, k == 0); };
  const auto bias = [&](size_t k) { return parameter(reader, e, "biasprm", k, 0); };
  for (const size_t k : {0, 1, 2, 3, 5})
    if (gain(k) != bias(k)) return "its gain and its bias are two different muscles";
  x.range[0] = gain(0), x.range[1] = gain(1), x.force = gain(2);
  if (x.force == 0) return "its force is 0";
  if (x.force < 0) {
    actuator.muscle_scale = gain(3);
    if (!(gain(3) > 0)) reader.bad_numbers(e, "gainprm", "the scale of a muscle is positive");
  }
  x.lmin = gain(4), x.lmax = gain(5), x.vmax = gain(6), x.fpmax = bias(7), x.fvmax = gain(8);
  x.t_act = parameter(reader, e, "dynprm", 0, 1), x.t_deact = parameter(reader, e, "dynprm", 1, 0),
  x.smoothing = parameter(reader, e, "dynprm", 2, 0);
  std::fill_n(x.length_range, 2, 0.0);
  if (const auto range = reader.numbers(e, "lengthrange", 2); range && compiler.length_given)
    std::copy_n(range->begin(), 2, x.length_range);
  return nullptr;
}

// Reads the law of a <general> actuator. Returns the reason if it is not supported.
const char* law(const Reader& reader, const Element& e, const MjcfCompiler& compiler, MjcfActuator& actuator) {
  dynActuator& a = actuator.spec;
  a.type = DYN_ACTUATOR_TYPE_AFFINE;
  const std::string_view kind = e.Name(), dynamics = e.Attribute("dyntype") ? e.Attribute("dyntype") : "none",
                         gain = e.Attribute("gaintype") ? e.Attribute("gaintype") : "fixed",
                         bias = e.Attribute("biastype") ? e.Attribute("biastype") : "none";
  if (dynamics == "muscle" && gain == "muscle" && bias == "muscle") return read_muscle(reader, e, compiler, actuator);
  if (dynamics == "filter" || dynamics == "filterexact") a.time_constant = parameter(reader, e, "dynprm", 0, 1);
  else if (dynamics == "integrator") a.integrates = 1;
  else if (dynamics != "none") return "its activation is neither a first-order filter nor an integrator";
  a.gain = parameter(reader, e, "gainprm", 0, 1);
  for (size_t k = 0; k < 2 && gain == "affine"; ++k) a.gain_slope[k] = parameter(reader, e, "gainprm", k + 1, 0);
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

// Reflects the motor's armature and damping to the joint or tendon, times gear^2.
void add_motor_inertia(const Reader& reader, const Element& e, const MjcfActuator& actuator, const Transmission& by) {
  for (const bool damping : {false, true}) {
    const char* const attribute = damping ? "damping" : "armature";
    const auto given = reader.numbers(e, attribute);
    if (!given || given->empty()) continue;
    if (!((*given)[0] >= 0)) reader.bad_numbers(e, attribute, "it is negative");
    if (!by.joint && !by.tendon && (*given)[0] > 0) reader.bad_numbers(e, attribute, "it needs a joint or a tendon");
    const double reflected = actuator.spec.gear * actuator.spec.gear * (*given)[0];
    if (actuator.spec.transmission == DYN_TRANSMISSION_AXES && (*given)[0] > 0) {
      actuator.place.physics(std::string(attribute) + " of an actuator on several axes of a joint is not used");
      continue;
    }
    if (by.joint) (damping ? by.joint->spec.damping : by.joint->spec.armature)[size_t(actuator.spec.component)] += reflected;
    if (by.tendon) (damping ? by.tendon->spec.damping : by.tendon->spec.armature) += reflected;
    if (std::any_of(given->begin() + 1, given->end(), [](double x) { return x != 0; }))
      actuator.place.physics(std::string(attribute) + " that depends on speed is not supported: its first number is used");
  }
}

// Some that are not supported have several controls.
size_t controls_of_unknown(const Element& e) {
  return std::string_view(e.Name()) != "orientation" ? 1 : attribute(e, "input") == "quat" ? 4 : 3;
}

}  // namespace

void read_mjcf_range(const Reader& reader, const Element& e, const char* attribute, const char* limited, bool autolimits,
                     double (&out)[2]) {
  const auto pair = reader.numbers(e, attribute, 2);
  const auto on = read_switch(reader, e, limited, std::nullopt);
  if (!pair && on.value_or(false)) reader.fail(DYN_ERROR_INVALID, e, std::string(limited) + "=\"true\" needs " + attribute);
  if (!pair || !on.value_or(autolimits && ((*pair)[0] != 0 || (*pair)[1] != 0))) return;
  if (!((*pair)[0] <= (*pair)[1])) reader.bad_numbers(e, attribute, "the lower end is above the upper one");
  for (size_t k = 0; k < 2; ++k)  // the largest double stands for no bound
    if (std::abs((*pair)[k]) < std::numeric_limits<double>::max()) out[k] = (*pair)[k];
}

void make_mjcf_actuator_inert(MjcfActuator& actuator, const std::string& why) {
  actuator.place.physics(why + ": it keeps its control and exerts no force");
  const dynActuator read = actuator.spec;
  actuator.spec = default_actuator(DYN_ACTUATOR_TYPE_AFFINE);  // its gain is 0
  actuator.spec.gear = 0, actuator.inert = true, actuator.damping_ratio = actuator.muscle_scale = 0;
  std::copy_n(read.control_range, 2, actuator.spec.control_range);
}

void read_mjcf_actuator(MjcfFile& file, Element& e, const MjcfContext& context) {
  const std::string_view kind = e.Name();
  const std::string given = e.Attribute("name") ? e.Attribute("name") : "";
  const std::string name =
      context.name(given.empty() ? std::string(kind) + "_" + std::to_string(file.robot.actuators.size()) : given);
  const Reader reader = file.source.reader(e, "actuator " + load::in_quotes(name));
  const MjcfPlace place{&reader.report, line(e), reader.owner};
  MjcfActuator actuator{place, name, default_actuator(DYN_ACTUATOR_TYPE_MOTOR), "", ""};
  // the order and number of controls is the file's
  const auto keep_place = [&](const std::string& why) {
    make_mjcf_actuator_inert(actuator, why);
    for (size_t k = 0, n = controls_of_unknown(e); k < n; ++k, actuator.activations = 0) {
      if (k > 0) actuator.name = name + "_" + std::to_string(k);
      file.robot.actuators.push_back(actuator);
    }
  };
  const std::string_view dynamics_before = e.Attribute("dyntype") ? e.Attribute("dyntype") : "none";
  actuator.activations = dynamics_before != "none";
  if (!is_actuator(e)) {
    read_mjcf_range(reader, e, "ctrlrange", "ctrllimited", file.compiler.autolimits, actuator.spec.control_range);
    return keep_place("<" + std::string(kind.substr(0, 60)) + "> is not supported");
  }
  reader.unread(e, {"name",         "class",         "group",     "nsample",    "interp",   "delay",       "ctrllimited",
                    "forcelimited", "actlimited",    "ctrlrange", "forcerange", "actrange", "lengthrange", "gear",
                    "joint",        "jointinparent", "tendon",    "site",       "refsite",  "body",        "slidersite",
                    "cranksite",    "cranklength",   "user",      "actdim",     "dyntype",  "gaintype",    "biastype",
                    "dynprm",       "gainprm",       "biasprm",   "actearly",   "kp",       "kv",          "dampratio",
                    "timeconst",    "inheritrange",  "armature",  "damping",    "area",     "diameter",    "bias",
                    "tausmooth",    "range",         "force",     "scale",      "lmin",     "lmax",        "vmax",
                    "fpmax",        "fvmax",         "gain",      "ki",         "imax",        "slewmax",     "input",
                    "posrange",     "velrange",      "ffrange",   "motorconst", "resistance",  "nominal",     "saturation",
                    "inductance",   "cogging",       "controller", "thermal",   "lugre",       converted_from},
                {"plugin"});
  file.defaults.apply(file.source, e, "actuator", context.childclass);
  as_general(reader, e);
  const std::string_view dynamics = e.Attribute("dyntype") ? e.Attribute("dyntype") : "none";
  actuator.activations = dynamics != "none";
  read_mjcf_range(reader, e, "ctrlrange", "ctrllimited", file.compiler.autolimits, actuator.spec.control_range);
  if (reader.optional_number(e, "delay").value_or(0) > 0) place.physics("its delay is not used: controls act at once");
  const Transmission by = read_transmission(file, reader, e, context, actuator);
  if (by.not_attached) return place.info("its " + std::string(by.not_attached) + " was not attached: left out");
  if (!by.why.empty()) return keep_place(by.why);
  if (kind == "pid" || kind == "dcmotor") read_mjcf_driver(reader, e, file.compiler.autolimits, actuator);
  else if (const char* why = law(reader, e, file.robot.compiler, actuator)) return keep_place(why);
  actuator.activations = size_t(activations_of(actuator.spec));
  actuator.spec.late = actuator.activations > 0 && kind != "dcmotor" &&
                       !read_switch(reader, e, "actearly", false).value_or(false);
  if (by.joint && (actuator.spec.bias[1] != 0 || actuator.spec.kp != 0 || has_general_law(actuator.spec)))
    take_axes(*by.joint, actuator.spec);
  read_mjcf_range(reader, e, "forcerange", "forcelimited", file.compiler.autolimits, actuator.spec.force_range);
  if (actuator.activations > 0 && !has_driver(actuator.spec))
    read_mjcf_range(reader, e, "actrange", "actlimited", file.compiler.autolimits, actuator.spec.act_range);
  const std::optional<std::array<double, 2>> target = range_of(by);
  if (const double inherit = reader.optional_number(e, "inheritrange").value_or(0); inherit > 0 && target) {
    const double middle = ((*target)[0] + (*target)[1]) / 2, half = inherit * ((*target)[1] - (*target)[0]) / 2;
    double (&range)[2] = kind == "intvelocity" ? actuator.spec.act_range : actuator.spec.control_range;
    range[0] = middle - half, range[1] = middle + half;
  }
  add_motor_inertia(reader, e, actuator, by);
  file.robot.actuators.push_back(std::move(actuator));
}

void limit_mjcf_actuators(MjcfRobot& robot) {
  std::map<std::pair<dynTransmission, std::string>, std::vector<dynActuator*>> driving;
  for (MjcfActuator& a : robot.actuators)
    if (!a.inert && a.spec.gear != 0) driving[{a.spec.transmission, a.target}].push_back(&a.spec);
  const auto limit = [&](const MjcfPlace& place, const std::optional<std::array<double, 2>>& force, dynTransmission transmission,
                         const std::string& target, bool compensates) {
    if (!force) return;
    const std::vector<dynActuator*>& all = driving[{transmission, target}];
    const bool tendon = transmission == DYN_TRANSMISSION_TENDON;
    if (all.size() > 1 || (compensates && !all.empty()))
      return void(robot.force_limits.push_back({place, tendon, target, *force, compensates}));
    if (compensates) place.physics("actuatorfrcrange does not limit the compensation of gravity: no actuator drives the joint");
    if (all.empty()) return;
    const double gear = all[0]->gear, ends[2] = {(*force)[gear < 0] / gear, (*force)[gear > 0] / gear};
    for (double& x : all[0]->force_range) x = std::min(std::max(x, ends[0]), ends[1]);
  };
  for (const MjcfBody& body : robot.bodies)
    for (const MjcfJoint& j : body.joints) limit(j.place, j.force, DYN_TRANSMISSION_JOINT, j.spec.name, j.compensates);
  for (const MjcfTendon& t : robot.tendons) limit(t.place, t.force, DYN_TRANSMISSION_TENDON, t.name, false);
}

void add_mjcf_actuator(Builder& builder, const MjcfRobot& robot, const MjcfActuator& a, const dynActuator& spec) {
  const bool site = spec.transmission == DYN_TRANSMISSION_SITE || spec.transmission == DYN_TRANSMISSION_SLIDER_CRANK;
  const std::string target = site ? find_site(robot, a.target)->frame : a.target,
                    reference = site && !a.reference.empty() ? find_site(robot, a.reference)->frame : "";
  with_location(a.place, [&] { builder.actuator(a.name, spec, target, reference); });
}

void add_mjcf_actuators(Builder& builder, const MjcfRobot& robot) {
  for (const MjcfForceLimit& x : robot.force_limits)
    with_location(x.place, [&] { builder.limit_actuators(x.tendon, x.target, x.range[0], x.range[1], x.with_weight); });
  const MjcfJoint* first = nullptr;  // those that are inert hang on it, with gear 0
  for (const MjcfBody& b : robot.bodies)
    for (const MjcfJoint& j : b.joints) first = first ? first : &j;
  constexpr double none = std::numeric_limits<double>::infinity();
  for (const MjcfActuator& a : robot.actuators) {
    dynActuator spec = a.spec;
    if (!robot.control_ranges) spec.control_range[0] = -none, spec.control_range[1] = none;
    if (!a.inert) add_mjcf_actuator(builder, robot, a, spec);
    else if (first) with_location(a.place, [&] { builder.actuator(a.name, spec, first->spec.name); });
  }
}

}  // namespace dyn::load
