// One data copied into another of its model: state, settings, and steps that are equal bit for bit.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

const std::vector<std::array<double, 3>> places{{0, 0, 0.1}, {0.05, 0, 0.3}, {1, 0, 0.5}};

Model scene() {
  return Scene()
      .ground()
      .box("low", 1, {0.2, 0.2, 0.2}, material(0.5))
      .box("high", 2, {0.2, 0.2, 0.2}, material(0.7, 0.1))
      .sphere("ball", 1, 0.1, material(0.2))
      .finish();
}

// Another data of the same model.
struct Other {
  const dynModel* m;
  dynData* d = nullptr;
  const double *q, *v, *time;
  explicit Other(const Simulation& run) : m(run.m) {
    EXPECT_EQ(DYN_OK, dyn_data_new(m, DYN_PART_SIMULATION | DYN_PART_ENERGY | DYN_PART_CENTROIDAL, &d));
    q = array_of(m, d, "q"), v = array_of(m, d, "v"), time = array_of(m, d, "time");
  }
  Other(const Other&) = delete;
  ~Other() { dyn_data_free(d); }
  dynStepReport report() const { return report_of(m, d); }
  void steps(int n) {
    for (int k = 0; k < n; ++k) ASSERT_EQ(DYN_OK, dyn_step(m, d)) << dyn_last_error();
  }
};

void expect_equal_steps(Simulation& a, Other& b, int steps) {
  for (int k = 0; k < steps; ++k) {
    a.steps(1), b.steps(1);
    ASSERT_TRUE(std::equal(a.q, a.q + a.m.nq(), b.q) && std::equal(a.v, a.v + a.m.nv(), b.v)) << k;
  }
  EXPECT_EQ(*a.array("time"), *b.time);
  EXPECT_EQ(a.report().contacts, b.report().contacts);
}

// Everything that is set in a data and is no part of its state, differently for k of 0 and 1.
void set_all(const dynModel* m, dynData* d, int k) {
  const double gravity[3] = {0.1 * k, 0, -9 - 0.1 * k}, push[6] = {0.5 + k, 0.2, 1, 0, 0, 0.01 * k}, at[3] = {0.02, 0, 0.01};
  ASSERT_EQ(DYN_OK, dyn_data_set_gravity(m, d, gravity));
  ASSERT_EQ(DYN_OK, dyn_data_apply_wrench(m, d, dyn_model_frame_id(m, "high"), at, push, DYN_REFERENCE_LOCAL));
  const dynMaterial slick = material(0.1 + 0.2 * k, 0.05 * k);
  ASSERT_EQ(DYN_OK, dyn_data_set_shape_material(m, d, 1, &slick)) << dyn_last_error();
  ASSERT_EQ(DYN_OK, dyn_data_set_pair(m, d, k + 1, 0));
  ASSERT_EQ(DYN_OK, dyn_data_set_shape_masks(m, d, 3, 1u << k, 1));
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(m, d, 2, k ? std::uint32_t(DYN_EFFECT_DEFAULT) : 0u));
  dynConstraint tie;
  dyn_constraint_init(&tie, k ? DYN_CONSTRAINT_TYPE_DISTANCE : DYN_CONSTRAINT_TYPE_POINT);
  tie.first = dyn_model_frame_id(m, "high"), tie.second = dyn_model_frame_id(m, "ball"), tie.length = 1;
  ASSERT_EQ(DYN_OK, dyn_data_set_constraint(m, d, k, &tie)) << dyn_last_error();
  if (!k) {
    ASSERT_EQ(DYN_OK, dyn_data_anchor_constraint(m, d, k, nullptr)) << dyn_last_error();
  }
  dynStepOptions options;
  dyn_step_options_init(&options);
  options.dt = 1e-3 * (k + 1), options.max_iterations = 30 + k, options.solver = DYN_CONTACT_SOLVER_TYPE_PGS;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(m, d, &options));
}

