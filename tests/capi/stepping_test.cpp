// Options of stepping, steps of a duration, steps by an accuracy, and what they report.
#include "capi/support.hpp"

namespace dyn_test {
namespace {

dynStepOptions options_of(dynIntegrator integrator, double dt, double accuracy = 0) {
  dynStepOptions o;
  dyn_step_options_init(&o);
  o.integrator = integrator, o.dt = dt, o.accuracy = accuracy;
  return o;
}
dynStepReport report_of(const dynModel* m, dynData* d) {
  dynStepReport r{};
  r.struct_size = sizeof r;
  EXPECT_EQ(DYN_OK, dyn_data_step_report(m, d, &r)) << dyn_last_error();
  return r;
}

struct Flight {
  Model m = all_types();
  Data d{m};
  Flight() {
    const State s = random_state(m, 3);
    EXPECT_EQ(DYN_OK, dyn_data_set_state(m, d, s.q.data(), s.v.data(), s.a.data(), s.tau.data()));
  }
};

TEST(Stepping, OptionsAreKept) {
  Flight f;
  dynStepOptions o;
  dyn_step_options_init(&o);
  ASSERT_EQ(DYN_OK, dyn_data_step_options(f.m, f.d, &o));
  EXPECT_EQ(DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, o.integrator);
  EXPECT_EQ(1e-3, o.dt);
  EXPECT_EQ(0, o.accuracy);
  const dynStepOptions mine = options_of(DYN_INTEGRATOR_RK45, 0.25, 1e-6);
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(f.m, f.d, &mine));
  ASSERT_EQ(DYN_OK, dyn_data_step_options(f.m, f.d, &o));
  EXPECT_EQ(DYN_INTEGRATOR_RK45, o.integrator);
  EXPECT_EQ(0.25, o.dt);
  EXPECT_EQ(1e-6, o.accuracy);
}

TEST(Stepping, ADurationIsSteps) {
  Flight one, many;
  const dynStepOptions o = options_of(DYN_INTEGRATOR_RK4, 1e-3);
  for (Flight* f : {&one, &many}) ASSERT_EQ(DYN_OK, dyn_data_set_step_options(f->m, f->d, &o));
  ASSERT_EQ(DYN_OK, dyn_advance(one.m, one.d, 0.0105)) << dyn_last_error();
  EXPECT_EQ(11, report_of(one.m, one.d).steps);
  EXPECT_EQ(44, report_of(one.m, one.d).evaluations);
  EXPECT_NEAR(5e-4, report_of(one.m, one.d).smallest_dt, 1e-12);
  for (int k = 0; k < 10; ++k) ASSERT_EQ(DYN_OK, dyn_step(many.m, many.d));
  ASSERT_EQ(DYN_OK, take_step(many.m, many.d, DYN_INTEGRATOR_RK4, report_of(one.m, one.d).smallest_dt));
  EXPECT_TRUE(same_bits(field(one.m, one.d, "q"), field(many.m, many.d, "q")));
  EXPECT_NEAR(0.0105, field(one.m, one.d, "time")[0], 1e-15);
  // what divides is not followed by a step of rounding
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(one.m, one.d, &o));
  ASSERT_EQ(DYN_OK, dyn_advance(one.m, one.d, 0.3));
  EXPECT_EQ(300, report_of(one.m, one.d).steps);
  ASSERT_EQ(DYN_OK, dyn_advance(one.m, one.d, 0));
  EXPECT_EQ(0, report_of(one.m, one.d).steps);
}

