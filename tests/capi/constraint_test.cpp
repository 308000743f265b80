// Constraints through dyn.h: slots, what is refused and leaves all as it was, huge states, and what a failure leaves behind.
#include <algorithm>
#include <cmath>
#include <limits>

#include "capi/support.hpp"

namespace dyn_test {
namespace {

dynConstraint make(dynConstraintType type, int first = 0, int second = 0) {
  dynConstraint c;
  dyn_constraint_init(&c, type);
  c.first = first, c.second = second;
  return c;
}
dynConstraintResult empty_result() {
  dynConstraintResult r{};
  r.struct_size = sizeof r;
  return r;
}

// A quadruped with its feet on the ground.
struct Standing {
  Model m = robot("go2", DYN_BASE_FLOATING);
  Data d{m};
  State s = random_state(m, 3);
  Standing() {
    int slot = 0;
    for (const char* foot : {"FL_foot", "FR_foot", "RL_foot", "RR_foot"}) {
      const dynConstraint c = make(DYN_CONSTRAINT_TYPE_POINT, dyn_model_frame_id(m, foot));
      EXPECT_EQ(DYN_OK, dyn_data_set_constraint(m, d, slot++, &c)) << dyn_last_error();
    }
  }
  dynStatus solve(Numbers& ddq, Numbers& lambda, dynConstraintResult& r) {
    ddq.assign(std::size_t(m.nv()), 0), lambda.assign(12, 0);
    return dyn_constrained_dynamics(m, d, s.q.data(), s.v.data(), s.tau.data(), nullptr, nullptr,
                                    with<dynConstrainedOutput>({0, ddq.data(), nullptr, lambda.data(), &r}));
  }
};

TEST(Constraint, FeetStayWhereTheyAre) {
  Standing x;
  Numbers ddq, lambda;
  dynConstraintResult r = empty_result();
  ASSERT_EQ(DYN_OK, x.solve(ddq, lambda, r)) << dyn_last_error();
  EXPECT_TRUE(r.reason == DYN_CONSTRAINT_REASON_CONVERGED && r.rows == 12 && r.rank == 12 && r.contradiction == 0 &&
              r.residual < 1e-11);
  Numbers J(12 * std::size_t(x.m.nv())), drift(12);
  ASSERT_EQ(DYN_OK, dyn_constraint_terms(x.m, x.d, nullptr, nullptr, nullptr, J.data(), nullptr, drift.data()));
  for (std::size_t i = 0; i < 12; ++i) {
    double a = drift[i];
    for (std::size_t k = 0; k < ddq.size(); ++k) a += J[i + 12 * k] * ddq[k];
    EXPECT_NEAR(0, a, 1e-10);
  }
  EXPECT_TRUE(finite(lambda));
}

TEST(Constraint, SlotsAreSetSwitchedAndEmptied) {
  Standing x;
  int first = -1, rows = -1;
  ASSERT_EQ(DYN_OK, dyn_data_set_constraint_enabled(x.m, x.d, 1, 0));
  ASSERT_EQ(DYN_OK, dyn_data_constraint_rows(x.m, x.d, 2, &first, &rows));
  EXPECT_TRUE(first == 3 && rows == 3);
  ASSERT_EQ(DYN_OK, dyn_data_set_constraint(x.m, x.d, 0, nullptr));
  ASSERT_EQ(DYN_OK, dyn_data_constraint_rows(x.m, x.d, -1, &first, &rows));
  EXPECT_TRUE(first == 0 && rows == 6);
  dynConstraint c = make(DYN_CONSTRAINT_TYPE_NONE);
  ASSERT_EQ(DYN_OK, dyn_data_constraint(x.m, x.d, 1, &c));
  EXPECT_TRUE(c.type == DYN_CONSTRAINT_TYPE_POINT && c.enabled == 0 && c.first == dyn_model_frame_id(x.m, "FR_foot"));
  EXPECT_EQ(8, dyn_model_nconstraint_slots(x.m));
  EXPECT_EQ(0, dyn_model_nconstraints(x.m));
  EXPECT_EQ(nullptr, dyn_model_constraint_name(x.m, 0));
  EXPECT_EQ(-1, dyn_model_constraint_id(x.m, "knee"));
  EXPECT_TRUE(says({"no constraint 'knee'"}));
}

// A slider of 2 kg within [0.5, 1.25] m, without gravity, and a free body, whose weld has six rows. The first row is the
// slider's.
struct Slider {
  Model m = build();
  Data d{m};
  double lambda = 0;
  static Model build() {
    Builder b("slider");
    const double none[3] = {}, lower = 0.5, upper = 1.25;
    EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
    Spec slide("slide", DYN_JOINT_TYPE_PRISMATIC);
    slide.about(1, 0, 0), slide.lower = &lower, slide.upper = &upper;
    b.joint(slide).body("sled", "slide", 2).joint(Spec("free", DYN_JOINT_TYPE_FREE_FLYER)).body("stone", "free");
    return b.finish();
  }
  explicit Slider(dynConstraintType type, double force = 0) {
    dynConstraint c = make(type, dyn_model_joint_id(m, "slide"));
    c.force = force;
    EXPECT_EQ(DYN_OK, dyn_data_set_constraint(m, d, 0, &c)) << dyn_last_error();
    c = make(DYN_CONSTRAINT_TYPE_WELD, dyn_model_frame_id(m, "stone"));
    EXPECT_EQ(DYN_OK, dyn_data_set_constraint(m, d, 1, &c)) << dyn_last_error();
  }
  static Numbers at(double x) { return {x, 0, 0, 0, 0, 0, 0, 1}; }
  // Its acceleration where a force pushes it. lambda: of its row.
  double accelerate(double x, double push) {
    const Numbers q = at(x), v(7), tau = {push, 0, 0, 0, 0, 0, 0};
    Numbers ddq(7), all(7);
    EXPECT_EQ(DYN_OK, dyn_constrained_dynamics(m, d, q.data(), v.data(), tau.data(), nullptr, nullptr,
                                               with<dynConstrainedOutput>({0, ddq.data(), nullptr, all.data(), nullptr})))
        << dyn_last_error();
    lambda = all[0];
    return ddq[0];
  }
};

// At a limit, a push outwards is taken by lambda, >= 0 at the lower limit and <= 0 at the upper one; a push inwards is not.
TEST(Constraint, LimitsHoldOneSide) {
  Slider x(DYN_CONSTRAINT_TYPE_LIMIT);
  for (const double at : {0.5, 1.25})
    for (const double push : {-3.0, 3.0}) {
      const bool outwards = (at == 1.25) == (push > 0);
      EXPECT_NEAR(outwards ? 0 : push / 2, x.accelerate(at, push), 1e-12) << at;
      EXPECT_NEAR(outwards ? -push : 0, x.lambda, 1e-12) << at;
    }
  for (const double push : {-3.0, 3.0}) EXPECT_NEAR(push / 2, x.accelerate(0.8, push), 1e-12);
}

// C = q - limit beyond a limit, and 0 between them.
TEST(Constraint, LimitsMeasureHowFarTheyArePassed) {
  Slider x(DYN_CONSTRAINT_TYPE_LIMIT);
  for (const auto& [at, expected] : {std::pair{0.4, -0.1}, {0.5, 0.0}, {0.8, 0.0}, {1.25, 0.0}, {1.35, 0.1}}) {
    const Numbers q = Slider::at(at), v(7);
    Numbers error(7);
    ASSERT_EQ(DYN_OK, dyn_constraint_terms(x.m, x.d, q.data(), v.data(), error.data(), nullptr, nullptr, nullptr));
    EXPECT_NEAR(expected, error[0], 1e-15) << at;
  }
}

// Dry friction of 3 N takes a push up to 3 N to either side, and 3 N of a larger one.
TEST(Constraint, DryFrictionHasTwoBounds) {
  Slider x(DYN_CONSTRAINT_TYPE_FRICTION, 3);
  for (const double push : {-5.0, -2.0, 0.0, 2.0, 5.0}) {
    const double taken = std::clamp(push, -3.0, 3.0);
    EXPECT_NEAR((push - taken) / 2, x.accelerate(0.8, push), 1e-12) << push;
    EXPECT_NEAR(-taken, x.lambda, 1e-12) << push;
  }
}

TEST(Constraint, Refusals) {
  Standing x;
  Numbers ddq, lambda;
  dynConstraintResult r = empty_result();
  ASSERT_EQ(DYN_OK, x.solve(ddq, lambda, r));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const int foot = dyn_model_frame_id(x.m, "FL_foot"), hip = dyn_model_joint_id(x.m, "FL_hip_joint");
  auto refuse = [&](dynConstraint c, dynStatus status, std::initializer_list<std::string> words) {
    const Snapshot before(x.m, x.d);
    EXPECT_EQ(status, dyn_data_set_constraint(x.m, x.d, 5, &c)) << *words.begin();
    for (const std::string& w : words) EXPECT_NE(nullptr, std::strstr(dyn_last_error(), w.c_str())) << dyn_last_error();
    EXPECT_EQ("", before.differs(Snapshot(x.m, x.d)));
  };
  auto with = [&](dynConstraint c, auto change) { return change(c), c; };
  const dynConstraint point = make(DYN_CONSTRAINT_TYPE_POINT, foot);
  refuse(make(dynConstraintType(77), foot), DYN_ERROR_ARGUMENT, {"slot 5", "type 77 does not exist"});
  refuse(make(DYN_CONSTRAINT_TYPE_POINT, 1000), DYN_ERROR_ARGUMENT, {"frame 1000"});
  refuse(make(DYN_CONSTRAINT_TYPE_POINT, foot, foot), DYN_ERROR_INVALID, {"same body", "FL_foot"});
  refuse(make(DYN_CONSTRAINT_TYPE_POINT, 0, 0), DYN_ERROR_INVALID, {"same body"});
  refuse(with(point, [](auto& c) { c.struct_size = 8; }), DYN_ERROR_SIZE, {"struct_size is 8", "dyn_constraint_init"});
  refuse(with(point, [](auto& c) { c.stiffness = -1; }), DYN_ERROR_ARGUMENT, {"stiffness is -1"});
  refuse(with(point, [](auto& c) { c.restitution = 1.5; }), DYN_ERROR_ARGUMENT, {"restitution is 1.5"});
  refuse(with(point, [&](auto& c) { c.damping = nan; }), DYN_ERROR_NONFINITE, {"damping"});
  refuse(with(point, [&](auto& c) { c.placement1[3] = 2; }), DYN_ERROR_ARGUMENT, {"placement1 has no rotation"});
  refuse(with(make(DYN_CONSTRAINT_TYPE_LOOP, foot), [](auto& c) { c.joint_type = DYN_JOINT_TYPE_FIXED; }), DYN_ERROR_ARGUMENT,
         {"WELD"});
  refuse(with(make(DYN_CONSTRAINT_TYPE_LOOP, foot), [](auto& c) { c.axis[2] = 0; }), DYN_ERROR_INVALID, {"axis is zero"});
  refuse(with(make(DYN_CONSTRAINT_TYPE_DISTANCE, foot), [](auto& c) { c.length = 0; }), DYN_ERROR_ARGUMENT, {"length is 0"});
  refuse(with(make(DYN_CONSTRAINT_TYPE_FRICTION, hip), [](auto& c) { c.force = -1; }), DYN_ERROR_ARGUMENT, {"force is -1"});
  refuse(make(DYN_CONSTRAINT_TYPE_COUPLING, hip, hip), DYN_ERROR_INVALID, {"coupled with itself"});
  refuse(make(DYN_CONSTRAINT_TYPE_LIMIT, 1), DYN_ERROR_INVALID, {"choose a joint with one"});
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_constraint_enabled(x.m, x.d, 8, 1));
  EXPECT_TRUE(says({"slot 8", "0 to 7"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_anchor_constraint(x.m, x.d, 7, nullptr));
  {  // nor is q taken
    const Snapshot before(x.m, x.d);
    Numbers other = x.s.q;
    other[7] += 0.1;
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_anchor_constraint(x.m, x.d, 7, other.data()));
    EXPECT_EQ("", before.differs(Snapshot(x.m, x.d)));
    dynConstraint one = make(DYN_CONSTRAINT_TYPE_DISTANCE, foot, 0);  // of a point of the world and the foot's own
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(x.m, x.d, other.data(), nullptr, nullptr));
    ASSERT_EQ(DYN_OK, dyn_frame_placement(x.m, x.d, foot, one.placement2));
    one.length = 1;
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(x.m, x.d, x.s.q.data(), nullptr, nullptr));
    ASSERT_EQ(DYN_OK, dyn_data_set_constraint(x.m, x.d, 7, &one)) << dyn_last_error();
    dynArray q{};
    q.struct_size = sizeof q;
    ASSERT_EQ(DYN_OK, dyn_data_array(x.m, x.d, dyn_field_id("q"), &q));
    const Numbers held(q.data, q.data + x.s.q.size());
    EXPECT_EQ(DYN_ERROR_INVALID, dyn_data_anchor_constraint(x.m, x.d, 7, other.data()));
    EXPECT_TRUE(says({"slot 7", "the two points are one"}));
    EXPECT_EQ(held, Numbers(q.data, q.data + held.size()));
  }
  dynConstraintOptions o;
  dyn_constraint_options_init(&o);
  o.regularisation = nan;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_constrained_dynamics(x.m, x.d, nullptr, nullptr, nullptr, nullptr, &o, nullptr));
  dynProjectOptions p;
  dyn_project_options_init(&p);
  p.tolerance = 0;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_project(x.m, x.d, nullptr, nullptr, &p, nullptr, nullptr, nullptr));
}

