// Tests rollouts: simulations are what calls of dyn_step on a data give, bit for bit, whatever the number of threads; sensors;
// one that fails; cancelling; arguments.
#include "capi/batch.hpp"

namespace dyn_test::rollout_test {
namespace {

// A quadruped above a floor.
Model scene() {
  const Model bare = robot("go2", DYN_BASE_FLOATING);
  Builder b;
  dyn_builder_free(b);
  EXPECT_EQ(DYN_OK, dyn_builder_from_model(bare, &b.b));
  return b.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}).finish();
}

struct Case {
  static constexpr int n = 12, steps = 60, every = 3, records = steps / every, capacity = 64;
  const dynModel* m;
  std::size_t nq, nv, state;
  std::vector<dynSensorType> sensor{DYN_SENSOR_TYPE_PLACEMENT, DYN_SENSOR_TYPE_VELOCITY, DYN_SENSOR_TYPE_IMU,
                                    DYN_SENSOR_TYPE_FORCE,     DYN_SENSOR_TYPE_COM,      DYN_SENSOR_TYPE_ENERGY};
  std::vector<std::int32_t> frame;
  Numbers q0, v0, tau, q, v, sensors;
  std::vector<dynContactForce> contacts;
  std::vector<std::int32_t> counts;
  std::vector<char> states;
  std::vector<dynStatus> status;
  dynRollout x;

  explicit Case(const dynModel* model)
      : m(model), nq(std::size_t(dyn_model_nq(m))), nv(std::size_t(dyn_model_nv(m))), state(dyn_model_state_size(m)) {
    frame.assign(sensor.size(), dyn_model_frame_id_of_type(m, "FL_foot", DYN_FRAME_TYPE_BODY));
    for (int k = 0; k < n; ++k) {
      Numbers start(nq, 0.0), speed(nv, 0.0);
      EXPECT_EQ(DYN_OK, dyn_configuration_neutral(m, start.data()));
      for (const char* leg : {"FL", "FR", "RL", "RR"}) bend(start, leg);
      start[2] = 0.3 + 0.005 * k, speed[0] = 0.1 * k;
      q0.insert(q0.end(), start.begin(), start.end()), v0.insert(v0.end(), speed.begin(), speed.end());
    }
    Random g{3};
    tau = g.numbers(int(std::size_t(n) * records * nv));
    for (std::size_t k = 0; k < tau.size(); ++k) tau[k] *= k % nv < 6 ? 0 : 3;
    const std::size_t rows = std::size_t(n) * records;
    q.assign(rows * nq, -7), v.assign(rows * nv, -7), sensors.assign(rows * 33, -7), contacts.resize(rows * capacity),
        counts.assign(rows, -7);
    states.assign(std::size_t(n) * state, 0), status.assign(n, DYN_ERROR_INTERNAL);
    dyn_rollout_init(&x);
    x.steps = steps, x.every = every, x.sensors = int(sensor.size()), x.sensor = sensor.data(), x.sensor_frame = frame.data();
    x.q0 = q0.data(), x.v0 = v0.data(), x.tau = tau.data(), x.q = q.data(), x.v = v.data(), x.sensor_data = sensors.data();
    x.contact_capacity = capacity, x.contacts = contacts.data(), x.contact_count = counts.data(), x.final_states = states.data(),
    x.status = status.data();
  }
  Case(const Case&) = delete;
  void bend(Numbers& start, const std::string& leg) const {
    for (const auto& [joint, angle] : {std::pair("_thigh_joint", 0.8), std::pair("_calf_joint", -1.5)}) {
      dynJointInfo info{};
      info.struct_size = sizeof info;
      ASSERT_EQ(DYN_OK, dyn_model_joint_info(m, dyn_model_joint_id(m, (leg + joint).c_str()), &info));
      start[std::size_t(info.idx_q)] = angle;
    }
  }
  dynStatus operator()(dynBatch* batch) const { return dyn_batch_rollout(batch, n, &x); }
  const double* record(const Numbers& all, int k, int r, std::size_t size) const {
    return all.data() + (std::size_t(k) * records + std::size_t(r)) * size;
  }
};

