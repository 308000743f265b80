// The top level of a URDF: <robot>, its links and joints in order, and blocks of other programs.
#include <algorithm>

#include "budget.hpp"
#include "reader.hpp"
#include "urdf_robot.hpp"

namespace dyn::load {

namespace {

const std::initializer_list<std::string_view> urdf_elements = {
    "link",   "joint",  "gazebo", "transmission", "material", "sensor",   "ros2_control",
    "mujoco", "webots", "group",  "actuator",     "hardware", "isaac_sim",    "libdyn"};

// Visits every element below e without recursion.
template <class Visit>
void for_each_below(const Element& e, const Visit& visit) {
  const tinyxml2::XMLNode* n = e.FirstChild();
  while (n) {
    if (const Element* c = n->ToElement()) visit(*c);
    if (n->FirstChild()) {
      n = n->FirstChild();
      continue;
    }
    while (n && !n->NextSibling()) {
      n = n->Parent();
      if (n == static_cast<const tinyxml2::XMLNode*>(&e)) return;
    }
    if (n) n = n->NextSibling();
  }
}

// Counts blocks of other programs. Warns if such a block hides mechanics that the model then lacks.
void report_foreign_block(const Element& e, Report& report) {
  const std::string_view name = e.Name();
  if (name == "gazebo")
    report.count("<gazebo>: settings of another simulator, not used", line(e));
  else if (name == "transmission")
    report.count("<transmission>: not used (mechanicalReduction and actuators do not change the mechanics)", line(e));
  else
    report.count("<" + std::string(name) + ">: not used", line(e));
  for_each_below(e, [&](const Element& c) {
    const std::string_view inner = c.Name();
    const auto hidden = [&](const std::string& what) {
      report.physics(line(c), "<" + std::string(inner) + "> in <" + std::string(name) + ">: " + what + " is not used");
    };
    if (name == "gazebo" && inner == "joint" && c.FirstChildElement()) hidden("a joint (a closed loop?)");
    if (inner == "springStiffness" || inner == "spring_stiffness") hidden("a spring");
    if (inner == "drake:rotor_inertia" || inner == "rotorInertia" || inner == "rotor_inertia") hidden("the rotor's inertia");
  });
}

// Names become frame names, JSON keys and words in messages.
void check_name(const char* kind, const std::string& name, int at_line, Report& report) {
  const std::string label = kind + std::string(" ");
  if (printable(name) != name)
    report.fail(DYN_ERROR_NAME, at_line,
                label + "name " + in_quotes(name) +
                    " is not UTF-8, or has a control character in it: rename it, or save the file as UTF-8");
  if (name == "universe")
    report.fail(DYN_ERROR_NAME, at_line, label + "'universe': this is the name of the world itself: rename it");
}

template <class Item>
void check_names(const char* kind, const std::vector<Item>& items, Report& report) {
  std::unordered_map<std::string_view, int> seen;
  for (const Item& t : items) {
    const std::string* name;
    if constexpr (requires { t.spec; })
      name = &t.spec.name;
    else
      name = &t.name;
    check_name(kind, *name, t.line, report);
    const auto [other, added] = seen.try_emplace(*name, t.line);
    if (!added)
      report.fail(DYN_ERROR_NAME, t.line,
                  kind + std::string(" ") + in_quotes(*name) + ": another " + kind + " has this name, at line " +
                      std::to_string(other->second));
  }
}

}  // namespace

UrdfRobot read_urdf(const Element& root, Report& report, const LoadOptions& options) {
  if (std::string_view(root.Name()) != "robot")
    report.fail(DYN_ERROR_PARSE, line(root), "<" + std::string(root.Name()).substr(0, 60) + ">: a URDF begins with <robot>");
  const Reader reader{report, "the robot"};
  UrdfRobot robot;
  if (const char* name = root.Attribute("name"); name && *name) {
    robot.name = name;
    if (printable(robot.name) != robot.name)
      report.fail(DYN_ERROR_NAME, line(root), "<robot name> is not UTF-8, or has a control character in it: rename it");
  } else {
    report.warning(line(root), "<robot> has no name");
  }
  if (const char* version = root.Attribute("version"); version && *version) {
    const std::string v = version;
    if (v != "1" && !v.starts_with("1."))
      report.fail(DYN_ERROR_UNSUPPORTED, line(root), "<robot version=\"" + v.substr(0, 20) + "\">: URDF 1.0 to 1.2 are read");
  }
  reader.unread(root, {"name", "version"}, urdf_elements);

  MeshPaths meshes(report.file(), options.package_dirs);
  Budget* const budget = options.budget;
  const Colours colours = urdf_colours(root);
  for (const Element* e = first(root); e; e = next(*e)) {
    const std::string_view name = e->Name();
    if (name == "link") {
      if (budget) budget->add_bodies(1, report, line(*e));
      robot.links.push_back(read_link(*e, report, meshes, colours));
      if (budget) budget->add_shapes(std::int64_t(robot.links.back().shapes.size()), report, line(*e));
    } else if (name == "joint") {
      if (budget) budget->add_joints(1, report, line(*e));
      robot.joints.push_back(read_joint(*e, report, options));
    } else if (name == "libdyn")
      read_constraints(*e, report, robot.constraints, budget);
    else if (name != "material" && std::find(urdf_elements.begin(), urdf_elements.end(), name) != urdf_elements.end())
      report_foreign_block(*e, report);
  }
  if (robot.links.empty())
    report.fail(
        DYN_ERROR_INVALID, line(root),
        "the robot has no links" + std::string(root.Attribute("xmlns:xacro") ? ": did xacro run without its arguments?" : ""));
  check_names("link", robot.links, report);
  check_names("joint", robot.joints, report);
  return robot;
}

}  // namespace dyn::load
