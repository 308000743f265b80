// Properties of steps in any scene: momentum, limits, constraints, islands, repetition.
#include "common/every.hpp"
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

Numbers momentum(Simulation& run) {
  Numbers h(6);
  EXPECT_EQ(DYN_OK, dyn_centroidal_momentum(run.m, run.d, nullptr, nullptr, h.data())) << dyn_last_error();
  return h;
}

// A tumbling body with its centre of mass off the joint's origin.
TEST(Step, FreeBodiesKeepTheirMomentum) {
  Simulation run(Scene({0, 0, 0}).free("stone", 2, {0.1, 0.2, 0.25}, {0.1, 0.2, 0.3}).finish());
  run.set({}, {1, 2, 3, 4, 5, -6});
  Numbers before = momentum(run);
  for (int k = 0; k < 1000; ++k) {
    run.steps(1);
    const Numbers now = momentum(run);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(before[i], now[i], 1e-12) << k;
    before = now;
  }
}

// Two bodies collide without external forces.
TEST(Step, CollisionsKeepMomentum) {
  Scene scene({0, 0, 0});
  scene.sphere("a", 1, 0.1, material(0.5, 0.8)).box("b", 3, {0.3, 0.2, 0.2}, material(0.5));
  Simulation run(scene.finish());
  run.place({{0, 0, 0}, {0.5, 0.05, 0.03}});
  run.set({}, {3, 0, 0, 0, 0, 10, 0, 0, 0, 0, 0, 0});
  const Numbers before = momentum(run);
  run.steps(300);
  const Numbers now = momentum(run);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(before[i], now[i], 1e-12);
  for (std::size_t i = 3; i < 6; ++i)
    EXPECT_NEAR(before[i], now[i], 1e-3);  // moments of an impact use its position at the beginning of the step
  EXPECT_GT(std::abs(run.velocity(1)[0]), 0.5);
}

// The loop of a swinging four-bar linkage stays closed.
TEST(Step, ConstraintsHold) {
  dynModel* loaded = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_load(DYN_MODELS_DIR "/mechanisms/four_bar.urdf", nullptr, &loaded)) << dyn_last_error();
  Simulation run{Model(loaded)};
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_ARMATURE));
  Numbers q(static_cast<std::size_t>(run.m.nq()));
  ASSERT_EQ(DYN_OK, dyn_configuration_neutral(run.m, q.data()));
  dynData* d = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(run.m, 0, &d));
  int rows = 0;
  ASSERT_EQ(DYN_OK, dyn_data_constraint_rows(run.m, d, -1, nullptr, &rows)) << dyn_last_error();
  ASSERT_GT(rows, 0);
  Numbers C(static_cast<std::size_t>(rows));
  for (double& x : q) x += 0.3;
  ASSERT_EQ(DYN_OK, dyn_project(run.m, d, q.data(), nullptr, nullptr, q.data(), nullptr, nullptr)) << dyn_last_error();
  run.set(q);
  double worst = 0;
  for (int k = 0; k < 1000; ++k) {
    run.steps(1);
    ASSERT_EQ(DYN_OK, dyn_constraint_terms(run.m, d, run.q, run.v, C.data(), nullptr, nullptr, nullptr)) << dyn_last_error();
    for (const double c : C) worst = std::max(worst, std::abs(c));
  }
  EXPECT_LT(worst, 1e-6);
  dyn_data_free(d);
}

// Islands are independent: each moves as it would alone, bit for bit.
TEST(Step, IslandsAreIndependent) {
  auto boxes = [](int n) {
    Scene scene;
    scene.ground();
    for (int k = 0; k < n; ++k) scene.box(k ? "second" : "first", 1 + k, {0.2, 0.2, 0.2}, material(0.4));
    return scene.finish();
  };
  Simulation one(boxes(1)), two(boxes(2));
  one.place({{0, 0, 0.15}});
  two.place({{0, 0, 0.15}, {5, 0, 0.3}});
  for (int k = 0; k < 500; ++k) {
    one.steps(1), two.steps(1);
    for (int i = 0; i < 7; ++i) ASSERT_EQ(one.q[i], two.q[i]) << k;
  }
  EXPECT_EQ(2, two.report().islands);
}

