// Derivatives of a step by parameters, against differences of steps of models that are built with other numbers.
#include <functional>

#include "simulation/step_derivatives.hpp"

namespace dyn_test {
namespace {

struct Parameters {
  std::vector<dynStepParameterType> types;
  std::vector<std::int32_t> index;
  void add(dynStepParameterType type, int k = 0) { types.push_back(type), index.push_back(k); }
};

std::size_t numbers_of(dynStepParameterType type) {
  return type == DYN_STEP_PARAMETER_TYPE_INERTIA ? 10 : type == DYN_STEP_PARAMETER_TYPE_GRAVITY ? 3 : 1;
}

// The numbers of a quantity of an object of the builder changed by f.
void change(dynBuilder* b, const std::string& object, const std::string& name, const char* quantity,
            const std::function<void(Numbers&)>& f) {
  for (int k = 0; k < dyn_builder_parameter_count(b); ++k) {
    dynParameter p{};
    p.struct_size = sizeof p;
    ASSERT_EQ(DYN_OK, dyn_builder_parameter(b, k, &p));
    if (p.object != object || p.name != name || std::string(p.quantity) != quantity) continue;
    Numbers x(p.values, p.values + p.count);
    f(x);
    ASSERT_EQ(DYN_OK, dyn_builder_set_parameter(b, k, x.data(), x.size())) << dyn_last_error();
    return;
  }
  ADD_FAILURE() << object << " '" << name << "' has no " << quantity;
}

// pi of a link in its own frame, which is that of its joint, plus s in one component.
void change_inertia(dynBuilder* b, const std::string& link, std::size_t component, double s) {
  double pi[10];
  Numbers com, I;
  change(b, "link", link, "com", [&](Numbers& x) { com = x; });
  change(b, "link", link, "inertia", [&](Numbers& x) { I = x; });
  change(b, "link", link, "mass", [&](Numbers& x) { pi[0] = x[0]; });
  const auto about_com = [&](double sign) {  // I -= sign m (c^2 1 - c c^T); xx, yy, zz, xy, xz, yz
    const double x = com[0], y = com[1], z = com[2], m = sign * pi[0];
    const double by[6] = {y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z};
    for (std::size_t k = 0; k < 6; ++k) I[k] -= m * by[k];
  };
  about_com(-1);
  constexpr std::size_t of[6] = {4, 6, 9, 5, 7, 8};  // pi: xx, xy, yy, xz, yz, zz
  for (std::size_t k = 0; k < 3; ++k) pi[1 + k] = pi[0] * com[k];
  for (std::size_t k = 0; k < 6; ++k) pi[of[k]] = I[k];
  pi[component] += s;
  for (std::size_t k = 0; k < 3; ++k) com[k] = pi[1 + k] / pi[0];
  for (std::size_t k = 0; k < 6; ++k) I[k] = pi[of[k]];
  about_com(1);
  change(b, "link", link, "mass", [&](Numbers& x) { x[0] = pi[0]; });
  change(b, "link", link, "com", [&](Numbers& x) { x = com; });
  change(b, "link", link, "inertia", [&](Numbers& x) { x = I; });
}

struct Products {
  Numbers P, jvp, vjp;
  dynStepDerivativeReport report{};
  dynStatus status;
};
// P, and a product each way.
Products parameter_derivatives(Stepper& run, const Parameters& p, const Numbers& tangent, const Numbers& cotangent,
                               dynDerivativeMethod method = DYN_DERIVATIVE_METHOD_ANALYTIC) {
  Products x;
  const std::size_t rows = cotangent.size();
  std::size_t numbers = 0;
  for (const dynStepParameterType t : p.types) numbers += numbers_of(t);
  x.P.resize(rows * numbers), x.jvp.resize(rows), x.vjp.resize(tangent.size());
  x.report.struct_size = sizeof x.report;
  dynStepDerivativeOptions options;
  dyn_step_derivative_options_init(&options);
  options.method = method;
  dynStepDerivatives out;
  dyn_step_derivatives_init(&out);
  out.parameters = p.types.data(), out.parameter_index = p.index.data();
  out.parameter_count = static_cast<std::int32_t>(p.types.size());
  out.P = x.P.data(), out.report = &x.report;
  out.tangents = tangent.data(), out.jvp = x.jvp.data(), out.cotangents = cotangent.data(), out.vjp = x.vjp.data();
  out.tangent_count = out.cotangent_count = 1;
  x.status = dyn_step_derivatives(run.m, run.d, &options, &out);
  return x;
}

void switch_all_effects_on(const dynModel* m, dynData* d) {
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(m, d, 0, DYN_EFFECT_ALL & ~std::uint32_t(DYN_EFFECT_SLEEPING))) << dyn_last_error();
}

// The next state of a model that differs from run's, from its state.
void step_of(Stepper& run, const std::function<void(dynBuilder*)>& edit, double dt, Numbers& q, Numbers& v) {
  dynBuilder* b = nullptr;
  ASSERT_EQ(DYN_OK, dyn_builder_from_model(run.m, &b));
  edit(b);
  dynModel* m = nullptr;
  ASSERT_EQ(DYN_OK, dyn_builder_finish(b, &m)) << dyn_last_error();
  dyn_builder_free(b);
  Stepper other{Model(m)};
  other.options = run.options, other.options.dt = dt;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(other.m, other.d, &other.options));
  switch_all_effects_on(other.m, other.d);
  if (dyn_model_nu(m) > 0) {
    ASSERT_EQ(DYN_OK, dyn_data_set_control(m, other.d, run.value("ctrl").data())) << dyn_last_error();
  }
  other.set(run.value("q"), run.value("v"), run.value("tau_applied"));
  const Derivatives x = derivatives(other.m, other.d, DYN_DERIVATIVE_METHOD_ANALYTIC);
  ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
  q = x.q, v = x.v;
}

