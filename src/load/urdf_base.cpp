// Decides whether the root link is fixed or floating.
#include "urdf_robot.hpp"

namespace dyn::load {

bool floating_base(const UrdfRobot& robot, const UrdfTree& tree, dynBase base, Report& report) {
  const UrdfLink& root = robot.links[tree.root];
  const std::string called = "the root link " + in_quotes(root.name);

  // Mass of the root and everything welded to it.
  double welded = root.mass;
  std::vector<char> rigid(robot.links.size());
  rigid[tree.root] = 1;
  const UrdfJoint* free_child = nullptr;
  for (int j : tree.order) {
    if (!rigid[tree.parent[j]]) continue;
    if (robot.joints[j].spec.type == DYN_JOINT_TYPE_FREE_FLYER && !free_child) free_child = &robot.joints[j];
    if (robot.joints[j].spec.type != DYN_JOINT_TYPE_FIXED) continue;
    rigid[tree.child[j]] = 1;
    welded += robot.links[tree.child[j]].mass;
  }

  switch (base) {
    case DYN_BASE_FIXED:
      return false;
    case DYN_BASE_UNSPECIFIED:
      if (root.mass > 0)
        report.fail(DYN_ERROR_BASE, root.line,
                    called + " has mass, but no base was chosen: load the robot with base fixed or base floating");
      if (root.name == "world" || welded == 0)
        report.info(root.line, called + " has no mass: it is welded to the world");
      else
        report.warning(root.line, called + " has no mass and no base was given: it is welded to the world, and " + text(welded) +
                                      " kg with it; for a robot that floats choose base floating");
      return false;
    case DYN_BASE_FLOATING:
      break;
    default:
      report.fail(DYN_ERROR_ARGUMENT, 0,
                  "base " + std::to_string(int(base)) + " does not exist: choose base fixed or base floating");
  }

  if (free_child)
    report.fail(DYN_ERROR_BASE, free_child->line,
                "joint " + in_quotes(free_child->spec.name) + " is floating already: choose base fixed");
  if (welded == 0)
    report.fail(
        DYN_ERROR_BASE, root.line,
        called + " and the links welded to it have no mass, so it cannot float: choose base fixed, or give it an <inertial>");
  if (root.name == "world")
    report.warning(root.line, "the file joins the robot to link 'world': with base floating this link floats with it");
  for (const UrdfJoint& j : robot.joints)
    if (j.spec.name == "root_joint")
      report.fail(DYN_ERROR_NAME, j.line, "joint 'root_joint': a floating base needs this name for itself: rename the joint");
  return true;
}

}  // namespace dyn::load
