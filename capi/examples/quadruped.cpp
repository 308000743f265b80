// A quadruped in four stages: sizes, feet, forces, and two threads that share the model. tools/test --tsan runs it under
// ThreadSanitizer.
//   quadruped ROBOT.urdf
// capi/python/examples/quadruped_project.py is the same in Python.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <dyn.hpp>
#include <thread>

namespace {

void claim(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "this does not hold: %s\n", what);
  std::exit(1);
}
double largest_difference(const double* a, const double* b, std::size_t n) {
  double out = 0;
  for (std::size_t k = 0; k < n; ++k) out = std::max(out, std::abs(a[k] - b[k]));
  return out;
}

// Stage 1. A robot: its model, which threads share, and its data, one for each thread.
struct RobotModel {
  dyn::Model model;
  dyn::Data data;
  std::vector<int> feet;

  explicit RobotModel(const std::string& file)
      : model(dyn::Model::load(file, dyn::LoadOptions().base(DYN_BASE_FLOATING))), data(model) {
    for (const char* foot : {"FL_foot", "FR_foot", "RL_foot", "RR_foot"}) feet.push_back(model.frame_id(foot));
  }
  dyn::Vector standing() const {
    dyn::Vector q = model.neutral();
    for (std::size_t leg = 0; leg < 4; ++leg) {
      q[7 + 3 * leg + 1] = 0.8;   // thigh
      q[7 + 3 * leg + 2] = -1.6;  // calf
    }
    return q;
  }
};

void print_sizes(const RobotModel& robot, const std::string& file) {
  const dyn::Model& m = robot.model;
  claim(m.nq() == 19 && m.nv() == 18 && m.njoints() == 14, "position and quaternion, twelve angles; the universe is joint 0");
  bool refused = false;
  try {
    dyn::Model::load(file);
  } catch (const dyn::Error& error) {
    refused = error.status() == DYN_ERROR_BASE;
  }
  claim(refused, "a base is never guessed");
  std::printf("1. %s: nq %d, nv %d, %d joints, %d frames, %.4g kg\n", m.name().c_str(), m.nq(), m.nv(), m.njoints(), m.nframes(),
              m.total_mass());
}

// Stage 2. Positions and 6 x 18 Jacobians: J v is the twist.
void print_feet(RobotModel& robot, const dyn::Vector& q, const dyn::Vector& v) {
  robot.data.forward_kinematics(q, v);
  std::printf("2. feet at");
  for (const int foot : robot.feet) {
    const dyn::Matrix J = robot.data.frame_jacobian(foot, DYN_REFERENCE_LOCAL_WORLD_ALIGNED);
    const dyn::Vector6 twist = robot.data.frame_velocity(foot, DYN_REFERENCE_LOCAL_WORLD_ALIGNED);
    dyn::Vector6 product{};
    for (int c = 0; c < 18; ++c)
      for (int r = 0; r < 6; ++r) product[static_cast<std::size_t>(r)] += J(r, c) * v[static_cast<std::size_t>(c)];
    claim(J.rows == 6 && J.cols == 18 && largest_difference(product.data(), twist.data(), 6) < 1e-13,
          "J v is the foot's velocity");
    const dyn::Placement X = robot.data.frame_placement(foot);
    std::printf(" (%.3f %.3f %.3f)", X[9], X[10], X[11]);
  }
  std::printf("\n");
}

// Stage 3. Gravity, inverse dynamics, and forward dynamics.
void check_dynamics(RobotModel& robot, const dyn::Vector& q, const dyn::Vector& v, const dyn::Vector& a) {
  const std::size_t n = v.size();
  const dyn::Vector zero(n), tau = robot.data.rnea(q, zero, zero).copy(), g = robot.data.gravity_torque(q).copy();
  claim(tau == g, "at rest inverse dynamics is gravity, bit for bit");
  claim(std::abs(std::hypot(g[0], g[1], g[2]) - 9.81 * robot.model.total_mass()) < 1e-11,
        "the base's row of g is the robot's weight");
  const dyn::Vector moving = robot.data.rnea(q, v, a).copy();
  const dyn::Vector found = robot.data.aba(q, v, moving).copy();
  claim(largest_difference(found.data(), a.data(), n) < 1e-10, "forward dynamics undoes inverse dynamics");
  std::printf("3. its weight is %.5g N; forward dynamics undoes inverse dynamics within %.1g\n", 9.81 * robot.model.total_mass(),
              largest_difference(found.data(), a.data(), n));
}

// Stage 4. A controller and a planner, each in a thread: they share the model, and have a data each.
void two_threads(const RobotModel& robot, const dyn::Vector& q, const dyn::Vector& v, const dyn::Vector& a) {
  const int states = 300;
  const auto at = [&](int k) {
    dyn::Vector step = v;
    for (double& x : step) x *= 1e-3 * k;
    return robot.model.integrate(q, step);
  };
  const auto control = [&](dyn::Vector& out) {
    dyn::Data data(robot.model, DYN_PART_INVERSE);
    for (int k = 0; k < states; ++k)
      for (const double x : data.rnea(at(k), v, a)) out.push_back(x);
  };
  const auto plan = [&](dyn::Vector& out) {
    dyn::Data data(robot.model);
    for (int k = 0; k < states; ++k) {
      data.aba_derivatives(at(k), v, dyn::Vector(v.size()));
      for (const double x : data.field("ddq_dq")) out.push_back(x);
    }
  };
  dyn::Vector control_alone, plan_alone, control_beside, plan_beside;
  control(control_alone);
  plan(plan_alone);
  std::thread controller(control, std::ref(control_beside)), planner(plan, std::ref(plan_beside));
  controller.join();
  planner.join();
  claim(control_alone == control_beside && plan_alone == plan_beside, "the same bits in any number of threads");
  std::printf("4. two threads with a data each computed %d states and got the same bits as one alone\n", 2 * states);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: quadruped ROBOT.urdf\n");
    return 2;
  }
  try {
    RobotModel robot(argv[1]);
    const dyn::Vector q = robot.standing();
    dyn::Vector v(18), a(18);
    for (std::size_t k = 0; k < 18; ++k) {
      v[k] = std::sin(1.0 + double(k));
      a[k] = std::cos(2.0 * double(k));
    }
    print_sizes(robot, argv[1]);
    print_feet(robot, q, v);
    check_dynamics(robot, q, v, a);
    two_threads(robot, q, v, a);
  } catch (const dyn::Error& error) {
    std::fprintf(stderr, "%s: %s\n", error.status_name(), error.what());
    return 1;
  }
}
