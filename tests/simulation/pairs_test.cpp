// Requested pairs with their own material, and a grasp.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

// Pairs excluded by the filter, and pairs with a friction of their own.
TEST(Pairs, RequestedPairsAreTested) {
  Scene scene;
  dynShapeSpec floor, shape;
  dyn_shape_spec_init(&floor), dyn_shape_spec_init(&shape);
  floor.name = "floor", floor.type = DYN_SHAPE_TYPE_HALF_SPACE, floor.contype = floor.conaffinity = 0,
  floor.material = material(0.9);
  ASSERT_EQ(DYN_OK, dyn_builder_add_shape(scene.builder(), &floor)) << dyn_last_error();
  scene.free("box", 1, {1, 1, 1});
  shape.name = "side", shape.body = "box", shape.size[0] = shape.size[1] = shape.size[2] = 0.2, shape.material = material(0.9);
  ASSERT_EQ(DYN_OK, dyn_builder_add_shape(scene.builder(), &shape)) << dyn_last_error();
  const dynMaterial ice = material(0.1);
  EXPECT_EQ(DYN_ERROR_NAME, dyn_builder_add_pair(scene.builder(), "floor", "nothing", nullptr));
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_add_pair(scene.builder(), "side", "side", nullptr));
  const dynMaterial bad = material(-1);
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_add_pair(scene.builder(), "floor", "side", &bad));
  ASSERT_EQ(DYN_OK, dyn_builder_add_pair(scene.builder(), "floor", "side", &ice)) << dyn_last_error();
  Simulation run(scene.finish());
  run.set({0, 0, 0.1, 0, 0, 0, 1}, {2, 0, 0, 0, 0, 0});
  run.steps(500);
  EXPECT_NEAR(2 - 0.1 * 9.81 * 0.5, run.velocity()[0], 1e-6);
  EXPECT_NEAR(0.1, run.q[2], 1e-6);
}

// A capsule of 45 g between two pads that press it with 20 to 95 times the force that friction needs.
// mujoco#3328: soft friction lets it sink by 50 to 2,300 um/s. Here it stays in place.
TEST(Grasp, PinchedCapsuleDoesNotSlip) {
  const char* text = R"(<mujoco><option timestep='.002'/><default><geom friction='1 0 0' condim='3'/></default><worldbody>
      <body pos='0 -.04 0'><joint name='left' type='slide' axis='0 1 0' damping='5'/><geom type='box' size='.05 .02 .05' mass='.2'/></body>
      <body pos='0 .04 0'><joint name='right' type='slide' axis='0 -1 0' damping='5'/><geom type='box' size='.05 .02 .05' mass='.2'/></body>
      <body name='held'><freejoint/><geom type='capsule' size='.02 .03' euler='0 90 0' mass='.045'/></body></worldbody>
      <actuator><motor joint='left'/><motor joint='right'/></actuator></mujoco>)";
  for (const double times : {20.0, 95.0}) {
    dynModel* m = nullptr;
    ASSERT_EQ(DYN_OK, dyn_model_load_string(text, nullptr, &m)) << dyn_last_error();
    Simulation run(Model(m), 2e-3);
    const double force = times * 0.045 * 9.81 / 2;
    control(run, {force, force});
    run.steps(500);
    const double before = run.q[4];
    run.steps(5000);
    EXPECT_NEAR(before, run.q[4], 1e-9) << times;  // 10 s: 1 um/s would be 1e-5
    EXPECT_NEAR(0, run.q[4], 1e-5) << times;
  }
}

}  // namespace
}  // namespace dyn_test