bool same(const double* a, const double* b, std::size_t n) { return std::memcmp(a, b, n * sizeof(double)) == 0; }

TEST(Rollout, IsWhatStepsAre) {
  const Model m = scene();
  const Batch one(m, 1), three(m, 3);
  const Case alone(m), together(m);
  ASSERT_EQ(DYN_OK, alone(one)) << dyn_last_error();
  ASSERT_EQ(DYN_OK, together(three)) << dyn_last_error();
  EXPECT_TRUE(same_bits(alone.q, together.q) && same_bits(alone.v, together.v) && same_bits(alone.sensors, together.sensors));
  EXPECT_EQ(alone.counts, together.counts);
  EXPECT_EQ(alone.states.size(), together.states.size());
  int touching = 0;
  for (int k = 0; k < Case::n; ++k) {
    const Data d(m);
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, alone.q0.data() + std::size_t(k) * alone.nq,
                                         alone.v0.data() + std::size_t(k) * alone.nv, nullptr, nullptr));
    for (int r = 0; r < Case::records; ++r) {
      ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, nullptr, nullptr, nullptr, alone.record(alone.tau, k, r, alone.nv)));
      for (int i = 0; i < Case::every; ++i)
        ASSERT_EQ(DYN_OK, take_step(m, d, DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3)) << dyn_last_error();
      ASSERT_TRUE(same(field(m, d, "q").data(), alone.record(alone.q, k, r, alone.nq), alone.nq)) << k << " " << r;
      ASSERT_TRUE(same(field(m, d, "v").data(), alone.record(alone.v, k, r, alone.nv), alone.nv)) << k << " " << r;
      int count = 0;
      std::vector<dynContactForce> contacts(Case::capacity);
      ASSERT_EQ(DYN_OK, dyn_data_step_contacts(m, d, contacts.data(), Case::capacity, &count));
      const std::size_t row = std::size_t(k) * Case::records + std::size_t(r);
      ASSERT_EQ(count, alone.counts[row]);
      for (int c = 0; c < count; ++c)
        ASSERT_TRUE(
            same(contacts[std::size_t(c)].force_on_b, alone.contacts[row * Case::capacity + std::size_t(c)].force_on_b, 3));
      touching += count;
    }
  }
  EXPECT_GT(touching, 100);
}

// The scene with all masses and frictions scaled.
Model scaled(const Model& m, double mass, double friction) {
  Builder b;
  dyn_builder_free(b);
  EXPECT_EQ(DYN_OK, dyn_builder_from_model(m, &b.b));
  int changed = 0;
  for (int i = 0; i < dyn_builder_parameter_count(b); ++i) {
    dynParameter p{};
    p.struct_size = sizeof p;
    EXPECT_EQ(DYN_OK, dyn_builder_parameter(b, i, &p));
    const std::string what = std::string(p.object) + " " + p.quantity;
    const double by = what == "link mass" || what == "link inertia" ? mass : what == "shape friction" ? friction : 1;
    Numbers x(p.values, p.values + p.count);
    for (double& number : x) number *= by;
    if (by == 1) continue;
    EXPECT_EQ(DYN_OK, dyn_builder_set_parameter(b, i, x.data(), x.size())) << dyn_last_error();
    ++changed;
  }
  EXPECT_GT(changed, 10);
  return b.finish();
}