// Agreement with differences, each column to `within` of its largest entry; and of both products with the matrices.
void agree(Stepper& run, const Parameters& p, double within = 1e-6) {
  const auto nv = static_cast<std::size_t>(run.m.nv()), rows = 2 * nv;
  switch_all_effects_on(run.m, run.d);
  const Derivatives base = derivatives(run.m, run.d, DYN_DERIVATIVE_METHOD_ANALYTIC);
  ASSERT_EQ(DYN_OK, base.status) << dyn_last_error();
  EXPECT_EQ(0, base.report.degenerate) << Stepper::modes(base);
  std::size_t numbers = 0;
  for (const dynStepParameterType t : p.types) numbers += numbers_of(t);
  const auto inputs = base.A.size() / rows + base.B.size() / rows + base.B_control.size() / rows;
  Numbers tangent(inputs + numbers), cotangent(rows);
  for (std::size_t k = 0; k < tangent.size(); ++k) tangent[k] = std::sin(1.3 * double(k) + 0.2);
  for (std::size_t k = 0; k < rows; ++k) cotangent[k] = std::sin(2.1 * double(k) + 0.4);
  const Products x = parameter_derivatives(run, p, tangent, cotangent);
  ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
  // products
  const Numbers all = joined({base.A, base.B, base.B_control, x.P});
  double size = 0, off = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    double sum = 0, most = 0;
    for (std::size_t k = 0; k < tangent.size(); ++k)
      sum += all[i + rows * k] * tangent[k], most += std::abs(all[i + rows * k] * tangent[k]);
    size = std::max(size, most), off = std::max(off, std::abs(sum - x.jvp[i]));
  }
  EXPECT_LE(off, 1e-10 * size) << "jvp";
  for (std::size_t k = 0; k < tangent.size(); ++k) {
    double sum = 0, most = 0;
    for (std::size_t i = 0; i < rows; ++i)
      sum += all[i + rows * k] * cotangent[i], most += std::abs(all[i + rows * k] * cotangent[i]);
    EXPECT_NEAR(sum, x.vjp[k], 1e-10 * std::max(most, 1e-3 * size)) << "vjp " << k;
  }
  // differences
  std::size_t number = 0;
  for (std::size_t k = 0; k < p.types.size(); ++k)
    for (std::size_t c = 0; c < numbers_of(p.types[k]); ++c, ++number) {
      SCOPED_TRACE("parameter " + std::to_string(p.types[k]) + " of " + std::to_string(p.index[k]) + ", number " +
                   std::to_string(c));
      double dt = run.options.dt, epsilon = p.types[k] == DYN_STEP_PARAMETER_TYPE_INERTIA ? 2e-5 : 1e-4;
      const auto of_dof = [&](dynBuilder* b, const char* quantity, double s) {
        dynJointInfo info{};
        for (int j = 1; j < run.m.njoints(); ++j) {
          info.struct_size = sizeof info;
          ASSERT_EQ(DYN_OK, dyn_model_joint_info(run.m, j, &info));
          const int dof = p.index[k] - info.idx_v;
          if (info.mimic_leader < 0 && dof >= 0 && dof < info.nv)
            return change(b, "joint", info.name, quantity, [&](Numbers& y) { y[static_cast<std::size_t>(dof)] += s; });
        }
      };
      const auto edit = [&](double s) {
        return [&, s](dynBuilder* b) {
          switch (p.types[k]) {
            case DYN_STEP_PARAMETER_TYPE_INERTIA: {
              const char* link = nullptr;
              dynFrameInfo f{};
              for (int i = 0; i < run.m.nframes(); ++i) {
                f.struct_size = sizeof f;
                ASSERT_EQ(DYN_OK, dyn_model_frame_info(run.m, i, &f));
                if (f.type == DYN_FRAME_TYPE_BODY && f.joint == p.index[k] && !link) link = f.name;
              }
              return change_inertia(b, link, c, s);
            }
            case DYN_STEP_PARAMETER_TYPE_ARMATURE: return of_dof(b, "armature", s);
            case DYN_STEP_PARAMETER_TYPE_DAMPING: return of_dof(b, "damping", s);
            case DYN_STEP_PARAMETER_TYPE_FRICTION: return of_dof(b, "friction", s);
            case DYN_STEP_PARAMETER_TYPE_GRAVITY: return change(b, "model", "", "gravity", [&](Numbers& y) { y[c] += s; });
            case DYN_STEP_PARAMETER_TYPE_CONTACT_FRICTION:
            case DYN_STEP_PARAMETER_TYPE_RESTITUTION: {  // whichever shape it comes from
              const char* const quantity = p.types[k] == DYN_STEP_PARAMETER_TYPE_RESTITUTION ? "restitution" : "friction";
              for (int i = 0; i < dyn_builder_parameter_count(b); ++i) {
                dynParameter y{};
                y.struct_size = sizeof y;
                ASSERT_EQ(DYN_OK, dyn_builder_parameter(b, i, &y));
                if (std::string(y.object) != "shape" || std::string(y.quantity) != quantity) continue;
                const double to = y.values[0] + s;
                ASSERT_EQ(DYN_OK, dyn_builder_set_parameter(b, i, &to, 1)) << dyn_last_error();
              }
              return;
            }
            case DYN_STEP_PARAMETER_TYPE_TIME_STEP: return;
          }
        };
      };
      const bool time = p.types[k] == DYN_STEP_PARAMETER_TYPE_TIME_STEP;
      if (time) epsilon = 1e-4 * dt;
      Numbers q, v, dq(nv), column(rows);
      for (const double side : {-2, -1, 1, 2}) {  // of fourth order
        const double s = side * epsilon, weight = (side < 0 ? -1 : 1) * (std::abs(side) > 1 ? -1 : 8) / (12 * epsilon);
        step_of(run, edit(s), time ? dt + s : dt, q, v);
        if (::testing::Test::HasFatalFailure()) return;
        ASSERT_EQ(DYN_OK, dyn_difference(run.m, base.q.data(), q.data(), dq.data()));
        for (std::size_t i = 0; i < nv; ++i) column[i] += weight * dq[i], column[nv + i] += weight * (v[i] - base.v[i]);
      }
      for (const std::size_t part : {std::size_t(0), std::size_t(1)}) {  // q' and v' by themselves
        double most = 0, error = 0;
        for (std::size_t i = 0; i < nv; ++i) {
          const std::size_t at = part * nv + i;
          most = std::max(most, std::abs(column[at])), error = std::max(error, std::abs(column[at] - x.P[rows * number + at]));
        }
        const double rounding = (part ? 1e-12 : 1e-15) / epsilon;  // of velocities of contacts, and of q
        EXPECT_LE(error, within * most + rounding) << (part ? "v', of " : "q', of ") << most;
      }
    }
}

