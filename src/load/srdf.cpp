// The top level of an SRDF: what is used, and what is reported with its line.
#include "srdf.hpp"

#include <algorithm>
#include <filesystem>

#include "file.hpp"
#include "reader.hpp"

namespace dyn::load {

namespace {

const std::initializer_list<std::string_view> srdf_elements = {
    "group_state",  "disable_collisions", "enable_collisions", "disable_default_collisions", "virtual_joint", "group",
    "end_effector", "passive_joint",      "joint_property",    "link_sphere_approximation",  "gripper",       "handle",
    "contact",      "specificities",      "rotor_params"};

constexpr int max_suggestions = 100;  // each looks at all names

void report_unknown(const Element& e, const char* kind, const std::string& name, const std::string& owner,
                    const SrdfContext& context, const std::vector<const std::string*>& all) {
  const std::string suggestion = ++context.unknown <= max_suggestions ? did_you_mean(name, all) : "";
  context.report.physics(line(e), owner + ": there is no " + kind + " " + in_quotes(name) + " in the robot" + suggestion);
}

// Checks names that groups and similar elements refer to.
void check_references(const Element& e, const std::string& owner, const SrdfContext& context) {
  for (const char* attribute : {"base_link", "tip_link", "parent_link", "child_link", "link"})
    if (const char* name = e.Attribute(attribute)) known_link(e, name, owner, context);
  for (const Element* c = first(e); c; c = next(*c)) {
    const std::string_view kind = c->Name();
    const char* name = c->Attribute("name");
    if (name && kind == "link") known_link(*c, name, owner, context);
    if (name && kind == "joint" && !is_virtual(context, name)) known_joint(*c, name, owner, context);
    if (kind == "chain") check_references(*c, owner, context);
  }
}

void list_unused(const Element& root, const SrdfContext& context) {
  for (const Element* e = first(root); e; e = next(*e)) {
    const std::string kind = e->Name();
    const std::string name = e->Attribute("name") ? e->Attribute("name") : "";
    const std::string owner = kind + (name.empty() ? "" : " " + in_quotes(name));
    if (kind == "virtual_joint") {
      context.report.info(line(*e),
                          owner + ": the base is " + (context.floating ? "floating" : "fixed") + ", as chosen at loading");
      check_references(*e, owner, context);
    } else if (kind == "group" || kind == "end_effector" || kind == "link_sphere_approximation") {
      context.report.info(line(*e), owner + ": not used");
      check_references(*e, owner, context);
    } else if (kind == "passive_joint" || kind == "joint_property") {
      const char* joint = kind == "passive_joint" ? e->Attribute("name") : e->Attribute("joint_name");
      context.report.info(line(*e),
                          kind + (joint ? " " + in_quotes(joint) : "") + ": not used: forces on joints are the caller's");
      if (joint && !is_virtual(context, joint)) known_joint(*e, joint, kind, context);
    } else if (kind == "rotor_params") {
      context.report.physics(line(*e), "<rotor_params>: the rotors' inertias are not used");
    } else if (kind == "gripper" || kind == "handle" || kind == "contact" || kind == "specificities") {
      context.report.count("<" + kind + ">: not used", line(*e));
    }
  }
}

}  // namespace

bool is_virtual(const SrdfContext& context, const std::string& joint) {
  return joint == "root_joint" || context.virtual_joints.count(joint);
}

bool known_link(const Element& e, const std::string& name, const std::string& owner, const SrdfContext& context) {
  if (context.links.count(name)) return true;
  std::vector<const std::string*> all;
  for (const UrdfLink& l : context.robot.links) all.push_back(&l.name);
  return report_unknown(e, "link", name, owner, context, all), false;
}
bool known_joint(const Element& e, const std::string& name, const std::string& owner, const SrdfContext& context) {
  if (context.joints.count(name)) return true;
  std::vector<const std::string*> all;
  for (const UrdfJoint& j : context.robot.joints) all.push_back(&j.spec.name);
  return report_unknown(e, "joint", name, owner, context, all), false;
}

Srdf load_srdf(const LoadOptions& options, const UrdfRobot& robot, const UrdfTree& tree, bool floating,
               std::vector<Report::Entry>& entries) {
  const std::string& file = options.srdf;
  Report report(file, options.strict);
  const std::string text = read_file(file, "an SRDF file", options.confined ? FileKind::Regular : FileKind::Pipe);
  const std::int64_t bytes = check_xml(text, report);
  if (options.budget) options.budget->add_bytes(bytes, report, 0);
  const Document document(text, report);
  const Element& root = document.root();
  if (std::string_view(root.Name()) != "robot" || first(root, "link"))
    report.fail(DYN_ERROR_PARSE, line(root),
                first(root, "link") ? "this is a URDF: an SRDF has no links of its own"
                                    : "<" + std::string(root.Name()).substr(0, 60) + ">: an SRDF begins with <robot>");
  Reader{report, "the SRDF"}.unread(root, {"name", "version"}, srdf_elements);
  if (const char* name = root.Attribute("name"); name && name != robot.name)
    report.warning(line(root), "this SRDF is for robot " + in_quotes(name) + ", and the robot is " + in_quotes(robot.name));
  SrdfContext context{robot, robot.links[std::size_t(tree.root)].name, floating, report, options.budget};
  for (const UrdfLink& l : robot.links) context.links.insert(l.name);
  for (const UrdfJoint& j : robot.joints) context.joints.emplace(j.spec.name, &j.spec);
  for (const Element* e = first(root, "virtual_joint"); e; e = next(*e, "virtual_joint"))
    if (const char* virtual_name = e->Attribute("name")) context.virtual_joints.insert(virtual_name);
  Srdf out;
  out.states = read_states(root, context);
  out.pairs = read_pairs(root, context);
  list_unused(root, context);
  const std::string begin = std::filesystem::path(file).filename().string() + ": ";
  for (Report::Entry& e : report.finish()) entries.push_back({e.level, e.line, printable(begin) + e.message});
  return out;
}

}  // namespace dyn::load
