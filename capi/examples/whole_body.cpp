// A whole-body controller: a quadruped stands on the ground, sways, and is pushed.
//   whole_body ROBOT.urdf [SECONDS]
// The equation of motion is M a + h = S' tau + sum J_k' f_k. The acceleration a takes the trunk to its target. The six rows of
// the base have no motor: the feet must give J_b' f = (M a + h)_b = w, each f_k in its friction cone. The least such forces are
//     min |J_b' f - w|^2 / 2 + epsilon |f|^2 / 2   over the cones,
// a contact problem with G = J_b J_b' + epsilon 1, g = -J_b w (as in capi/python/examples/standing.py). The other rows give tau.
// The simulator gets the torques alone.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <dyn.hpp>

namespace {

constexpr double stiffness = 120, damping = 22;  // 1/s^2, 1/s, of the trunk
constexpr double friction = 0.6, epsilon = 1e-3;
constexpr double weights[6] = {1, 1, 1, 10, 10, 10};  // turning costs more than moving
constexpr int feet_count = 4, forces = 3 * feet_count, base = 6;

// The trunk's target, which moves up and down.
struct Target {
  dyn::Vector q;
  double velocity, acceleration;  // m/s, m/s^2, along z
};

struct Controller {
  dyn::Data data;
  dyn::ContactSolver solver{forces};
  std::vector<int> feet;
  int trunk;
  std::vector<double> J = std::vector<double>(forces * 64), lambda = std::vector<double>(forces);

  explicit Controller(const dyn::Model& model) : data(model), trunk(model.frame_id("base")) {
    for (const char* foot : {"FL_foot", "FR_foot", "RL_foot", "RR_foot"}) feet.push_back(model.frame_id(foot));
  }
  // Torques of the motors (nv, the first six zero) for the state (q, v).
  dyn::Vector torques(const dyn::Vector& q, const dyn::Vector& v, const Target& target) {
    const int nv = data.model().nv();
    dyn::Vector a(v.size());
    const dyn::Vector error = data.model().difference(q, target.q);  // in the trunk's axes
    data.forward_kinematics(q, v);
    const dyn::Placement X = data.frame_placement(trunk);
    for (std::size_t k = 0; k < base; ++k) a[k] = stiffness * error[k] - damping * v[k];
    for (std::size_t k = 0; k < 3; ++k)
      a[k] += X[3 * k + 2] * (target.acceleration + damping * target.velocity);  // z in the trunk's axes
    for (int k = 0; k < feet_count; ++k) {
      const dyn::Matrix of_foot = data.frame_jacobian(feet[std::size_t(k)], DYN_REFERENCE_LOCAL_WORLD_ALIGNED);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < nv; ++c) at(3 * k + r, c) = of_foot(r, c);
    }
    const dyn::View need = data.rnea(q, v, a);  // M a + h
    double G[forces * forces], g[forces] = {}, mu[feet_count];
    for (int i = 0; i < forces; ++i) {
      for (int j = 0; j < forces; ++j) {
        G[i + forces * j] = i == j ? epsilon : 0;
        for (int c = 0; c < base; ++c) G[i + forces * j] += at(i, c) * at(j, c) * weights[c] * weights[c];
      }
      for (int c = 0; c < base; ++c) g[i] -= at(i, c) * need[std::size_t(c)] * weights[c] * weights[c];
    }
    std::fill(mu, mu + feet_count, friction);
    dynContactProblem problem = dyn::contact_problem();
    problem.contacts = feet_count;
    problem.G = G;
    problem.g = g;
    problem.friction = mu;
    dynContactOptions options = dyn::contact_options();
    options.tolerance = 1e-7;
    options.warm_start = 1;
    solver.solve(problem, lambda.data(), nullptr, &options);
    dyn::Vector tau(v.size());
    for (int c = base; c < nv; ++c) {
      tau[std::size_t(c)] = need[std::size_t(c)];
      for (int i = 0; i < forces; ++i) tau[std::size_t(c)] -= at(i, c) * lambda[std::size_t(i)];
    }
    return tau;
  }

 private:
  double& at(int row, int column) { return J[std::size_t(row + forces * column)]; }
};

