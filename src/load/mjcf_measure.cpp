// Numbers that follow from inertias and lengths, from a model with motors in place of the actuators. By MuJoCo's rules, with
// the moment arms J of an actuator at the initial configuration, where all joints are free:
//   servos with a damping ratio: kv = 2 ratio sqrt(kp m), 1 / m = J M^-1 J'
//   muscles without a force: force = scale / |M^-1 J'|
// Joints with a time constant T and ratio r use the same m; balls use the mean of 1 / m:
//   stiffness = m / (T r)^2      damping = 2 m / T
#include <algorithm>
#include <cmath>
#include <vector>

#include "algorithm/forward_dynamics.hpp"
#include "mjcf_length.hpp"

namespace dyn::load {

namespace {

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

// M^-1, with the armature of tendons, at the configuration "qpos0", else the neutral one.
struct InverseInertia {
  MeasuredModel& at;
  std::vector<double> zero, rest;
  std::vector<std::vector<double>> taken;  // u of each tendon with armature: M^-1 loses u u'

  explicit InverseInertia(MeasuredModel& model)
      : at(model), zero(size_t(at.m.n.nv)), rest(size_t(at.m.n.nv)) {
    at.place(at.initial);
    forward_dynamics(at.m, at.d, zero.data(), zero.data(), static_cast<const double*>(nullptr), rest.data());
    for (Index k = 0; k < at.m.n.tendons; ++k) {
      const double armature = at.m.tendons()[k].spec.armature;
      if (!(armature > 0)) continue;
      const std::vector<double> arms = at.path_arms(k);
      std::vector<double> u = times(arms);
      const double scale = 1 / std::sqrt(1 / armature + product(arms, u));
      for (double& x : u) x *= scale;
      taken.push_back(std::move(u));
    }
  }
  // M^-1 x
  std::vector<double> times(const std::vector<double>& x) {
    std::vector<double> out(x.size());
    forward_dynamics(at.m, at.d, zero.data(), x.data(), static_cast<const double*>(nullptr), out.data());
    for (size_t k = 0; k < out.size(); ++k) out[k] -= rest[k];
    for (const std::vector<double>& u : taken) {
      const double along = product(u, x);
      for (size_t k = 0; k < out.size(); ++k) out[k] -= along * u[k];
    }
    return out;
  }
};

bool is_measured(const MjcfActuator& a) { return a.damping_ratio > 0 || a.muscle_scale > 0 || needs_length_range(a); }

void set_damping(InverseInertia& inverse_inertia, const std::vector<double>& arms, MjcfActuator& a) {
  const bool servo = a.spec.type == DYN_ACTUATOR_TYPE_POSITION || a.spec.type == DYN_ACTUATOR_TYPE_PID;
  const double kp = servo ? a.spec.kp : a.spec.gain, inverse_mass = product(arms, inverse_inertia.times(arms)),
               kv = inverse_mass > 0 ? 2 * a.damping_ratio * std::sqrt(kp / inverse_mass) : 0;
  if (!(inverse_mass > 0) || !std::isfinite(kv))
    a.place.fail(DYN_ERROR_INVALID, "its damping is a ratio, but " +
                                        std::string(a.spec.transmission == DYN_TRANSMISSION_JOINT ? "the joint" : "it") +
                                        " moves no inertia: give kv");
  (servo ? a.spec.kv : a.spec.bias[2]) = servo ? kv : -kv;
}

void set_force(InverseInertia& inverse_inertia, const std::vector<double>& arms, MjcfActuator& a) {
  const std::vector<double> acceleration = inverse_inertia.times(arms);
  const double force = a.muscle_scale / std::sqrt(product(acceleration, acceleration));
  if (!std::isfinite(force))
    a.place.fail(DYN_ERROR_INVALID, "its force follows from the inertia that it moves, which is none: give force");
  a.spec.muscle.force = force;
}

}  // namespace

bool has_springdampers(const MjcfRobot& robot) {
  return std::any_of(robot.bodies.begin(), robot.bodies.end(), [](const MjcfBody& b) {
    return std::any_of(b.joints.begin(), b.joints.end(), [](const MjcfJoint& j) { return j.time_constant > 0; });
  });
}

void compute_mjcf_springs(const Model& m, MjcfRobot& robot) {
  MeasuredModel measured(m);
  InverseInertia inverse_inertia(measured);
  for (MjcfBody& b : robot.bodies)
    for (MjcfJoint& j : b.joints) {
      if (!(j.time_constant > 0)) continue;
      const JointRecord* const joint = &model_joint(m, j.spec.name);
      double inverse_inertia_jj = 0;
      for (Index k = 0; k < joint->nv; ++k) {
        std::vector<double> unit(size_t(m.n.nv));
        unit[size_t(joint->idx_v + k)] = 1;
        inverse_inertia_jj += product(unit, inverse_inertia.times(unit)) / joint->nv;
      }
      const double period = j.time_constant * j.damping_ratio, stiffness = 1 / (inverse_inertia_jj * period * period),
                   damping = 2 / (inverse_inertia_jj * j.time_constant);
      if (!(inverse_inertia_jj > 0) || !std::isfinite(stiffness) || !std::isfinite(damping))
        j.place.fail(DYN_ERROR_INVALID,
                     "its springdamper gives no finite stiffness and damping for its inertia: give stiffness and damping");
      if (!j.spec.stiffness.empty()) std::fill(j.spec.stiffness.begin(), j.spec.stiffness.end(), stiffness);
      std::fill(j.spec.damping.begin(), j.spec.damping.end(), damping);
    }
}

bool has_measured_actuators(const MjcfRobot& robot) {
  return std::any_of(robot.actuators.begin(), robot.actuators.end(), is_measured);
}

void add_mjcf_motors(Builder& builder, const MjcfRobot& robot) {
  for (const MjcfActuator& a : robot.actuators)
    if (is_measured(a)) {
      dynActuator spec = default_actuator(DYN_ACTUATOR_TYPE_MOTOR);
      spec.transmission = a.spec.transmission, spec.component = a.spec.component, spec.gear = a.spec.gear;
      std::copy_n(a.spec.wrench, 6, spec.wrench), spec.rod = a.spec.rod, spec.in_parent = a.spec.in_parent;
      add_mjcf_actuator(builder, robot, a, spec);
    }
}

void measure_mjcf_actuators(const Model& m, MjcfRobot& robot) {
  MeasuredModel measured(m);
  InverseInertia inverse_inertia(measured);
  const ActuatorRecord* motor = m.actuators();
  for (MjcfActuator& a : robot.actuators) {
    if (!is_measured(a)) continue;
    measured.place(measured.initial);
    const std::vector<double> arms = measured.arms(*motor);
    if (a.damping_ratio > 0) set_damping(inverse_inertia, arms, a);
    if (a.muscle_scale > 0) set_force(inverse_inertia, arms, a);
    if (needs_length_range(a)) set_length_range(measured, *motor, robot, a);
    ++motor;
  }
}

}  // namespace dyn::load