TEST(Step, IsRepeatedBitForBit) {
  Numbers end[2];
  for (Numbers& x : end) {
    Scene scene;
    scene.ground();
    for (const char* name : {"a", "b", "c"}) scene.box(name, 1, {0.2, 0.2, 0.2}, material(0.6, 0.2));
    Simulation run(scene.finish());
    run.place({{0, 0, 0.3}, {0.05, 0.02, 0.6}, {0.1, 0, 0.9}});
    run.steps(1000);
    x.assign(run.q, run.q + 21);
  }
  EXPECT_EQ(end[0], end[1]);
}

// A saved state continues in other data with the same steps.
TEST(Step, RestoredStateReproducesTheBits) {
  auto scene = [] {
    Scene x;
    x.ground();
    for (const char* name : {"a", "b", "c"}) x.box(name, 1, {0.2, 0.2, 0.2}, material(0.6, 0.2));
    return x.finish();
  };
  Simulation play(scene());
  play.place({{0, 0, 0.3}, {0.05, 0.02, 0.6}, {0.1, 0, 0.9}});
  play.steps(300);
  std::vector<unsigned char> kept(dyn_model_state_size(play.m));
  ASSERT_EQ(DYN_OK, dyn_data_save_state(play.m, play.d, kept.data(), kept.size())) << dyn_last_error();
  play.steps(300);
  const Numbers end(play.q, play.q + 21), speed(play.v, play.v + 18);
  ASSERT_EQ(DYN_OK, dyn_data_restore_state(play.m, play.d, kept.data(), kept.size())) << dyn_last_error();
  EXPECT_NEAR(0.3, play.array("time")[0], 1e-12);
  play.steps(300);
  EXPECT_EQ(end, Numbers(play.q, play.q + 21));
  EXPECT_EQ(speed, Numbers(play.v, play.v + 18));

  const Numbers before(play.q, play.q + 21);
  Simulation other(scene());
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_restore_state(other.m, other.d, kept.data(), kept.size()));
  EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "another model"));
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_data_restore_state(play.m, play.d, kept.data(), kept.size() - 1));
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_data_save_state(play.m, play.d, kept.data(), 3));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_restore_state(play.m, play.d, nullptr, kept.size()));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_data_save_state(nullptr, play.d, kept.data(), kept.size()));
  EXPECT_EQ(0u, dyn_model_state_size(nullptr));
  for (const std::size_t at : {std::size_t(0), std::size_t(16), std::size_t(32)}) {
    std::vector<unsigned char> damaged = kept;
    std::fill_n(damaged.begin() + std::ptrdiff_t(at), 8, static_cast<unsigned char>(0xff));
    EXPECT_NE(DYN_OK, dyn_data_restore_state(play.m, play.d, damaged.data(), damaged.size())) << at;
  }
  EXPECT_EQ(before, Numbers(play.q, play.q + 21));
}

