// Closed mechanisms: redundant rows, singular passages, stiffness.
#include "cases.hpp"
#include "scene.hpp"

namespace cli::stress {

namespace {

constexpr Vector3 about_z{0, 0, 1};

// A uniform rod along x of its frame, from the origin.
void rod(Builder& b, const std::string& name, const std::string& joint, double length, double mass) {
  const double I = mass * length * length / 12;
  b.add_body(name, joint, mass, {length / 2, 0, 0}, diagonal(0, I, I));
}

}  // namespace

// ---------------------------------------------------------------------------------------------------- N-four-bar (IFToMM A02)

namespace {

// windows parallelograms in a row, uprights from (i, 0), couplers on top: rods of 1 m, 1 kg in the x-y plane. The uprights begin
// upright.
Play windows(int count) {
  Builder b("four_bars");
  b.set_gravity({0, -g, 0});
  for (int i = 0; i <= count; ++i) {
    const std::string k = std::to_string(i);
    b.add_joint(hinge("upright" + k, "", about_z, at(i, 0, 0)));
    rod(b, "upright_rod" + k, "upright" + k, 1, 1);
    if (i == count) break;
    b.add_joint(hinge("coupler" + k, "upright" + k, about_z, at(1, 0, 0)));
    rod(b, "coupler_rod" + k, "coupler" + k, 1, 1);
  }
  for (int i = 0; i < count; ++i)
    b.add_constraint("corner" + std::to_string(i), connect({1, 0, 0}, {1, 0, 0}), "coupler_rod" + std::to_string(i),
                     "upright_rod" + std::to_string(i + 1));
  Play play(b.finish(), DYN_INTEGRATOR_REFERENCE, 0.05);
  Vector q, v;
  for (int i = 0; i <= count; ++i) {
    q.push_back(pi / 2), v.push_back(-1);  // the top moves to +x by 1 m/s
    if (i < count) q.push_back(-pi / 2), v.push_back(1);
  }
  play.set_state(q, v);
  return play;
}

// x and y of the first upright's top and their rates at 20 s; windows: the largest difference of two uprights' angles.
Outcome four_bars(bool angles) {
  constexpr int count = 40;
  Play play = windows(count);
  play.set_step_options(DYN_INTEGRATOR_REFERENCE, 0.05,
                        1e-11);  // 4e-9 in all; less is beyond rounding near singular configurations
  Outcome out;
  out.picture = {"time, s", "x of B0, m", false, {}};
  Curve& curve = out.curve("x");
  const auto at0 = [&](std::size_t k) { return play.q()[k]; };
  for (int k = 0; k < 400; ++k) {
    play.advance(0.05);
    curve.add(play.time(), std::cos(at0(0)));
    if (!angles) continue;
    for (std::size_t i = 1; i <= count; ++i) out.off_by(std::abs(at0(2 * i) - at0(0)));
  }
  if (angles) return out;
  const double a = at0(0), w = play.v()[0];
  return out.compare(0.4109011537629452, std::cos(a))
      .compare(0.9116799009719807, std::sin(a))
      .compare(1.56678537190907, -w * std::sin(a))
      .compare(-0.7061622355938373, w * std::cos(a));
}

}  // namespace

Outcome four_bars_place() { return four_bars(false); }
Outcome four_bars_angles() { return four_bars(true); }

// ---------------------------------------------------------------------------------------------------- Bricard (IFToMM A04)

namespace {

// Five slender rods between P0 .. P5 and six hinges, P0 and P5 on the ground; the sixth closes the ring by five rows, or by two
// points of its axis: six.
Play bricard(bool six_rows) {
  const Vector3 P[] = {{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}, {0, 0, 1}};
  const Vector3 axes[] = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  Builder b("bricard");
  b.set_gravity({0, -g, 0});
  std::string parent;
  Vector3 along{};
  for (std::size_t k = 0; k < 5; ++k) {
    const Vector3 before = along;
    for (std::size_t i = 0; i < 3; ++i) along[i] = P[k + 1][i] - P[k][i];
    const std::string joint = "hinge" + std::to_string(k);
    b.add_joint(hinge(joint, parent, axes[k], at(before[0], before[1], before[2])));
    const auto I = [&](std::size_t i) { return (1 - along[i] * along[i]) / 12; };
    b.add_body("rod" + std::to_string(k), joint, 1, {along[0] / 2, along[1] / 2, along[2] / 2}, diagonal(I(0), I(1), I(2)));
    parent = joint;
  }
  if (six_rows) {
    b.add_constraint("end", connect(along, P[5]), "rod4");
    b.add_constraint("axis", connect({along[0] + 1, along[1], along[2]}, {P[5][0] + 1, P[5][1], P[5][2]}), "rod4");
  } else {
    dynConstraint c = connect(along, P[5]);
    c.type = DYN_CONSTRAINT_TYPE_LOOP, c.joint_type = DYN_JOINT_TYPE_REVOLUTE;
    for (std::size_t i = 0; i < 3; ++i) c.axis[i] = axes[5][i];
    b.add_constraint("end", c, "rod4");
  }
  Play play(b.finish());
  play.set_state(play.model().neutral());
  return play;
}

Outcome bricard_place(bool six_rows) {
  Play play = bricard(six_rows);
  const int rod3 = play.model().frame_id("rod2");
  Outcome out;
  out.picture = {"time, s", "P3, m", false, {{"x", {}, {}}, {"y", {}, {}}, {"z", {}, {}}}};
  Vector3 x{};
  play.steps(100, [&](double t) {
    x = play.point(rod3, {0, 0, 1});
    for (std::size_t k = 0; k < 3; ++k) out.picture.curves[k].add(t, x[k]);
  });
  return out.compare(0.999999729401917775, x[0]).compare(-1.00073538991051202, x[1]).compare(0.999264339690327738, x[2]);
}

}  // namespace

Outcome bricard_five_rows() { return bricard_place(false); }
Outcome bricard_six_rows() { return bricard_place(true); }
// P3 after a second of default steps by each integrator.
Outcome bricard_default() {
  Outcome out;
  const auto end = [](Play& play) {
    play.steps(1000);
    return play.point(play.model().frame_id("rod2"), {0, 0, 1});
  };
  Play exact = bricard(false);
  exact.set_step_options(DYN_INTEGRATOR_REFERENCE, 1e-3);
  const Vector3 reference = end(exact);
  for (const dynIntegrator integrator : {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_INTEGRATOR_IMPLICIT_FAST, DYN_INTEGRATOR_RK4,
                                         DYN_INTEGRATOR_RK45, DYN_INTEGRATOR_IMPLICIT_MIDPOINT}) {
    Play play = bricard(false);
    play.set_step_options(integrator, 1e-3);
    const Vector3 x = end(play);
    for (std::size_t k = 0; k < 3; ++k) out.compare(reference[k], x[k]);
  }
  return out;
}
Outcome bricard_energy() {
  Play play = bricard(false);
  Outcome out;
  EnergyDrift drift(out, play, 3 * g);
  play.steps(100, [&](double) { drift.look(); });
  return out;
}

// ---------------------------------------------------------------------------------------------------- Andrews' squeezer (IVP
// test set)

namespace {

struct Squeezer {
  static constexpr double xa = -0.06934, ya = -0.00227, xb = -0.03635, yb = 0.03273, xc = 0.014, yc = 0.072;
  static constexpr double d = 0.028, da = 0.0115, e = 0.02, ea = 0.01421, rr = 0.007, ra = 0.00092, ss = 0.035, sa = 0.01874,
                          sb = 0.01043, sc = 0.018, sd = 0.02;
  static constexpr double ta = 0.02308, tb = 0.00916, u = 0.04, ua = 0.01228, ub = 0.00449, zf = 0.02, zt = 0.04, fa = 0.01421;
  static constexpr double c0 = 4530, l0 = 0.07785, torque = 0.033;

