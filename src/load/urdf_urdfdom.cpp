// Second reading by urdfdom, the parser of ROS. Where the readings differ, one of them would simulate another robot.
#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <thread>

#include "urdf_robot.hpp"
#include "base/portable.hpp"

namespace dyn::load {

namespace {

// urdfdom frees chains of links by recursion, so larger robots are not compared.
constexpr size_t max_links = 20000;

// Captures urdfdom's messages of this thread. Messages of other threads go to the previous handler.
class CapturedMessages : public console_bridge::OutputHandler {
 public:
  CapturedMessages() : before_(console_bridge::getOutputHandler()) { console_bridge::useOutputHandler(this); }
  ~CapturedMessages() override {
    console_bridge::useOutputHandler(before_);
    console_bridge::useOutputHandler(before_);  // twice: it also stores the previous handler, which must not be this object
  }
  void log(const std::string& text, console_bridge::LogLevel level, const char* file, int line) override {
    if (std::this_thread::get_id() == thread_)
      lines.push_back(text);
    else if (before_)
      before_->log(text, level, file, line);
  }
  std::vector<std::string> lines;

 private:
  console_bridge::OutputHandler* before_;
  std::thread::id thread_ = std::this_thread::get_id();
};

// urdfdom passes words of the file to printf as formats, so '%' must not occur, not even as a character reference.
std::string without_percent(std::string text) {
  std::replace(text.begin(), text.end(), '%', '_');
  return text;
}
bool has_references(const std::string& text) { return text.find("&#") != std::string::npos; }

struct UrdfdomModel {
  urdf::ModelInterfaceSharedPtr model;
  std::string refusal;

  explicit UrdfdomModel(const std::string& text) {
    static std::mutex one_at_a_time;  // console_bridge has one handler for the process
    const std::lock_guard lock(one_at_a_time);
    CapturedMessages messages;
    try {
      model = urdf::parseURDF(without_percent(text));
    } catch (const std::exception& e) {
      messages.lines.push_back(e.what());
    }
    if (!model) refusal = messages.lines.empty() ? "no reason given" : messages.lines.front();
  }
  ~UrdfdomModel() {  // breaks the ownership chain of links
    if (!model) return;
    for (auto& [name, link] : model->links_) link->child_links.clear(), link->child_joints.clear();
  }
};

bool near(double a, double b, double scale = 1) { return std::abs(a - b) <= 1e-9 * std::max({scale, std::abs(a), std::abs(b)}); }

bool same(const Placement& X, const urdf::Pose& pose) {
  double x, y, z, w;
  pose.rotation.getQuaternion(x, y, z, w);
  const double R[9] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z),     2 * (x * z - w * y),  //
                       2 * (x * y - w * z),     1 - 2 * (x * x + z * z), 2 * (y * z + w * x),  //
                       2 * (x * z + w * y),     2 * (y * z - w * x),     1 - 2 * (x * x + y * y)};
  for (int i = 0; i < 9; ++i)
    if (!near(X[i], R[i])) return false;
  return near(X[9], pose.position.x) && near(X[10], pose.position.y) && near(X[11], pose.position.z);
}

// Returns "" or what differs.
std::string difference(const UrdfLink& l, const urdf::Link& other) {
  if ((l.inertial_line > 0) != bool(other.inertial)) return "<inertial>";
  if (!other.inertial) return "";
  const urdf::Inertial& i = *other.inertial;
  if (l.mass != i.mass) return "mass";
  if (!near(l.com[0], i.origin.position.x) || !near(l.com[1], i.origin.position.y) || !near(l.com[2], i.origin.position.z))
    return "centre of mass";
  const double trace = i.ixx + i.iyy + i.izz;
  if (!near(l.inertia[0] + l.inertia[4] + l.inertia[8], trace, 0) && std::abs(trace) > 1e-300) return "inertia";
  return "";
}

std::string difference(const UrdfJoint& j, const urdf::Joint& other) {
  const JointSpec& s = j.spec;
  if (without_percent(j.parent) != other.parent_link_name) return "parent";
  if (without_percent(j.child) != other.child_link_name) return "child";
  if (!same(s.placement, other.parent_to_joint_origin_transform)) return "origin";
  const bool has_axis = s.type != DYN_JOINT_TYPE_FIXED && s.type != DYN_JOINT_TYPE_FREE_FLYER;
  if (has_axis) {
    const double norm = math::hypot(other.axis.x, other.axis.y, other.axis.z);
    if (!near(s.axis[0] * norm, other.axis.x, norm) || !near(s.axis[1] * norm, other.axis.y, norm) ||
        !near(s.axis[2] * norm, other.axis.z, norm))
      return "axis";
  }
  if (!s.lower.empty() && (!other.limits || s.lower[0] != other.limits->lower || s.upper[0] != other.limits->upper))
    return "limit";
  if (!s.effort.empty() && (!other.limits || s.effort[0] != other.limits->effort)) return "limit effort";
  if (!s.velocity.empty() && (!other.limits || s.velocity[0] != other.limits->velocity)) return "limit velocity";
  if (!s.damping.empty() && (!other.dynamics || s.damping[0] != other.dynamics->damping)) return "damping";
  if (!s.friction.empty() && (!other.dynamics || s.friction[0] != other.dynamics->friction)) return "friction";
  if (!s.mimic.empty() && (!other.mimic || without_percent(s.mimic) != other.mimic->joint_name ||
                           s.mimic_ratio != other.mimic->multiplier || s.mimic_offset != other.mimic->offset))
    return "mimic";
  return "";
}

}  // namespace

void compare_with_urdfdom(const std::string& text, const UrdfRobot& robot, const UrdfTree& tree, Report& report) {
  if (robot.links.size() > max_links) {
    report.info(0, "more than " + std::to_string(max_links) + " links: not read a second time by urdfdom");
    return;
  }
  if (has_references(text)) {
    report.info(0, "character references (&#...;): not read a second time by urdfdom");
    return;
  }
  const UrdfdomModel urdfdom(text);
  if (!urdfdom.model) {
    report.info(0, "urdfdom, the parser of ROS, refuses this file: " + urdfdom.refusal);
    return;
  }
  const auto differs = [&](int line, const std::string& what) {
    report.physics(line, what + ": urdfdom, the parser of ROS, reads this differently; libdyn's reading counts");
  };
  if (urdfdom.model->links_.size() != robot.links.size()) differs(0, "the number of links");
  if (urdfdom.model->joints_.size() != robot.joints.size()) differs(0, "the number of joints");
  if (!urdfdom.model->getRoot() || urdfdom.model->getRoot()->name != without_percent(robot.links[tree.root].name))
    differs(0, "the root link");
  for (const UrdfLink& l : robot.links) {
    const auto other = urdfdom.model->getLink(without_percent(l.name));
    if (const std::string what = other ? difference(l, *other) : "the link"; !what.empty())
      differs(l.line, "link " + in_quotes(l.name) + ": " + what);
  }
  for (const UrdfJoint& j : robot.joints) {
    const auto other = urdfdom.model->getJoint(without_percent(j.spec.name));
    if (const std::string what = other ? difference(j, *other) : "the joint"; !what.empty())
      differs(j.line, "joint " + in_quotes(j.spec.name) + ": " + what);
  }
}

}  // namespace dyn::load
