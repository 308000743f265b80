// A step takes instructions only for the effects that act, counted exactly; the others change no bit of the result.
#include <gtest/gtest.h>

#include <cmath>

#include "capi/support.hpp"
#include "effects/scenes.hpp"

namespace {

using bench::Counted;
constexpr std::uint32_t awake = DYN_EFFECT_ALL & ~DYN_EFFECT_SLEEPING;

long count(const std::string& text, std::uint32_t effects = awake) {
  Counted c(text, effects);
  const long n = c.step();
  EXPECT_EQ("", c.error);
  return n;
}
#define SKIP_UNCOUNTED(n)                                                                    \
  if ((n) < 0) GTEST_SKIP() << "this system does not let a process trace its child";         \
  if (dyn_test::sanitized) GTEST_SKIP() << "sanitizers have instructions of their own"

TEST(StepInstructions, ChainCostsForwardDynamicsAndIntegration) {
  Counted c(bench::scene(bench::chain(10, "", bench::masked)));
  const long step = c.step(), bare = c.bare();
  SKIP_UNCOUNTED(step);
  EXPECT_LE(double(step), 1.02 * double(bare));
}

TEST(StepInstructions, FreeBodyCostsForwardDynamicsAndIntegration) {
  Counted c(bench::scene(bench::free_body(bench::masked)));
  const long step = c.step(), bare = c.bare();
  SKIP_UNCOUNTED(step);
  EXPECT_LE(double(step), 1.02 * double(bare));
}

TEST(StepInstructions, FarShapesAddNothing) {
  const long alone = count(bench::scene(bench::chain(10, "", bench::masked)));
  SKIP_UNCOUNTED(alone);
  for (const int boxes : {900, 3000})
    EXPECT_LE(double(count(bench::scene(bench::chain(10, "", bench::touching) + bench::far_boxes(boxes)))), 1.01 * double(alone))
        << boxes;
}

// Only how fast shapes approach each other counts: robots run, fall and ride.
TEST(StepInstructions, SpeedThatShapesShareAddsLittle) {
  std::string row;
  for (int k = 0; k < 8; ++k)
    row += "<body pos='" + std::to_string(0.25 * k) + " 0 0' euler='10 20 30'><freejoint/><geom type='cylinder' size='.08 .08'/></body>";
  long steps[2];
  for (const int fast : {0, 1}) {
    Counted c(bench::scene(row, "0 0 0"), awake);
    ASSERT_EQ("", c.error);
    std::vector<double> v(std::size_t(dyn_model_nv(c.m)), 0.0);
    for (std::size_t k = 2; fast && k < v.size(); k += 6) v[k] = 60;  // all turned alike
    ASSERT_EQ(DYN_OK, dyn_data_set_state(c.m, c.d, nullptr, v.data(), nullptr, nullptr)) << dyn_last_error();
    steps[fast] = c.step();
    SKIP_UNCOUNTED(steps[fast]);
  }
  EXPECT_LE(steps[1], 2 * steps[0]);  // 7.6 times with the speeds themselves
}

TEST(StepInstructions, InactiveLimitsAddNothing) {
  const long alone = count(bench::scene(bench::chain(10, "", bench::masked)));
  SKIP_UNCOUNTED(alone);
  EXPECT_LE(count(bench::scene(bench::chain(10, bench::limited, bench::masked))) - alone, 10 * 11);
}

// An effect switched off costs the same as a model without it.
TEST(StepInstructions, DisabledEffectsAddNothing) {
  const long alone = count(bench::scene(bench::chain(10, "", bench::masked)));
  SKIP_UNCOUNTED(alone);
  const struct {
    const char* joint;
    std::uint32_t effect;
  } effects[] = {{bench::limited, DYN_EFFECT_LIMITS},
                 {bench::damped, DYN_EFFECT_DAMPING},
                 {"stiffness='1'", DYN_EFFECT_SPRINGS},
                 {"armature='.01'", DYN_EFFECT_ARMATURE}};
  for (const auto& e : effects)
    EXPECT_NEAR(double(count(bench::scene(bench::chain(10, e.joint, bench::masked)), awake & ~e.effect)), double(alone),
                0.01 * double(alone))
        << e.joint;
}

// The same for effects that are not at the joints.
TEST(StepInstructions, DisabledSceneEffectsAddNothing) {
  const std::string chain = bench::chain(10, "name='j' frictionloss='.1'", bench::masked),
                    plain = bench::chain(10, "name='j'", bench::masked);
  const auto unnamed = [](std::string text) {  // except the first joint
    for (std::size_t at = text.find("name='j'") + 1; (at = text.find("name='j'", at)) != std::string::npos;) text.erase(at, 8);
    return text;
  };
  const long alone = count("<mujoco><worldbody>" + unnamed(plain) + "</worldbody></mujoco>");
  SKIP_UNCOUNTED(alone);
  const auto expect_alone = [&](const std::string& text, std::uint32_t effect) {
    EXPECT_GT(double(count(text)), 1.01 * double(alone)) << effect;  // it does act
    EXPECT_NEAR(double(count(text, awake & ~effect)), double(alone), 0.01 * double(alone)) << effect;
  };
  expect_alone("<mujoco><worldbody>" + unnamed(chain) + "</worldbody></mujoco>", DYN_EFFECT_FRICTION);
  expect_alone(
      "<mujoco><worldbody>" + unnamed(plain) + "</worldbody><actuator><position joint='j' kp='10' kv='1'/></actuator></mujoco>",
      DYN_EFFECT_ACTUATORS);
  expect_alone("<mujoco><option density='1.2' viscosity='1e-5'/><worldbody>" + unnamed(plain) + "</worldbody></mujoco>",
               DYN_EFFECT_FLUID);
  std::string ellipsoids = unnamed(plain);
  for (std::size_t at = 0; (at = ellipsoids.find("<geom ", at)) != std::string::npos; at += 6)
    ellipsoids.insert(at + 6, "fluidshape='ellipsoid' ");
  expect_alone("<mujoco><option density='1.2' viscosity='1e-5'/><worldbody>" + ellipsoids + "</worldbody></mujoco>",
               DYN_EFFECT_FLUID_ELLIPSOIDS);
}

// A box within reach whose pairs are switched off.
TEST(StepInstructions, DisabledPairsAddNothing) {
  const long alone = count(bench::scene(bench::chain(10, "", bench::masked)));
  SKIP_UNCOUNTED(alone);
  Counted c(bench::scene(bench::chain(10, "", bench::touching) +
                         "<geom type='box' size='.3 .3 .3' pos='.5 0 -.3' contype='0' conaffinity='1'/>"),
            awake);
  ASSERT_EQ("", c.error);
  ASSERT_EQ(DYN_OK, dyn_data_set_pair(c.m, c.d, -1, 0)) << dyn_last_error();
  EXPECT_NEAR(double(c.step()), double(alone), 0.01 * double(alone));
}

// The chain swings past a box and to its limits and back: steps that skip the search give the bits of those that do not.
TEST(AdvancementCache, ChangesNoBit) {
  const std::string box = "<geom type='box' size='.1 .1 .1' pos='.3 0 -.9' contype='0' conaffinity='1'/>";
  const std::string text = bench::scene(bench::chain(6, "limited='true' range='-100 100'", bench::touching) + box);
  Counted a(text), b(text);
  ASSERT_EQ("", a.error + b.error);
  dynArray qa{}, qb{};
  qa.struct_size = qb.struct_size = sizeof qa;
  ASSERT_EQ(DYN_OK, dyn_data_array(a.m, a.d, dyn_field_id("q"), &qa));
  ASSERT_EQ(DYN_OK, dyn_data_array(b.m, b.d, dyn_field_id("q"), &qb));
  int met = 0;
  for (int k = 0; k < 3000; ++k) {
    ASSERT_EQ(DYN_OK, dyn_data_set_pair(b.m, b.d, 0, 0));  // clears the cache
    ASSERT_EQ(DYN_OK, dyn_data_set_pair(b.m, b.d, 0, 1));
    ASSERT_EQ(DYN_OK, dyn_step(a.m, a.d));
    ASSERT_EQ(DYN_OK, dyn_step(b.m, b.d));
    dynStepReport r{};
    r.struct_size = sizeof r;
    ASSERT_EQ(DYN_OK, dyn_data_step_report(a.m, a.d, &r));
    met += r.rows > 0;
    for (int i = 0; i < dyn_model_nq(a.m); ++i) ASSERT_EQ(qa.data[i], qb.data[i]) << k << " " << i;
  }
  EXPECT_GT(met, 10);
  EXPECT_LT(met, 2900);
}

}  // namespace
