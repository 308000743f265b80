// What steps remember of shapes that were apart saves queries and changes nothing.
#include "count.hpp"
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

// Slender shapes fall into a heap: their bounding spheres overlap all the time, while few of them touch.
Model slender() {
  Scene scene;
  scene.ground();
  for (int k = 0; k < 8; ++k) {
    const std::string name = "b" + std::to_string(k);
    const dynMaterial x = material(0.4);
    const dynShapeType type = k % 4 == 0 ? DYN_SHAPE_TYPE_CYLINDER : DYN_SHAPE_TYPE_CONE;
    if (k % 2) scene.box(name.c_str(), 1, {0.4, 0.03, 0.05}, x);
    else scene.free(name.c_str(), 1, {0.01, 0.01, 0.001}).shape(name.c_str(), type, {0.02, 0.4, 0}, x);
  }
  return scene.finish();
}

// Data that knows nothing continues from a saved state with the same bits as data that stepped all the way.
TEST(Clearances, AreNoPartOfTheState) {
  Simulation run(slender(), 2e-3);
  Numbers q, v;
  for (int k = 0; k < 8; ++k) {
    const double a = 0.7 * k, norm = std::sqrt(1 + a * a + 0.3 * 0.3);
    for (const double x : {0.05 * (k % 3), 0.04 * (k % 2), 0.3 + 0.15 * k, 0.3 / norm, a / norm, 0.0, 1 / norm}) q.push_back(x);
    for (const double x : {0.1, -0.2, 0.0, 1.0, -0.5, 2.0}) v.push_back(x * std::cos(double(k)));
  }
  run.set(q, v);
  std::vector<char> state(dyn_model_state_size(run.m));
  int touched = 0;
  for (int k = 0; k < 400; ++k) {
    ASSERT_EQ(DYN_OK, dyn_data_save_state(run.m, run.d, state.data(), state.size()));
    run.steps(1);
    dynData* fresh = nullptr;
    ASSERT_EQ(DYN_OK, dyn_data_new(run.m, DYN_PART_SIMULATION, &fresh));
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, fresh, &run.options));
    ASSERT_EQ(DYN_OK, dyn_data_restore_state(run.m, fresh, state.data(), state.size())) << dyn_last_error();
    ASSERT_EQ(DYN_OK, dyn_step(run.m, fresh)) << dyn_last_error();
    std::vector<char> one(state.size()), other(state.size());
    ASSERT_EQ(DYN_OK, dyn_data_save_state(run.m, run.d, one.data(), one.size()));
    ASSERT_EQ(DYN_OK, dyn_data_save_state(run.m, fresh, other.data(), other.size()));
    ASSERT_EQ(one, other) << "step " << k;
    touched += !run.contacts().empty();
    dyn_data_free(fresh);
  }
  EXPECT_GT(touched, 100);
}

// Slender rods side by side, apart but within each other's bounding spheres, cost little more than rods far apart: of many pairs,
// none takes another's place.
TEST(Clearances, PairsApartCostAComparison) {
  if (sanitized) GTEST_SKIP() << "sanitizers have instructions of their own";
  for (const int rods : {2, 12}) {
    const auto count = [&](double apart) -> long {
      Scene scene({0, 0, 0});
      Numbers q, v;
      for (int k = 0; k < rods; ++k) {
        const std::string name = "rod" + std::to_string(k);
        scene.free(name.c_str(), 1, {0.08, 0.08, 0.001});
        scene.shape(name.c_str(), DYN_SHAPE_TYPE_CYLINDER, {0.02, 1, 0}, material(0.4));
        q.insert(q.end(), {apart * k, 0, 0, 0, 0, 0, 1}), v.insert(v.end(), {0, 0, 0, 0, k % 2 ? 0.01 : -0.01, 0.02});
      }
      Simulation run(scene.finish());
      run.set(q, v);
      run.steps(10);
      return bench::instructions([&] {
        for (int k = 0; k < 4; ++k) dyn_step(run.m, run.d);
      });
    };
    const long far = count(10), near = count(0.08);
    if (far < 0) GTEST_SKIP() << "this system does not let a process trace its child";
    EXPECT_LE(double(near - far) / 4, 230 * rods * (rods - 1) / 2) << rods << ": " << near << " " << far;
  }
}

// Instructions of a step of two rods that fly side by side with a gap, beyond those of rods far apart. Shape by type.
long more_of_pair(dynShapeType type, std::array<double, 3> size, double thick, double gap) {
  const auto count = [&](double apart) -> long {
    Scene scene({0, 0, 0});
    Numbers q, v;
    for (int k = 0; k < 2; ++k) {
      const std::string name = "rod" + std::to_string(k);
      scene.free(name.c_str(), 1, {0.08, 0.08, 0.001}).shape(name.c_str(), type, size, material(0.4));
      q.insert(q.end(), {apart * k, 0, 0, 0, 0, 0, 1}), v.insert(v.end(), {0, 3, 1, 0, 0, 0});
    }
    Simulation run(scene.finish());
    run.set(q, v);
    run.steps(10);
    return bench::instructions([&] {
      for (int k = 0; k < 4; ++k) dyn_step(run.m, run.d);
    });
  };
  const long far = count(10), near = count(thick + gap);
  return far < 0 ? -1 : std::max(0L, near - far) / 4;
}
struct Rod {
  dynShapeType type;
  std::array<double, 3> size;
  double thick;  // m, across
};
const Rod rods[] = {{DYN_SHAPE_TYPE_CYLINDER, {0.02, 1, 0}, 0.04},
                    {DYN_SHAPE_TYPE_CONE, {0.02, 1, 0}, 0.04},
                    {DYN_SHAPE_TYPE_ELLIPSOID, {0.02, 0.02, 0.5}, 0.04},
                    {DYN_SHAPE_TYPE_BOX, {0.04, 0.04, 1}, 0.04}};

// Shapes apart cost a comparison of what is left of their distance, while both move on together.
TEST(Clearances, RememberedPairCostsAComparison) {
  if (sanitized) GTEST_SKIP() << "sanitizers have instructions of their own";
  for (const Rod& r : rods) {
    const long more = more_of_pair(r.type, r.size, r.thick, 0.3);
    if (more < 0) GTEST_SKIP() << "this system does not let a process trace its child";
    EXPECT_LE(more, 250) << r.type;
  }
}

// Shapes that are little farther apart than what a step may close cost two support points: both move on by more than the rest.
TEST(Clearances, PairNearWithoutContactCostsTwoSupportPoints) {
  if (sanitized) GTEST_SKIP() << "sanitizers have instructions of their own";
  for (const Rod& r : rods) {
    const long more = more_of_pair(r.type, r.size, r.thick, 0.02);
    if (more < 0) GTEST_SKIP() << "this system does not let a process trace its child";
    EXPECT_LE(more, 640) << r.type;
  }
}

// A query finds a box again after a jump of the state.
TEST(Clearances, FollowJumps) {
  Scene scene({0, 0, 0});
  for (const char* name : {"a", "b"}) scene.box(name, 1, {0.1, 0.1, 1}, material(0.4));
  Simulation run(scene.finish());
  for (int k = 0; k < 3; ++k) {
    run.place({{0, 0, 0}, {0.5, 0, 0}});
    run.steps(1);
    EXPECT_TRUE(run.contacts().empty());
    run.place({{0, 0, 0}, {0.0999, 0, 0}});
    run.steps(1);
    EXPECT_FALSE(run.contacts().empty());
  }
}

}  // namespace
}  // namespace dyn_test