Parameters of_dofs(const dynModel* m) {
  Parameters p;
  for (int k = 0; k < dyn_model_nv(m); ++k)
    for (const auto type :
         {DYN_STEP_PARAMETER_TYPE_ARMATURE, DYN_STEP_PARAMETER_TYPE_DAMPING, DYN_STEP_PARAMETER_TYPE_FRICTION})
      p.add(type, k);
  return p;
}

// A tumbling stone under a force, its centre of mass off its origin.
TEST(StepParameters, OfAFreeBody) {
  Stepper run(Scene().free("stone", 2, {0.1, 0.12, 0.15}, {0.1, 0.2, 0.3}).finish(), 5e-3);
  run.set({0.1, 0.2, 1, 0.1, 0.2, 0.3, 0.9}, {1, 2, 3, 4, 5, -6}, {1, 2, 3, 0.4, 0.5, 0.6});
  Parameters p;
  p.add(DYN_STEP_PARAMETER_TYPE_INERTIA, 1), p.add(DYN_STEP_PARAMETER_TYPE_GRAVITY), p.add(DYN_STEP_PARAMETER_TYPE_TIME_STEP);
  agree(run, p);
}

// Three links with every effect of joints.
Model hinges() {
  Builder b("hinges");
  std::string parent;
  for (int k = 0; k < 3; ++k) {
    const std::string name = "j" + std::to_string(k);
    Spec s(name.c_str(), k == 1 ? DYN_JOINT_TYPE_PRISMATIC : DYN_JOINT_TYPE_REVOLUTE, parent.empty() ? nullptr : parent.c_str(),
           {0, 0.1, 0.2});
    const double armature[1] = {0.01}, damping[1] = {0.2}, friction[1] = {0.1};
    s.armature = armature, s.damping = damping, s.friction = friction;
    b.joint(s.about(k % 2, 1, 0.5)).body(("l" + std::to_string(k)).c_str(), name.c_str(), 0.5);
    parent = name;
  }
  return b.finish();
}

