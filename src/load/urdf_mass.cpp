// Strict: every joint must move mass. Otherwise its acceleration under a force is undefined.
#include <algorithm>

#include "urdf_robot.hpp"

namespace dyn::load {

void check_moving_mass(const UrdfRobot& robot, const UrdfTree& tree, Report& report) {
  const int njoints = int(robot.joints.size());
  std::vector<char> has_mass(robot.links.size());  // the link, or anything beyond it
  for (size_t i = 0; i < robot.links.size(); ++i) {
    const UrdfLink& l = robot.links[i];
    has_mass[i] = l.mass > 0 || l.moments[2] > 0;
  }
  for (auto j = tree.order.rbegin(); j != tree.order.rend(); ++j)
    if (has_mass[tree.child[*j]]) has_mass[tree.parent[*j]] = 1;

  // A mimic joint's mass counts for its leader. check_mimic has verified that the chains end.
  std::unordered_map<std::string_view, int> index;
  for (int j = 0; j < njoints; ++j) index[robot.joints[j].spec.name] = j;
  std::vector<char> moves(njoints);
  for (int j = 0; j < njoints; ++j) {
    if (!has_mass[tree.child[j]]) continue;
    for (int k = j; !moves[k];) {
      moves[k] = 1;
      if (!robot.joints[k].spec.mimic.empty()) k = index[robot.joints[k].spec.mimic];
    }
  }

  std::vector<int> massless;
  for (int j : tree.order) {
    const JointSpec& s = robot.joints[j].spec;
    if (s.type != DYN_JOINT_TYPE_FIXED && s.mimic.empty() && !moves[j]) massless.push_back(j);
  }
  if (massless.empty()) return;
  std::string others;
  for (size_t i = 1; i < std::min<size_t>(massless.size(), 6); ++i)
    others += (i > 1 ? ", " : "; so also ") + in_quotes(robot.joints[massless[i]].spec.name);
  if (massless.size() > 6) others += " and " + std::to_string(massless.size() - 6) + " more";
  const UrdfJoint& first = robot.joints[massless[0]];
  report.fail(
      DYN_ERROR_INVALID, first.line,
      "joint " + in_quotes(first.spec.name) + ": neither link " + in_quotes(first.child) +
          " nor anything on it has mass, so that forward dynamics is undefined: give it an <inertial>, or make the joint fixed" +
          others);
}

}  // namespace dyn::load
