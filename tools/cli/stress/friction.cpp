// Coulomb friction against closed forms, at its thresholds, and where rigid bodies have no accelerations.
#include <random>

#include "cases.hpp"
#include "contact_law.hpp"
#include "scene.hpp"

namespace cli::stress {

namespace {

void tighten(Play& play, double tolerance) {
  dynStepOptions options = play.step_options();
  options.tolerance = tolerance;
  play.set_step_options(options);
}

// A flat box on a plane, gravity turned by angle.
Play box_on_plane(double mu, double angle, double dt) {
  Builder b("incline");
  b.set_gravity({g * std::sin(angle), 0, -g * std::cos(angle)});
  add_ground(b);
  add_box(b, "box", 1, {0.2, 0.2, 0.1}, material(mu));
  Play play(b.finish(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, dt);
  play.set_state(Vector{0, 0, 0.05, 0, 0, 0, 1});
  return play;
}
Play sphere_on_plane(double mu, double dt) {
  Builder b("sphere");
  add_ground(b);
  add_sphere(b, "ball", 1, 0.1, material(mu));
  Play play(b.finish(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, dt);
  play.set_state(Vector{0, 0, 0.1, 0, 0, 0, 1});
  return play;
}
constexpr double accuracy = 1e-6;

}  // namespace

// Below the friction angle nothing moves.
Outcome incline_sticks() {
  Outcome out;
  out.picture = {"time, s", "speed, m/s", true, {}};
  for (const double mu : {0.1, 0.5, 1.0})
    for (const double share : {0.5, 0.9, 0.99, 0.999}) {
      Play play = box_on_plane(mu, share * std::atan(mu), 1e-3);
      Curve& curve = out.curve("");
      for (int k = 0; k < 3000; ++k) {
        play.step();
        const double speed = std::hypot(play.v()[0], play.v()[1], play.v()[2]);
        out.off_by(speed);
        if (k % 20 == 0) curve.add(play.time(), speed);
      }
    }
  return out;
}

// Beyond it v = g (sin - mu cos) t.
Outcome incline_slides() {
  Outcome out;
  for (const double mu : {0.1, 0.5, 1.0})
    for (const double share : {1.001, 1.01, 1.1}) {
      const double angle = share * std::atan(mu);
      Play play = box_on_plane(mu, angle, 1e-3);
      tighten(play, 1e-12);
      play.steps(3000);
      out.compare(3 * g * (std::sin(angle) - mu * std::cos(angle)), play.v()[0]);
    }
  return out;
}

// v0 = 1 m/s, mu = 0.2: it slides until t = 2 v0 / (7 mu g), then rolls with 5/7 v0.
Outcome sphere_rolls() {
  Play play = sphere_on_plane(0.2, 1e-3);
  play.set_state(dyn::held, Vector{1, 0, 0, 0, 0, 0});
  Outcome out;
  out.picture = {"time, s", "x, m", false, {}};
  Curve& curve = out.curve("x");
  const double t = 2 / (7 * 0.2 * g), x = t - 0.1 * g * t * t;
  play.set_step_options(DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3, accuracy / 5);
  for (int k = 0; k < 5; ++k) play.advance(0.1), curve.add(play.time(), play.q()[0]);
  return out.compare(x + 5.0 / 7 * (0.5 - t), play.q()[0]);
}
Outcome sphere_final_speed() {
  Play play = sphere_on_plane(0.2, 1e-3);
  play.set_state(dyn::held, Vector{1, 0, 0, 0, 0, 0});
  tighten(play, 1e-12);
  play.steps(500);
  const auto q = play.q(), v = play.v();  // of the body's axes to the world's: it turns about y
  const double angle = 2 * std::atan2(q[4], q[6]);
  Outcome out;
  return out.compare(5.0 / 7, std::cos(angle) * v[0] + std::sin(angle) * v[2]);
}

// v0 = 1 m/s, mu = 0.4: it stops after v0^2 / (2 mu g).
Outcome block_stops() {
  Play play = box_on_plane(0.4, 0, 1e-3);
  play.set_state(dyn::held, Vector{1, 0, 0, 0, 0, 0});
  play.set_step_options(DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3, accuracy / 3);
  Outcome out;
  out.picture = {"time, s", "x, m", false, {}};
  Curve& curve = out.curve("x");
  for (int k = 0; k < 3; ++k) play.advance(0.1), curve.add(play.time(), play.q()[0]);
  return out.compare(0.12742099898, play.q()[0]);
}

// 64 directions: relative spread of the distance.
Outcome isotropy() {
  Outcome out;
  out.picture = {"x, m", "y, m", false, {}};
  Curve& curve = out.curve("stop");
  double least = HUGE_VAL, most = 0;
  for (int k = 0; k <= 64; ++k) {
    const double angle = 2 * pi * k / 64;
    Play play = box_on_plane(0.4, 0, 1e-3);
    tighten(play, 1e-12);
    play.set_state(dyn::held, Vector{std::cos(angle), std::sin(angle), 0, 0, 0, 0});
    play.steps(300);
    const double x = play.q()[0], y = play.q()[1], distance = std::hypot(x, y);
    least = std::min(least, distance), most = std::max(most, distance);
    out.off_by(std::abs(x * std::sin(angle) - y * std::cos(angle)) / distance);
    curve.add(x, y);
  }
  return out.off_by((most - least) / most);
}

// A force that grows from 0 to 20 N in a second, mu = 0.4: it slips from 0.1962 s on; v(1) = 6.4609444 m/s (Le Lidec et al.
// 2024).
Outcome drag() {
  Play play = box_on_plane(0.4, 0, 1e-4);
  tighten(play, 1e-12);
  Outcome out;
  out.picture = {"time, s", "speed, m/s", false, {}};
  Curve& curve = out.curve("speed");
  Vector tau(6);
  for (int k = 0; k < 10000; ++k) {
    tau[0] = 20 * (k + 0.5) * 1e-4;
    play.set_state(dyn::held, dyn::held, dyn::held, tau);
    play.step();
    if (k % 50 == 49) curve.add(play.time(), play.v()[0]);
  }
  const double slip = 0.4 * g / 20;
  return out.compare(10 * (1 - slip * slip) - 0.4 * g * (1 - slip), play.v()[0]);
}

// A rod whose tip slides, in the range where rigid bodies have no acceleration or two (Painleve): impulses that hold all laws.
Outcome painleve() {
  Outcome out;
  std::mt19937 dice(1);
  std::uniform_real_distribution<double> part(0, 1);
  const struct {
    double mu, low, high;
  } ranges[] = {{1.4, 55.5858, 69.9519}, {1.5, 50.6416, 73.0485}, {2, 37.3774, 79.1877}};
  constexpr double length = 1, tip = 1e-3;
  for (const auto& r : ranges) {
    Builder b("rod");
    add_ground(b);
    add_free(b, "rod", 1, diagonal(1e-4, length * length / 12, length * length / 12));
    add_shape(b, "rod", DYN_SHAPE_TYPE_SPHERE, {tip, 0, 0}, material(r.mu), at(-length / 2, 0, 0));
    Play play(b.finish(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-4);
    tighten(play, 1e-12);
    ContactLaw law(play, {1}, r.mu, 1e-4);
    for (int k = 0; k < 334; ++k) {
      // the other end is up, the tip slides towards it: the angle from the horizontal
      const double angle = (r.low + (r.high - r.low) * part(dice)) * pi / 180, slip = 0.5 + 5 * part(dice),
                   turn = 4 * part(dice) - 2;
      const double c = std::cos(angle), s = std::sin(angle), at_x = -length / 2;
      const Vector q = {-at_x * c, 0, tip - at_x * s, 0, -std::sin(angle / 2), 0, std::cos(angle / 2)};
      // velocity of the tip along the ground, and none into it; w about -y
      const double w = turn, vx = -slip * (k % 2 ? 1 : -1) - w * at_x * -s, vz = -w * at_x * c;
      play.set_state(q, Vector{c * vx + s * vz, 0, -s * vx + c * vz, 0, -w, 0});
      out.off_by(law.step());
      for (const double v : play.v())
        if (!(std::abs(v) < 1e3)) out.off_by(HUGE_VAL);
    }
  }
  return out;
}

// The same for accelerations, where the tip slides: 0 <= f _|_ a + p f >= 0 with p = 1 + 3 cos^2 - 3 mu sin cos. Where p < 0
// there is no f, or two: said to be no solution, and never a force that pulls. Counts wrong results.
Outcome painleve_accelerations() {
  Outcome out;
  dyn::ContactSolver solver(1);
  int wrong = 0;
  for (const double mu : {0.5, 1.3, 1.4, 1.5, 2.0, 5.0})
    for (int k = 1; k < 900; ++k) {
      const double angle = k * pi / 1800, c = std::cos(angle), s = std::sin(angle);
      const double p = 1 + 3 * c * c - 3 * mu * s * c;
      for (const double a : {-g, -1e-6, 0.5, 40.0})
        for (const dynContactSolverType type :
             {DYN_CONTACT_SOLVER_TYPE_PGS, DYN_CONTACT_SOLVER_TYPE_ADMM, DYN_CONTACT_SOLVER_TYPE_NEWTON}) {
          const std::int32_t row = 1;
          dynContactProblem problem = dyn::contact_problem();
          problem.contacts = 1, problem.contact_rows = &row, problem.G = &p, problem.g = &a;
          dynContactOptions options = dyn::contact_options();
          options.solver = type;
          double force = 0;
          bool solved = false;
          try {
            solved = solver.solve(problem, &force, nullptr, &options).status == DYN_CONTACT_STATUS_CONVERGED;
          } catch (const dyn::Error&) {
          }
          const bool right =
              p > 0 ? solved && std::abs(force - std::max(0.0, -a / p)) <= 1e-8 * (1 + force) : !solved || (a >= 0 && force == 0);
          wrong += !right || !(force >= 0);
        }
    }
  out.reference = {0}, out.result = {static_cast<double>(wrong)};
  return out.off_by(wrong);
}

// Two cards that lean against each other by an angle from the vertical, rounded by r: they stand from mu = L sin / (2 (L cos +
// r)) on.
Outcome cards() {
  constexpr double length = 1, r = 1e-3, share = 1e-3;
  Outcome out;
  out.picture = {"time, s", "sunk by, m", true, {}};
  for (const double degrees : {15.0, 20.0, 30.0})
    for (const bool stands : {true, false}) {
      const double angle = degrees * pi / 180, s = std::sin(angle), c = std::cos(angle);
      const double critical = length * s / (2 * (length * c + r)), mu = critical * (1 + (stands ? share : -share));
      Builder b("cards");
      add_ground(b);
      Vector q;
      for (const double side : {-1.0, 1.0}) {  // in the x-z plane
        const std::string name = side < 0 ? "left" : "right";
        b.add_joint(slide(name + "_x", "", {1, 0, 0}, at(3 * side, 0, 3)))
            .add_joint(slide(name + "_z", name + "_x", {0, 0, 1}))
            .add_joint(hinge(name + "_turn", name + "_z", {0, 1, 0}));
        b.add_body(name, name + "_turn", 1, {0, 0, 0}, box_inertia(1, {1e-3, 1, length}));
        add_shape(b, name, DYN_SHAPE_TYPE_CAPSULE, {r, length, 0}, material(mu));
        q.insert(q.end(), {side * (length / 2 * s + r - 3), length / 2 * c + r - 3,
                           -side * angle});  // (shapes that overlap at q = 0 are not tested)
      }
      Play play(b.finish(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3);
      tighten(play, 1e-12);
      play.set_state(q, Vector(6));
      Curve& curve = out.curve(std::to_string(static_cast<int>(degrees)) + (stands ? " above" : " below"));
      double sunk = 0;
      for (int k = 0; k < 3000; ++k) {
        play.step();
        if (k % 20 != 19) continue;
        sunk = q[1] - play.q()[1];
        curve.add(play.time(), std::abs(sunk));
        if (stands) out.off_by(std::abs(sunk));
        if (!stands && sunk > 0.01) break;
      }
      if (!stands && sunk < 0.01) out.off_by(HUGE_VAL);
    }
  return out;
}

}  // namespace cli::stress