// Results computed for a restored state are not reused for the next one.
TEST(Step, RestoredStateInvalidatesResults) {
  Simulation play(Scene().ground().box("a", 1, {0.2, 0.2, 0.2}, material(0.6)).finish()),
      fresh(Scene().ground().box("a", 1, {0.2, 0.2, 0.2}, material(0.6)).finish());
  play.place({{0, 0, 0.3}});
  play.steps(10);
  std::vector<unsigned char> kept(dyn_model_state_size(play.m));
  ASSERT_EQ(DYN_OK, dyn_data_save_state(play.m, play.d, kept.data(), kept.size())) << dyn_last_error();
  const Numbers next = {1, 2, 3, 0, 0, 1, 0}, v = {1, 2, 3, 4, 5, 6}, tau = {6, 5, 4, 3, 2, 1};
  for (int k = 0; k < 3; ++k) {
    ASSERT_EQ(DYN_OK, dyn_data_restore_state(play.m, play.d, kept.data(), kept.size())) << dyn_last_error();
    for (int n = 0; n < k; ++n) ASSERT_EQ(DYN_OK, dyn_aba(play.m, play.d, nullptr, nullptr, nullptr, nullptr, nullptr));
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(play.m, play.d, nullptr, nullptr, nullptr));
    double at[2][12], hg[2][6], ddq[2][6];
    int which = 0;
    for (Simulation* one : {&play, &fresh}) {
      ASSERT_EQ(DYN_OK, dyn_forward_kinematics(one->m, one->d, next.data(), nullptr, nullptr));
      ASSERT_EQ(DYN_OK, dyn_frame_placement(one->m, one->d, dyn_model_frame_id(one->m, "a"), at[which])) << dyn_last_error();
      ASSERT_EQ(DYN_OK, dyn_centroidal_momentum(one->m, one->d, next.data(), v.data(), hg[which])) << dyn_last_error();
      ASSERT_EQ(DYN_OK, dyn_aba(one->m, one->d, next.data(), v.data(), tau.data(), nullptr, ddq[which++])) << dyn_last_error();
    }
    EXPECT_TRUE(std::equal(at[0], at[0] + 12, at[1])) << k;
    EXPECT_TRUE(std::equal(hg[0], hg[0] + 6, hg[1])) << k;
    EXPECT_TRUE(std::equal(ddq[0], ddq[0] + 6, ddq[1])) << k;
  }
}

// Refused options leave sleeping bodies asleep.
TEST(Step, RefusedOptionsWakeNobody) {
  Scene scene;
  Simulation play(scene.ground().box("a", 1, {0.2, 0.2, 0.2}, material(0.6)).finish());
  dynData* plain = nullptr;  // without energies
  ASSERT_EQ(DYN_OK, dyn_data_new(play.m, DYN_PART_SIMULATION, &plain));
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(play.m, plain, 0, DYN_EFFECT_ALL));
  const double q[] = {0, 0, 0.1, 0, 0, 0, 1};
  ASSERT_EQ(DYN_OK, dyn_data_set_state(play.m, plain, q, nullptr, nullptr, nullptr));
  dynStepReport report{};
  report.struct_size = sizeof report;
  for (int k = 0; k < 2000; ++k) ASSERT_EQ(DYN_OK, dyn_step(play.m, plain));
  ASSERT_EQ(DYN_OK, dyn_data_step_report(play.m, plain, &report));
  ASSERT_EQ(1, report.sleeping);
  dynStepOptions options = play.options;
  options.ledger = 1, options.dt = 2e-3, options.solver = DYN_CONTACT_SOLVER_TYPE_PGS;
  ASSERT_EQ(DYN_ERROR_PART, dyn_data_set_step_options(play.m, plain, &options));
  ASSERT_EQ(DYN_OK, dyn_step(play.m, plain));
  ASSERT_EQ(DYN_OK, dyn_data_step_report(play.m, plain, &report));
  EXPECT_EQ(1, report.sleeping);
  dyn_data_free(plain);
}

// Islands of more rows than a dense matrix holds.
TEST(Step, LargePileIsSolved) {
  Scene scene;
  scene.ground();
  std::vector<std::array<double, 3>> at;
  std::vector<std::string> names;
  for (int k = 0; k < 64; ++k) names.push_back("s" + std::to_string(k));
  for (int k = 0; k < 64; ++k) {
    scene.sphere(names[std::size_t(k)].c_str(), 1, 0.1, material(0.5));
    at.push_back({0.19 * (k % 4) + 0.001 * (k % 3), 0.19 * (k / 4 % 4) + 0.001 * (k % 5), 0.1 + 0.2 * (k / 16)});
  }
  Simulation play(scene.finish());
  play.exactly(), play.place(at);
  const double start = play.energy();
  play.steps(1000);
  EXPECT_GT(play.report().rows, 0);
  EXPECT_LT(play.energy(), start);
  double lowest = inf;
  for (int k = 0; k < 64; ++k) lowest = std::min(lowest, play.q[7 * k + 2]);
  EXPECT_GT(lowest, 0.1 - 1e-4);
  EXPECT_LT(play.residual, 1e-8);
}