  Model model;
  Squeezer() : model(build()) {}

  // Angles of the test set: beta, Theta, gamma, Phi, delta, Omega, epsilon. The third body hangs on the spring, a telescope from
  // C.
  static Model build() {
    Builder b("squeezer");
    b.set_gravity({0, 0, 0});
    const auto body = [&](const char* name, const char* joint, double mass, double I, double x, double y) {
      b.add_body(name, joint, mass, {x, y, 0}, diagonal(I / 2, I / 2, I));
    };
    b.add_joint(hinge("beta", "", about_z));
    body("K1", "beta", 0.04325, 2.194e-6, ra, 0);
    b.add_joint(hinge("theta", "beta", about_z, at(rr, 0, 0)));
    body("K2", "theta", 0.00365, 4.410e-7, -da, 0);
    b.add_joint(hinge("spring_angle", "", about_z, at(xc, yc, 0)));
    JointSpec spring = slide("spring", "spring_angle", {1, 0, 0});
    spring.stiffness = {c0}, spring.spring_reference = {l0};
    b.add_joint(spring).add_joint(hinge("spring_end", "spring", about_z));
    body("K3", "spring_end", 0.02373, 5.255e-6, sb - sd, sc - sa);  // from D: (sb, -sa) - (sd, -sc)
    b.add_joint(hinge("delta", "", about_z, at(xa, ya, 0)));
    body("K5", "delta", 0.07050, 1.169e-5, ta, tb);
    b.add_joint(hinge("phi", "delta", about_z, at(zt, 0, 0)));
    body("K4", "phi", 0.00706, 5.667e-7, 0, ea - e);
    b.add_joint(hinge("epsilon", "", about_z, at(xa, ya, 0)));
    body("K7", "epsilon", 0.05498, 1.912e-5, -ub, -ua);
    b.add_joint(hinge("omega", "epsilon", about_z, at(0, -u, 0)));
    body("K6", "omega", 0.00706, 5.667e-7, zf - fa, 0);
    b.add_constraint("B", connect({-sd, sc, 0}, {xb, yb, 0}), "K3");
    b.add_constraint("K3_K2", connect({-sd, sc - ss, 0}, {-d, 0, 0}), "K3", "K2");
    b.add_constraint("K4_K2", connect({0, -e, 0}, {-d, 0, 0}), "K4", "K2");
    b.add_constraint("K6_K2", connect({zf, 0, 0}, {-d, 0, 0}), "K6", "K2");
    return b.finish();
  }
  std::size_t index(const char* joint) const { return static_cast<std::size_t>(model.joint_info(model.joint_id(joint)).idx_q); }
};

}  // namespace

Outcome andrews_squeezer() {
  const Squeezer s;
  Play play(s.model, DYN_INTEGRATOR_REFERENCE, 1e-4);
  const char* names[] = {"beta", "theta", nullptr, "phi", "delta", "omega", "epsilon"};
  const double start[] = {-0.0617138900142764496358948458001, 0,
                          0.455279819163070380255912382449,   0.222668390165885884674473185609,
                          0.487364979543842550225598953530,   -0.222668390165885884674473185609,
                          1.23054744454982119249735015568};
  const double end[] = {1.5810771195153707097119e+01,  -1.5756371058411839469728e+01, 4.0822240119645804858282e-02,
                        -5.3473011634207959377019e-01, 5.2440996587995406937166e-01,  5.3473011634207959377019e-01,
                        1.0480807410419378730685e+00};
  Vector q(static_cast<std::size_t>(s.model.nq())), tau(q.size());
  for (std::size_t k = 0; k < 7; ++k)
    if (names[k]) q[s.index(names[k])] = start[k];
  // the spring from C to D, and the third body's angle
  const double gamma = start[2],
               x = Squeezer::xb + Squeezer::sc * std::sin(gamma) + Squeezer::sd * std::cos(gamma) - Squeezer::xc,
               y = Squeezer::yb - Squeezer::sc * std::cos(gamma) + Squeezer::sd * std::sin(gamma) - Squeezer::yc;
  const std::size_t angle = s.index("spring_angle"), length = s.index("spring"), last = s.index("spring_end");
  q[angle] = std::atan2(y, x), q[length] = std::hypot(x, y), q[last] = gamma - q[angle];
  tau[s.index("beta")] = Squeezer::torque;
  play.set_state(q, Vector(q.size()), Vector(q.size()), tau);
  Outcome out;
  out.picture = {"time, s", "angle, rad", false, {}};
  for (const char* name : {"beta", "theta", "gamma", "phi", "delta", "omega", "epsilon"}) out.curve(name);
  const auto angle_of = [&](std::size_t k) { return names[k] ? play.q()[s.index(names[k])] : play.q()[angle] + play.q()[last]; };
  play.steps(300, [&](double t) {
    for (std::size_t k = 0; k < 7; ++k) out.picture.curves[k].add(t, angle_of(k));
  });
  for (std::size_t k = 0; k < 7; ++k) out.compare(end[k], angle_of(k));
  return out;
}

// ---------------------------------------------------------------------------------------------------- flyball governor (IFToMM
// A05)

namespace {

// On a shaft about z a slider of 3 kg; from it springs of 8e5 N/m with dampers of 4e4 N s/m to the middles of two rods that hang
// on the shaft at 1 m, 5 kg at their tips. Each spring is a telescope that carries its rod, whose upper end closes the loop.
// Height of the slider at time t.
Outcome governor(dynIntegrator integrator, double dt, double duration, double expected,
                 dynContactSolverType solver = DYN_CONTACT_SOLVER_TYPE_ADMM) {
  Builder b("governor");
  const double side = 0.01, rod_mass = 0.3, along = rod_mass * side * side / 6, across = rod_mass * (1 + side * side) / 12;
  b.add_joint(hinge("shaft", "", {0, 0, 1}))
      .add_body("shaft_bar", "shaft", rod_mass, {0, 0, 0.5}, diagonal(across, across, along));
  b.add_joint(slide("slider", "shaft", {0, 0, 1}))
      .add_body("slider_block", "slider", 3, {0, 0, 0}, diagonal(0.005, 0.005, 0.005));
  Vector q = {0, 0.5}, v = {2 * pi, 0};
  for (const double sign : {1.0, -1.0}) {
    const std::string name = sign > 0 ? "right" : "left";
    b.add_joint(hinge(name + "_foot", "slider", {0, -1, 0}, turned({0, 0, 1}, sign > 0 ? 0 : pi, {sign * 0.05, 0, 0})));
    JointSpec spring = slide(name + "_spring", name + "_foot", {1, 0, 0});
    spring.stiffness = {8e5}, spring.damping = {4e4}, spring.spring_reference = {0.5};
    b.add_joint(spring).add_joint(hinge(name + "_middle", name + "_spring", {0, -1, 0}));
    b.add_body(name + "_rod", name + "_middle", rod_mass, {0, 0, 0}, diagonal(along, across, across));
    b.add_body(name + "_ball", name + "_middle", 5, {0.5, 0, 0}, no_inertia());
    b.add_constraint(name + "_top", connect({-0.5, 0, 0}, {sign * 0.05, 0, 1}), name + "_rod", "shaft_bar");
    q.insert(q.end(), {pi / 6, 0.5, -pi / 3}), v.insert(v.end(), {0, 0, 0});
  }
  Play play(b.finish());
  dynStepOptions options = play.step_options();
  options.integrator = integrator, options.dt = dt, options.solver = solver;
  play.set_step_options(options), play.set_state(q, v);
  Outcome out;
  out.picture = {"time, s", "height of the slider, m", false, {}};
  Curve& curve = out.curve("s");
  const int steps = static_cast<int>(std::lround(duration / dt)), every = std::max(1, steps / 500);
  for (int k = 0; k < steps; ++k) {
    play.step();
    if (k % every == 0) curve.add(play.time(), play.q()[1]);
  }
  return out.compare(expected, play.q()[1]);
}

}  // namespace

Outcome governor_reference() { return governor(DYN_INTEGRATOR_REFERENCE, 1e-3, 1, 0.501420922379567651); }
Outcome governor_100ms() { return governor(DYN_INTEGRATOR_REFERENCE, 1e-3, 0.1, 0.523836475569575694); }
Outcome governor_5s() { return governor(DYN_INTEGRATOR_REFERENCE, 1e-3, 5, 0.535563103721643485); }
Outcome governor_rk4() { return governor(DYN_INTEGRATOR_RK4, 1e-4, 1, 0.501420922379567651); }
// By each solver, and by each integrator: those that are explicit take shorter steps by themselves.
Outcome governor_default() {
  constexpr double expected = 0.501420922379567651;
  Outcome out;
  const auto end = [](dynIntegrator integrator, dynContactSolverType solver) {
    return governor(integrator, 1e-3, 1, expected, solver).result[0];
  };
  for (const dynContactSolverType solver :
       {DYN_CONTACT_SOLVER_TYPE_PGS, DYN_CONTACT_SOLVER_TYPE_ADMM, DYN_CONTACT_SOLVER_TYPE_NEWTON})
    out.compare(expected, end(DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, solver));
  for (const dynIntegrator integrator : {DYN_INTEGRATOR_RK4, DYN_INTEGRATOR_RK45, DYN_INTEGRATOR_IMPLICIT_MIDPOINT})
    out.compare(expected, end(integrator, DYN_CONTACT_SOLVER_TYPE_ADMM));
  return out;
}
Outcome governor_implicit() { return governor(DYN_INTEGRATOR_IMPLICIT_FAST, 1e-3, 1, 0.501420922379567651); }

}  // namespace cli::stress
