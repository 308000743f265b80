// <joint> and <freejoint>.
#include <cmath>

#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity(), half_turn = 3.14159265358979324;

dynJointType joint_type_of(const Reader& reader, const Element& e) {
  const std::string_view type = e.Attribute("type") ? e.Attribute("type") : "hinge";
  if (type == "hinge") return DYN_JOINT_TYPE_REVOLUTE;
  if (type == "slide") return DYN_JOINT_TYPE_PRISMATIC;
  if (type == "ball") return DYN_JOINT_TYPE_SPHERICAL;
  if (type == "free") return DYN_JOINT_TYPE_FREE_FLYER;
  reader.fail(DYN_ERROR_PARSE, e,
              "<joint type> is " + load::in_quotes(std::string(type)) + ": hinge, slide, ball or free is expected");
}

// Limits the rotation angle of a ball joint. Half a turn or more is no limit.
void limit_ball(const Reader& reader, const Element& e, const MjcfPlace& place, double least, double most, JointSpec& spec) {
  if (least != 0) reader.bad_numbers(e, "range", "a ball joint's range begins at 0; its second number is the largest angle");
  if (!(most > 0)) return place.physics("the limit of its angle is 0: it is not used, and the joint is free");
  if (most > half_turn * (1 + 1e-12)) return;
  spec.lower.assign(4, -no_limit), spec.lower[3] = std::max(0.0, std::cos(most / 2));
}

}  // namespace

