// Free bodies are integrated in batches, to the same motion as by the recursion; contacts without load need no solver.
#include "simulation/scene.hpp"

#include "count.hpp"

namespace dyn_test {
namespace {

// The same with a negligible wrench on the first body: then all bodies take the recursion.
void take_recursion(Simulation& run) {
  const double nothing[6] = {1e-300, 0, 0, 0, 0, 0};
  ASSERT_EQ(DYN_OK, dyn_data_apply_wrench(run.m, run.d, dyn_model_frame_id(run.m, "body0"), nullptr, nothing,
                                          DYN_REFERENCE_LOCAL_WORLD_ALIGNED))
      << dyn_last_error();
}

// Nine driven, rotating bodies with offset centres of mass, one (with equal inertias) by more than 1 rad a step; quaternions of
// any norm.
struct Tumbling {
  static constexpr int bodies = 9;
  Simulation run;
  explicit Tumbling(bool recursion) : run(model(), 2e-3) {
    Numbers q, v, tau;
    for (int k = 0; k < bodies; ++k) {
      const double norm = k == 2 ? 1e-40 : k == 5 ? 3 : 1, fast = k == 0 ? 700 : 3;
      q.insert(q.end(), {3.0 * k, 0.1 * k, 1, 0.5 * norm, -0.5 * norm, 0.1 * norm, 0.7 * norm});
      v.insert(v.end(), {1, 0.2 * k, -0.5, k == 0 ? 0 : 2.0 - k, k == 0 ? 0 : 1.0, fast});
      if (k == 0) tau.insert(tau.end(), {0, 0, 0, 0, 0, 0.5});  // about its rotation axis
      else tau.insert(tau.end(), {0.3 * k, 0, 0.1, 0.01, -0.02, 0.001 * k});
    }
    EXPECT_EQ(DYN_OK, dyn_data_set_state(run.m, run.d, q.data(), v.data(), nullptr, tau.data())) << dyn_last_error();
    if (recursion) take_recursion(run);
  }
  static Model model() {
    Scene scene;
    for (int k = 0; k < bodies; ++k)
      scene.free(("body" + std::to_string(k)).c_str(), 1 + k, {k ? 0.2 : 0.4, k ? 0.3 : 0.4, 0.4}, {0, 0, 0.02 * k});
    return scene.finish();
  }
};

TEST(FreeBodies, MoveLikeTheRecursion) {
  Tumbling a(false), b(true);
  for (int k = 0; k < 200; ++k) {
    a.run.steps(1), b.run.steps(1);
    for (int i = 0; i < dyn_model_nq(a.run.m); ++i)
      ASSERT_NEAR(b.run.q[i], a.run.q[i], 1e-11 * (1 + std::abs(b.run.q[i]))) << k << " " << i;
    for (int i = 0; i < dyn_model_nv(a.run.m); ++i)  // tolerances grow with the speed of points
      ASSERT_NEAR(b.run.v[i], a.run.v[i], 1e-11 * (1 + std::abs(b.run.v[i / 6 * 6 + 5]))) << k << " " << i;
  }
}

// The joint's frame is displaced and rotated.
TEST(FreeBodies, PlacedJointFallsAlongWorldGravity) {
  dynBuilder* b = nullptr;
  ASSERT_EQ(DYN_OK, dyn_builder_new("placed", &b));
  const double c = std::cos(0.7), s = std::sin(0.7), I[9] = {1e-3, 0, 0, 0, 1e-3, 0, 0, 0, 1e-3}, com[3] = {0, 0, 0};
  Spec spec("joint", DYN_JOINT_TYPE_FREE_FLYER);
  const double X[12] = {1, 0, 0, 0, c, s, 0, -s, c, 0.3, -0.2, 0.6};
  std::copy(X, X + 12, spec.placement);
  ASSERT_EQ(DYN_OK, dyn_builder_add_joint(b, &spec)) << dyn_last_error();
  ASSERT_EQ(DYN_OK, dyn_builder_add_body(b, "ball", "joint", nullptr, 1, com, I)) << dyn_last_error();
  for (const char* body : {"universe", "ball"}) {
    dynShapeSpec shape;
    dyn_shape_spec_init(&shape);
    shape.body = body, shape.type = body[0] == 'u' ? DYN_SHAPE_TYPE_HALF_SPACE : DYN_SHAPE_TYPE_SPHERE, shape.size[0] = 0.1;
    ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &shape)) << dyn_last_error();
  }
  dynModel* m = nullptr;
  ASSERT_EQ(DYN_OK, dyn_builder_finish(b, &m)) << dyn_last_error();
  dyn_builder_free(b);
  Simulation run(Model(m), 1e-3);
  const auto height = [&] {
    double at[12];
    EXPECT_EQ(DYN_OK, dyn_forward_kinematics(run.m, run.d, nullptr, nullptr, nullptr));
    EXPECT_EQ(DYN_OK, dyn_frame_placement(run.m, run.d, dyn_model_frame_id(run.m, "ball"), at)) << dyn_last_error();
    EXPECT_NEAR(0.3, at[9], 1e-14);
    EXPECT_NEAR(-0.2, at[10], 1e-14);
    return at[11];
  };
  const int n = 200;
  run.steps(n);
  EXPECT_NEAR(0.6 - 9.81 * 1e-6 * n * (n + 1) / 2, height(), 1e-13);
  run.steps(800);
  EXPECT_NEAR(0.1, height(), 1e-6);
}

