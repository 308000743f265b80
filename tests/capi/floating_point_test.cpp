// Whatever a caller has set its processor to, calls compute with the default settings, and leave the caller's as they were.
#include "capi/batch.hpp"

#if defined(__SSE2__)
#include <xmmintrin.h>

namespace dyn_test::floating_point_test {
namespace {

// Rounds upward, flushes subnormal numbers, and traps divisions by zero, overflows and invalid operations.
constexpr unsigned hostile = 0xd940, raised = 0x3f;

template <class F>
auto in_hostile_settings(F&& f) {
  const unsigned before = _mm_getcsr();
  _mm_setcsr(hostile);
  const auto result = f();
  const unsigned after = _mm_getcsr() & ~raised;
  _mm_setcsr(before);
  EXPECT_EQ(hostile, after);
  return result;
}

TEST(FloatingPoint, OfTheCallerChangesNoCall) {
  for (const Model& m : {all_types(), robot("panda"), robot("go2", DYN_BASE_FLOATING)}) {
    const State before = random_state(m, 1), s = random_state(m, 2);
    for (const CallRow& row : call_rows) {
      SCOPED_TRACE(row.name);
      Data d(m), e(m);
      compute_all(m, d, before), compute_all(m, e, before);
      Prepared usual(row, m, s), other(row, m, s);
      const dynStatus status = usual(m, d);
      EXPECT_EQ(status, in_hostile_settings([&] { return other(m, e); }));
      EXPECT_EQ(usual.results(), other.results());
      EXPECT_EQ("", Snapshot(m, d).differs(Snapshot(m, e)));
    }
  }
}

TEST(FloatingPoint, OfTheCallerChangesNoBatch) {
  const Model m = robot("go2", DYN_BASE_FLOATING);
  Batch usual(m, 2);
  dynBatch* made = nullptr;  // by a thread whose settings its own threads begin with
  ASSERT_EQ(DYN_OK, in_hostile_settings([&] { return dyn_batch_new(m, 0, 2, &made); }));
  for (int k = 0; k < batch_algorithms; ++k) {
    BatchCase a(m, k, 19), b(m, k, 19);
    SCOPED_TRACE(a.info.name);
    EXPECT_EQ(DYN_OK, dyn_batch_run(usual, a.algorithm, a.n, &a.x)) << dyn_last_error();
    EXPECT_EQ(DYN_OK, in_hostile_settings([&] { return dyn_batch_run(made, b.algorithm, b.n, &b.x); })) << dyn_last_error();
    for (int i = 0; i < 4; ++i) EXPECT_EQ(a.out[i], b.out[i]);
  }
  dyn_batch_free(made);
}

// A box and a ball of hulls fall onto a plane, from reading the file on.
TEST(FloatingPoint, OfTheCallerChangesNoSimulation) {
  const char* const text = R"(<mujoco><option timestep="0.002"/><worldbody><geom type="plane" size="5 5 1"/>
      <body pos="0 0 0.3" euler="20 30 0"><freejoint/><geom type="box" size=".1 .2 .05" mass="1"/></body>
      <body pos="0.1 0 0.8"><freejoint/><geom type="ellipsoid" size=".1 .08 .06" mass="1e-3"/></body>
      <body pos="0.5 0 0.8"><joint type="hinge" axis="0 1 0" range="-20 30" damping="0.01" frictionloss="0.02" stiffness="2"/>
        <geom type="capsule" fromto="0 0 0 0.3 0 0" size=".02" mass="0.4"/></body></worldbody></mujoco>)";
  const auto run = [&] {
    dynLoadOptions options;
    dyn_load_options_init(&options);
    dynModel* m = nullptr;
    EXPECT_EQ(DYN_OK, dyn_model_load_string(text, &options, &m)) << dyn_last_error();
    const Model owner(m);
    Data d(m);
    Numbers states;
    for (int k = 0; k < 300; ++k) {
      EXPECT_EQ(DYN_OK, dyn_step(m, d)) << dyn_last_error();
      const Numbers q = field(m, d, "q");
      states.insert(states.end(), q.begin(), q.end());
    }
    return states;
  };
  const Numbers usual = run();
  EXPECT_EQ(usual, in_hostile_settings(run));
}

TEST(FloatingPoint, OfTheCallerChangesNoGeometry) {
  dynGeometry box, ball;
  dyn_geometry_init(&box), dyn_geometry_init(&ball);
  box.type = DYN_SHAPE_TYPE_BOX, box.size[0] = 1, box.size[1] = 0.3, box.size[2] = 0.2;
  ball.type = DYN_SHAPE_TYPE_ELLIPSOID, ball.size[0] = 0.3, ball.size[1] = 0.2, ball.size[2] = 0.1;
  const double at_origin[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  for (const double height : {0.05, 0.19, 0.6}) {
    const double twist[6] = {0, 0, height, 0.3, -0.2, 0.1};
    double X[12];
    ASSERT_EQ(DYN_OK, dyn_se3_exp(1, twist, X));
    const auto run = [&] {
      Numbers out(12 + 36);
      EXPECT_EQ(DYN_OK, dyn_se3_exp(1, twist, out.data()));
      EXPECT_EQ(DYN_OK, dyn_se3_adjoint(1, X, out.data() + 12));
      dynDistance d{};
      d.struct_size = sizeof d;
      EXPECT_EQ(DYN_OK, dyn_geometry_distance(&box, at_origin, &ball, X, nullptr, &d)) << dyn_last_error();
      out.insert(out.end(), {d.distance, d.normal[0], d.normal[1], d.normal[2]});
      dynContact contacts[DYN_MAX_CONTACTS_PER_PAIR];
      int count = 0;
      dynGeometryPair pair;
      dyn_geometry_pair_init(&pair);
      pair.a = &box, pair.b = &ball, pair.placement_a = at_origin, pair.placement_b = X;
      EXPECT_EQ(DYN_OK, dyn_geometry_contacts(&pair, 0.5, 0, contacts, &count)) << dyn_last_error();
      for (int k = 0; k < count; ++k) out.push_back(contacts[k].distance);
      return out;
    };
    EXPECT_EQ(run(), in_hostile_settings(run));
  }
}

}  // namespace
}  // namespace dyn_test::floating_point_test
#endif
