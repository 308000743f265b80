// Links and joints as one tree, and mimic relations as finite chains. No recursion: a chain may have 10^5 links.
#include <algorithm>

#include "urdf_robot.hpp"

namespace dyn::load {

namespace {

using Index = std::unordered_map<std::string_view, int>;

std::string joint_label(const UrdfJoint& j) { return "joint " + in_quotes(j.spec.name); }

// The first names of a list: "'a', 'b', 'c' and 4 more".
std::string first_names(const std::vector<std::string>& names, const char* between) {
  std::string out;
  const size_t shown = std::min<size_t>(names.size(), 8);
  for (size_t i = 0; i < shown; ++i) out += (i ? between : "") + in_quotes(names[i]);
  if (names.size() > shown) out += " and " + std::to_string(names.size() - shown) + " more";
  return out;
}

int find_link(const Index& links, const UrdfRobot& robot, const UrdfJoint& j, const std::string& name, const char* which, int at,
              const Report& report) {
  const auto found = links.find(name);
  if (found != links.end()) return found->second;
  std::vector<const std::string*> names;
  for (const UrdfLink& l : robot.links) names.push_back(&l.name);
  report.fail(DYN_ERROR_NAME, at,
              joint_label(j) + ": " + which + " link " + in_quotes(name) + " is not in the file" + did_you_mean(name, names) +
                  ": add <link name=...> or correct the name");
}

// Reports a cycle that contains or leads to `link`. Every link on the way up must have a parent joint.
[[noreturn]] void fail_cycle(const UrdfRobot& robot, const UrdfTree& tree, const std::vector<int>& parent_joint, int link,
                             const Report& report) {
  std::vector<char> seen(robot.links.size());
  while (!seen[link]) seen[link] = 1, link = tree.parent[parent_joint[link]];
  std::vector<std::string> names;
  const int start = link;
  do {
    names.push_back(robot.links[link].name);
    link = tree.parent[parent_joint[link]];
  } while (link != start);
  names.push_back(robot.links[start].name);
  std::reverse(names.begin(), names.end());
  const UrdfJoint& j = robot.joints[parent_joint[start]];
  report.fail(DYN_ERROR_INVALID, j.line,
              joint_label(j) + ": the links form a cycle: " + first_names(names, " -> ") +
                  ": a URDF is a tree, so remove one of these joints");
}

}  // namespace

UrdfTree check_tree(const UrdfRobot& robot, Report& report) {
  const int nlinks = int(robot.links.size()), njoints = int(robot.joints.size());
  Index links;
  for (int i = 0; i < nlinks; ++i) links[robot.links[i].name] = i;

  UrdfTree tree;
  std::vector<int> parent_joint(nlinks, -1);  // of each link
  std::vector<std::vector<int>> children(nlinks);
  for (int i = 0; i < njoints; ++i) {
    const UrdfJoint& j = robot.joints[i];
    const int parent = find_link(links, robot, j, j.parent, "parent", j.parent_line, report);
    const int child = find_link(links, robot, j, j.child, "child", j.child_line, report);
    if (parent == child)
      report.fail(DYN_ERROR_INVALID, j.line, joint_label(j) + " connects link " + in_quotes(j.child) + " with itself");
    if (parent_joint[child] >= 0) {
      const UrdfJoint& other = robot.joints[parent_joint[child]];
      report.fail(DYN_ERROR_INVALID, j.child_line,
                  joint_label(j) + ": link " + in_quotes(j.child) + " already is the child of " + joint_label(other) +
                      ", at line " + std::to_string(other.line) + ": a link has one parent");
    }
    parent_joint[child] = i;
    tree.parent.push_back(parent);
    tree.child.push_back(child);
    children[parent].push_back(i);
  }

  std::vector<std::string> roots;
  for (int i = 0; i < nlinks; ++i)
    if (parent_joint[i] < 0) {
      if (roots.empty()) tree.root = i;
      roots.push_back(robot.links[i].name + "' at line " + std::to_string(robot.links[i].line));
    }
  if (roots.empty()) fail_cycle(robot, tree, parent_joint, 0, report);
  if (roots.size() > 1) {
    std::string list;
    for (size_t i = 0; i < std::min<size_t>(roots.size(), 6); ++i) list += (i ? ", '" : "'") + roots[i];
    if (roots.size() > 6) list += " and " + std::to_string(roots.size() - 6) + " more";
    report.fail(DYN_ERROR_INVALID, robot.links[tree.root].line,
                std::to_string(roots.size()) + " root links: " + list + ": connect all but one by joints, or remove them");
  }

  std::vector<int> stack(children[tree.root].rbegin(), children[tree.root].rend());
  while (!stack.empty()) {
    const int j = stack.back();
    stack.pop_back();
    tree.order.push_back(j);
    const auto& for_each_below = children[tree.child[j]];
    stack.insert(stack.end(), for_each_below.rbegin(), for_each_below.rend());
  }
  if (int(tree.order.size()) != njoints) {
    std::vector<char> reached(njoints);
    for (int j : tree.order) reached[j] = 1;
    const int lost = int(std::find(reached.begin(), reached.end(), 0) - reached.begin());
    fail_cycle(robot, tree, parent_joint, tree.child[lost], report);
  }
  return tree;
}

void check_mimic(UrdfRobot& robot, Report& report) {
  Index index;
  for (size_t i = 0; i < robot.joints.size(); ++i) index[robot.joints[i].spec.name] = int(i);
  const int none = -1;
  std::vector<int> leader(robot.joints.size(), none);
  for (size_t i = 0; i < robot.joints.size(); ++i) {
    UrdfJoint& j = robot.joints[i];
    if (j.spec.mimic.empty()) continue;
    const std::string begin = joint_label(j) + " mimics " + in_quotes(j.spec.mimic);
    const auto found = index.find(j.spec.mimic);
    if (found == index.end()) {
      std::vector<const std::string*> names;
      for (const UrdfJoint& other : robot.joints) names.push_back(&other.spec.name);
      report.fail(DYN_ERROR_NAME, j.mimic_line, begin + ", which is not in the file" + did_you_mean(j.spec.mimic, names));
    }
    leader[i] = found->second;
    UrdfJoint& l = robot.joints[found->second];
    if (size_t(found->second) == i) report.fail(DYN_ERROR_INVALID, j.mimic_line, joint_label(j) + " mimics itself");
    if (l.spec.type == DYN_JOINT_TYPE_FIXED)
      report.fail(DYN_ERROR_INVALID, j.mimic_line, begin + ", which is fixed: make both fixed, or free the leader");
    if (l.spec.type == DYN_JOINT_TYPE_FREE_FLYER || l.spec.type == DYN_JOINT_TYPE_PLANAR ||
        l.spec.type == DYN_JOINT_TYPE_SPHERICAL)
      report.fail(DYN_ERROR_INVALID, j.mimic_line,
                  begin + ", a " + l.type + " joint: only revolute, continuous and prismatic ones can lead");
    for (UrdfJoint* side : {&j, &l})  // the relation is between angles
      if (side->spec.type == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED) {
        side->spec.type = DYN_JOINT_TYPE_CONTINUOUS;
        report.info(side->line, joint_label(*side) + " takes part in a mimic relation: stored as an angle, not as (cos, sin)");
      }
  }
  std::vector<char> ends(robot.joints.size());  // chains already followed to a leader
  for (size_t i = 0; i < leader.size(); ++i) {
    std::vector<int> path;
    std::vector<std::string> names;
    int j = int(i);
    for (; j != none && !ends[j]; j = leader[j]) {
      if (const auto again = std::find(path.begin(), path.end(), j); again != path.end() || path.size() > 1000) {
        if (again == path.end())
          report.fail(DYN_ERROR_LIMIT, robot.joints[i].mimic_line,
                      joint_label(robot.joints[i]) + ": more than 1000 joints mimic one another in a row, which is the limit");
        for (auto k = again; k != path.end(); ++k) names.push_back(robot.joints[*k].spec.name);
        names.push_back(robot.joints[j].spec.name);
        report.fail(DYN_ERROR_INVALID, robot.joints[j].mimic_line,
                    joint_label(robot.joints[j]) + ": mimic joints form a cycle: " + first_names(names, " -> "));
      }
      path.push_back(j);
    }
    for (int k : path) ends[k] = 1;
  }
}

}  // namespace dyn::load