TEST(Rollout, OfModelsOfTheirOwn) {
  const Model m = scene();
  std::vector<Model> models;
  std::vector<const dynModel*> given;
  for (int k = 0; k < 4; ++k) models.push_back(scaled(m, 1 + 0.1 * k, 0.5 + 0.2 * k));
  for (int k = 0; k < Case::n; ++k) given.push_back(models[std::size_t(k / 2 % 4)]);
  const Batch one(m, 1), three(m, 3);
  Case alone(m), together(m), rest(m);
  alone.x.models = together.x.models = rest.x.models = given.data();
  for (dynBatch* batch : {one.b, three.b})
    ASSERT_EQ(DYN_OK, dyn_batch_set_effects(batch, 0, DYN_EFFECT_DEFAULT & ~std::uint32_t(DYN_EFFECT_DAMPING)));
  ASSERT_EQ(DYN_OK, alone(one)) << dyn_last_error();
  ASSERT_EQ(DYN_OK, together(three)) << dyn_last_error();
  EXPECT_TRUE(same_bits(alone.q, together.q) && same_bits(alone.v, together.v) && same_bits(alone.sensors, together.sensors));
  rest.x.states = alone.x.final_states, rest.x.q0 = rest.x.v0 = nullptr;
  ASSERT_EQ(DYN_OK, rest(three)) << dyn_last_error();
  for (int k = 0; k < Case::n; ++k) {
    const dynModel* own = given[std::size_t(k)];
    dynData* d = nullptr;
    ASSERT_EQ(DYN_OK, dyn_data_new(own, 0, &d));
    ASSERT_EQ(DYN_OK, dyn_data_set_effects(own, d, 0, DYN_EFFECT_DEFAULT & ~std::uint32_t(DYN_EFFECT_DAMPING)));
    ASSERT_EQ(DYN_OK, dyn_data_set_state(own, d, alone.q0.data() + std::size_t(k) * alone.nq,
                                         alone.v0.data() + std::size_t(k) * alone.nv, nullptr, nullptr));
    for (const Case* c : {&alone, &rest})
      for (int r = 0; r < Case::records; ++r) {
        ASSERT_EQ(DYN_OK, dyn_data_set_state(own, d, nullptr, nullptr, nullptr, c->record(c->tau, k, r, c->nv)));
        for (int i = 0; i < Case::every; ++i)
          ASSERT_EQ(DYN_OK, take_step(own, d, DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3)) << dyn_last_error();
        ASSERT_TRUE(same(field(own, d, "q").data(), c->record(c->q, k, r, c->nq), c->nq)) << k << " " << r;
      }
    dyn_data_free(d);
  }
  const Model other = robot("panda", DYN_BASE_FIXED);
  given[5] = other;
  EXPECT_EQ(DYN_ERROR_MODEL, alone(one));
  EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "models[5]"));
  given[5] = nullptr;
  EXPECT_NE(DYN_OK, alone(one));
}

TEST(Rollout, GoesOnWhereItEnded) {
  const Model m = scene();
  const Batch batch(m, 2);
  Case whole(m), first(m), second(m);
  ASSERT_EQ(DYN_OK, whole(batch)) << dyn_last_error();
  const auto half = [&](Case& c, int from) {
    c.x.steps = Case::steps / 2;
    Numbers tau;
    for (int k = 0; k < Case::n; ++k)
      tau.insert(tau.end(), whole.record(whole.tau, k, from, whole.nv),
                 whole.record(whole.tau, k, from + Case::records / 2, whole.nv));
    c.tau = tau, c.x.tau = c.tau.data();
  };
  half(first, 0), half(second, Case::records / 2);
  ASSERT_EQ(DYN_OK, first(batch)) << dyn_last_error();
  second.x.q0 = second.x.v0 = nullptr, second.x.states = first.states.data();
  ASSERT_EQ(DYN_OK, second(batch)) << dyn_last_error();
  for (int k = 0; k < Case::n; ++k)
    for (int r = 0; r < Case::records / 2; ++r) {
      const double* again = second.q.data() + (std::size_t(k) * (Case::records / 2) + std::size_t(r)) * whole.nq;
      ASSERT_TRUE(same(whole.record(whole.q, k, r + Case::records / 2, whole.nq), again, whole.nq)) << k << " " << r;
    }
}