// Large rotations: the momentum is exact up to a third of a turn a step; beyond, its length is, and steps that gain energy are made
// in parts.
TEST(FreeBodies, MomentumIsKeptAtAnySpeed) {
  for (const bool recursion : {false, true})
    for (const double rate : {1.0, 100.0, 300.0, 400.0, 500.0, 700.0, 1000.0, 2000.0, 10000.0}) {
      Scene scene({0, 0, 0});
      Simulation run(scene.free("body0", 1, {1e-3, 2e-3, 2.7e-3}, {0, 0.01, 0.02}).finish(), 1e-3);
      run.set({0, 0, 0, 0, 0, 0, 1}, {1, 2, 3, 0.1 * rate, rate, 0.1 * rate});
      if (recursion) take_recursion(run);
      const auto momentum = [&] {
        std::array<double, 6> hg;
        EXPECT_EQ(DYN_OK, dyn_centroidal_momentum(run.m, run.d, nullptr, nullptr, hg.data())) << dyn_last_error();
        return hg;
      };
      const auto before = momentum();
      const double L = std::hypot(before[3], before[4], before[5]), energy = run.energy();
      int parts = 0;
      for (int k = 0; k < 1000; ++k) run.steps(1), parts += run.report().rejected > 0;
      const auto after = momentum();
      EXPECT_EQ(rate > 2000, parts > 0) << rate;
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(before[k], after[k], 1e-11 + 1e-14 * rate) << rate;  // tolerances grow with the speed of points
      for (std::size_t k = 3; k < 6 && rate <= 2000; ++k) EXPECT_NEAR(before[k], after[k], 1e-11 * L) << rate << " " << recursion;
      EXPECT_NEAR(L, std::hypot(after[3], after[4], after[5]), 1e-11 * L) << rate << " " << recursion;
      EXPECT_LT(run.energy(), 1.05 * energy) << rate;
    }
}

// Also where the squares of a quaternion underflow or overflow, or lose digits.
TEST(FreeBodies, QuaternionsOfAnyNormTurnAlike) {
  const auto after_step = [](double norm) {
    Simulation run(Scene().free("body0", 1, {1e-3, 2e-3, 2.7e-3}, {0, 0.01, 0.02}).finish(), 0.1);
    run.set({0, 0, 0, 0.5 * norm, -0.5 * norm, 0.1 * norm, 0.7 * norm}, {1, 2, 3, 1, 2, -1});
    run.steps(1);
    Numbers out(run.q, run.q + 7);
    out.insert(out.end(), run.v, run.v + 6);
    return out;
  };
  const Numbers unit = after_step(1);
  for (const double norm : {1e-300, 1e-160, 5e-155, 1e-154, 1e-20, 1e20, 1e153, 1e154, 1e160, 1e300}) {
    const Numbers x = after_step(norm);
    for (std::size_t k = 0; k < x.size(); ++k) EXPECT_NEAR(unit[k], x[k], 3e-15) << norm << ", " << k;
  }
}