TEST(Stepping, AnAccuracyIsKept) {
  Flight reference;
  dynStepOptions o = options_of(DYN_INTEGRATOR_REFERENCE, 0.01);
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(reference.m, reference.d, &o));
  ASSERT_EQ(DYN_OK, dyn_advance(reference.m, reference.d, 0.05)) << dyn_last_error();
  for (const dynIntegrator integrator : {DYN_INTEGRATOR_RK45, DYN_INTEGRATOR_RK4})
    for (const double accuracy : {1e-4, 1e-8}) {
      Flight f;
      o = options_of(integrator, 1, accuracy);
      ASSERT_EQ(DYN_OK, dyn_data_set_step_options(f.m, f.d, &o));
      ASSERT_EQ(DYN_OK, dyn_advance(f.m, f.d, 0.05)) << dyn_last_error();
      double distance;
      ASSERT_EQ(DYN_OK, dyn_configuration_distance(f.m, field(f.m, f.d, "q").data(), field(reference.m, reference.d, "q").data(),
                                                   &distance));
      EXPECT_LE(distance, 10 * accuracy);
      EXPECT_LE(report_of(f.m, f.d).error_estimate, accuracy);
      EXPECT_EQ(0.05, report_of(f.m, f.d).time);
    }
}

TEST(Stepping, BadOptions) {
  Flight f;
  const auto expect = [&](dynStatus status, const dynStepOptions& o, const char* word) {
    EXPECT_EQ(status, dyn_data_set_step_options(f.m, f.d, &o)) << word;
    EXPECT_TRUE(says({"dyn_data_set_step_options", word}));
  };
  expect(DYN_ERROR_ARGUMENT, options_of(DYN_INTEGRATOR_RK4, 0), "dt");
  expect(DYN_ERROR_ARGUMENT, options_of(DYN_INTEGRATOR_RK4, -1), "dt");
  expect(DYN_ERROR_NONFINITE, options_of(DYN_INTEGRATOR_RK4, nan), "dt");
  expect(DYN_ERROR_NONFINITE, options_of(DYN_INTEGRATOR_RK4, inf), "dt");
  expect(DYN_ERROR_ARGUMENT, options_of(DYN_INTEGRATOR_RK4, 1, -1e-3), "accuracy");
  expect(DYN_ERROR_NONFINITE, options_of(DYN_INTEGRATOR_RK4, 1, nan), "accuracy");
  dynStepOptions budget = options_of(DYN_INTEGRATOR_RK4, 1);
  budget.time_budget = -1e-3, expect(DYN_ERROR_ARGUMENT, budget, "time_budget");
  budget.time_budget = nan, expect(DYN_ERROR_NONFINITE, budget, "time_budget");
  dynStepOptions rows = options_of(DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1);
  rows.contact_model = static_cast<dynContactModel>(2), expect(DYN_ERROR_ARGUMENT, rows, "contact_model");
  rows.contact_model = DYN_CONTACT_MODEL_AS_FILE, expect(DYN_ERROR_UNSUPPORTED, rows, "contact_model");  // no MJCF file
  dynStepOptions small = options_of(DYN_INTEGRATOR_RK4, 1);
  small.struct_size = 4;
  expect(DYN_ERROR_SIZE, small, "struct_size");
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_step_options(f.m, f.d, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_step_options(f.m, f.d, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_step_report(f.m, f.d, nullptr));
  dynStepReport none{};
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_data_step_report(f.m, f.d, &none));
  dyn_step_options_init(nullptr);
  dynStepOptions kept;
  dyn_step_options_init(&kept);
  ASSERT_EQ(DYN_OK, dyn_data_step_options(f.m, f.d, &kept));
  EXPECT_EQ(1e-3, kept.dt);
}

TEST(Stepping, BadDurations) {
  Flight f;
  const Numbers q = field(f.m, f.d, "q");
  for (const double bad : {-1.0, -1e-300}) EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_advance(f.m, f.d, bad));
  for (const double bad : {nan, inf, -inf}) EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_advance(f.m, f.d, bad));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_advance(f.m, f.d, 1e300));
  EXPECT_TRUE(says({"dyn_advance", "too many"}));
  EXPECT_TRUE(same_bits(q, field(f.m, f.d, "q")));
  const Data bare(f.m, DYN_PART_FORWARD);
  for (const dynStatus s : {dyn_step(f.m, bare), dyn_advance(f.m, bare, 1)}) EXPECT_EQ(DYN_ERROR_PART, s);
  EXPECT_TRUE(says({"DYN_PART_SIMULATION"}));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_advance(nullptr, f.d, 1));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_advance(f.m, nullptr, 1));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_step(nullptr, nullptr));
}