TEST(StepParameters, OfJoints) {
  for (dynIntegrator by : {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_INTEGRATOR_IMPLICIT_FAST}) {
    Stepper run(hinges(), 2e-3);
    run.integrate_by(by);
    run.set({0.3, 0.1, -0.5}, {1, 0.002, -2}, {1, 2, 0.3});
    Parameters p = of_dofs(run.m);
    for (int j = 1; j < run.m.njoints(); ++j) p.add(DYN_STEP_PARAMETER_TYPE_INERTIA, j);
    p.add(DYN_STEP_PARAMETER_TYPE_GRAVITY), p.add(DYN_STEP_PARAMETER_TYPE_TIME_STEP);
    agree(run, p);
  }
}

TEST(StepParameters, OfEveryJointType) {
  for (const bool mimic : {false, true}) {
    Stepper run(all_types(mimic), 2e-3);
    const State s = random_state(run.m, 3);
    run.set(s.q, s.v, s.tau);
    Parameters p;
    for (int j = 1; j < run.m.njoints(); ++j) p.add(DYN_STEP_PARAMETER_TYPE_INERTIA, j);
    p.add(DYN_STEP_PARAMETER_TYPE_GRAVITY);
    agree(run, p);
  }
}

Parameters of_contact(bool rebounds) {
  Parameters p;
  p.add(DYN_STEP_PARAMETER_TYPE_INERTIA, 1), p.add(DYN_STEP_PARAMETER_TYPE_GRAVITY);
  p.add(DYN_STEP_PARAMETER_TYPE_CONTACT_FRICTION, 0);
  if (rebounds) p.add(DYN_STEP_PARAMETER_TYPE_RESTITUTION, 1);
  p.add(DYN_STEP_PARAMETER_TYPE_TIME_STEP);
  return p;
}
Model stone_on_ground(double friction, double restitution = 0) {
  Scene scene;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(friction, restitution));
  scene.free("stone", 2, {0.03, 0.035, 0.04}, {0.02, 0.01, -0.03});
  scene.shape("stone", DYN_SHAPE_TYPE_SPHERE, {0.1, 0, 0}, material(friction, restitution));
  return scene.finish();
}

