// What dyn_builder_finish refuses, and what a finished builder still does.
#include "capi/support.hpp"

namespace dyn_test {
namespace {

// What only the whole can show.
struct Whole {
  const char* name;
  void (*build)(Builder&);
  dynStatus status;
  std::vector<std::string> fragments;
};
const Whole wholes[] = {
    {"mimic circle",
     [](Builder& b) {
       Spec x("x", DYN_JOINT_TYPE_REVOLUTE), y("y", DYN_JOINT_TYPE_REVOLUTE);
       x.mimic = "y", y.mimic = "x";
       b.joint(x).joint(y).body("bx", "x").body("by", "y");
     },
     DYN_ERROR_INVALID,
     {"mimic goes round in a circle", "must move by itself"}},
    {"mimic of nobody",
     [](Builder& b) {
       Spec x("x", DYN_JOINT_TYPE_REVOLUTE);
       x.mimic = "nobody";
       b.joint(x).body("bx", "x");
     },
     DYN_ERROR_NAME,
     {"joint 'x'", "mimics 'nobody'", "no moving joint"}},
    {"mimic of a fixed joint",
     [](Builder& b) {
       Spec x("x", DYN_JOINT_TYPE_REVOLUTE);
       x.mimic = "weld";
       b.joint(Spec("weld", DYN_JOINT_TYPE_FIXED)).joint(x).body("bx", "x");
     },
     DYN_ERROR_NAME,
     {"joint 'x'", "'weld'", "no moving joint"}},
    {"mimic of many coordinates",
     [](Builder& b) {
       Spec x("x", DYN_JOINT_TYPE_REVOLUTE);
       x.mimic = "ball";
       b.joint(Spec("ball", DYN_JOINT_TYPE_SPHERICAL)).joint(x).body("bx", "x").body("bb", "ball");
     },
     DYN_ERROR_INVALID,
     {"joint 'x'", "'ball'", "more than one coordinate"}},
    {"nothing resists",
     [](Builder& b) { b.joint(Spec("x", DYN_JOINT_TYPE_REVOLUTE)).body("bx", "x", 0, {0, 0, 0}, no_inertia); },
     DYN_ERROR_INVALID,
     {"joint 'x'", "nothing resists it", "'bx'", "armature"}},
    {"no body",
     [](Builder& b) { b.joint(Spec("x", DYN_JOINT_TYPE_PRISMATIC)); },
     DYN_ERROR_INVALID,
     {"joint 'x'", "nothing resists it", "no link"}},
    {"negative moment",
     [](Builder& b) {
       static constexpr double odd[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
       b.joint(Spec("x", DYN_JOINT_TYPE_REVOLUTE)).body("bx", "x", 1, {0, 0, 0}, odd);
     },
     DYN_ERROR_INVALID,
     {"joint 'x'", "'bx'", "negative principal moment"}},
    {"configuration of a wrong size",
     [](Builder& b) {
       static constexpr double q[2] = {};
       b.joint(Spec("x", DYN_JOINT_TYPE_REVOLUTE)).body("bx", "x");
       EXPECT_EQ(DYN_OK, dyn_builder_add_configuration(b, "c", q, 2));
     },
     DYN_ERROR_SIZE,
     {"configuration 'c' has 2 numbers", "nq = 1"}},
    {"configuration with a zero quaternion",
     [](Builder& b) {
       static constexpr double q[4] = {};
       b.joint(Spec("ball", DYN_JOINT_TYPE_SPHERICAL)).body("bb", "ball");
       EXPECT_EQ(DYN_OK, dyn_builder_add_configuration(b, "c", q, 4));
     },
     DYN_ERROR_QUATERNION,
     {"configuration 'c'", "joint 'ball' is zero", "norm 1"}},
};
TEST(BuilderFinish, Refusals) {
  for (const Whole& w : wholes) {
    Builder b;
    w.build(b);
    dynModel* m = nullptr;
    EXPECT_EQ(w.status, dyn_builder_finish(b, &m)) << w.name;
    EXPECT_TRUE(says(w.fragments)) << w.name;
    EXPECT_EQ(nullptr, m) << w.name;
  }
}

TEST(BuilderFinish, InfiniteLimitsTheRightWayRound) {
  const double lower[1] = {-inf}, upper[1] = {inf};
  Spec s("x", DYN_JOINT_TYPE_REVOLUTE);
  s.lower = lower, s.upper = upper, s.velocity = upper, s.effort = upper;
  Builder b;
  const Model m = b.joint(s).body("bx", "x").finish();
  EXPECT_EQ(-inf, dyn_model_array(m, DYN_MODEL_ARRAY_LOWER_LIMIT)[0]);
  for (dynModelArray which : {DYN_MODEL_ARRAY_UPPER_LIMIT, DYN_MODEL_ARRAY_VELOCITY_LIMIT, DYN_MODEL_ARRAY_EFFORT_LIMIT})
    EXPECT_EQ(inf, dyn_model_array(m, which)[0]);
}

TEST(BuilderFinish, AgainAndFurther) {
  Builder b;
  b.joint(Spec("x", DYN_JOINT_TYPE_REVOLUTE));
  dynModel* none = nullptr;
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_finish(b, &none));
  b.body("bx", "x");  // remedied
  const Model first = b.finish();
  b.joint(Spec("y", DYN_JOINT_TYPE_REVOLUTE, "x")).body("by", "y");
  const Model second = b.finish(), third = b.finish();
  EXPECT_EQ(1, first.nv());
  EXPECT_EQ(2, second.nv());
  Data d(second);
  EXPECT_EQ(DYN_ERROR_MODEL, dyn_crba(third, d, nullptr, nullptr));  // alike is not the same
}

TEST(BuilderFinish, NothingAtAll) {
  Builder b(nullptr);
  const Model m = b.finish();
  EXPECT_STREQ("", dyn_model_name(m));
  EXPECT_TRUE(m.nq() == 0 && m.nv() == 0 && m.njoints() == 1 && m.nframes() == 1 && dyn_model_nbodies(m) == 0 &&
              dyn_model_total_mass(m) == 0);
  Data d(m);
  compute_all(m, d, State{{0}, {0}, {0}, {0}, Numbers(6, 0.0)});
  double com[3] = {1, 1, 1}, X[12], x[1] = {7};
  EXPECT_EQ(DYN_OK, dyn_com(m, d, nullptr, nullptr, nullptr, com, nullptr, nullptr));
  EXPECT_TRUE(com[0] == 0 && com[1] == 0 && com[2] == 0);
  EXPECT_EQ(DYN_OK, dyn_frame_placement(m, d, 0, X));
  EXPECT_EQ(DYN_OK, dyn_cholesky_solve(m, d, x, 1, x));
  EXPECT_EQ(7, x[0]);
  // arrays of no numbers may be NULL; velocities and accelerations are there all the same
  double V[6] = {7};
  EXPECT_EQ(DYN_OK, dyn_forward_kinematics(m, d, nullptr, nullptr, nullptr));
  EXPECT_EQ(DYN_OK, dyn_frame_acceleration(m, d, 0, DYN_REFERENCE_WORLD, V));
  EXPECT_EQ(0, V[0]);
  double distance = 1;
  for (dynStatus s :
       {dyn_cholesky_solve(m, d, nullptr, 1, nullptr), dyn_configuration_neutral(m, nullptr),
        dyn_configuration_random(m, 1, nullptr, nullptr, nullptr), dyn_integrate(m, nullptr, nullptr, nullptr),
        dyn_difference(m, nullptr, nullptr, nullptr), dyn_interpolate(m, nullptr, nullptr, 0.5, nullptr),
        dyn_configuration_normalize(m, nullptr), dyn_model_configuration(m, "neutral", nullptr),
        dyn_configuration_distance(m, nullptr, nullptr, &distance), dyn_frame_jacobian(m, d, 0, DYN_REFERENCE_WORLD, nullptr)})
    EXPECT_EQ(DYN_OK, s) << dyn_last_error();
  EXPECT_EQ(0, distance);
  EXPECT_EQ(DYN_OK, take_step(m, d, DYN_INTEGRATOR_RK4, 0.1));
  EXPECT_EQ(0.1, field(m, d, "time")[0]);
}

// Figures whose products overflow make no model.
TEST(BuilderFinish, Huge) {
  auto expect = [](Builder& b, const char* what) {
    dynModel* m = nullptr;
    const dynStatus s = dyn_builder_finish(b, &m);
    const Model owner(m);
    if (s != DYN_OK) {
      EXPECT_TRUE(s == DYN_ERROR_INVALID || s == DYN_ERROR_NUMERIC || s == DYN_ERROR_NONFINITE)
          << what << ": " << dyn_last_error();
      return;
    }
    EXPECT_TRUE(std::isfinite(dyn_model_total_mass(owner))) << what;
    for (dynModelArray which : {DYN_MODEL_ARRAY_ARMATURE, DYN_MODEL_ARRAY_DAMPING, DYN_MODEL_ARRAY_FRICTION})
      for (int k = 0; k < owner.nv(); ++k) EXPECT_FALSE(std::isnan(dyn_model_array(owner, which)[k])) << what;
  };
  {
    Builder b;
    Spec s("x", DYN_JOINT_TYPE_REVOLUTE);
    s.rotor_inertia = 1e200, s.gear_ratio = 1e200;
    if (dyn_builder_add_joint(b, &s) == DYN_OK) expect(b.body("bx", "x"), "rotor");
  }
  {
    Builder b;
    b.joint(Spec("x", DYN_JOINT_TYPE_REVOLUTE)).body("b1", "x", 1.5e308).body("b2", "x", 1.5e308);
    dynModel* m = nullptr;
    const dynStatus s = dyn_builder_finish(b, &m);
    dyn_model_free(m);
    EXPECT_TRUE(s == DYN_OK || s == DYN_ERROR_INVALID || s == DYN_ERROR_NUMERIC) << dyn_last_error();
  }
}

}  // namespace
}  // namespace dyn_test
