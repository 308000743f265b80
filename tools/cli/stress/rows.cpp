// Constraints that say the same twice, that contradict each other, and mechanisms that pass where they are flat.
#include "cases.hpp"
#include "scene.hpp"

namespace cli::stress {

namespace {

// A four-bar whose corner is closed so many times.
Model four_bar(int closures) {
  Builder b("four_bar");
  b.set_gravity({0, -g, 0}).set_constraint_slots(0);
  const auto bar = [&](const std::string& name, const std::string& parent, double x, double length) {
    b.add_joint(hinge(name, parent, {0, 0, 1}, at(x, 0, 0)))
        .add_body(name + "_bar", name, 1, {length / 2, 0, 0}, diagonal(0.01, length * length / 12, length * length / 12));
  };
  bar("crank", "", 0, 1), bar("coupler", "crank", 1, 3), bar("rocker", "", 3, 2.5);
  for (int k = 0; k < closures; ++k)
    b.add_constraint("corner" + std::to_string(k), connect({3, 0, 0}, {2.5, 0, 0}), "coupler_bar", "rocker_bar");
  return b.finish();
}

// The four-bar by itself: its bars' angles to the horizontal, their rates and accelerations, by virtual work of one coordinate.
struct PlanarFourBar {
  static constexpr double lengths[3] = {1, 3, 2.5};
  double angle[3], rate[3], acceleration[3];
  Vector forces;  // generalized ones of the corner's force, in the tree's joints

