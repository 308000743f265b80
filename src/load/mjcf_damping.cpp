// Servos with a damping ratio (MuJoCo's rule): kv = 2 ratio sqrt(kp m), 1 / m = gear^2 (M^-1)_jj at the initial configuration
// with all other joints free. Joints with a time constant T and ratio r use the same m; balls use the mean of 1 / m:
//   stiffness = m / (T r)^2      damping = 2 m / T
#include <algorithm>
#include <cmath>
#include <new>

#include "algorithm/forward_dynamics.hpp"
#include "model/block.hpp"
#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

// Diagonal of M^-1 at the configuration "qpos0", else the neutral one: the acceleration per unit force.
struct InverseInertia {
  const Model& m;
  Zeros zeros;
  Data<double> d;
  std::vector<double> zero, tau, rest, pushed;

  explicit InverseInertia(const Model& model)
      : m(model),
        zeros(data_bytes<double>(m, DYN_PART_FORWARD)),
        zero(size_t(m.n.nv)),
        tau(size_t(m.n.nv)),
        rest(size_t(m.n.nv)),
        pushed(size_t(m.n.nv)) {
    if (!zeros.memory) throw std::bad_alloc();
    data_layout(m, DYN_PART_FORWARD, zeros.memory, d);
    for (Index k = 0; k < m.n.configurations; ++k)
      if (m.string(m.configuration_names()[k]) == std::string_view("qpos0"))
        std::copy_n(m.configurations() + std::ptrdiff_t(k) * m.n.nq, m.n.nq, d.q);
    forward_dynamics(m, d, zero.data(), zero.data(), static_cast<const double*>(nullptr), rest.data());
  }
  double operator()(Index dof) {
    tau.assign(tau.size(), 0), tau[size_t(dof)] = 1;
    forward_dynamics(m, d, zero.data(), tau.data(), static_cast<const double*>(nullptr), pushed.data());
    return pushed[size_t(dof)] - rest[size_t(dof)];
  }
};

}  // namespace

bool has_springdampers(const MjcfRobot& robot) {
  return std::any_of(robot.bodies.begin(), robot.bodies.end(), [](const MjcfBody& b) {
    return std::any_of(b.joints.begin(), b.joints.end(), [](const MjcfJoint& j) { return j.time_constant > 0; });
  });
}

void compute_mjcf_springs(const Model& m, MjcfRobot& robot) {
  InverseInertia inverse_inertia(m);
  for (MjcfBody& b : robot.bodies)
    for (MjcfJoint& j : b.joints) {
      if (!(j.time_constant > 0)) continue;
      const JointRecord* const joint = std::find_if(m.joints(), m.joints() + m.n.joints,
                                                    [&](const JointRecord& r) { return m.string(r.name) == j.spec.name; });
      double inverse_inertia_jj = 0;
      for (Index k = 0; k < joint->nv; ++k) inverse_inertia_jj += inverse_inertia(joint->idx_v + k) / joint->nv;
      const double period = j.time_constant * j.damping_ratio, stiffness = 1 / (inverse_inertia_jj * period * period),
                   damping = 2 / (inverse_inertia_jj * j.time_constant);
      if (!(inverse_inertia_jj > 0) || !std::isfinite(stiffness) || !std::isfinite(damping))
        j.place.fail(DYN_ERROR_INVALID,
                     "its springdamper gives no finite stiffness and damping for its inertia: give stiffness and damping");
      if (!j.spec.stiffness.empty()) std::fill(j.spec.stiffness.begin(), j.spec.stiffness.end(), stiffness);
      std::fill(j.spec.damping.begin(), j.spec.damping.end(), damping);
    }
}

bool damped_by_ratio(const MjcfRobot& robot) {
  return std::any_of(robot.actuators.begin(), robot.actuators.end(), [](const MjcfActuator& a) { return a.damping_ratio > 0; });
}

void compute_mjcf_damping(const Model& m, MjcfRobot& robot) {
  InverseInertia inverse_inertia(m);
  for (MjcfActuator& a : robot.actuators) {
    if (!(a.damping_ratio > 0)) continue;
    const JointRecord* const joint =
        std::find_if(m.joints(), m.joints() + m.n.joints, [&](const JointRecord& j) { return m.string(j.name) == a.joint; });
    const double inverse_inertia_jj = a.spec.gear * a.spec.gear * inverse_inertia(joint->idx_v + a.spec.component);
    const bool servo = a.spec.type == DYN_ACTUATOR_TYPE_POSITION;
    const double kp = servo ? a.spec.kp : a.spec.gain,
                 kv = inverse_inertia_jj > 0 ? 2 * a.damping_ratio * std::sqrt(kp / inverse_inertia_jj) : 0;
    if (!(inverse_inertia_jj > 0) || !std::isfinite(kv))
      a.place.fail(DYN_ERROR_INVALID, "its damping is a ratio, but the joint moves no inertia: give kv");
    (servo ? a.spec.kv : a.spec.bias[2]) = servo ? kv : -kv;
  }
}

}  // namespace dyn::load