// Standing: the floor carries the weight, an accelerometer at rest feels minus gravity, placement and velocity are those of the
// frame.
TEST(Rollout, SensorsAreRight) {
  const Model m = scene();
  const Batch batch(m, 2);
  Case c(m);
  ASSERT_EQ(DYN_OK, c(batch)) << dyn_last_error();
  const Data d(m);
  const int foot = c.frame[0];
  for (int k = 0; k < Case::n; ++k)
    for (int r = 0; r < Case::records; ++r) {
      const double* s = c.record(c.sensors, k, r, 33);
      double X[12], v[6], com[3], vcom[3], energy[2], force[3] = {};
      ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, c.record(c.q, k, r, c.nq), c.record(c.v, k, r, c.nv), nullptr));
      ASSERT_EQ(DYN_OK, dyn_frame_placement(m, d, foot, X));
      ASSERT_EQ(DYN_OK, dyn_frame_velocity(m, d, foot, DYN_REFERENCE_LOCAL, v));
      ASSERT_EQ(DYN_OK, dyn_com(m, d, nullptr, nullptr, nullptr, com, vcom, nullptr));
      ASSERT_EQ(DYN_OK, dyn_energy(m, d, nullptr, nullptr, energy, energy + 1));
      const std::size_t row = std::size_t(k) * Case::records + std::size_t(r);
      for (int i = 0; i < c.counts[row]; ++i) {
        const dynContactForce& f = c.contacts[row * Case::capacity + std::size_t(i)];
        for (int side = 0; side < 2; ++side) {
          dynShapeInfo shape{};
          shape.struct_size = sizeof shape;
          ASSERT_EQ(DYN_OK, dyn_model_shape_info(m, side ? f.contact.shape_b : f.contact.shape_a, &shape));
          for (int e = 0; e < 3 && shape.frame == foot; ++e) force[e] += (side ? 1 : -1) * f.force_on_b[e];
        }
      }
      const double x = s[3], y = s[4], z = s[5], w = s[6];
      EXPECT_NEAR(X[1], 2 * (x * y + z * w), 1e-14);
      EXPECT_NEAR(X[8], 1 - 2 * (x * x + y * y), 1e-14);
      for (int e = 0; e < 3; ++e) {
        EXPECT_EQ(X[9 + e], s[e]);
        EXPECT_NEAR(v[e], s[7 + e], 1e-13);
        EXPECT_NEAR(v[3 + e], s[10 + e], 1e-13);
        EXPECT_NEAR(v[3 + e], s[16 + e], 1e-13);
        EXPECT_NEAR(force[e], s[19 + e], 1e-9);
        EXPECT_NEAR(com[e], s[25 + e], 1e-13);
        EXPECT_NEAR(vcom[e], s[28 + e], 1e-13);
      }
      EXPECT_NEAR(energy[0], s[31], 1e-12);
      EXPECT_NEAR(energy[1], s[32], 1e-12);
    }
  // in free fall an accelerometer feels nothing
  const Model alone = robot("go2", DYN_BASE_FLOATING);
  const Batch falling(alone, 1);
  Case f(alone);
  f.x.tau = nullptr, f.x.v0 = nullptr;
  ASSERT_EQ(DYN_OK, f(falling)) << dyn_last_error();
  for (int e = 0; e < 3; ++e) EXPECT_NEAR(0, f.record(f.sensors, 0, 0, 33)[13 + e], 1e-9);
}

TEST(Rollout, OneThatFails) {
  const Model m = scene();
  const Batch batch(m, 3);
  Case good(m), bad(m);
  ASSERT_EQ(DYN_OK, good(batch));
  bad.tau[(5 * Case::records + 4) * bad.nv + 7] = NAN;  // simulation 5, record 4
  EXPECT_EQ(DYN_ERROR_NONFINITE, bad(batch));
  EXPECT_TRUE(says({"dyn_batch_rollout: simulation 5: ", "tau", "1 of 12 simulations"}));
  for (int k = 0; k < Case::n; ++k) {
    EXPECT_EQ(k == 5 ? DYN_ERROR_NONFINITE : DYN_OK, bad.status[std::size_t(k)]);
    for (int r = 0; r < Case::records; ++r) {
      const double* q = bad.record(bad.q, k, r, bad.nq);
      EXPECT_TRUE(k == 5 && r >= 4 ? q[0] == -7 : same(good.record(good.q, k, r, good.nq), q, good.nq)) << k << " " << r;
    }
  }
  ASSERT_EQ(DYN_OK, good(batch));  // and it works on
}