// A failing step leaves the state that the steps before it made.
TEST(Stepping, AFailureKeepsWhatWasReached) {
  Flight f;
  Numbers v = field(f.m, f.d, "v");
  for (double& x : v) x *= 1e150;
  for (const double accuracy : {0.0, 1e-6}) {
    ASSERT_EQ(DYN_OK, dyn_data_set_state(f.m, f.d, nullptr, v.data(), nullptr, nullptr));
    const Numbers q = field(f.m, f.d, "q");
    const dynStepOptions o = options_of(DYN_INTEGRATOR_RK4, 1e-3, accuracy);
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(f.m, f.d, &o));
    EXPECT_EQ(DYN_ERROR_NUMERIC, dyn_advance(f.m, f.d, 1)) << accuracy;
    EXPECT_TRUE(says({"dyn_advance", "as before the step"}));
    for (double x : field(f.m, f.d, "q")) EXPECT_TRUE(std::isfinite(x));
    if (report_of(f.m, f.d).steps == 0) {
      EXPECT_TRUE(same_bits(q, field(f.m, f.d, "q")));
    }
  }
}


// A named configuration is set with all that it states beside q; what it does not state is zero.
TEST(Reset, GoesToTheBeginningOrToAKey) {
  const char* text =
      "<mujoco><option timestep='0.004' integrator='RK4'/><worldbody><body pos='0 0 1'><joint name='j' type='slide' axis='0 0 1' "
      "ref='1'/>"
      "<geom type='sphere' size='.1'/></body></worldbody><actuator><motor name='a' joint='j'/></actuator>"
      "<keyframe><key name='k' qpos='2' qvel='3' ctrl='4' time='5'/></keyframe></mujoco>";
  dynModel* m = nullptr;
  dynData* d = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_load_string(text, nullptr, &m)) << dyn_last_error();
  ASSERT_EQ(DYN_OK, dyn_data_new(m, 0, &d));
  EXPECT_STREQ("qpos0", dyn_model_configuration_name(m, dyn_model_initial_configuration(m)));
  dynStepOptions o;
  dyn_step_options_init(&o);
  ASSERT_EQ(DYN_OK, dyn_model_step_options(m, &o));
  EXPECT_EQ(0.004, o.dt);
  EXPECT_EQ(DYN_INTEGRATOR_RK4, o.integrator);
  const auto is = [&](double q, double v, double u, double t) {
    const struct {
      const char* field;
      double value;
    } rows[] = {{"q", q}, {"v", v}, {"ctrl", u}, {"time", t}};
    for (const auto& r : rows) {
      dynArray x{};
      x.struct_size = sizeof x;
      ASSERT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id(r.field), &x));
      EXPECT_EQ(r.value, x.data[0]) << r.field;
    }
  };
  is(1, 0, 0, 0);
  ASSERT_EQ(DYN_OK, dyn_data_reset(m, d, "k"));
  is(2, 3, 4, 5);
  EXPECT_EQ(DYN_ERROR_NAME, dyn_data_reset(m, d, "l"));
  EXPECT_NE(std::string::npos, std::string(dyn_last_error()).find("'l'")) << dyn_last_error();
  is(2, 3, 4, 5);
  ASSERT_EQ(DYN_OK, dyn_step(m, d));
  ASSERT_EQ(DYN_OK, dyn_data_reset(m, d, nullptr));
  is(1, 0, 0, 0);
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_data_reset(m, nullptr, nullptr));
  dyn_data_free(d), dyn_model_free(m);
}

}  // namespace
}  // namespace dyn_test
