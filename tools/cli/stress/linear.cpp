// Motions near a steady one: a four-bar on a spring, a bicycle that runs straight.
#include <algorithm>
#include <complex>

#include "cases.hpp"
#include "scene.hpp"

namespace cli::stress {

// ---------------------------------------------------------------------------------------------------- four-bar with a spring

namespace {

// A parallelogram of uniform rods of 1 kg, uprights of 1 m on a base of 2 m, a spring along its diagonal that is as long as at a
// right angle when slack; no gravity. The spring is a telescope that carries the coupler, whose ends close two loops.
constexpr double base = 2, stiffness = 100, inertia = 2.0 / 3 + 1;  // of the angle: A theta'' = -U'
const double slack = std::sqrt(base * base + 1);
double diagonal_at(double angle) { return std::sqrt(base * base + 1 + 2 * base * std::cos(angle)); }
double potential(double angle) { return stiffness / 2 * (diagonal_at(angle) - slack) * (diagonal_at(angle) - slack); }

Model sprung_four_bar() {
  Builder b("sprung_four_bar");
  b.set_gravity({0, 0, 0});
  const Vector3 about_z{0, 0, 1};
  const auto rod = [&](const std::string& name, const std::string& joint, double length, double from) {
    b.add_body(name, joint, 1, {from + length / 2, 0, 0}, diagonal(0, length * length / 12, length * length / 12));
  };
  b.add_joint(hinge("left", "", about_z)).add_joint(hinge("right", "", about_z, at(base, 0, 0)));
  rod("left_rod", "left", 1, 0), rod("right_rod", "right", 1, 0);
  b.add_joint(hinge("foot", "", about_z));
  JointSpec spring = slide("spring", "foot", {1, 0, 0});
  spring.stiffness = {stiffness}, spring.spring_reference = {slack};
  b.add_joint(spring).add_joint(hinge("corner", "spring", about_z));
  rod("coupler", "corner", base, -base);
  b.add_constraint("right_top", connect({0, 0, 0}, {1, 0, 0}), "coupler", "right_rod");
  b.add_constraint("left_top", connect({-base, 0, 0}, {1, 0, 0}), "coupler", "left_rod");
  return b.finish();
}
Vector at_angle(double angle) {
  const double turn = std::atan2(std::sin(angle), base + std::cos(angle));
  return {angle, angle, turn, diagonal_at(angle), -turn};
}

}  // namespace

// w^2 = U'' / A about the right angle, of the accelerations' derivative along the motion.
Outcome four_bar_frequency() {
  const Model model = sprung_four_bar();
  Data data(model, DYN_PART_CONSTRAINTS | DYN_PART_CONSTRAINT_DERIVATIVES);
  data.set_effects(DYN_EFFECT_ALL & ~DYN_EFFECT_SLEEPING);
  const double along = -base / slack, turn = 1 / (slack * slack);  // of the spring, of its foot, by the angle
  const Vector motion = {1, 1, turn, along, -turn};
  const auto d = data.constrained_dynamics_derivatives(at_angle(pi / 2), Vector(5), Vector(5));
  double square = 0;
  for (int k = 0; k < 5; ++k) square -= d.ddq_dq(0, k) * motion[static_cast<std::size_t>(k)];
  Outcome out;
  const double expected = std::sqrt(stiffness * along * along / inertia);
  return out.compare(expected, std::sqrt(square), expected);
}

// From 0.8 rad off at rest: the same again after ten periods, whose length is a quadrature of the energy.
Outcome four_bar_periods() {
  const double first = pi / 2 - 0.8, longest = diagonal_at(first);
  const double other = 2 * slack - longest, last = std::acos((other * other - base * base - 1) / (2 * base));
  const double middle = (first + last) / 2, half = (last - first) / 2;
  double period = 0;
  constexpr int count = 256;  // the midpoint rule of a periodic function
  for (int k = 0; k < count; ++k) {
    const double s = pi * ((k + 0.5) / count - 0.5), angle = middle + half * std::sin(s);
    period += 2 * pi / count * half * std::cos(s) / std::sqrt(2 * (potential(first) - potential(angle)) / inertia);
  }
  Play play(sprung_four_bar(), DYN_INTEGRATOR_REFERENCE, period / 20);
  play.set_state(at_angle(first));
  Outcome out;
  out.picture = {"time, s", "angle, rad", false, {}};
  Curve& curve = out.curve("angle");
  play.steps(200, [&](double t) { curve.add(t, play.q()[0]); });
  return out.compare(first, play.q()[0]).compare(0, play.v()[0] * period / (2 * pi));
}

// ---------------------------------------------------------------------------------------------------- Whipple's bicycle

namespace {

// The benchmark bicycle of Meijaard, Papadopoulos, Ruina and Schwab (2007), table 1: x ahead, y to the right, z down, from where
// the rear wheel touches.
struct Bicycle {
  static constexpr double w = 1.02, c = 0.08, rear = 0.3, front = 0.35, tilt = pi / 10;
  const Vector3 steer{std::sin(tilt), 0, std::cos(tilt)};
  enum { x, y, yaw, lean, rear_spin, pitch, steering, front_spin, n };