TEST(Rollout, ProgressAndCancelling) {
  const Model m = scene();
  const Batch batch(m, 2);
  Case c(m);
  std::vector<std::int64_t> told;
  c.x.context = &told;
  c.x.progress = [](void* context, std::int64_t made, std::int64_t of) {
    EXPECT_EQ(Case::n * Case::steps, of);
    static_cast<std::vector<std::int64_t>*>(context)->push_back(made);
    return 0;
  };
  ASSERT_EQ(DYN_OK, c(batch)) << dyn_last_error();
  ASSERT_FALSE(told.empty());
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_EQ(Case::n * Case::steps, told.back());
  Case ended(m);
  const Batch alone(m, 1);
  ended.x.progress = [](void*, std::int64_t, std::int64_t) { return 1; };
  EXPECT_EQ(DYN_ERROR_CANCELLED, ended(alone));
  EXPECT_TRUE(says({"cancelled after 60 of 720 steps"}));
  EXPECT_EQ(DYN_OK, ended.status[0]);
  for (int k = 1; k < Case::n; ++k) EXPECT_EQ(DYN_ERROR_CANCELLED, ended.status[std::size_t(k)]);
  EXPECT_EQ(-7, ended.record(ended.q, 1, 0, ended.nq)[0]) << "untouched";
}

TEST(Rollout, Arguments) {
  const Model m = scene();
  const Batch batch(m, 2);
  const auto refused = [&](dynStatus status, const std::vector<std::string>& words, auto&& change) {
    Case c(m);
    change(c);
    EXPECT_EQ(status, c(batch));
    EXPECT_TRUE(says(words)) << dyn_last_error();
    EXPECT_EQ(-7, c.q[0]) << "untouched";
  };
  refused(DYN_ERROR_SIZE, {"struct_size", "dyn_rollout_init"}, [](Case& c) { c.x.struct_size = 8; });
  refused(DYN_ERROR_ARGUMENT, {"steps is 0"}, [](Case& c) { c.x.steps = 0; });
  refused(DYN_ERROR_ARGUMENT, {"every is 7", "divides"}, [](Case& c) { c.x.every = 7; });
  refused(DYN_ERROR_ARGUMENT, {"contact_capacity is -1"}, [](Case& c) { c.x.contact_capacity = -1; });
  refused(DYN_ERROR_ARGUMENT, {"contact_count is NULL"}, [](Case& c) { c.x.contact_count = nullptr; });
  refused(DYN_ERROR_ARGUMENT, {"sensors is -1"}, [](Case& c) { c.x.sensors = -1; });
  refused(DYN_ERROR_ARGUMENT, {"sensor is NULL"}, [](Case& c) { c.x.sensor = nullptr; });
  refused(DYN_ERROR_ARGUMENT, {"sensor_frame is NULL"}, [](Case& c) { c.x.sensor_frame = nullptr; });
  refused(DYN_ERROR_ARGUMENT, {"sensor[2] is 7"}, [](Case& c) { c.sensor[2] = dynSensorType(7); });
  refused(DYN_ERROR_ARGUMENT, {"sensor_frame[1] is -1"}, [](Case& c) { c.frame[1] = -1; });
  refused(DYN_ERROR_ARGUMENT, {"sensor_frame[3]", "no link"},
          [&](Case& c) { c.frame[3] = dyn_model_frame_id(m, "FL_hip_joint"); });
  dynStepOptions options;
  dyn_step_options_init(&options);
  options.dt = -1;
  refused(DYN_ERROR_ARGUMENT, {"dt"}, [&](Case& c) { c.x.stepping = &options; });
  refused(DYN_ERROR_ARGUMENT, {"memory holds no state"}, [](Case& c) { c.x.states = c.states.data(); });
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_batch_rollout(batch, 1, nullptr));
  Case c(m);
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_batch_rollout(batch, -1, &c.x));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_batch_rollout(batch, INT64_MAX, &c.x));
  EXPECT_EQ(DYN_OK, dyn_batch_rollout(batch, 0, &c.x));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_batch_rollout(nullptr, 1, &c.x));
  const Batch without(m, 1, DYN_PART_INVERSE);
  EXPECT_EQ(DYN_ERROR_PART, c(without));
  dyn_rollout_init(nullptr);
  EXPECT_EQ(7, dyn_sensor_size(DYN_SENSOR_TYPE_PLACEMENT));
  for (int s : {-1, 6, 1 << 30}) EXPECT_EQ(0, dyn_sensor_size(dynSensorType(s)));
}

}  // namespace
}  // namespace dyn_test::rollout_test