// Gaps that close, of balls that roll, slide, sink in and rebound.
TEST(StepParameters, OfContacts) {
  const struct {
    double friction, restitution, gap;
    Numbers v;
    dynContactMode mode;
  } cases[] = {{0.8, 0, 5e-6, {0.3, 0, 0, 0, 3, 0.5}, DYN_CONTACT_MODE_STICK},
               {0.3, 0, 5e-6, {1, 0.5, 0, 0.2, 0.1, 2}, DYN_CONTACT_MODE_SLIDE},
               {0.4, 0, -1e-4, {1, 0.5, 0, 0.2, 0.1, 2}, DYN_CONTACT_MODE_SLIDE},
               {0.4, 0, -1e-2, {1, 0.5, 0, 0.2, 0.1, 2}, DYN_CONTACT_MODE_SLIDE},  // at the largest speed of corrections
               {0.8, 0, -1e-4, {0.3, 0, 0, 0, 3, 0.5}, DYN_CONTACT_MODE_STICK},
               {0.5, 0.7, 1e-4, {0.3, 0.1, -1, 0, 1, 2}, DYN_CONTACT_MODE_IMPACT}};
  for (const auto& x : cases) {
    SCOPED_TRACE(x.gap);
    Stepper run(stone_on_ground(x.friction, x.restitution));
    run.set(upright(0, 0, 0.1 + x.gap), x.v);
    const Derivatives d = run.analytic();
    ASSERT_EQ(1u, d.modes.size());
    EXPECT_EQ(x.mode, d.modes[0]);
    agree(run, of_contact(x.restitution > 0));
  }
}

// A leg whose foot slides on the ground, a little below it, at a limit: corrections whose matrix changes with the masses.
TEST(StepParameters, OfALegOnTheGround) {
  Builder b("leg");
  const double armature[1] = {0.01}, damping[1] = {0.2}, friction[1] = {0.1}, lower[1] = {-1}, upper[1] = {1};
  Spec rail("rail", DYN_JOINT_TYPE_PRISMATIC), hip("hip", DYN_JOINT_TYPE_REVOLUTE, "rail", {0, 0, 0.5}),
      knee("knee", DYN_JOINT_TYPE_REVOLUTE, "hip", {0, 0, -0.3});
  rail.about(1, 0, 0), hip.about(0, 1, 0), knee.about(0, 1, 0);
  for (Spec* s : {&rail, &hip, &knee}) s->armature = armature, s->damping = damping, s->friction = friction;
  knee.lower = lower, knee.upper = upper;
  b.joint(rail).body("carriage", "rail", 3);
  b.joint(hip).body("thigh", "hip", 2, {0.01, 0, -0.15}).joint(knee).body("shin", "knee", 1, {0, 0.02, -0.1});
  const auto shape = [&](const char* body, dynShapeType type, std::array<double, 3> at) {
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    s.body = body, s.type = type, s.material = material(0.4), s.size[0] = 0.05;
    std::copy(at.begin(), at.end(), s.placement + 9);
    EXPECT_EQ(DYN_OK, dyn_builder_add_shape(b, &s)) << dyn_last_error();
  };
  const double q1 = 0.6, q2 = -1.00002;  // beyond the knee's limit
  const double ground = 0.5 - 0.3 * std::cos(q1) - 0.3 * std::cos(q1 + q2) - 0.05 + 2e-5;
  shape("shin", DYN_SHAPE_TYPE_SPHERE, {0, 0, -0.3}), shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, ground});
  Stepper run(b.finish());
  run.set({0.1, q1, q2}, {1, -0.5, -0.4}, {0.5, 1, -2});
  const Derivatives x = run.analytic();
  ASSERT_EQ(1u, x.modes.size());
  EXPECT_EQ(DYN_CONTACT_MODE_SLIDE, x.modes[0]);
  Parameters p = of_dofs(run.m);
  for (int j : {1, 2, 3}) p.add(DYN_STEP_PARAMETER_TYPE_INERTIA, j);
  p.add(DYN_STEP_PARAMETER_TYPE_GRAVITY), p.add(DYN_STEP_PARAMETER_TYPE_CONTACT_FRICTION, 1);
  p.add(DYN_STEP_PARAMETER_TYPE_TIME_STEP);
  agree(run, p);
}