// Lowers q until a shape touches the ground.
void put_down(dyn::Data& data, dyn::Vector& q) {
  const dyn::Vector distances = data.distances(q);
  const int ground = data.model().nshapes() - 1;
  double least = INFINITY;
  for (int k = 0; k < data.model().npairs(); ++k) {
    const auto [a, b] = data.model().pair(k);
    if (a == ground || b == ground) least = std::min(least, distances[std::size_t(k)]);
  }
  q[2] -= least;
}

int run(const char* file, double seconds) {
  const dyn::Model robot_alone = dyn::Model::load(file, dyn::LoadOptions().base(DYN_BASE_FLOATING));
  const dyn::Model model = dyn::Builder(robot_alone).add_shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {}).finish();
  dyn::Data robot(model);
  Controller controller(model);
  dyn::Vector home = model.neutral();
  for (std::size_t leg = 0; leg < feet_count; ++leg) {
    home[7 + 3 * leg + 1] = 0.8;   // thigh
    home[7 + 3 * leg + 2] = -1.6;  // calf
  }
  put_down(robot, home);

  const double dt = 1e-3;
  robot.set_effects(DYN_EFFECT_ARMATURE | DYN_EFFECT_LIMITS);
  robot.set_step_options(DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, dt);
  robot.set_state(home, dyn::Vector(std::size_t(model.nv())));
  const int steps = int(seconds / dt);
  const double amplitude = 0.01, w = 2 * M_PI;  // m, 1/s
  double away = 0, pushed_away = 0, off_at_end = 0, thinking = 0;
  dyn::Vector tau;
  for (int k = 0; k < steps; ++k) {
    const double t = k * dt;
    Target target{home, -amplitude * w * std::sin(w * t), -amplitude * w * w * std::cos(w * t)};
    target.q[2] -= amplitude * (1 - std::cos(w * t));
    const bool push = t >= 0.5 * seconds && t < 0.5 * seconds + 0.2;
    if (k % 2 == 0) {  // 500 Hz
      const auto began = std::chrono::steady_clock::now();
      tau = controller.torques(robot.q().copy(), robot.v().copy(), target);
      thinking += std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    }
    robot.clear_wrenches();
    if (push) robot.apply_wrench(controller.trunk, {0, 60, 0, 0, 0, 0});
    robot.set_state(dyn::held, dyn::held, dyn::held, tau);
    robot.step();
    const dyn::Vector off = model.difference(target.q, robot.q());
    double& largest = t < 0.5 * seconds ? away : pushed_away;
    off_at_end = std::hypot(off[0], off[1], off[2]);
    largest = std::max(largest, off_at_end);
  }
  double up = 0;
  for (const dynContactForce& c : robot.step_contacts())
    up += c.contact.shape_b == model.nshapes() - 1 ? -c.force_on_b[2] : c.force_on_b[2];
  const double expected =
      model.total_mass() * (9.81 - amplitude * w * w * std::cos(w * steps * dt));  // at the top it begins to sink
  std::printf("%g s, up and down by %g mm: the trunk follows within %.3g mm\n", seconds, 2e3 * amplitude, 1e3 * away);
  std::printf("pushed with 60 N for 0.2 s it is moved by %.3g mm, and is back within %.3g mm\n", 1e3 * pushed_away,
              1e3 * off_at_end);
  std::printf("the ground carries %.5g N at the end; mass times (g + acceleration) is %.5g N\n", up, expected);
  std::printf("the controller takes %.3g us of its 2000\n", 1e6 * thinking / ((steps + 1) / 2));
  const bool stands = away < 0.002 && pushed_away < 0.1 && off_at_end < 0.002 && std::abs(up / expected - 1) < 0.01;
  if (!stands) std::fprintf(stderr, "the robot does not stand within the bounds\n");
  return stands ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: whole_body ROBOT.urdf [SECONDS]\n");
    return 2;
  }
  try {
    return run(argv[1], argc > 2 ? std::atof(argv[2]) : 4);
  } catch (const dyn::Error& error) {
    std::fprintf(stderr, "%s: %s\n", error.status_name(), error.what());
    return 1;
  }
}
