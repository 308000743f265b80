// Constraints between frames and between joints.
#include <algorithm>

#include "builder_impl.hpp"
#include "model/constraints.hpp"

namespace dyn {

void Builder::Impl::check_constraint_name(const std::string& name) const {
  if (name.empty()) refuse(DYN_ERROR_ARGUMENT, "the constraint has no name: give one");
  if (name.find('\0') != std::string::npos)
    refuse(DYN_ERROR_ARGUMENT, "constraint '" + std::string(name.c_str()) + "': the name holds a zero byte");
  if (names.constraints.find(constraints, name) >= 0)
    refuse(DYN_ERROR_NAME, "constraint '" + name + "' exists already: choose another name");
}

void Builder::constraint(const std::string& name, const dynConstraint& spec, const Parent& first, const Parent& second,
                         const Compliance& compliance) {
  impl->check_constraint_name(name);
  const std::string who = "constraint '" + name + "'";
  char message[256];
  if (const dynStatus status = check_constraint_numbers(spec, message, sizeof message)) refuse(status, who + ": " + message);
  if (spec.type == DYN_CONSTRAINT_TYPE_NONE)
    refuse(DYN_ERROR_ARGUMENT, who + ": its type is NONE: spare slots are empty by themselves");
  ConstraintEntry entry{name, spec, -1, -1, compliance};
  if (between_joints(spec.type)) {
    const auto joint = [&](const std::string& of) {
      const int j = impl->find_joint(of);
      if (j < 0) refuse(DYN_ERROR_NAME, who + ": there is no moving joint '" + of + "'");
      return j;
    };
    entry.first = joint(first.name);
    if (spec.type == DYN_CONSTRAINT_TYPE_COUPLING && second.name != "universe") entry.second = joint(second.name);
  } else {
    auto frame = [&](const Parent& p) { return p.name.empty() || p.name == "universe" ? 0 : impl->find(p, who); };
    entry.first = frame(first), entry.second = frame(second);
    const FrameEntry &a = impl->frames[std::size_t(entry.first)], &b = impl->frames[std::size_t(entry.second)];
    if (a.joint == b.joint)
      refuse(DYN_ERROR_INVALID, who + ": first, '" + a.name + "', and second, '" + b.name +
                                    "', are on the same body: nothing can move between them");
  }
  impl->constraints.push_back(std::move(entry));
}

void Builder::constraint_slots(int spare) {
  if (spare < 0 || spare > 1000)
    refuse(DYN_ERROR_ARGUMENT, "constraint slots: " + std::to_string(spare) + " are asked for: give 0 to 1000");
  impl->constraint_slots = spare;
}

void Builder::contact_capacity(int contacts) {
  if (contacts < 0 || contacts > max_contacts)
    refuse(DYN_ERROR_ARGUMENT, "contact capacity: " + std::to_string(contacts) + " contacts are asked for: give 1 to " +
                                   std::to_string(max_contacts) + ", or 0 for what the shapes need");
  impl->contact_capacity = contacts;
}

std::vector<dynConstraint> constraints_of(const std::vector<ConstraintEntry>& constraints, const std::vector<Index>& id) {
  std::vector<dynConstraint> out;
  for (const ConstraintEntry& c : constraints) {
    dynConstraint spec = c.spec;
    spec.struct_size = sizeof spec;
    auto joint = [&](int j) { return j < 0 ? 0 : id[std::size_t(j)]; };
    spec.first = between_joints(spec.type) ? joint(c.first) : c.first;
    spec.second = between_joints(spec.type) ? joint(c.second) : c.second;
    out.push_back(spec);
  }
  return out;
}

Index room_for_rows(const std::vector<ConstraintEntry>& constraints, int spare) {
  Index rows = max_rows * Index(spare);
  for (const ConstraintEntry& e : constraints) {
    Constraint c{};
    c.type = e.spec.type, c.joint_type = e.spec.joint_type;
    rows += constraint_rows(c);
  }
  return rows;
}

void check_constraints(const Model& m) {
  char message[256];
  for (Index k = 0; k < m.n.constraints; ++k) {
    const ConstraintRecord& c = m.constraints()[k];
    if (const dynStatus status = check_constraint(m, c.spec, message, sizeof message))
      refuse(status, "constraint '" + std::string(m.string(c.name)) + "': " + message);
  }
}

}  // namespace dyn
