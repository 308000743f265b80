// <joint>: type, axis, limits, dynamics, mimic.
#include <algorithm>
#include <cmath>

#include "reader.hpp"
#include "base/portable.hpp"
#include "urdf_robot.hpp"

namespace dyn::load {

namespace {

struct Type {
  std::string_view name;
  dynJointType type;
  bool standard;
};
constexpr Type types[] = {
    {"revolute", DYN_JOINT_TYPE_REVOLUTE, true},    {"continuous", DYN_JOINT_TYPE_CONTINUOUS, true},
    {"prismatic", DYN_JOINT_TYPE_PRISMATIC, true},  {"fixed", DYN_JOINT_TYPE_FIXED, true},
    {"floating", DYN_JOINT_TYPE_FREE_FLYER, true},  {"planar", DYN_JOINT_TYPE_PLANAR, true},
    {"spherical", DYN_JOINT_TYPE_SPHERICAL, false}, {"ball", DYN_JOINT_TYPE_SPHERICAL, false},
};

// The largest double stands for no limit where the format requires a number.
constexpr double no_limit_as_written = std::numeric_limits<double>::max();

bool one_axis(dynJointType t) {
  return t == DYN_JOINT_TYPE_REVOLUTE || t == DYN_JOINT_TYPE_CONTINUOUS || t == DYN_JOINT_TYPE_PRISMATIC ||
         t == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED;
}

dynJointType read_type(const Element& e, const Reader& reader, const std::string& name) {
  for (const Type& t : types) {
    if (t.name != name) continue;
    if (!t.standard)
      reader.report.info(line(e),
                         reader.owner + ": type '" + name + "' is not in the URDF standard: read as a ball joint (quaternion)");
    return t.type;
  }
  std::string known;
  for (const Type& t : types) known += (known.empty() ? "" : ", ") + std::string(t.name);
  reader.fail(DYN_ERROR_INVALID, e, "unknown type " + in_quotes(name) + ": libdyn knows " + known);
}

void read_axis(const Element& e, const Reader& reader, JointSpec& spec) {
  const Element* a = reader.only(e, "axis");
  if (spec.type == DYN_JOINT_TYPE_FIXED || spec.type == DYN_JOINT_TYPE_FREE_FLYER || spec.type == DYN_JOINT_TYPE_SPHERICAL) {
    if (a) reader.report.count("<axis> of a joint that has none: not used", line(*a));
    return;
  }
  spec.axis = {1, 0, 0};
  if (!a) {
    reader.report.info(line(e), reader.owner + " has no <axis>: x, as the URDF standard says");
    return;
  }
  reader.unread(*a, {"xyz"}, {});
  const auto xyz = reader.vector3(*a, "xyz");
  if (!xyz) reader.fail(DYN_ERROR_PARSE, *a, "<axis> has no attribute xyz: give a direction such as xyz=\"0 0 1\"");
  const auto [x, y, z] = *xyz;
  const double largest = std::max({std::abs(x), std::abs(y), std::abs(z)});
  if (largest == 0) reader.fail(DYN_ERROR_INVALID, *a, "axis is zero: give a direction such as xyz=\"0 0 1\"");
  const double norm = math::hypot(x / largest, y / largest, z / largest);
  spec.axis = {x / largest / norm, y / largest / norm, z / largest / norm};
  if (std::abs(norm * largest - 1) > 1e-6)
    reader.report.info(line(*a), reader.owner + ": the axis has length " + text(norm * largest) + " and was normalised");
}

void read_limit(const Element& e, const Reader& reader, JointSpec& spec) {
  const Element* l = reader.only(e, "limit");
  const bool bounded = spec.type == DYN_JOINT_TYPE_REVOLUTE || spec.type == DYN_JOINT_TYPE_PRISMATIC;
  if (!l) {
    if (bounded) reader.report.warning(line(e), reader.owner + " has no <limit>, which the URDF standard requires: unlimited");
    return;
  }
  if (!one_axis(spec.type)) {
    reader.report.count("<limit> of a joint that is not revolute, continuous or prismatic: not used", line(*l));
    return;
  }
  reader.unread(*l, {"lower", "upper", "velocity", "effort"}, {}, false);
  const auto lower = reader.optional_number(*l, "lower"), upper = reader.optional_number(*l, "upper");
  const auto magnitude = [&](const char* name, std::vector<double>& out) {
    const auto value = reader.optional_number(*l, name);
    if (!value) {
      reader.report.info(line(*l), reader.at(*l) + " has no " + name + ": unlimited");
      return;
    }
    if (*value < 0) reader.fail(DYN_ERROR_INVALID, *l, std::string("<limit ") + name + "> is negative: " + text(*value));
    if (*value == 0)
      reader.report.count(std::string("<limit ") + name + "=\"0\">: kept, but a joint so limited cannot be driven", line(*l));
    if (*value < no_limit_as_written) out = {*value};
  };
  magnitude("velocity", spec.velocity);
  magnitude("effort", spec.effort);

  if (!bounded) {
    if (lower || upper)
      reader.report.info(line(*l), reader.owner + ": a continuous joint has no range: lower and upper are not used");
    return;
  }
  if (!lower && !upper) {
    reader.report.warning(
        line(*l),
        reader.at(*l) + " has neither lower nor upper: unlimited (the standard's default of 0 for both would lock the joint)");
    return;
  }
  if (!lower || !upper)
    reader.report.warning(line(*l), reader.at(*l) + " has no " + (lower ? "upper" : "lower") + ": 0, as the URDF standard says");
  spec.lower = {lower.value_or(0)};
  spec.upper = {upper.value_or(0)};
  if (spec.lower[0] == -no_limit_as_written) spec.lower[0] = -HUGE_VAL;
  if (spec.upper[0] == no_limit_as_written) spec.upper[0] = HUGE_VAL;
  if (spec.lower[0] > spec.upper[0])
    reader.fail(DYN_ERROR_INVALID, *l, "<limit> lower " + text(spec.lower[0]) + " is above upper " + text(spec.upper[0]));
  if (spec.lower[0] == spec.upper[0])
    reader.report.info(line(*l),
                       reader.owner + ": lower and upper are both " + text(spec.lower[0]) + ": the range is a single point");
}

void read_dynamics(const Element& e, const Reader& reader, JointSpec& spec) {
  const Element* d = reader.only(e, "dynamics");
  if (!d) return;
  reader.unread(*d, {"damping", "friction"}, {});
  const auto coefficient = [&](const char* name, std::vector<double>& out) {
    const auto value = reader.optional_number(*d, name);
    if (!value) return;
    if (*value < 0) reader.fail(DYN_ERROR_INVALID, *d, std::string("<dynamics ") + name + "> is negative: " + text(*value));
    if (one_axis(spec.type))
      out = {*value};
    else if (spec.type == DYN_JOINT_TYPE_SPHERICAL)
      out = {*value, *value, *value};
    else if (*value != 0 && spec.type != DYN_JOINT_TYPE_FIXED)
      reader.report.physics(line(*d), reader.at(*d, name) + ": one number for a joint with rotation and translation: not used");
  };
  coefficient("damping", spec.damping);
  coefficient("friction", spec.friction);
}

void read_mimic(const Element& e, const Reader& reader, UrdfJoint& joint) {
  const Element* m = reader.only(e, "mimic");
  if (!m) return;
  JointSpec& spec = joint.spec;
  reader.unread(*m, {"joint", "multiplier", "offset"}, {});
  const std::string leader = reader.name(*m, "joint");
  const double ratio = reader.optional_number(*m, "multiplier").value_or(1),
               offset = reader.optional_number(*m, "offset").value_or(0);
  if (spec.type == DYN_JOINT_TYPE_FIXED) {
    reader.report.info(line(*m), reader.owner + " is fixed: its <mimic> has no effect");
    return;
  }
  if (!one_axis(spec.type))
    reader.fail(DYN_ERROR_INVALID, *m,
                "a " + joint.type + " joint cannot mimic: only revolute, continuous and prismatic ones do");
  joint.mimic_line = line(*m);
  spec.mimic = leader;
  spec.mimic_ratio = ratio;
  spec.mimic_offset = offset;
}

}  // namespace

UrdfJoint read_joint(const Element& e, Report& report, const LoadOptions& options) {
  UrdfJoint joint;
  JointSpec& spec = joint.spec;
  joint.line = line(e);
  spec.name = Reader{report, "a joint"}.name(e, "name");
  const Reader reader{report, "joint " + in_quotes(spec.name)};
  reader.unread(
      e, {"name", "type"},
      {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "safety_controller", "calibration", "gazebo"});
  joint.type = reader.name(e, "type");
  spec.type = read_type(e, reader, joint.type);
  if (spec.type == DYN_JOINT_TYPE_CONTINUOUS && options.cos_sin) spec.type = DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED;
  spec.placement = reader.origin(e);

  const auto end = [&](const char* name, std::string& link, int& at) {
    const Element* c = reader.only(e, name);
    if (!c) reader.fail(DYN_ERROR_PARSE, e, std::string("no <") + name + "> element: add <" + name + " link=\"...\"/>");
    reader.unread(*c, {"link"}, {});
    link = reader.name(*c, "link");
    at = line(*c);
  };
  end("parent", joint.parent, joint.parent_line);
  end("child", joint.child, joint.child_line);

  read_axis(e, reader, spec);
  read_limit(e, reader, spec);
  read_dynamics(e, reader, spec);
  read_mimic(e, reader, joint);
  if (const Element* s = first(e, "safety_controller")) report.count("<safety_controller>: not used", line(*s));
  if (const Element* c = first(e, "calibration")) report.count("<calibration>: not used", line(*c));
  if (const Element* g = first(e, "gazebo")) report.count("<gazebo> in a joint: not used", line(*g));
  return joint;
}

}  // namespace dyn::load
