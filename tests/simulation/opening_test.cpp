// Starts that overlap or lie beyond limits: every integrator opens them at the same speed, so all find the same motion.
#include <functional>

#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

Numbers after(Model model, const Numbers& q, double duration, double dt, double accuracy) {
  Simulation run(std::move(model), dt);
  run.options.accuracy = accuracy, run.options.integrator = DYN_INTEGRATOR_IMPLICIT_FAST;
  EXPECT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
  run.set(q, Numbers(std::size_t(run.m.nv()), 0));
  EXPECT_EQ(DYN_OK, dyn_advance(run.m, run.d, duration)) << dyn_last_error();
  return Numbers(run.q, run.q + run.m.nq());
}

// Short steps err in proportion to dt: at 1e-5 s by less than a tenth of `within`.
void expect_one_motion(const std::function<Model()>& model, const Numbers& q, double duration, double within) {
  const Numbers end = after(model(), q, duration, 1e-5, 0);
  for (const double accuracy : {1e-3, 1e-5}) {
    const Numbers x = after(model(), q, duration, 1e-3, accuracy);
    for (std::size_t k = 0; k < x.size(); ++k) EXPECT_NEAR(end[k], x[k], within + accuracy) << accuracy << " " << k;
  }
}

// A knee of 0.03 rad beyond its limit, on a thigh that falls: the limit turns both. It opens in 40 ms.
TEST(Opening, OfLimitsIsOneMotion) {
  const auto leg = [] {
    dynModel* m = nullptr;
    const std::string text = R"(<mujoco><compiler angle='radian' autolimits='true'/><worldbody><body><freejoint/>
      <geom type='capsule' fromto='0 0 0 0 0 -0.4' size='0.05'/><body pos='0 0 -0.4'><joint axis='0 1 0' range='-2 -0.03'/>
      <geom type='capsule' fromto='0 0 0 0.05 0 -0.4' size='0.04'/></body></body></worldbody></mujoco>)";
    EXPECT_EQ(DYN_OK, dyn_model_load_string(text.c_str(), nullptr, &m)) << dyn_last_error();
    return Model(m);
  };
  expect_one_motion(leg, {0, 0, 0, 0, 0, 0, 1, 0}, 0.1, 1e-4);
}

// A tilted box whose lowest corner is 2 cm below the ground.
TEST(Opening, OfContactsIsOneMotion) {
  const auto box = [] {
    Scene s;
    return s.ground().box("box", 1, {0.2, 0.2, 0.1}, material(0.5)).finish();
  };
  const double turn = 0.1;
  expect_one_motion(box, {0, 0, 0.03 + 0.1 * std::sin(turn), 0, std::sin(turn / 2), 0, std::cos(turn / 2)}, 0.05, 2e-4);
}

// Boxes deep in one another, 0.1 to 6 kg: they come apart at the speed of overlaps, and gain no other.
TEST(Opening, OfAHeapGivesNoSpeed) {
  const char* const names[] = {"a", "b", "c", "d", "e", "f"};
  Numbers q;
  for (int k = 0; k < 6; ++k) {
    const double turn = 0.6 * std::sin(1.0 + k);
    q.insert(q.end(), {0.08 * std::cos(3.0 * k), 0.08 * std::sin(5.0 * k), 0.05 + 0.08 * k, std::sin(turn / 2), 0, 0, std::cos(turn / 2)});
  }
  for (const double accuracy : {1e-2, 1e-4}) {
    Scene s;
    s.ground();
    for (int k = 0; k < 6; ++k) s.box(names[k], std::pow(10, 0.8 * std::cos(2.0 * k)), {0.2, 0.16, 0.12}, material(0.5));
    Simulation run(s.finish());
    run.options.accuracy = accuracy;
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
    run.set(q, Numbers(36, 0));
    ASSERT_EQ(DYN_OK, dyn_advance(run.m, run.d, 0.1)) << dyn_last_error();
    for (int k = 0; k < 36; ++k) EXPECT_LT(std::abs(run.v[k]), k % 6 < 3 ? 2 : 20) << accuracy << " " << k;
  }
}

}  // namespace
}  // namespace dyn_test