TEST(Step, EverySolverHoldsAStack) {
  for (const dynContactSolverType solver : every<dynContactSolverType>("dynContactSolverType")) {
    Scene scene;
    scene.ground();
    std::vector<std::array<double, 3>> at;
    const char* names[] = {"b0", "b1", "b2", "b3", "b4"};
    for (int k = 0; k < 5; ++k) scene.box(names[k], 1, {0.2, 0.2, 0.2}, material(0.6)), at.push_back({0, 0, 0.1 + 0.2 * k});
    Simulation run(scene.finish(), 1e-3, solver);
    run.options.max_iterations = 2000;
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
    run.place(at);
    run.steps(300);
    for (int k = 0; k < 5; ++k) EXPECT_NEAR(0.1 + 0.2 * k, run.q[7 * k + 2], 1e-6) << int(solver);
    EXPECT_EQ(20, run.report().contacts);
  }
}

TEST(Step, MaterialsCombineAndInvalidOnesAreRefused) {
  Simulation run(Scene().ground().box("box", 1, {0.2, 0.2, 0.2}, material(0.25)).finish());
  dynMaterial x;
  ASSERT_EQ(DYN_OK, dyn_data_shape_material(run.m, run.d, 1, &x));
  EXPECT_EQ(0.25, x.friction);
  dynShapeInfo info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(DYN_OK, dyn_model_shape_info(run.m, 1, &info));
  EXPECT_EQ(0.25, info.material.friction);
  const dynMaterial good = material(0.75);
  ASSERT_EQ(DYN_OK, dyn_data_set_shape_material(run.m, run.d, -1, &good));
  ASSERT_EQ(DYN_OK, dyn_data_shape_material(run.m, run.d, 0, &x));
  EXPECT_EQ(0.75, x.friction);
  for (double dynMaterial::* number : {&dynMaterial::friction, &dynMaterial::torsion, &dynMaterial::rolling,
                                       &dynMaterial::restitution, &dynMaterial::stiffness, &dynMaterial::damping})
    for (const double bad : {-1.0, nan, inf, 1e16}) {
      dynMaterial wrong = good;
      wrong.*number = bad;
      EXPECT_NE(DYN_OK, dyn_data_set_shape_material(run.m, run.d, 1, &wrong)) << bad;
      ASSERT_EQ(DYN_OK, dyn_data_shape_material(run.m, run.d, 1, &x));
      EXPECT_EQ(0.75, x.friction);
      dynShapeSpec spec;
      dyn_shape_spec_init(&spec);
      spec.size[0] = spec.size[1] = spec.size[2] = 1, spec.material = wrong;
      dynBuilder* b = nullptr;
      ASSERT_EQ(DYN_OK, dyn_builder_new("x", &b));
      EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_add_shape(b, &spec));
      EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "material"));
      dyn_builder_free(b);
    }
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_shape_material(run.m, run.d, 7, &good));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_shape_material(run.m, run.d, 1, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_shape_material(run.m, run.d, -1, &x));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_shape_material(run.m, run.d, 0, nullptr));
  int count = 0;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_step_contacts(run.m, run.d, nullptr, 1, &count));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_step_contacts(run.m, run.d, nullptr, 0, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_step_contacts(run.m, run.d, nullptr, -1, &count));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_data_step_contacts(nullptr, run.d, nullptr, 0, &count));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_data_shape_material(run.m, nullptr, 0, &x));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_data_set_shape_material(nullptr, run.d, 0, &good));
}

}  // namespace
}  // namespace dyn_test
