// Common mistakes with handles: shared models and data, first calls, and singular models.
#include "traps/traps.hpp"

namespace dyn_test {
namespace {

TEST(Traps, DataOfAnotherModelIsRefused) {
  Builder b;
  b.joint(Spec("j", DYN_JOINT_TYPE_REVOLUTE)).body("l", "j");
  const Model before = b.finish();
  Data d(before);
  ASSERT_EQ(DYN_OK, dyn_builder_add_frame(b, "tool", "l", nullptr, DYN_FRAME_TYPE_OP_FRAME));
  const Model after = b.finish();
  const int tool = dyn_model_frame_id(after, "tool");
  ASSERT_EQ(DYN_OK, dyn_forward_kinematics(before, d, nullptr, nullptr, nullptr));
  double X[12];
  EXPECT_EQ(DYN_ERROR_MODEL, dyn_frame_placement(after, d, tool, X));
  EXPECT_TRUE(says({"another model", "make data from the model you pass"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_frame_placement(before, d, tool, X));
}

TEST(Traps, ModelsNeverChange) {
  Builder b;
  b.joint(Spec("j", DYN_JOINT_TYPE_REVOLUTE)).body("l", "j");
  const Model m = b.finish();
  Data d(m);
  const State s = random_state(m, 8);
  compute_all(m, d, s);
  const Snapshot before(m, d);
  const double gravity[3] = {0, 0, 0};
  ASSERT_EQ(DYN_OK, dyn_builder_set_gravity(b, gravity));
  b.joint(Spec("k", DYN_JOINT_TYPE_REVOLUTE, "j")).body("heavy", "k", 100);
  b.finish();
  EXPECT_TRUE(m.nv() == 1 && m.njoints() == 2 && dyn_model_total_mass(m) == 1);
  Data again(m);
  compute_all(m, again, s);
  EXPECT_EQ("", before.differs(Snapshot(m, again)));
}

// A singular problem is an error that names the joint. No function returns NaN.
TEST(Traps, SingularModelsGiveErrorsInsteadOfNan) {
  for (const bool mimic : {false, true}) {
    const Model m = singular_at_zero(mimic);
    Data d(m);
    Numbers out(9, 0.5);
    for (const char* name : {"dyn_aba", "dyn_minv"}) {
      Prepared p(call_row(name), m, State{Numbers(3, 0.0), Numbers(3, 0.0), Numbers(3, 0.0), Numbers(3, 1.0), Numbers(30, 0.0)});
      EXPECT_EQ(DYN_ERROR_NUMERIC, p(m, d)) << name;
      EXPECT_TRUE(says({"singular", "'shoulder'", "armature"}));
      EXPECT_TRUE(p.untouched()) << name;
    }
    // approach the singularity: results are finite or refused
    for (double q = 1; q > 1e-320; q /= 8) {
      const Numbers bent = {0, q, 0}, tau(3, 1.0);
      const dynStatus s = dyn_aba(m, d, bent.data(), nullptr, tau.data(), nullptr, out.data());
      EXPECT_TRUE(s == DYN_OK || s == DYN_ERROR_NUMERIC);
      EXPECT_TRUE(finite(out));
    }
  }
}

// Data are independent of each other. tests/rt covers two threads at once.
TEST(Traps, DataAreIndependent) {
  const Model m = all_types();
  Data d(m), e(m);
  const State s = random_state(m, 16), t = random_state(m, 17);
  compute_all(m, d, s);
  const Snapshot before(m, d);
  compute_all(m, e, t);
  ASSERT_EQ(DYN_OK, take_step(m, e, DYN_INTEGRATOR_RK4, 1e-3));
  EXPECT_EQ("", before.differs(Snapshot(m, d)));
}

// The first call gives the same results as later ones. tests/rt checks that it does not allocate.
TEST(Traps, FirstCallGivesTheResultOfLaterCalls) {
  for (const Model& m : models()) {
    const State s = random_state(m, 18);
    for (const CallRow& row : call_rows) {
      if (row.needs != Needs::nothing || std::string(row.name) == "dyn_step" || std::string(row.name) == "dyn_data_array")
        continue;
      Data d(m);
      Prepared first(row, m, s), second(row, m, s);
      ASSERT_EQ(DYN_OK, first(m, d)) << row.name;
      ASSERT_EQ(DYN_OK, second(m, d)) << row.name;
      for (int k = 0; k < row.outputs; ++k) EXPECT_TRUE(same_bits(first.out[k], second.out[k])) << row.name;
    }
  }
}

}  // namespace
}  // namespace dyn_test
