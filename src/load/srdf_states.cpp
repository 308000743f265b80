// <group_state>: joint values by name, which become named configurations.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "reader.hpp"
#include "base/portable.hpp"
#include "srdf.hpp"

namespace dyn::load {

namespace {

// A joint's coordinates from the file's numbers. Converts between an angle and (cos, sin). Returns an empty vector if the count
// is wrong.
std::vector<double> coordinates(dynJointType type, const std::vector<double>& given) {
  if (type == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED && given.size() == 1) return {math::cos(given[0]), math::sin(given[0])};
  if (type == DYN_JOINT_TYPE_CONTINUOUS && given.size() == 2) return {math::atan2(given[1], given[0])};
  return given.size() == std::size_t(joint_nq(type)) ? given : std::vector<double>();
}

// A quaternion or (cos, sin) of norm 0 is invalid.
bool is_zero_rotation(dynJointType type, const std::vector<double>& given) {
  const bool rotates = type == DYN_JOINT_TYPE_FREE_FLYER || type == DYN_JOINT_TYPE_SPHERICAL ||
                       ((type == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED || type == DYN_JOINT_TYPE_CONTINUOUS) && given.size() == 2);
  const auto begin = given.begin() + (type == DYN_JOINT_TYPE_FREE_FLYER ? 3 : 0);
  return rotates && std::all_of(begin, given.end(), [](double x) { return x == 0; });
}

struct StateReader {
  const SrdfContext& context;
  Reader reader;  // named after the state
  std::set<std::string> given = {};

  void joint(const Element& e, Srdf::State& state) {
    reader.unread(e, {"name", "value"}, {});
    const std::string name = reader.name(e, "name"), who = reader.owner + ": joint " + in_quotes(name);
    const auto known = context.joints.find(name);
    const JointSpec* spec = known == context.joints.end() ? nullptr : known->second;
    JointSpec base;
    base.name = "root_joint", base.type = DYN_JOINT_TYPE_FREE_FLYER;
    if (!spec && is_virtual(context, name)) {
      if (!context.floating) return context.report.info(line(e), who + " is not used: the base is fixed");
      spec = &base;
    }
    if (!spec) return void(known_joint(e, name, reader.owner, context));
    if (spec->type == DYN_JOINT_TYPE_FIXED) return context.report.info(line(e), who + " is fixed: its value is not used");
    if (!spec->mimic.empty())
      return context.report.info(line(e), who + " follows " + in_quotes(spec->mimic) + ": its value is not used");
    const auto value = reader.numbers(e, "value");
    if (!value) return context.report.physics(line(e), who + " has no value: not used");
    const std::vector<double> q = coordinates(spec->type, *value);
    if (q.empty())
      return context.report.physics(line(e), who + " has " + std::to_string(value->size()) + " numbers and needs " +
                                                 std::to_string(joint_nq(spec->type)) + ": not used");
    if (is_zero_rotation(spec->type, *value))
      reader.fail(DYN_ERROR_QUATERNION, e, "joint " + in_quotes(name) + ": its quaternion or (cos, sin) is zero: give norm 1");
    if (!given.insert(spec->name).second) return context.report.physics(line(e), who + " occurs twice: the first value is used");
    if (!spec->lower.empty() && (q[0] < spec->lower[0] || q[0] > spec->upper[0]))
      context.report.warning(line(e), who + " is at " + text(q[0]) + ", outside of its limits, " + text(spec->lower[0]) + " to " +
                                          text(spec->upper[0]));
    state.joints.push_back({spec->name, q});
  }
};

}  // namespace

std::vector<Srdf::State> read_states(const Element& root, const SrdfContext& context) {
  std::map<std::string, int> groups;  // number of groups with a state of this name
  std::set<std::string> known_groups, taken = {"neutral"};
  for (const Element* g = first(root, "group"); g; g = next(*g, "group"))
    if (const char* name = g->Attribute("name")) known_groups.insert(name);
  const Reader unnamed{context.report, "a group_state"};
  for (const Element* e = first(root, "group_state"); e; e = next(*e, "group_state")) ++groups[unnamed.name(*e, "name")];

  std::vector<Srdf::State> out;
  for (const Element* e = first(root, "group_state"); e; e = next(*e, "group_state")) {
    const std::string state = unnamed.name(*e, "name"), group = e->Attribute("group") ? e->Attribute("group") : "";
    StateReader in{context, {context.report, "group_state " + in_quotes(state)}};
    in.reader.unread(*e, {"name", "group"}, {"joint"});
    if (!group.empty() && !known_groups.empty() && !known_groups.count(group)) {
      std::vector<const std::string*> all;
      for (const std::string& g : known_groups) all.push_back(&g);
      context.report.physics(line(*e), in.reader.owner + ": there is no group " + in_quotes(group) + did_you_mean(group, all));
    }
    Srdf::State s{groups[state] > 1 || state == "neutral" ? group + "/" + state : state, line(*e), {}};
    if (printable(s.name) != s.name)
      in.reader.fail(DYN_ERROR_NAME, *e, "its name is not UTF-8, or has a control character in it: rename it");
    for (const Element* j = first(*e, "joint"); j; j = next(*j, "joint")) in.joint(*j, s);
    if (context.budget) {
      context.budget->add_keys(1, context.report, line(*e));
      context.budget->add_bytes(100 * std::int64_t(context.robot.joints.size()), context.report, line(*e));
    }
    if (!taken.insert(s.name).second) {
      context.report.physics(line(*e),
                             in.reader.owner + " of group " + in_quotes(group) + " occurs twice: the first one is used");
      continue;
    }
    out.push_back(std::move(s));
  }
  return out;
}

}  // namespace dyn::load