void read_mjcf_joint(MjcfFile& file, Element& e, const MjcfContext& context) {
  file.source.charge(&Budget::add_joints, 1, e);
  MjcfBody& body = file.robot.bodies[size_t(context.body)];
  const bool free_joint = std::string_view(e.Name()) == "freejoint";
  if (free_joint) e.SetAttribute("type", "free");
  else file.defaults.apply(file.source, e, "joint", context.childclass);
  MjcfJoint joint;
  const char* given = e.Attribute("name");
  joint.spec.name = context.name(given ? given : "");
  const std::string owner =
      joint.spec.name.empty() ? body.place.owner + ": a joint" : "joint " + load::in_quotes(joint.spec.name);
  const Reader reader = file.source.reader(e, owner);
  joint.place = {&file.source.report(e), line(e), owner};
  if (context.body == 0) reader.fail(DYN_ERROR_INVALID, e, "the world has no joints: put it into a <body>");
  reader.unread(e,
                {"name",
                 "class",
                 "type",
                 "group",
                 "pos",
                 "axis",
                 "limited",
                 "range",
                 "actuatorfrclimited",
                 "actuatorfrcrange",
                 "actuatorgravcomp",
                 "stiffness",
                 "springref",
                 "ref",
                 "armature",
                 "damping",
                 "springdamper",
                 "frictionloss",
                 "user",
                 "align",
                 "margin",
                 "solreflimit",
                 "solimplimit",
                 "solreffriction",
                 "solimpfriction"},
                {});
  JointSpec& spec = joint.spec;
  spec.compliance = read_mjcf_compliance(reader, e, "solreflimit", "solimplimit");
  spec.friction_compliance = read_mjcf_compliance(reader, e, "solreffriction", "solimpfriction");
  spec.type = joint_type_of(reader, e);
  const bool hinge = spec.type == DYN_JOINT_TYPE_REVOLUTE, scalar = hinge || spec.type == DYN_JOINT_TYPE_PRISMATIC;
  const double unit = hinge || spec.type == DYN_JOINT_TYPE_SPHERICAL ? file.compiler.angle : 1;
  if (spec.type == DYN_JOINT_TYPE_FREE_FLYER && body.parent != 0)
    reader.fail(DYN_ERROR_INVALID, e,
                "a free joint belongs to a body of the world, and " + body.place.owner + " is in another body");
  if (spec.type == DYN_JOINT_TYPE_FREE_FLYER && context.suffix.empty() && !body.joints.empty())
    reader.fail(DYN_ERROR_INVALID, e, "a free joint must be the only joint of its body");
  if (!body.joints.empty() && body.joints.back().spec.type == DYN_JOINT_TYPE_FREE_FLYER)
    reader.fail(DYN_ERROR_INVALID, e, "a free joint must be the only joint of its body");

  const bool alone = !e.Parent()->ToElement() || file.source.children(*e.Parent()->ToElement(), "body").empty();
  if (free_joint && alone && read_switch(reader, e, "align", std::nullopt).value_or(file.compiler.align_free))
    joint.place.physics("the joint is not aligned with the body's inertia: q and v belong to the body's frame in the file");

  const size_t nv = size_t(joint_nv(spec.type)), nq = size_t(joint_nq(spec.type));
  if (const auto p = reader.vector3(e, "pos"); p && spec.type != DYN_JOINT_TYPE_FREE_FLYER)
    joint.anchor = context.X.act(load3(p->data()));
  else if (spec.type != DYN_JOINT_TYPE_FREE_FLYER) joint.anchor = context.X.p;
  if (const auto a = reader.vector3(e, "axis")) joint.axis = load3(a->data());
  if (const double length = std::sqrt(dot(joint.axis, joint.axis)); scalar && !(length > 1e-10))
    reader.bad_numbers(e, "axis", "this is no direction: it is zero");
  else joint.axis = context.X.R * (joint.axis * (1 / length));
  if (scalar) joint.reference = unit * reader.optional_number(e, "ref").value_or(0);

  const double margin = reader.optional_number(e, "margin").value_or(0);  // the limit holds so far inside the range
  // a free joint has no limits, whatever its class says
  if (const auto limits = spec.type == DYN_JOINT_TYPE_FREE_FLYER
                              ? std::nullopt
                              : read_limits(reader, e, "range", "limited", file.compiler.autolimits)) {
    if (scalar) spec.lower = {unit * read_bound((*limits)[0]) + margin}, spec.upper = {unit * read_bound((*limits)[1]) - margin};
    else limit_ball(reader, e, joint.place, unit * (*limits)[0], unit * (*limits)[1] - margin, spec);
  }
  // compensation by the actuator moves as a passive one, but for its limit
  const bool compensates = read_switch(reader, e, "actuatorgravcomp", false).value_or(false);
  const auto force = read_limits(reader, e, "actuatorfrcrange", "actuatorfrclimited", file.compiler.autolimits);
  if (force && scalar) {
    joint.force = force, joint.compensates = compensates, spec.effort = {std::max(std::abs((*force)[0]), std::abs((*force)[1]))};
  }
  spec.armature.assign(nv, read_coefficient(reader, e, "armature"));
  if (spec.type == DYN_JOINT_TYPE_FREE_FLYER && spec.armature[0] != 0)
    joint.place.physics(
        "the armature of a free joint acts along the body's axes, not the world's as in MuJoCo: forces differ when the body "
        "turns");
  spec.damping.assign(nv, read_coefficient(reader, e, "damping"));
  spec.friction.assign(nv, read_coefficient(reader, e, "frictionloss"));
  const double stiffness = read_coefficient(reader, e, "stiffness");
  if (const auto both = reader.numbers(e, "springdamper", 2); both && ((*both)[0] != 0 || (*both)[1] != 0)) {
    if (!((*both)[0] > 0 && (*both)[1] > 0))
      reader.bad_numbers(e, "springdamper", "a time constant and a damping ratio are expected, both positive");
    joint.time_constant = (*both)[0], joint.damping_ratio = (*both)[1];
  }
  const bool springs = stiffness > 0 || joint.time_constant > 0;
  if (springs && spec.type == DYN_JOINT_TYPE_FREE_FLYER) joint.place.physics("the spring of a free joint is not used");
  else if (springs) spec.stiffness.assign(nv, stiffness);
  if (scalar && (springs || e.Attribute("springref")))
    spec.spring_reference.assign(nq, unit * reader.optional_number(e, "springref").value_or(0));
  body.joints.push_back(std::move(joint)), file.robot.names.reset();
}

}  // namespace dyn::load