  Data data{build(), DYN_PART_INVERSE | DYN_PART_INVERSE_DERIVATIVES};

  static std::array<double, 9> moments(double xx, double yy, double zz, double xz) { return {xx, 0, xz, 0, yy, 0, xz, 0, zz}; }
  Model build() const {
    Builder b("bicycle");
    b.set_gravity({0, 0, g});
    const Vector3 about_y{0, 1, 0};
    b.add_joint(slide("x", "", {1, 0, 0}))
        .add_joint(slide("y", "x", {0, 1, 0}))
        .add_joint(hinge("yaw", "y", {0, 0, 1}))
        .add_joint(hinge("lean", "yaw", {1, 0, 0}));
    b.add_joint(hinge("rear_spin", "lean", about_y, at(0, 0, -rear)))
        .add_body("rear_wheel", "rear_spin", 2, {0, 0, 0}, moments(0.0603, 0.12, 0.0603, 0));
    b.add_joint(hinge("pitch", "lean", about_y, at(0, 0, -rear)))
        .add_body("frame", "pitch", 85, {0.3, 0, -0.9 + rear}, moments(9.2, 11, 2.8, 2.4));
    b.add_joint(hinge("steering", "pitch", steer, at(w + c, 0, rear)))
        .add_body("fork", "steering", 4, {0.9 - w - c, 0, -0.7}, moments(0.05892, 0.06, 0.00708, -0.00756));
    b.add_joint(hinge("front_spin", "steering", about_y, at(-c, 0, -front)))
        .add_body("front_wheel", "front_spin", 3, {0, 0, 0}, moments(0.1405, 0.28, 0.1405, 0));
    return b.finish();
  }