TEST(FreeBodies, CostLessThanTheRecursion) {
  Tumbling a(false), b(true);
  a.run.steps(3), b.run.steps(3);
  const long loose = bench::instructions([&] { dyn_step(a.run.m, a.run.d); }),
             others = bench::instructions([&] { dyn_step(b.run.m, b.run.d); });
  if (loose < 0) GTEST_SKIP() << "this system does not let a process trace its child";
  EXPECT_LT(loose, 0.7 * double(others));
}

// A rolling ball with an offset centre of mass touches the ground and another ball: three contacts, each determined by one
// equation.
TEST(FreeBodies, ContactsMatchTheRecursion) {
  const auto make = [] {
    Scene scene;
    scene.ground()
        .free("body0", 1, {5e-3, 4e-3, 6e-3}, {0, 0.01, -0.02})
        .shape("body0", DYN_SHAPE_TYPE_SPHERE, {0.1, 0, 0}, material(0.5));
    scene.sphere("other", 2, 0.1, material(0.4));
    return scene.finish();
  };
  Simulation a(make()), b(make());
  for (Simulation* x : {&a, &b}) {
    x->options.tolerance = 1e-12;
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(x->m, x->d, &x->options));
  }
  const Numbers at = {0, 0, 0.1, 0, 0, 0, 1, 0.35, 0, 0.1, 0, 0, 0, 1}, v = {1, 0, 0, 0, 10, 0, 0, 0, 0, 0, 0, 0};
  a.set(at, v), b.set(at, v), take_recursion(b);
  int met = 0;
  for (int k = 0; k < 300; ++k) {
    a.steps(1), b.steps(1);
    met += a.contacts().size() > 2;
    for (int i = 0; i < dyn_model_nq(a.m); ++i) ASSERT_NEAR(b.q[i], a.q[i], 1e-12) << k << " " << i;
  }
  EXPECT_GT(met, 0);
}

// Without gravity a row of touching balls moves on together; the first step that loads them is solved.
TEST(FreeBodies, TouchingWithoutLoadNeedsNoSolver) {
  Scene scene({0, 0, 0});
  for (int k = 0; k < 4; ++k) scene.sphere(("ball" + std::to_string(k)).c_str(), 1, 0.1, material(0.5));
  Simulation run(scene.finish());
  Numbers q, v;
  for (int k = 0; k < 4; ++k) q.insert(q.end(), {0.2 * k, 0, 0, 0, 0, 0, 1}), v.insert(v.end(), {0.5, 0, 0, 0, 0, 0});
  run.set(q, v);
  run.steps(100);
  EXPECT_EQ(3, run.report().contacts);
  EXPECT_EQ(0, run.report().iterations);
  for (const dynContactForce& f : run.contacts()) EXPECT_EQ(0, f.force_on_b[0]);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(0.5, run.v[6 * k], 1e-14);
  const double push[6] = {8, 0, 0, 0, 0, 0};  // the first pushes all
  ASSERT_EQ(DYN_OK, dyn_data_apply_wrench(run.m, run.d, dyn_model_frame_id(run.m, "ball0"), nullptr, push,
                                          DYN_REFERENCE_LOCAL_WORLD_ALIGNED));
  run.steps(100);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(0.5 + 2 * 0.1, run.v[6 * k], 1e-8);
  const auto forces = run.contacts();
  ASSERT_EQ(3u, forces.size());
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(6 - 2 * k, std::abs(forces[std::size_t(k)].force_on_b[0]), 1e-6);
}

// Resting contacts carry load however short the steps.
TEST(FreeBodies, RestingContactsAreActiveInShortSteps) {
  for (const double dt : {1e-2, 1e-4, 1e-6, 1e-8}) {
    Scene scene;
    Simulation run(scene.ground().sphere("ball", 1, 0.1, material(0.5)).finish(), dt);
    run.place({{0, 0, 0.1}});
    run.steps(20);
    ASSERT_EQ(1u, run.contacts().size()) << dt;
    EXPECT_NEAR(9.81, run.contacts()[0].force_on_b[2], 1e-5) << dt;
    EXPECT_NEAR(0, run.v[2], 1e-5 * dt * 9.81) << dt;
  }
}

}  // namespace
}  // namespace dyn_test
