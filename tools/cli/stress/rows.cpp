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

}  // namespace

// One, two and ten times the same rows: the same accelerations and forces at the joints.
Outcome duplicate_rows() {
  Outcome out;
  Vector once, forces_once;
  Data single(four_bar(1), DYN_PART_CONSTRAINTS);
  const auto start = single.project(Vector{1.2, -0.9, 1.4}, Vector{1, 0.3, 0.2});
  for (const int times : {1, 2, 10}) {
    Data data(four_bar(times), DYN_PART_CONSTRAINTS | DYN_PART_INVERSE);
    const auto found = data.constrained_dynamics(start.q, start.v, Vector{0.5, 0, 0});
    const auto terms = data.constraint_terms(start.q, start.v);
    Vector forces(3);
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < terms.J.rows; ++r)
        forces[static_cast<std::size_t>(c)] += terms.J(r, c) * found.lambda[static_cast<std::size_t>(r)];
    if (times == 1) once = found.x, forces_once = forces;
    for (std::size_t k = 0; k < 3; ++k)
      out.compare(once[k], found.x[k], std::abs(once[k]))
          .compare(forces_once[k], forces[k], std::max(1.0, std::abs(forces_once[k])));
  }
  return out;
}

// Three bodies that fly freely, tied by four hinges: 20 rows of rank 17 for 18 degrees of freedom; the accelerations of the tree.
Outcome four_bar_in_space() {
  Data tree(four_bar(1), DYN_PART_CONSTRAINTS | DYN_PART_KINEMATICS);
  const auto start = tree.project(Vector{1.2, -0.9, 1.4}, Vector{1, 0.3, 0.2});
  const auto reference = tree.constrained_dynamics(start.q, start.v, Vector(3));
  Builder b("bodies");
  b.set_gravity({0, -g, 0});
  const char* names[] = {"crank", "coupler", "rocker"};
  const double lengths[] = {1, 3, 2.5};
  for (int k = 0; k < 3; ++k) {
    const double l = lengths[k];
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
  Vector q, v;
  Outcome out;
  tree.forward_kinematics(start.q, start.v, reference.x);
  Vector expected;
  for (const char* name : names) {
    const int frame = tree.model().frame_id(std::string(name) + "_bar");
    const Placement X = tree.frame_placement(frame);
    const double angle = std::atan2(X[1], X[0]);
    q.insert(q.end(), {X[9], X[10], X[11], 0, 0, std::sin(angle / 2), std::cos(angle / 2)});
    const auto V = tree.frame_velocity(frame), A = tree.frame_acceleration(frame);
    v.insert(v.end(), V.begin(), V.end()), expected.insert(expected.end(), A.begin(), A.end());
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