  // M q'' + C q' + K q = 0 of lean and steering at speed v. Wheels roll: yaw' = (v steer + c steer') cos(tilt) / w, y' = v yaw;
  // the front one stays on the ground, which pitch sees to, and whose second derivatives the force there multiplies.
  struct Matrices {
    double M[2][2], C[2][2], K[2][2];
  };
  Matrices at_speed(double v) {
    Vector velocity(n), zero(n);
    velocity[x] = v, velocity[rear_spin] = -v / rear, velocity[front_spin] = -v / front;
    const double load = data.rnea(zero, velocity, zero).copy()[pitch] / -w;
    const auto d = data.rnea_derivatives(zero, velocity, zero);
    const double turn = std::cos(tilt) / w,
                 held[2][2] = {{0, -c * std::cos(tilt)}, {-c * std::cos(tilt), -c * std::cos(tilt) * std::sin(tilt)}};
    const auto along = [&](const dyn::View& A, int i, int column) {  // of the motions that the wheels allow
      return i == 0 ? A(lean, column) : A(steering, column) + c * turn * A(yaw, column);
    };
    Matrices out;
    for (int i = 0; i < 2; ++i) {
      const double by_yaw = along(d.dtau_da, i, yaw) * turn, by_y = along(d.dtau_da, i, y) * v * turn,
                   by_turning = along(d.dtau_dv, i, yaw) * turn;
      out.M[i][0] = along(d.dtau_da, i, lean), out.M[i][1] = along(d.dtau_da, i, steering) + by_yaw * c;
      out.C[i][0] = along(d.dtau_dv, i, lean),
      out.C[i][1] = along(d.dtau_dv, i, steering) + by_turning * c + by_yaw * v + by_y * c;
      out.K[i][0] = along(d.dtau_dq, i, lean) - load * held[i][0],
      out.K[i][1] = along(d.dtau_dq, i, steering) - load * held[i][1] + by_turning * v + by_y * v;
    }
    return out;
  }
};

// The root of det(s^2 M + s C + K) next to s: Newton's method.
std::complex<double> eigenvalue(const Bicycle::Matrices& m, std::complex<double> s) {
  for (int step = 0; step < 4; ++step) {
    std::complex<double> f[2][2], df[2][2];
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 2; ++k)
        f[i][k] = s * s * m.M[i][k] + s * m.C[i][k] + m.K[i][k], df[i][k] = 2.0 * s * m.M[i][k] + m.C[i][k];
    s -= (f[0][0] * f[1][1] - f[0][1] * f[1][0]) /
         (df[0][0] * f[1][1] + f[0][0] * df[1][1] - df[0][1] * f[1][0] - f[0][1] * df[1][0]);
  }
  return s;
}

}  // namespace

// Eigenvalues at 0 to 10 m/s: table 2 of the same.
Outcome bicycle() {
  struct Row {
    std::complex<double> weave;
    double capsize, caster;
  };
  const Row table[] = {{{3.52696170990070, 0.80774027519930}, -3.13423125066578, -7.11008014637442},
                       {{2.68234517512745, 1.68066296590675}, -3.07158645641514, -8.67387984831735},
                       {{1.70675605663975, 2.31582447384325}, -2.63366137253667, -10.35101467245920},
                       {{0.41325331521125, 3.07910818603206}, -1.42944427361326, -12.15861426576447},
                       {{-0.77534188219585, 4.46486771378823}, -0.32286642900409, -14.07838969279822},
                       {{-1.52644486584142, 5.87673060598709}, -0.00406690076970, -16.08537123098026},
                       {{-2.13875644258362, 7.19525913329805}, 0.10268170574766, -18.15788466125262},
                       {{-2.69348683581097, 8.46037971396931}, 0.14327879765713, -20.27940894394569},
                       {{-3.21675402252485, 9.69377351531791}, 0.15790184030917, -22.43788559040858},
                       {{-3.72016840437287, 10.90681139476287}, 0.16105338653172, -24.62459635017404}};
  Bicycle bicycle;
  Outcome out;
  out.picture = {"speed, m/s", "real part, 1/s", false, {{"weave", {}, {}}, {"capsize", {}, {}}, {"caster", {}, {}}}};
  const auto look = [&](const Bicycle::Matrices& m, std::complex<double> expected) {
    const std::complex<double> found = eigenvalue(m, expected);
    out.compare(expected.real(), found.real()).compare(expected.imag(), found.imag());
    return found.real();
  };
  const Bicycle::Matrices still = bicycle.at_speed(0);
  for (const double s : {3.13164324790656, 5.53094371765393}) look(still, s), look(still, -s);
  for (int v = 1; v <= 10; ++v) {
    const Row& row = table[v - 1];
    const Bicycle::Matrices m = bicycle.at_speed(v);
    const std::complex<double> all[] = {row.weave, row.capsize, row.caster};
    for (std::size_t k = 0; k < 3; ++k) out.picture.curves[k].add(v, look(m, all[k]));
  }
  return out;
}

}  // namespace cli::stress
