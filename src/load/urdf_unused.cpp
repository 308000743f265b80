// Reports parameters that the model keeps and no algorithm applies by itself: one line for damping and dry friction, one for
// velocity and effort limits.
#include <algorithm>

#include "urdf_robot.hpp"

namespace dyn::load {

void report_unused_data(const UrdfRobot& robot, Report& report) {
  const auto nonzero = [](const std::vector<double>& x) {
    return std::any_of(x.begin(), x.end(), [](double e) { return e != 0; });
  };
  int damping = 0, friction = 0, velocity = 0, effort = 0;
  for (const UrdfJoint& j : robot.joints) {
    const JointSpec& s = j.spec;
    damping += nonzero(s.damping), friction += nonzero(s.friction);
    const bool limited = !s.lower.empty() || !s.velocity.empty() || !s.effort.empty();
    if (!s.mimic.empty()) {
      if (limited) report.count("<limit> of a mimicking joint: not kept", j.line);
      continue;
    }
    velocity += !s.velocity.empty(), effort += !s.effort.empty();
  }
  std::string all;
  const auto add = [&](const char* what, int n) {
    if (n) all += (all.empty() ? "" : ", ") + std::to_string(n) + " x " + what;
  };
  add("damping", damping), add("dry friction", friction);
  if (!all.empty()) report.info(0, "acts in steps, and in algorithms when its effect is switched on: " + all), all.clear();
  add("velocity limit", velocity), add("effort limit", effort);
  if (!all.empty()) report.info(0, "kept as data, not applied by the algorithms: " + all);
}

}  // namespace dyn::load