// So far beyond their limits that they return at the largest speed, which follows from gravity and the bodies' sizes.
TEST(StepParameters, OfLimitsThatAreFarOff) {
  Builder b("limits");
  const double lower[1] = {-1}, upper[1] = {1};
  Spec slide("slide", DYN_JOINT_TYPE_PRISMATIC), turn("turn", DYN_JOINT_TYPE_REVOLUTE, "slide", {0, 0, 0.2});
  slide.about(0, 0, 1), turn.about(0, 1, 0);
  for (Spec* s : {&slide, &turn}) s->lower = lower, s->upper = upper;
  b.joint(slide).body("carriage", "slide", 3).joint(turn).body("arm", "turn", 1, {0.1, 0.02, -0.1});
  Stepper run(b.finish(), 2e-3);
  run.set({-1.5, 1.8}, {-0.01, 0.5});
  Parameters p;
  p.add(DYN_STEP_PARAMETER_TYPE_INERTIA, 1), p.add(DYN_STEP_PARAMETER_TYPE_INERTIA, 2), p.add(DYN_STEP_PARAMETER_TYPE_GRAVITY);
  p.add(DYN_STEP_PARAMETER_TYPE_TIME_STEP);
  agree(run, p);
}

// Closed loops, in motion and at rest: their forces follow the masses, and their drift is rounding.
TEST(StepParameters, OfMechanisms) {
  for (const char* name : {"four_bar.urdf", "four_bar_in_space.urdf"})
    for (double speed : {0.0, 0.7}) {
      SCOPED_TRACE(name);
      Stepper run(mechanism(name));
      Numbers q(static_cast<std::size_t>(run.m.nq())), v(static_cast<std::size_t>(run.m.nv()), speed);
      ASSERT_EQ(DYN_OK, dyn_configuration_neutral(run.m, q.data()));
      for (double& x : q) x += 0.2;
      close_loops(run, q, v);
      Parameters p;
      for (int j = 1; j < run.m.njoints(); ++j) p.add(DYN_STEP_PARAMETER_TYPE_INERTIA, j);
      p.add(DYN_STEP_PARAMETER_TYPE_GRAVITY), p.add(DYN_STEP_PARAMETER_TYPE_TIME_STEP);
      agree(run, p, 1e-5);
    }
}

TEST(StepParameters, OfAStackOfBoxes) {
  Scene scene;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.7));
  scene.box("lower", 2, {0.2, 0.2, 0.1}, material(0.7)).box("upper", 1, {0.15, 0.15, 0.1}, material(0.7));
  Stepper run(scene.finish());
  run.set(joined({upright(0, 0, 0.05 - 1e-5), upright(0.01, 0.02, 0.15 - 3e-5)}));
  Parameters p;
  p.add(DYN_STEP_PARAMETER_TYPE_INERTIA, 1), p.add(DYN_STEP_PARAMETER_TYPE_INERTIA, 2), p.add(DYN_STEP_PARAMETER_TYPE_GRAVITY);
  agree(run, p);
}

TEST(StepParameters, OfAStandingQuadruped) {
  Numbers q;
  Stepper run(standing("go2", {0, 0.9, -1.8}, q, 2e-5), 2e-3);
  hold(run, q);
  Parameters p;
  for (int j : {1, 3}) p.add(DYN_STEP_PARAMETER_TYPE_INERTIA, j);  // the trunk and a thigh
  p.add(DYN_STEP_PARAMETER_TYPE_GRAVITY), p.add(DYN_STEP_PARAMETER_TYPE_TIME_STEP);
  agree(run, p);
}

