// Impacts without end, at once, and discs that roll.
#include "cases.hpp"
#include "scene.hpp"

namespace cli::stress {

namespace {

Model ball(double e) {
  Builder b("ball");
  add_ground(b);
  add_sphere(b, "ball", 1, 0.1, material(0.5, e));
  return b.finish();
}

void set_accuracy(Play& play, double dt, double accuracy) {
  dynStepOptions options = play.step_options();
  options.dt = dt, options.accuracy = accuracy, options.tolerance = 1e-13;
  play.set_step_options(options);
}

// A thin disc on its rim: its lower face through its centre of mass.
Play disc(double radius, double mu, const Vector& q, const Vector& v, double dt) {
  constexpr double thickness = 1e-6;
  Builder b("disc");
  add_ground(b);
  const double I = radius * radius / 4;
  add_free(b, "disc", 1, diagonal(I, I, 2 * I));
  add_shape(b, "disc", DYN_SHAPE_TYPE_CYLINDER, {radius, thickness, 0}, material(mu), at(0, 0, thickness / 2));
  Play play(b.finish(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, dt);
  play.set_state(q, v);
  return play;
}

// Rolling upright along x with a lean of 1e-4: the largest lean in 3 s, or 0.1 when it falls.
constexpr double wheel = 0.1, first_lean = 1e-4;
double rolling_lean(double factor, Curve& curve) {
  const double speed = factor * std::sqrt(g * wheel / 3), angle = pi / 2 - first_lean;
  // its axis along y, leaned: turned about x; it rolls about its own z
  Play play = disc(wheel, 1, {0, 0, wheel * std::sin(angle), std::sin(-angle / 2), 0, 0, std::cos(angle / 2)},
                   {speed, 0, 0, 0, 0, speed / wheel}, 1e-4);
  double worst = 0;
  for (int k = 0; k < 30000 && worst < 0.1; ++k) {
    play.step();
    const auto q = play.q();
    const double up = 1 - 2 * (q[3] * q[3] + q[4] * q[4]);  // z of the disc's axis
    worst = std::max(worst, std::abs(std::asin(std::clamp(up, -1.0, 1.0))));
    if (k % 50 == 0) curve.add(play.time(), worst);
  }
  return worst;
}

}  // namespace

// h = 1 m: at rest from sqrt(2 h / g) (1 + e) / (1 - e) on; in milliseconds, a step.
namespace {
void bounce_to_rest(Outcome& out, double e, double end, double accuracy = 1e-8) {
  Play play(ball(e));
  play.set_state(Vector{0, 0, 1.1, 0, 0, 0, 1});
  Curve& curve = out.curve("e = " + std::to_string(e).substr(0, 4));
  const double dt = 1e-3;
  set_accuracy(play, dt, accuracy);
  double rest = 0;
  for (int k = 0; k < static_cast<int>((end + 0.5) / dt); ++k) {
    play.advance(dt);
    if (std::abs(play.v()[2]) > 1e-12) rest = play.time();
    if (k % 10 == 0) curve.add(play.time(), play.q()[2] - 0.1);
  }
  out.compare(end, rest, dt);
}
}  // namespace
Outcome zeno() {
  Outcome out;
  out.picture = {"time, s", "height, m", false, {}};
  bounce_to_rest(out, 0.5, 1.3545709229571927), bounce_to_rest(out, 0.8, 4.0637127688715781),
      bounce_to_rest(out, 0.9, 8.5789491787288872);
  return out;
}
Outcome zeno_90s() {
  Outcome out;
  out.picture = {"time, s", "height, m", false, {}};
  bounce_to_rest(out, 0.99, 89.85320455616045, 1e-11);  // of each millisecond
  return out;
}

// Energy after each bounce, as a share of the first: it grows nowhere.
Outcome zeno_energy() {
  Outcome out;
  for (const double e : {0.5, 0.8, 0.9, 1.0}) {
    Play play(ball(e));
    play.set_state(Vector{0, 0, 1.1, 0, 0, 0, 1});
    set_accuracy(play, 1e-2, 1e-7);
    double before = play.mechanical();
    for (int k = 0; k < 300; ++k) {
      play.advance(1e-2);
      const double now = play.mechanical();
      out.off_by((now - before) / g), before = std::min(before, now);
    }
  }
  return out;
}

// SimBenchmark's bouncing: 7 x 7 balls of 10 kg fall from 5 m, e = 1, 20 s. Energy of all, and the height of each against the
// parabola.
Outcome elastic_balls() {
  constexpr int count = 49;
  constexpr double radius = 0.1, top = 5;
  Builder b("balls");
  add_ground(b, material(0, 1));
  Vector q;
  for (int k = 0; k < count; ++k)
    add_sphere(b, "ball" + std::to_string(k), 10, radius, material(0, 1)),
        q.insert(q.end(), {2.0 * (k / 7), 2.0 * (k % 7), top, 0, 0, 0, 1});
  Play play(b.finish());
  play.set_state(q);
  set_accuracy(play, 0.1, 1e-5);
  Outcome out;
  EnergyDrift drift(out, play, count * 10 * g * top);
  const double fall = std::sqrt(2 * (top - radius) / g);
  for (int k = 0; k < 200; ++k) {
    play.advance(0.1);
    drift.look();
    const double s = std::fmod(play.time() + fall, 2 * fall) - fall;
    for (int i = 0; i < count; ++i)
      out.off_by(std::abs(play.q()[7 * static_cast<std::size_t>(i) + 2] - (top - g * s * s / 2)) / top);
  }
  return out;
}

// Equal balls that touch, e = 1, the first one at 1 m/s: Moreau's law, all impacts at once.
Outcome cradle() {
  Builder b("cradle");
  b.set_gravity({0, 0, 0});
  for (int k = 0; k < 3; ++k) add_sphere(b, "ball" + std::to_string(k), 1, 0.1, material(0, 1));
  Play play(b.finish(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3);
  Vector q, v(18);
  for (int k = 0; k < 3; ++k) q.insert(q.end(), {0.2 * k, 0, 0, 0, 0, 0, 1});
  v[0] = 1;
  play.set_state(q, v);
  dynStepOptions options = play.step_options();
  options.tolerance = 1e-15;
  play.set_step_options(options);
  play.step();
  Outcome out;
  return out.compare(-1.0 / 3, play.v()[0])
      .compare(2.0 / 3, play.v()[6])
      .compare(2.0 / 3, play.v()[12])
      .compare(0.5, play.energy().kinetic);
}

// A coin whose centre of mass is at rest, alpha = 30 degrees: it rolls on its rim with W = sqrt(4 g / (a sin alpha)) for 100
// turns.
Outcome euler_disk() {
  constexpr double a = 0.0375, alpha = pi / 6;
  const double turn = std::sqrt(4 * g / (a * std::sin(alpha))), half = alpha / 2;
  // in its own axes: turn about the vertical, less the spin that makes the point of contact rest: w3 = 0
  Play play = disc(a, 1, {0, 0, a * std::sin(alpha), std::sin(half), 0, 0, std::cos(half)},
                   {0, 0, 0, 0, turn * std::sin(alpha), 0}, 1e-3);
  Outcome out;
  out.picture = {"time, s", "alpha - 30 deg, rad", true, {}};
  Curve& curve = out.curve("alpha");
  set_accuracy(play, 1e-3, 1e-6);  // of a turn
  for (int k = 0; k < 100; ++k) {
    play.advance(2 * pi / turn);
    const auto q = play.q();
    const double lean = 2 * std::asin(std::min(1.0, std::hypot(q[3], q[4])));
    double force = 0;
    for (const auto& c : play.step_contacts()) force += c.force_on_b[2];
    out.off_by(std::abs(lean - alpha)).off_by(std::abs(force - g) < 1e-3 * g ? 0 : HUGE_VAL);
    curve.add(play.time(), std::abs(lean - alpha));
  }
  return out;
}

// Upright discs roll stably from v^2 = g a / 3 on (thin ones): the lean l oscillates, l'' = 4/5 (g/a - 3 w^2) l + 12/5 w^2 l0.
Outcome rolling_disc_above() {
  Outcome out;
  out.picture = {"time, s", "largest lean, rad", true, {}};
  const double found = rolling_lean(1.1, out.curve("lean")), square = 1.1 * 1.1;
  const double expected = first_lean * (2 * square / (square - 1) - 1);
  return out.compare(expected, found, expected);
}
Outcome rolling_disc_below() {
  Outcome out;
  out.picture = {"time, s", "largest lean, rad", true, {}};
  const double lean = rolling_lean(0.9, out.curve("lean"));
  out.reference = {0.1}, out.result = {lean};
  return out.off_by(lean >= 0.1 ? 0 : HUGE_VAL);
}

}  // namespace cli::stress
