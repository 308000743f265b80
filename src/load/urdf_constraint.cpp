// <libdyn> in a URDF: constraints, which the format itself does not have.
//   <constraint name="pin" type="revolute" stiffness="0" damping="0">
//     <first link="rocker"><origin xyz="0.8 0 0"/></first>
//     <second link="ground"/>                                  (none: the world)
//     <axis xyz="0 0 1"/>
//   </constraint>
// type: point, frame, connect, weld, distance (length), a joint type that closes a loop (pitch; <axis2>), coupling
// (coefficients), limit, friction (force). The last three have <first joint="..."/>.
#include <algorithm>

#include "constraint/loop.hpp"
#include "model/constraints.hpp"
#include "budget.hpp"
#include "reader.hpp"
#include "table/names.hpp"
#include "urdf_robot.hpp"

namespace dyn::load {

namespace {

// The name of a constraint, or of the joint that closes a loop.
dynConstraint of_type(const Element& e, const Reader& reader, const std::string& type) {
  if (dynConstraintType named; value_of(type, named) && named != DYN_CONSTRAINT_TYPE_NONE && named != DYN_CONSTRAINT_TYPE_LOOP)
    return default_constraint(named);
  dynConstraint c = default_constraint(DYN_CONSTRAINT_TYPE_LOOP);
  if (value_of(type, c.joint_type) && constraint::Loop::rows(c.joint_type) > 0) return c;
  std::string known;
  for (const ValueName& v : value_names<dynConstraintType>)
    if (v.value != DYN_CONSTRAINT_TYPE_NONE && v.value != DYN_CONSTRAINT_TYPE_LOOP) known += v.name + std::string(", ");
  reader.fail(DYN_ERROR_INVALID, e,
              "type " + in_quotes(type) + " is no constraint: " + known + "or the type of a joint that closes a loop");
}

UrdfConstraint read_constraint(const Element& e, Report& report) {
  UrdfConstraint out;
  out.line = line(e);
  out.name = Reader{report, "a constraint"}.name(e, "name");
  const Reader reader{report, "constraint " + in_quotes(out.name)};
  reader.unread(e, {"name", "type", "stiffness", "damping", "restitution", "length", "pitch", "force", "coefficients"},
                {"first", "second", "axis", "axis2"});
  dynConstraint& c = out.spec;
  c = of_type(e, reader, reader.name(e, "type"));
  const bool joints = between_joints(c.type);
  const struct {
    const char* name;
    double* to;
  } numbers[] = {{"stiffness", &c.stiffness}, {"damping", &c.damping}, {"restitution", &c.restitution},
                 {"length", &c.length},       {"pitch", &c.pitch},     {"force", &c.force}};
  for (const auto& n : numbers) *n.to = reader.optional_number(e, n.name).value_or(*n.to);
  if (const auto p = reader.numbers(e, "coefficients")) {
    if (p->empty() || p->size() > 5)
      reader.bad_numbers(e, "coefficients", "has " + std::to_string(p->size()) + " numbers: give 1 to 5");
    std::fill(c.coefficients, c.coefficients + 5, 0.0);
    std::copy(p->begin(), p->end(), c.coefficients);
  }
  auto end = [&](const char* which, std::string& name, double* placement) {
    const Element* x = reader.only(e, which);
    if (!x) return;
    reader.unread(*x, {joints ? "joint" : "link"}, {"origin"});
    name = reader.name(*x, joints ? "joint" : "link");
    const Placement X = reader.origin(*x);
    std::copy(X.begin(), X.end(), placement);
  };
  end("first", out.first, c.placement1), end("second", out.second, c.placement2);
  if (out.first.empty())
    reader.fail(DYN_ERROR_PARSE, e, std::string("no <first> element: add <first ") + (joints ? "joint" : "link") + "=\"...\"/>");
  auto vector = [&](const char* name, double* to) {
    const Element* x = reader.only(e, name);
    if (!x) return;
    reader.unread(*x, {"xyz"}, {});
    if (const auto a = reader.vector3(*x, "xyz")) std::copy(a->begin(), a->end(), to);
  };
  vector("axis", c.axis), vector("axis2", c.axis2);
  return out;
}

}  // namespace

const char* constraint_type_name(const dynConstraint& c) {
  return c.type == DYN_CONSTRAINT_TYPE_LOOP ? name_of(c.joint_type) : name_of(c.type);
}

void read_constraints(const Element& block, Report& report, std::vector<UrdfConstraint>& out, Budget* budget) {
  Reader{report, "<libdyn>"}.unread(block, {}, {"constraint"});
  for (const Element* e = first(block, "constraint"); e; e = next(*e, "constraint")) {
    out.push_back(read_constraint(*e, report));
    Constraint c{};
    c.type = out.back().spec.type, c.joint_type = out.back().spec.joint_type;
    if (budget) budget->add_rows(constraint_rows(c), report, line(*e));
  }
}

}  // namespace dyn::load
