// Pendulums: a long one that has a closed form, and one that is chaotic.
#include "cases.hpp"
#include "scene.hpp"

namespace cli::stress {

namespace {

// Point masses of 1 kg on massless rods of 1 m, about y: angles from the downward vertical, x to the right.
Model pendulum(int links) {
  Builder b("pendulum");
  std::string parent;
  for (int k = 0; k < links; ++k) {
    const std::string joint = "hinge" + std::to_string(k);
    b.add_joint(hinge(joint, parent, {0, -1, 0}, at(0, 0, k ? -1 : 0)));
    b.add_body("bob" + std::to_string(k), joint, 1, {0, 0, -1}, no_inertia());
    parent = joint;
  }
  return b.finish();
}

Play released(int links) {
  Play play(pendulum(links), DYN_INTEGRATOR_REFERENCE, links == 1 ? 0.5 : 0.1);
  Vector q(static_cast<std::size_t>(links));
  q[0] = pi / 2;
  play.set_state(q);
  return play;
}

Outcome double_pendulum(double duration, const std::array<double, 4>& reference) {
  Play play = released(2);
  Outcome out;
  out.picture = {"x of the second bob, m", "z, m", false, {}};
  Curve& path = out.curve("path");
  play.steps(static_cast<int>(std::lround(duration / 0.1)), [&](double) {
    const double a = play.q()[0], c = a + play.q()[1];
    path.add(std::sin(a) + std::sin(c), -std::cos(a) - std::cos(c));
  });
  const auto q = play.q(), v = play.v();
  return out.compare(reference[0], q[0])
      .compare(reference[1], q[0] + q[1])
      .compare(reference[2], v[0])
      .compare(reference[3], v[0] + v[1]);
}

}  // namespace

Outcome pendulum_2000s() {
  Play play = released(1);
  Outcome out;
  out.picture = {"time, s", "error of the energy, J", true, {}};
  Curve& drift = out.curve("energy");
  const double energy = play.mechanical();
  for (int k = 0; k < 4000; ++k) {
    play.step();
    if (k % 40 == 39) drift.add(play.time(), std::abs(play.mechanical() - energy));
  }
  const double angle = play.q()[0];
  return out.compare(-0.81460306858903215212, std::sin(angle)).compare(-0.58001882783693546159, -std::cos(angle));
}

Outcome pendulum_energy() {
  Play play = released(1);
  Outcome out;
  EnergyDrift drift(out, play, g);
  for (int k = 0; k < 4000; ++k) {
    play.step();
    if (k % 20 == 0) drift.look();
  }
  return out;
}

Outcome double_pendulum_10s() {
  return double_pendulum(10, {-0.568474664015950189, -0.526393727932404698, 6.07838488576196486, -9.68136068170887876});
}
Outcome double_pendulum_20s() {
  return double_pendulum(20, {0.748760975479181827, -25.8324619988937768, 4.07800396927508779, 2.77988945538666974});
}

Outcome double_pendulum_energy() {
  Play play = released(2);
  Outcome out;
  EnergyDrift drift(out, play, 3 * g);
  play.steps(1000, [&](double) { drift.look(); });
  return out;
}

}  // namespace cli::stress