  // q, v: of the tree; torque at the crank
  PlanarFourBar(const Vector& q, const Vector& v, double torque) : forces(3) {
    const double at[3] = {q[0], q[0] + q[1], q[2]}, turns[3] = {v[0], v[0] + v[1], v[2]};
    double c[3], s[3];
    for (int k = 0; k < 3; ++k) angle[k] = at[k], rate[k] = turns[k], c[k] = std::cos(at[k]), s[k] = std::sin(at[k]);
    const double l1 = lengths[0], l2 = lengths[1], l3 = lengths[2], w1 = rate[0] * rate[0], w2 = rate[1] * rate[1],
                 w3 = rate[2] * rate[2];
    // l1 e(1) + l2 e(2) - l3 e(3) = const, differentiated twice: accelerations of coupler and rocker are ratio[k] x + rest[k]
    const double det = l2 * l3 * (s[1] * c[2] - c[1] * s[2]);
    const auto solve = [&](double x, double y) {  // l2 e'(2) a - l3 e'(3) b = (x, y)
      return std::pair{(-l3 * c[2] * x - l3 * s[2] * y) / det, (-l2 * c[1] * x - l2 * s[1] * y) / det};
    };
    const auto [r2, r3] = solve(l1 * s[0], -l1 * c[0]);
    const auto [b2, b3] = solve(l1 * c[0] * w1 + l2 * c[1] * w2 - l3 * c[2] * w3, l1 * s[0] * w1 + l2 * s[1] * w2 - l3 * s[2] * w3);
    const double ratio[3] = {1, r2, r3}, rest[3] = {0, b2, b3};
    // sum over bars of m a . dp + I alpha dangle = torque - sum of m g dy: m = 1, I = l^2 / 12, centres half way
    double inertia = 0, load = torque;
    for (int k = 0; k < 3; ++k) {
      const bool carried = k == 1;  // by the crank's end
      const double l = lengths[k], I = l * l / 12;
      const double dx = (carried ? -l1 * s[0] : 0) - l / 2 * s[k] * ratio[k], dy = (carried ? l1 * c[0] : 0) + l / 2 * c[k] * ratio[k];
      const double ax = (carried ? -l1 * c[0] * w1 : 0) - l / 2 * (s[k] * rest[k] + c[k] * rate[k] * rate[k]),
                   ay = (carried ? -l1 * s[0] * w1 : 0) + l / 2 * (c[k] * rest[k] - s[k] * rate[k] * rate[k]);
      inertia += dx * dx + dy * dy + I * ratio[k] * ratio[k];
      load -= ax * dx + (ay + g) * dy + I * rest[k] * ratio[k];
    }
    for (int k = 0; k < 3; ++k) acceleration[k] = ratio[k] * (load / inertia) + rest[k];
    // F on the rocker's end, -F on the coupler's: moments of the rocker about its foot, of the coupler about the crank's end
    const double rocker = l3 * l3 / 3 * acceleration[2] + g * l3 / 2 * c[2];
    const double end_x = -l1 * (s[0] * acceleration[0] + c[0] * w1), end_y = l1 * (c[0] * acceleration[0] - s[0] * w1);
    const double coupler = l2 * l2 / 3 * acceleration[1] + l2 / 2 * (c[1] * (end_y + g) - s[1] * end_x);
    // l3 (c3 Fy - s3 Fx) = rocker, l2 (c2 Fy - s2 Fx) = -coupler
    const double d = s[1] * c[2] - c[1] * s[2], x = rocker / l3, y = -coupler / l2;
    const double Fx = (c[1] * x - c[2] * y) / d, Fy = (s[1] * x - s[2] * y) / d;
    forces[0] = -((l1 * c[0] + l2 * c[1]) * Fy - (l1 * s[0] + l2 * s[1]) * Fx), forces[1] = coupler, forces[2] = rocker;
  }
};

}  // namespace

// One, two and ten times the same rows: accelerations and forces at the joints.
Outcome duplicate_rows() {
  Outcome out;
  Data single(four_bar(1), DYN_PART_CONSTRAINTS);
  const auto start = single.project(Vector{1.2, -0.9, 1.4}, Vector{1, 0.3, 0.2});
  const PlanarFourBar bars(start.q, start.v, 0.5);
  const double expected[] = {bars.acceleration[0], bars.acceleration[1] - bars.acceleration[0], bars.acceleration[2]};
  for (const int times : {1, 2, 10}) {
    Data data(four_bar(times), DYN_PART_CONSTRAINTS | DYN_PART_INVERSE);
    const auto found = data.constrained_dynamics(start.q, start.v, Vector{0.5, 0, 0});
    const auto terms = data.constraint_terms(start.q, start.v);
    for (std::size_t c = 0; c < 3; ++c) {
      double force = 0;
      for (int r = 0; r < terms.J.rows; ++r) force += terms.J(r, static_cast<int>(c)) * found.lambda[static_cast<std::size_t>(r)];
      out.compare(expected[c], found.x[c], std::abs(expected[c]))
          .compare(bars.forces[c], force, std::max(1.0, std::abs(bars.forces[c])));
    }
  }
  return out;
}

// Three bodies that fly freely, tied by four hinges: 20 rows of rank 17 for 18 degrees of freedom.
Outcome four_bar_in_space() {
  Data tree(four_bar(1), DYN_PART_CONSTRAINTS);
  const auto start = tree.project(Vector{1.2, -0.9, 1.4}, Vector{1, 0.3, 0.2});
  const PlanarFourBar bars(start.q, start.v, 0);
  Builder b("bodies");
  b.set_gravity({0, -g, 0});
  const char* names[] = {"crank", "coupler", "rocker"};
  for (int k = 0; k < 3; ++k) {
    const double l = bars.lengths[k];
    b.add_joint(names[k], DYN_JOINT_TYPE_FREE_FLYER)
        .add_body(std::string(names[k]) + "_bar", names[k], 1, {l / 2, 0, 0}, diagonal(0.01, l * l / 12, l * l / 12));
  }
  const auto tie = [&](const std::string& name, const Vector3& x, const Vector3& y, const std::string& first,
                       const std::string& second) {
    dynConstraint c = connect(x, y);
    c.type = DYN_CONSTRAINT_TYPE_LOOP, c.joint_type = DYN_JOINT_TYPE_REVOLUTE;
    b.add_constraint(name, c, first, second);
  };
  tie("O", {0, 0, 0}, {0, 0, 0}, "crank_bar", ""), tie("A", {0, 0, 0}, {1, 0, 0}, "coupler_bar", "crank_bar");
  tie("B", {3, 0, 0}, {2.5, 0, 0}, "coupler_bar", "rocker_bar"), tie("C", {0, 0, 0}, {3, 0, 0}, "rocker_bar", "");
  Data data(b.finish(), DYN_PART_CONSTRAINTS);
  Vector q, v, expected;
  Outcome out;
  const double c = std::cos(bars.angle[0]), s = std::sin(bars.angle[0]), w = bars.rate[0], x = bars.acceleration[0];
  const Vector3 places[] = {{0, 0, 0}, {c, s, 0}, {3, 0, 0}}, speeds[] = {{0, 0, 0}, {-s * w, c * w, 0}, {0, 0, 0}},
                accelerations[] = {{0, 0, 0}, {-s * x - c * w * w, c * x - s * w * w, 0}, {0, 0, 0}};
  for (std::size_t k = 0; k < 3; ++k) {
    const double angle = bars.angle[k], cosine = std::cos(angle), sine = std::sin(angle), turn = bars.rate[k];
    const auto in_bar = [&](const Vector3& y) { return Vector3{cosine * y[0] + sine * y[1], cosine * y[1] - sine * y[0], 0}; };
    const Vector3 speed = in_bar(speeds[k]), a = in_bar(accelerations[k]);
    q.insert(q.end(), {places[k][0], places[k][1], 0, 0, 0, std::sin(angle / 2), std::cos(angle / 2)});
    v.insert(v.end(), {speed[0], speed[1], 0, 0, 0, turn});
    // the rate of v, in the bar's axes, which turn: less w x v
    expected.insert(expected.end(), {a[0] + turn * speed[1], a[1] - turn * speed[0], 0, 0, 0, bars.acceleration[k]});
  }
  const auto found = data.constrained_dynamics(q, v, Vector(18));
  for (std::size_t k = 0; k < 18; ++k) out.compare(expected[k], found.x[k]);
  if (found.result.rank != 17) out.off_by(HUGE_VAL);
  return out;
}

// A rod of 1 m, its ends held at points 1.001 m apart: the least-squares place, said to be one.
Outcome contradictory_rows() {
  Builder b("rod");
  b.set_gravity({0, 0, 0});
  add_free(b, "rod", 1, diagonal(0.01, 1.0 / 12, 1.0 / 12));
  b.add_constraint("left", connect({-0.5, 0, 0}, {0, 0, 0}), "rod")
      .add_constraint("right", connect({0.5, 0, 0}, {1.001, 0, 0}), "rod");
  Play play(b.finish(), DYN_INTEGRATOR_RK4, 1e-3);
  Data data(play.model(), DYN_PART_CONSTRAINTS);
  Outcome out;
  const auto found = data.project(Vector{0.47, 0.02, 0.01, 0.01, 0.02, 0.05, 0.99}, Vector(6));
  out.compare(0.5005, found.q[0]).compare(0, found.q[1]).compare(0, found.q[2]);
  if (found.result.reason != DYN_CONSTRAINT_REASON_CONTRADICTORY) out.off_by(HUGE_VAL);
  play.set_state(Vector{0.5, 0, 0, 0, 0, 0, 1});
  play.steps(1000);
  return out.compare(0.5005, play.q()[0]).compare(0, std::hypot(play.q()[1], play.q()[2]));
}

// Crank and rod of one length: the slider stands on the crank's axis at 90 degrees, where it may stay and the crank turn on. Four
// such passages.
Outcome slider_crank() {
  Builder b("slider_crank");
  b.set_gravity({0, 0, 0});
  const auto bar = [&](const std::string& name, const std::string& parent, double x) {
    b.add_joint(hinge(name, parent, {0, 0, 1}, at(x, 0, 0)))
        .add_body(name + "_bar", name, 1, {0.5, 0, 0}, diagonal(0, 1.0 / 12, 1.0 / 12));
  };
  bar("crank", "", 0), bar("rod", "crank", 1);
  b.add_joint(slide("slider", "", {1, 0, 0})).add_body("block", "slider", 1, {0, 0, 0}, no_inertia());
  b.add_constraint("pin", connect({1, 0, 0}, {0, 0, 0}), "rod_bar", "block");
  Play play(b.finish(), DYN_INTEGRATOR_REFERENCE, 0.01);
  const double angle = pi / 4, rate = 2;
  play.set_state(Vector{angle, -2 * angle, 2 * std::cos(angle)}, Vector{rate, -2 * rate, -2 * std::sin(angle) * rate});
  Outcome out;
  out.picture = {"time, s", "slider, m", false, {}};
  Curve& curve = out.curve("slider");
  const double energy = play.mechanical();
  play.steps(800, [&](double t) {
    const auto q = play.q();
    curve.add(t, q[2]);
    out.off_by(std::abs(q[2] - 2 * std::cos(q[0])));
  });
  return out.off_by(std::abs(play.mechanical() / energy - 1)).off_by(play.q()[0] > 4 * pi ? 0 : HUGE_VAL);
}

// Two links of 1 m in the x-y plane.
namespace {
Builder two_links() {
  Builder b("arm");
  b.set_gravity({0, -g, 0});
  for (int k = 0; k < 2; ++k) {
    const std::string name = k ? "elbow" : "shoulder";
    b.add_joint(hinge(name, k ? "shoulder" : "", {0, 0, 1}, at(k, 0, 0)))
        .add_body(name + "_link", name, 1, {0.5, 0, 0}, diagonal(0, 1.0 / 12, 1.0 / 12));
  }
  b.add_frame("tip", "elbow_link", at(1, 0, 0));
  return b;
}
}  // namespace

// The tip of a stretched arm (its Jacobian has lost a row) to places within reach, at the end of it, beyond it: as near as one
// can.
Outcome stretched_arm() {
  Data data(two_links().finish());
  const int tip = data.model().frame_id("tip");
  Outcome out;
  for (const double reach : {0.0, 1e-3, 1.0, 1.999, 2.0, 2.001, 2.5, 10.0})
    for (const double angle : {0.0, 1e-8, 0.5, pi / 2, pi})
      for (const double elbow : {0.0, 1e-9, pi}) {
        const auto found =
            data.ik({dyn::IkTask::position(tip, {reach * std::cos(angle), reach * std::sin(angle), 0})}, Vector{0, elbow});
        out.compare(std::max(0.0, reach - 2), found.result.residual_linear);
        if (found.converged() != (reach <= 2)) out.off_by(HUGE_VAL);
      }
  return out;
}

// The same with its tip tied to a slide along a wall at 2 m, which it reaches at one point only: no force that is finite holds it
// there, and what rows may be off by, r, lets the tip move by 2 sqrt(r): that and no more.
Outcome stretched_arm_at_wall() {
  Builder b = two_links();
  b.add_joint(slide("wall", "", {0, 1, 0}, at(2, 0, 0))).add_body("block", "wall", 1, {0, 0, 0}, no_inertia());
  b.add_constraint("hand", connect({1, 0, 0}, {0, 0, 0}), "elbow_link", "block");
  Play play(b.finish(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3);
  Outcome out;
  out.picture = {"time, s", "m", true, {{"rows", {}, {}}, {"tip", {}, {}}}};
  play.set_state(Vector(3));
  play.steps(1000, [&](double t) {
    const Vector3 x = play.point(play.model().frame_id("tip"));
    const double off = std::hypot(x[0] - 2, x[1] - play.q()[2]);
    out.picture.curves[0].add(t, off), out.picture.curves[1].add(t, std::abs(x[1]));
    out.off_by(off).off_by(std::abs(x[1]) < 2e-3 ? 0 : HUGE_VAL);
  });
  return out;
}

}  // namespace cli::stress