// Central differences where ANALYTIC does not cover the step; parameters that have none are refused.
TEST(StepParameters, OfOtherIntegrators) {
  Stepper run(hinges(), 2e-3);
  switch_all_effects_on(run.m, run.d);
  run.set({0.3, 0.1, -0.5}, {1, 0.5, -2}, {1, 2, 0.3});
  Parameters p = of_dofs(run.m);
  p.add(DYN_STEP_PARAMETER_TYPE_GRAVITY), p.add(DYN_STEP_PARAMETER_TYPE_TIME_STEP);
  const Numbers tangent(9 + 9 + 4, 1.0), cotangent(6, 1.0);
  const Products a = parameter_derivatives(run, p, tangent, cotangent),
                 c = parameter_derivatives(run, p, tangent, cotangent, DYN_DERIVATIVE_METHOD_CENTRAL_DIFFERENCES);
  ASSERT_EQ(DYN_OK, a.status) << dyn_last_error();
  ASSERT_EQ(DYN_OK, c.status) << dyn_last_error();
  EXPECT_LE(difference(a.P, c.P), 1e-6 * largest(c.P));
  EXPECT_LE(difference(a.jvp, c.jvp), 1e-6 * largest(c.jvp));
  EXPECT_LE(difference(a.vjp, c.vjp), 1e-6 * largest(c.vjp));
  run.integrate_by(DYN_INTEGRATOR_RK4);
  EXPECT_EQ(DYN_OK, parameter_derivatives(run, p, tangent, cotangent, DYN_DERIVATIVE_METHOD_AUTO).status) << dyn_last_error();
  p = {}, p.add(DYN_STEP_PARAMETER_TYPE_INERTIA, 1);
  EXPECT_EQ(DYN_ERROR_UNSUPPORTED,
            parameter_derivatives(run, p, Numbers(9 + 10, 1.0), cotangent, DYN_DERIVATIVE_METHOD_AUTO).status);
  EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "SEMI_IMPLICIT_EULER")) << dyn_last_error();
}

TEST(StepParameters, RefuseWhatIsWrong) {
  Stepper run(ball_on_ground(0));
  run.set(upright(0, 0, 0.1 + 5e-6), {0.3, 0, 0, 0, 3, 0});
  const auto refused = [&](dynStepParameterType type, int index, dynStatus status, const char* says) {
    Parameters p;
    p.add(type, index);
    EXPECT_EQ(status, parameter_derivatives(run, p, Numbers(18 + 10, 1.0), Numbers(12, 1.0), DYN_DERIVATIVE_METHOD_AUTO).status);
    EXPECT_NE(nullptr, std::strstr(dyn_last_error(), says)) << dyn_last_error();
  };
  refused(DYN_STEP_PARAMETER_TYPE_INERTIA, 0, DYN_ERROR_ARGUMENT, "joints are from 1 to 1");
  refused(DYN_STEP_PARAMETER_TYPE_DAMPING, 6, DYN_ERROR_ARGUMENT, "parameter_index[0] is 6");
  refused(DYN_STEP_PARAMETER_TYPE_GRAVITY, 1, DYN_ERROR_ARGUMENT, "parameter_index[0] is 1");
  refused(DYN_STEP_PARAMETER_TYPE_CONTACT_FRICTION, 2, DYN_ERROR_ARGUMENT, "shape 2 does not exist");
  refused(DYN_STEP_PARAMETER_TYPE_CONTACT_FRICTION, 0, DYN_ERROR_UNSUPPORTED, "no friction");
  refused(static_cast<dynStepParameterType>(99), 0, DYN_ERROR_ARGUMENT, "parameters");
  dynStepDerivatives out;
  dyn_step_derivatives_init(&out), out.parameter_count = -1;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_step_derivatives(run.m, run.d, nullptr, &out));
  out.parameter_count = 1;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_step_derivatives(run.m, run.d, nullptr, &out));
  EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "parameters")) << dyn_last_error();
}

}  // namespace
}  // namespace dyn_test