TEST(DataCopy, StepsAreEqualWhateverWasSetBefore) {
  Simulation a(scene());
  Other b(a);
  a.place(places), set_all(a.m, a.d, 0), a.steps(30);
  set_all(b.m, b.d, 1), b.steps(7);
  ASSERT_EQ(DYN_OK, dyn_data_copy(a.m, b.d, a.d)) << dyn_last_error();
  expect_equal_steps(a, b, 100);
  // each goes its own way from here
  const double up[3] = {0, 0, 1};
  ASSERT_EQ(DYN_OK, dyn_data_set_gravity(b.m, b.d, up));
  a.steps(1), b.steps(1);
  EXPECT_NE(a.v[2], b.v[2]);
  EXPECT_EQ(DYN_OK, dyn_data_copy(a.m, a.d, a.d));
}

TEST(DataCopy, OfBodiesThatSleep) {
  Simulation a(scene());
  Other b(a);
  a.place({{0, 0, 0.1}, {0, 0, 0.3}, {1, 0, 0.1}});
  a.options.sleep_time = 0.1;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(a.m, a.d, &a.options));
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(a.m, a.d, 0, DYN_EFFECT_DEFAULT | DYN_EFFECT_SLEEPING));
  a.steps(400);
  ASSERT_GT(a.report().sleeping, 0);
  ASSERT_EQ(DYN_OK, dyn_data_copy(a.m, b.d, a.d)) << dyn_last_error();
  expect_equal_steps(a, b, 50);  // a copy begins awake, and goes to sleep again
  EXPECT_EQ(a.report().sleeping, b.report().sleeping);
  // a copy of what is awake wakes what sleeps
  a.place(places), a.steps(20);
  ASSERT_EQ(DYN_OK, dyn_data_copy(a.m, b.d, a.d)) << dyn_last_error();
  expect_equal_steps(a, b, 50);
}

TEST(DataCopy, OfDataThatMakesNoSteps) {
  const Model m = scene();
  dynData *a = nullptr, *b = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(m, DYN_PART_MASS, &a));
  ASSERT_EQ(DYN_OK, dyn_data_new(m, DYN_PART_MASS, &b));
  Numbers q(std::size_t(m.nq()), 0.0), v(std::size_t(m.nv()), 0.5);
  for (std::size_t k = 6; k < q.size(); k += 7) q[k] = 1, q[k - 6] = 0.1 * double(k);
  ASSERT_EQ(DYN_OK, dyn_data_set_state(m, a, q.data(), v.data(), nullptr, nullptr));
  ASSERT_EQ(DYN_OK, dyn_crba(m, b, nullptr, nullptr));
  ASSERT_EQ(DYN_OK, dyn_data_copy(m, b, a)) << dyn_last_error();
  dynArray x{};
  x.struct_size = sizeof x;
  ASSERT_EQ(DYN_OK, dyn_data_array(m, b, dyn_field_id("q"), &x));
  EXPECT_TRUE(std::equal(q.begin(), q.end(), x.data));
  EXPECT_EQ(DYN_ERROR_STALE, dyn_data_array(m, b, dyn_field_id("M"), &x));
  dyn_data_free(a), dyn_data_free(b);
}

TEST(DataCopy, RefusesAnotherModelAndOtherParts) {
  Simulation a(scene()), b(Scene().box("box", 1, {0.1, 0.1, 0.1}, material(0.5)).finish());
  EXPECT_EQ(DYN_ERROR_MODEL, dyn_data_copy(a.m, b.d, a.d));
  EXPECT_EQ(DYN_ERROR_MODEL, dyn_data_copy(a.m, a.d, b.d));
  EXPECT_EQ(DYN_ERROR_MODEL, dyn_data_copy(b.m, a.d, a.d));
  EXPECT_NE(DYN_OK, dyn_data_copy(a.m, a.d, nullptr));
  EXPECT_NE(DYN_OK, dyn_data_copy(a.m, nullptr, a.d));
  dynData* few = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(a.m, DYN_PART_MASS, &few));
  a.place(places), a.steps(3);
  const double before = a.q[2];
  EXPECT_EQ(DYN_ERROR_PART, dyn_data_copy(a.m, a.d, few));
  EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "same parts"));
  EXPECT_EQ(before, a.q[2]);
  dyn_data_free(few);
}

}  // namespace
}  // namespace dyn_test