// Finite or refused, and the state as it was.
TEST(Constraint, HugeStates) {
  for (double size : {1e20, 1e80, 1e140, 1e200, 1e300}) {
    Standing x;
    const State before = x.s;
    ASSERT_EQ(DYN_OK, dyn_data_set_state(x.m, x.d, before.q.data(), before.v.data(), before.a.data(), before.tau.data()));
    for (double& v : x.s.v) v *= size;
    Numbers ddq, lambda;
    dynConstraintResult r = empty_result();
    const dynStatus status = x.solve(ddq, lambda, r);
    EXPECT_TRUE(status == DYN_OK || status == DYN_ERROR_NUMERIC) << dyn_last_error();
    EXPECT_TRUE(finite(ddq) && finite(lambda));
    EXPECT_TRUE(same_bits(status == DYN_OK ? x.s.v : before.v, field(x.m, x.d, "v")));
  }
}

TEST(Constraint, MoreThanThereIsRoomFor) {
  dynLoadOptions o;
  dyn_load_options_init(&o);
  o.base = DYN_BASE_FLOATING;
  o.constraint_slots = 0;
  dynModel* m = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_load(DYN_MODELS_DIR "/robots/go2.urdf", &o, &m)) << dyn_last_error();
  EXPECT_EQ(0, dyn_model_nconstraint_slots(m));
  dynData* d = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(m, 0, &d));
  const dynConstraint c = make(DYN_CONSTRAINT_TYPE_POINT, 5);
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_constraint(m, d, 0, &c));
  EXPECT_EQ(DYN_OK, dyn_constrained_dynamics(m, d, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr));
  dyn_data_free(d), dyn_model_free(m);
  o.constraint_slots = -1;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_load(DYN_MODELS_DIR "/robots/go2.urdf", &o, &m));
  EXPECT_TRUE(says({"constraint_slots is -1"}));
}

}  // namespace
}  // namespace dyn_test
