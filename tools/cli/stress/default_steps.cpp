// Mechanisms in default steps of 1 ms with each integrator and solver, and scenes at rest.
#include "cases.hpp"
#include "scene.hpp"

namespace cli::stress {

namespace {

constexpr dynIntegrator integrators[] = {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_INTEGRATOR_IMPLICIT_FAST, DYN_INTEGRATOR_RK4,
                                         DYN_INTEGRATOR_RK45, DYN_INTEGRATOR_IMPLICIT_MIDPOINT};
constexpr dynContactSolverType solvers[] = {DYN_CONTACT_SOLVER_TYPE_PGS, DYN_CONTACT_SOLVER_TYPE_ADMM,
                                            DYN_CONTACT_SOLVER_TYPE_NEWTON};

// f(play) for steps of 1 ms by each integrator with each solver; the solvers act in steps of order 1 alone.
template <class Make, class F>
void each_setting(Make&& make, F&& f) {
  for (const dynIntegrator integrator : integrators)
    for (const dynContactSolverType solver : solvers) {
      const bool first_order = integrator == DYN_INTEGRATOR_SEMI_IMPLICIT_EULER || integrator == DYN_INTEGRATOR_IMPLICIT_FAST;
      if (!first_order && solver != DYN_CONTACT_SOLVER_TYPE_ADMM) continue;
      Play play = make();
      dynStepOptions options = play.step_options();
      options.integrator = integrator, options.solver = solver, options.dt = 1e-3;
      play.set_step_options(options);
      f(play);
    }
}

void rod(Builder& b, const std::string& name, const std::string& joint, double length) {
  b.add_body(name, joint, 1, {length / 2, 0, 0}, diagonal(1e-3, length * length / 12, length * length / 12));
}

// Rods of 1, 1.3 and 0.8 m, closed at (1.1, 0); the coupler's hinge leans by `tilt` from the normal of the plane.
Play tilted_four_bar(double tilt) {
  Builder b("tilted");
  b.set_gravity({0, -g, 0});
  b.add_joint(hinge("a", "", {0, 0, 1}));
  rod(b, "crank", "a", 1);
  b.add_joint(hinge("b", "a", {0.6 * std::sin(tilt), 0.8 * std::sin(tilt), std::cos(tilt)}, at(1, 0, 0)));
  rod(b, "coupler", "b", 1.3);
  b.add_joint(hinge("c", "b", {0, 0, 1}, at(1.3, 0, 0)));
  rod(b, "rocker", "c", 0.8);
  dynConstraint pin = connect({0.8, 0, 0}, {1.1, 0, 0});
  pin.type = DYN_CONSTRAINT_TYPE_LOOP, pin.joint_type = DYN_JOINT_TYPE_REVOLUTE, pin.axis[2] = 1;
  b.add_constraint("pin", pin, "rocker");
  return Play(b.finish());
}

// The same in the x-z plane from a URDF, whose right angles have four digits.
Play four_bar_of_urdf() {
  const auto link = [](const std::string& name, double length) {
    const std::string middle = std::to_string(length / 2), across = std::to_string(length * length / 12);
    return "<link name='" + name + "'><inertial><origin xyz='" + middle + " 0 0'/><mass value='1'/><inertia ixx='0.001' iyy='" +
           across + "' izz='" + across + "' ixy='0' ixz='0' iyz='0'/></inertial></link>";
  };
  const auto joint = [](const std::string& name, const std::string& parent, const std::string& child, const std::string& origin,
                        const char* axis) {
    return "<joint name='" + name + "' type='continuous'><parent link='" + parent + "'/><child link='" + child + "'/><origin " +
           origin + "/><axis xyz='" + axis + "'/></joint>";
  };
  const std::string text = "<robot name='four_bar'><link name='ground'/>" + link("crank", 1) + link("coupler", 1.3) +
                           link("rocker", 0.8) +
                           joint("a", "ground", "crank", "rpy='1.5708 0 0'", "0 0 1") +
                           joint("b", "crank", "coupler", "xyz='1 0 0' rpy='-1.5708 0 0'", "0 -1 0") +
                           joint("c", "coupler", "rocker", "xyz='1.3 0 0' rpy='1.5708 0 0'", "0 0 1") + "</robot>";
  dyn::LoadOptions options;
  options.base(DYN_BASE_FIXED);
  Builder b(Model::load_string(text, options));
  dynConstraint pin = connect({0.8, 0, 0}, {1.1, 0, 0});
  pin.type = DYN_CONSTRAINT_TYPE_LOOP, pin.joint_type = DYN_JOINT_TYPE_REVOLUTE, pin.axis[2] = 1;
  const Placement upright = turned({1, 0, 0}, 1.5708, {1.1, 0, 0});
  std::copy(upright.begin(), upright.end(), pin.placement2);
  b.add_constraint("pin", pin, "rocker");
  return Play(b.finish());
}

// Angle of the crank half a second after it was let go.
double crank_angle(Play& play) {
  static const Vector start = tilted_four_bar(0).project(Vector{1, -0.9, -1.2}, Vector(3)).q;  // of the exact mechanism
  play.set_state(start);
  play.steps(500);
  return play.q()[0];
}

// Three arms of 0.3 m on hinges; from each two rods of 0.6 m on balls to a platform.
Play delta_robot() {
  Builder b("delta");
  add_free(b, "platform", 1, diagonal(0.01, 0.01, 0.02));
  for (int k = 0; k < 3; ++k) {
    const double angle = 2 * pi / 3 * k, c = std::cos(angle), s = std::sin(angle);
    const std::string name = "arm" + std::to_string(k);
    b.add_joint(hinge(name + "_hinge", "", {0, 1, 0}, turned({0, 0, 1}, angle, {0.2 * c, 0.2 * s, 0})));
    b.add_body(name, name + "_hinge", 0.5, {0.15, 0, 0}, diagonal(1e-4, 4e-3, 4e-3));
    for (const double side : {-0.05, 0.05}) {
      const std::string rod = name + (side < 0 ? "_left" : "_right");
      JointSpec ball(rod + "_ball", DYN_JOINT_TYPE_SPHERICAL, name + "_hinge");
      ball.placement(at(0.3, side, 0)), ball.damping = {1e-3, 1e-3, 1e-3};
      b.add_joint(ball).add_body(rod, rod + "_ball", 0.1, {0, 0, -0.3}, diagonal(3e-3, 3e-3, 1e-4));
      b.add_constraint(rod + "_pin", connect({0, 0, -0.6}, {0.05 * c - side * s, 0.05 * s + side * c, 0}), rod, "platform");
    }
  }
  Play play(b.finish());
  Vector q = play.model().neutral();
  q[2] = -0.5;
  const auto closed = play.project(q, Vector(static_cast<std::size_t>(play.model().nv())));
  play.set_state(closed.q);
  return play;
}

// A trunk on four legs, each a parallelogram of thigh, shank, link and rocker that a pin closes; servos hold the hips.
Play legged_robot() {
  Builder b("legged");
  add_ground(b, material(0.8));
  add_free(b, "trunk", 8, box_inertia(8, {0.5, 0.3, 0.1}));
  for (int k = 0; k < 4; ++k) {
    const std::string leg = "leg" + std::to_string(k);
    const double x = k < 2 ? 0.2 : -0.2, y = k % 2 ? 0.15 : -0.15;
    const auto bar = [&](const std::string& name, double length) {
      const double I = 0.3 * length * length / 12;
      b.add_body(leg + name, leg + name + "_joint", 0.3, {0, 0, -length / 2}, diagonal(I, I, 1e-4));
    };
    b.add_joint(hinge(leg + "_thigh_joint", "trunk_joint", {0, 1, 0}, at(x, y, 0)));
    bar("_thigh", 0.2);
    b.add_joint(hinge(leg + "_shank_joint", leg + "_thigh_joint", {0, 1, 0}, at(0, 0, -0.2)));
    bar("_shank", 0.25);
    add_shape(b, leg + "_shank", DYN_SHAPE_TYPE_SPHERE, {0.02, 0, 0}, material(0.8), at(0, 0, -0.23));
    b.add_joint(hinge(leg + "_rocker_joint", "trunk_joint", {0, 1, 0}, at(x - 0.05, y, 0.0)));
    bar("_rocker", 0.2);
    b.add_constraint(leg + "_pin", connect({0, 0, -0.2}, {-0.05, 0, 0}), leg + "_rocker", leg + "_shank");
    dynActuator servo;
    dyn_actuator_init(&servo, DYN_ACTUATOR_TYPE_POSITION);
    servo.kp = 300, servo.kv = 5;
    b.add_actuator(leg + "_servo", servo, leg + "_thigh_joint");
  }
  Play play(b.finish());
  Vector q = play.model().neutral();
  q[2] = 0.5;
  play.set_state(q);
  return play;
}

template <class Make>
Model heap_model(Make&& make) {
  Builder b("heap");
  add_ground(b, material(0.6));
  make(b);
  return b.finish();
}

}  // namespace

// Each tilt ends as the exact mechanism does: what is left is the error of the methods of order 1.
Outcome misaligned_four_bars() {
  Outcome out;
  Play exact = tilted_four_bar(0);
  exact.set_step_options(DYN_INTEGRATOR_REFERENCE, 1e-3);
  const double reference = crank_angle(exact);
  for (const double tilt : {0.0, 1e-12, 1e-8, 3.7e-6, 1e-4})
    each_setting([&] { return tilted_four_bar(tilt); }, [&](Play& play) { out.compare(reference, crank_angle(play)); });
  return out;
}

Outcome four_digit_angles() {
  Outcome out;
  Play exact = tilted_four_bar(0);
  exact.set_step_options(DYN_INTEGRATOR_REFERENCE, 1e-3);
  const double reference = crank_angle(exact);
  each_setting(four_bar_of_urdf, [&](Play& play) { out.compare(reference, crank_angle(play)); });
  return out;
}

// Place of the platform after it fell for 0.2 s.
Outcome delta_default() {
  Outcome out;
  const auto fall = [](Play& play) {
    play.steps(200);
    return Vector3{play.q()[0], play.q()[1], play.q()[2]};
  };
  Play exact = delta_robot();
  exact.set_step_options(DYN_INTEGRATOR_REFERENCE, 1e-3);
  const Vector3 reference = fall(exact);
  each_setting(delta_robot, [&](Play& play) {
    const Vector3 x = fall(play);
    for (std::size_t k = 0; k < 3; ++k) out.compare(reference[k], x[k]);
  });
  return out;
}

// It lands and stands: kinetic energy never exceeds that of the fall, and fades.
Outcome legged_loops() {
  Outcome out;
  each_setting(legged_robot, [&](Play& play) {
    const double fall = 8 * g * 0.1 + 12 * 0.3 * g * 0.1;
    double most = 0;
    for (int k = 0; k < 1500; ++k) play.step(), most = std::max(most, play.energy().kinetic);
    out.off_by(std::max(0.0, most / fall - 1)).off_by(play.energy().kinetic / fall);
  });
  return out;
}

// Bricks in running bond stay where they were laid.
Outcome wall_stands() {
  constexpr int rows = 6, columns = 5;
  Play play(heap_model([](Builder& b) {
              for (int k = 0; k < rows * columns; ++k) add_box(b, "brick" + std::to_string(k), 1, {0.4, 0.2, 0.2}, material(0.6));
            }), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 2e-3);
  Vector q;
  for (int k = 0; k < rows * columns; ++k) {
    const int row = k / columns;
    q.insert(q.end(), {0.4 * (k % columns) + 0.2 * (row % 2), 0, 0.1 + 0.2 * row, 0, 0, 0, 1});
  }
  play.set_state(q);
  play.steps(1000);
  Outcome out;
  for (std::size_t k = 0; k < q.size(); ++k) out.off_by(std::abs(play.q()[k] - q[k]));
  return out;
}

// 27 boxes fall turned into a pit between four planes and come to rest.
Outcome bin_settles() {
  Play play(heap_model([](Builder& b) {
              for (const double angle : {0.0, pi / 2, pi, 3 * pi / 2})
                add_shape(b, "", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.6),
                          turned({-std::sin(angle), std::cos(angle), 0}, pi / 2,
                                 {-0.4 * std::cos(angle), -0.4 * std::sin(angle), 0}));
              for (int k = 0; k < 27; ++k) add_box(b, "box" + std::to_string(k), 1, {0.14, 0.14, 0.14}, material(0.6));
            }), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 2e-3);
  Vector q;
  for (int k = 0; k < 27; ++k) {
    const double a = std::sin(3.0 * k), b = std::sin(5.0 * k), c = std::sin(7.0 * k), d = std::sin(11.0 * k + 1);
    const double size = std::sqrt(a * a + b * b + c * c + d * d);
    const double at[] = {0.25 * (k % 3 - 1), 0.25 * (k / 3 % 3 - 1), 0.15 + 0.25 * (k / 9)};
    q.insert(q.end(), {at[0], at[1], at[2], a / size, b / size, c / size, d / size});
  }
  play.set_state(q);
  play.steps(1500);
  Outcome out;
  for (const double v : play.v()) out.off_by(std::abs(v));
  return out;
}

}  // namespace cli::stress
