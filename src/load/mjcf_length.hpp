// Lengths of actuators, and their ranges.
#pragma once

#include "algorithm/paths.hpp"
#include "model/block.hpp"
#include "mjcf_robot.hpp"

namespace dyn::load {

// A model with data, for its lengths and moment arms.
struct MeasuredModel {
  const Model& m;
  Zeros zeros;
  Data<double> d;
  std::vector<double> initial;  // the configuration "qpos0", else the neutral one

  explicit MeasuredModel(const Model& model);
  void place(const std::vector<double>& q);
  // dl/dq, where the model was placed last.
  std::vector<double> path_arms(Index path);
  std::vector<double> arms(const ActuatorRecord& a);
  double length(const ActuatorRecord& a);

 private:
  void measure(Index path);
};

// The joint of that name, which is in the model.
const JointRecord& model_joint(const Model& m, const std::string& name);

// A muscle whose range of lengths the file leaves open.
bool needs_length_range(const MjcfActuator& a);
// Sets the smallest and the largest length of a muscle over the ranges of the joints that move it. Where they have none, it
// becomes inert.
void set_length_range(MeasuredModel& at, const ActuatorRecord& motor, MjcfRobot& robot, MjcfActuator& muscle);

}  // namespace dyn::load
