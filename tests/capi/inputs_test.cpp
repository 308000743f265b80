// Tests what every call refuses: NaN, infinity, zero quaternions, ids, enumerations, missing outputs, absent parts, stale
// results; what it says then; and that the data and the outputs are bit-equal to before.
#include "capi/calls.hpp"

namespace dyn_test {
namespace {

struct Input {
  unsigned use;
  const char* name;
  Numbers& (*numbers)(Prepared&);
  const double*& (*pointer)(Prepared&);
};
const Input inputs[] = {
    {uses_q, "q", [](Prepared& p) -> Numbers& { return p.s.q; }, [](Prepared& p) -> const double*& { return p.x.q; }},
    {uses_v, "v", [](Prepared& p) -> Numbers& { return p.s.v; }, [](Prepared& p) -> const double*& { return p.x.v; }},
    {uses_a, "a", [](Prepared& p) -> Numbers& { return p.s.a; }, [](Prepared& p) -> const double*& { return p.x.a; }},
    {uses_tau, "tau", [](Prepared& p) -> Numbers& { return p.s.tau; }, [](Prepared& p) -> const double*& { return p.x.tau; }},
    {uses_fext, "fext", [](Prepared& p) -> Numbers& { return p.s.fext; }, [](Prepared& p) -> const double*& { return p.x.fext; }},
    {uses_b, "b", [](Prepared& p) -> Numbers& { return p.b; }, [](Prepared& p) -> const double*& { return p.x.b; }},
    {uses_lambda, "lambda", [](Prepared& p) -> Numbers& { return p.b; },
     [](Prepared& p) -> const double*& { return p.x.lambda; }},
};

// A data with everything computed for one state; calls come with another.
class Refused : public ::testing::Test {
 protected:
  Model m = all_types();
  Data d{m};
  State held = random_state(m, 3), other = random_state(m, 4);

  void SetUp() override { compute_all(m, d, held); }
  void expect(Prepared& p, dynStatus status, const std::vector<std::string>& fragments) {
    const Snapshot before(m, d);
    EXPECT_EQ(status, p(m, d)) << p.row.name;
    EXPECT_TRUE(says(fragments)) << p.row.name;
    EXPECT_TRUE(p.untouched()) << p.row.name;
    EXPECT_EQ("", before.differs(Snapshot(m, d))) << p.row.name << " " << dyn_status_name(status);
  }
};

TEST_F(Refused, NotFinite) {
  int cases = 0;
  for (const CallRow& row : call_rows)
    for (const Input& in : inputs) {
      if (!(row.uses & in.use)) continue;
      const std::size_t n = in.numbers(*std::make_unique<Prepared>(row, m, other)).size();
      const std::size_t first = in.use == uses_fext ? 6 : 0;  // the universe's column does not count
      for (std::size_t at : {first, n / 2, n - 1})
        for (double bad : {nan, inf, -inf}) {
          Prepared p(row, m, other);
          in.numbers(p)[at] = bad;
          expect(p, DYN_ERROR_NONFINITE,
                 {row.name, std::string(in.name) + "[" + std::to_string(at) + "]", std::isnan(bad) ? "NaN" : "infinite",
                  "finite number"});
          ++cases;
        }
    }
  EXPECT_GT(cases, 300);
}

// Column 0 of fext is ignored, whatever it holds.
TEST_F(Refused, NotTheUniversesForce) {
  for (const char* name : {"dyn_rnea", "dyn_static_torque", "dyn_aba"}) {
    Prepared clean(call_row(name), m, other), p(call_row(name), m, other);
    std::fill(p.s.fext.begin(), p.s.fext.begin() + 6, nan);
    ASSERT_EQ(DYN_OK, clean(m, d)) << name << dyn_last_error();
    EXPECT_EQ(DYN_OK, p(m, d)) << name << dyn_last_error();
    EXPECT_TRUE(same_bits(clean.out[0], p.out[0])) << name;
  }
}

TEST_F(Refused, ZeroQuaternion) {
  // joint, first index in q, numbers
  for (const auto& [joint, offset, n] :
       {std::tuple("free", 3, 4), std::tuple("ball", 0, 4), std::tuple("compound", 1, 4), std::tuple("dial", 0, 2)}) {
    dynJointInfo info{};
    info.struct_size = sizeof info;
    ASSERT_EQ(DYN_OK, dyn_model_joint_info(m, dyn_model_joint_id(m, joint), &info));
    for (const CallRow& row : call_rows) {
      if (!(row.uses & uses_q)) continue;
      for (double zero : {0.0, -0.0}) {
        Prepared p(row, m, other);
        std::fill_n(p.s.q.begin() + info.idx_q + offset, n, zero);
        expect(p, DYN_ERROR_QUATERNION,
               {row.name, joint, n == 4 ? "quaternion" : "(cos, sin)", "zero", "norm 1", "dyn_configuration_neutral"});
      }
    }
  }
}

TEST_F(Refused, Ids) {
  for (const CallRow& row : call_rows)
    for (const int bad : {-1, 1000, std::numeric_limits<int>::max(), std::numeric_limits<int>::min(), m.nframes(), m.njoints()}) {
      if (row.uses & uses_frame && (bad < 0 || bad >= m.nframes())) {
        Prepared p(row, m, other);
        p.x.frame = bad;
        expect(p, DYN_ERROR_ARGUMENT,
               {row.name, "frame " + std::to_string(bad), "0 to " + std::to_string(m.nframes() - 1), "dyn_model_frame_id"});
      }
      if (row.uses & uses_joint && (bad < 0 || bad >= m.njoints())) {
        Prepared p(row, m, other);
        p.x.joint = bad;
        expect(p, DYN_ERROR_ARGUMENT,
               {row.name, "joint " + std::to_string(bad), "0 to " + std::to_string(m.njoints() - 1), "dyn_model_joint_id"});
      }
    }
}

TEST_F(Refused, References) {
  for (const CallRow& row : call_rows)
    if (row.uses & uses_reference)
      for (int bad : {-1, 3, 1000}) {
        Prepared p(row, m, other);
        std::memcpy(&p.x.reference, &bad, sizeof bad);
        expect(p, DYN_ERROR_ARGUMENT,
               {row.name, "reference is " + std::to_string(bad), "DYN_REFERENCE_LOCAL, _WORLD, _LOCAL_WORLD_ALIGNED"});
      }
}

TEST_F(Refused, OutputsThatAreNeeded) {
  for (const CallRow& row : call_rows)
    if (row.out_required) {
      Prepared p(row, m, other);
      p.x.out[0] = nullptr;
      expect(p, DYN_ERROR_ARGUMENT, {row.name, "is NULL", "required"});
    }
  Prepared p(call_row("dyn_data_array"), m, other);
  p.x.array = nullptr;
  expect(p, DYN_ERROR_ARGUMENT, {"dyn_data_array", "out is NULL"});
}

TEST_F(Refused, WhatIsPeculiarToOneCall) {
  const Snapshot before(m, d);
  for (int nrhs : {-1, std::numeric_limits<int>::min()}) {
    Prepared p(call_row("dyn_cholesky_solve"), m, other);
    p.x.nrhs = nrhs;
    expect(p, DYN_ERROR_ARGUMENT, {"dyn_cholesky_solve", "nrhs", "negative"});
  }
  {
    Prepared p(call_row("dyn_cholesky_solve"), m, other);
    p.x.b = nullptr;
    expect(p, DYN_ERROR_ARGUMENT, {"dyn_cholesky_solve", "b is NULL"});
  }
  {
    Prepared p(call_row("dyn_rnea_second_order_product"), m, other);
    p.x.lambda = nullptr;
    expect(p, DYN_ERROR_ARGUMENT, {"dyn_rnea_second_order_product", "lambda is NULL"});
  }
  for (double dt : {0.0, -1e-3, -0.0}) {
    Prepared p(call_row("dyn_step"), m, other);
    p.x.dt = dt;
    expect(p, DYN_ERROR_ARGUMENT, {"step_options", "dt", "positive"});
  }
  for (double dt : {nan, inf, -inf}) {
    Prepared p(call_row("dyn_step"), m, other);
    p.x.dt = dt;
    expect(p, DYN_ERROR_NONFINITE, {"step_options", "dt"});
  }
  for (int bad : {-1, 6, 77}) {
    Prepared p(call_row("dyn_step"), m, other);
    std::memcpy(&p.x.integrator, &bad, sizeof bad);
    expect(p, DYN_ERROR_ARGUMENT, {"step_options", "integrator is " + std::to_string(bad), "_RK4"});
  }
  for (std::uint32_t mask : {0x2000u, 0x80000000u, 0xffffffffu}) {
    Prepared p(call_row("dyn_all_terms"), m, other);
    p.x.mask = mask;
    expect(p, DYN_ERROR_ARGUMENT, {"dyn_all_terms", "unknown bits", "DYN_TERM_"});
  }
  for (dynField f : {-1, dyn_field_count(), 1 << 30}) {
    Prepared p(call_row("dyn_data_array"), m, other);
    p.x.field = f;
    expect(p, DYN_ERROR_ARGUMENT, {"dyn_data_array", "field " + std::to_string(f)});
  }
  for (std::uint32_t size : {0u, 1u, std::uint32_t(sizeof(dynArray)) - 1}) {
    dynArray a{};
    a.struct_size = size;
    EXPECT_EQ(DYN_ERROR_SIZE, dyn_data_array(m, d, 0, &a));
    EXPECT_TRUE(says({"dyn_data_array", "struct_size", "sizeof(dynArray)"}));
    EXPECT_TRUE(a.struct_size == size && !a.data && a.rows == 0);
  }
  EXPECT_EQ("", before.differs(Snapshot(m, d)));
}

// Each call with a data that lacks its part.
TEST(Parts, Absent) {
  for (const bool mimic : {true, false}) {
    const Model m = all_types(mimic);
    const State s = random_state(m, 5), other = random_state(m, 6);
    static const char* const names[] = {"KINEMATICS",
                                        "JACOBIANS",
                                        "COM",
                                        "INVERSE",
                                        "FORWARD",
                                        "MASS",
                                        "CHOLESKY",
                                        "MINV",
                                        "CORIOLIS",
                                        "ENERGY",
                                        "FRAMES",
                                        "CENTROIDAL",
                                        "INVERSE_DERIVATIVES",
                                        "FORWARD_DERIVATIVES",
                                        "REGRESSOR",
                                        "IK",
                                        "SECOND_ORDER",
                                        "COLLISION",
                                        "CONSTRAINTS",
                                        "CONSTRAINT_DERIVATIVES",
                                        "SIMULATION",
                                        "STEP_DERIVATIVES"};
    int refused = 0;
    for (const CallRow& row : call_rows)
      for (unsigned bit = 0; bit < std::size(names); ++bit) {
        Data d(m, 1u << bit);
        ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, s.q.data(), s.v.data(), s.a.data(), s.tau.data()));
        // a part brings what it includes
        dynParts has = 1u << bit;
        if (has & DYN_PART_STEP_DERIVATIVES) has |= DYN_PART_SIMULATION | DYN_PART_MINV | DYN_PART_INVERSE_DERIVATIVES;
        if (has & DYN_PART_SIMULATION)
          has |= DYN_PART_FORWARD | DYN_PART_CONSTRAINTS | (dyn_model_npairs(m) > 0 ? DYN_PART_COLLISION : 0);
        if (has & DYN_PART_CONSTRAINT_DERIVATIVES) has |= DYN_PART_CONSTRAINTS | DYN_PART_FORWARD_DERIVATIVES;
        if (has & DYN_PART_CONSTRAINTS) has |= DYN_PART_FORWARD | DYN_PART_INVERSE | DYN_PART_KINEMATICS;
        if (mimic && has & (DYN_PART_CONSTRAINTS | DYN_PART_SIMULATION)) has |= DYN_PART_CHOLESKY;
        if (has & DYN_PART_FORWARD_DERIVATIVES) has |= DYN_PART_MINV | DYN_PART_INVERSE_DERIVATIVES | DYN_PART_FORWARD;
        if (has & DYN_PART_SECOND_ORDER) has |= DYN_PART_INVERSE_DERIVATIVES;
        if (has & DYN_PART_INVERSE_DERIVATIVES) has |= DYN_PART_INVERSE | DYN_PART_MASS;
        if (has & DYN_PART_MINV) has |= DYN_PART_CHOLESKY | DYN_PART_FORWARD;
        if (has & DYN_PART_CHOLESKY) has |= DYN_PART_MASS;
        if (has & DYN_PART_IK) has |= DYN_PART_COM;
        if (has & (DYN_PART_JACOBIANS | DYN_PART_COM | DYN_PART_CORIOLIS | DYN_PART_ENERGY | DYN_PART_FRAMES |
                   DYN_PART_CENTROIDAL | DYN_PART_REGRESSOR | DYN_PART_IK | DYN_PART_COLLISION))
          has |= DYN_PART_KINEMATICS;
        Prepared p(row, m, other);
        const Snapshot before(m, d);
        if ((row.part & has) == row.part) {
          const dynStatus status = p(m, d);
          if (mimic && row.part == DYN_PART_FORWARD && !(has & DYN_PART_CHOLESKY)) {
            EXPECT_EQ(DYN_ERROR_PART, status) << row.name;
            EXPECT_TRUE(says({row.name, "mimic", "DYN_PART_CHOLESKY", "dyn_data_new"}));
            EXPECT_EQ("", before.differs(Snapshot(m, d))) << row.name;
          } else {
            EXPECT_EQ(row.needs == Needs::nothing ? DYN_OK : DYN_ERROR_STALE, status)
                << row.name << " " << names[bit] << ": " << dyn_last_error();
          }
          continue;
        }
        ++refused;
        EXPECT_EQ(DYN_ERROR_PART, p(m, d)) << row.name << " " << names[bit];
        EXPECT_TRUE(says({row.name, "DYN_PART_", "dyn_data_new"}));
        bool named = false;
        for (unsigned k = 0; k < std::size(names); ++k)
          named |= (row.part & ~has) >> k & 1u && says({std::string("DYN_PART_") + names[k] + ","});
        EXPECT_TRUE(named) << row.name << ": " << dyn_last_error();
        EXPECT_TRUE(p.untouched()) << row.name;
        EXPECT_EQ("", before.differs(Snapshot(m, d))) << row.name;
      }
    EXPECT_GT(refused, 200);
  }
}

TEST(Parts, AllTermsAsksOnlyForWhatItNeeds) {
  const Model m = all_types(false);
  Data d(m, DYN_PART_MASS | DYN_PART_INVERSE);
  EXPECT_EQ(DYN_OK, dyn_all_terms(m, d, DYN_TERM_MASS | DYN_TERM_NLE | DYN_TERM_GRAVITY_TORQUE, nullptr, nullptr, nullptr))
      << dyn_last_error();
  EXPECT_EQ(DYN_ERROR_PART, dyn_all_terms(m, d, DYN_TERM_MASS | DYN_TERM_COM, nullptr, nullptr, nullptr));
  EXPECT_TRUE(says({"DYN_PART_COM"}));
}

// What needs a result of another call says which.
TEST(Stale, NamesTheCallToMake) {
  const Model m = all_types();
  const State s = random_state(m, 7);
  for (const CallRow& row : call_rows) {
    if (row.needs == Needs::nothing) continue;
    Data d(m);
    Prepared p(row, m, s);
    const char* call = row.needs == Needs::com ? "dyn_com" : row.needs == Needs::mass ? "dyn_crba"
                       : row.needs == Needs::factor ? "dyn_cholesky" : "dyn_forward_kinematics";
    const Snapshot before(m, d);
    EXPECT_EQ(DYN_ERROR_STALE, p(m, d)) << row.name;
    EXPECT_TRUE(says({row.name, "not computed for the current state", call}));
    EXPECT_TRUE(p.untouched());
    EXPECT_EQ("", before.differs(Snapshot(m, d)));
    compute_all(m, d, s);
    EXPECT_EQ(DYN_OK, p(m, d)) << row.name << dyn_last_error();
    EXPECT_TRUE(p.written()) << row.name;
    // one level short
    if (row.needs == Needs::velocity || row.needs == Needs::acceleration) {
      const State t = random_state(m, 8);
      ASSERT_EQ(DYN_OK,
                dyn_forward_kinematics(m, d, t.q.data(), row.needs == Needs::acceleration ? t.v.data() : nullptr, nullptr));
      p.refill();
      EXPECT_EQ(DYN_ERROR_STALE, p(m, d)) << row.name;
      EXPECT_TRUE(says({"dyn_forward_kinematics with q", row.needs == Needs::acceleration ? "a" : "v"}));
      EXPECT_TRUE(p.untouched());
    }
  }
}

// Every output is written whole and nothing past it; NULL outputs give the same field.
TEST(Outputs, WholeAndOptional) {
  for (const Model& m : {all_types(), robot("panda"), robot("go2", DYN_BASE_FLOATING)}) {
    const State s = random_state(m, 9);
    for (const CallRow& row : call_rows) {
      Data d(m), e(m);
      compute_all(m, d, s), compute_all(m, e, s);
      Prepared p(row, m, s);
      EXPECT_EQ(DYN_OK, p(m, d)) << row.name << dyn_last_error();
      EXPECT_TRUE(p.written()) << row.name;
      for (const Numbers& x : p.results()) EXPECT_TRUE(may_be_infinite(row) || finite(x)) << row.name;  // infinite: not tested
      if (row.out_required) continue;
      for (double*& out : p.x.out) out = nullptr;
      p.x.filled = nullptr;
      EXPECT_EQ(DYN_OK, p(m, e)) << row.name;
      EXPECT_EQ("", Snapshot(m, d).differs(Snapshot(m, e))) << row.name;
    }
  }
}

// A quaternion of any norm but zero is that rotation.
TEST(Quaternions, AnyNormButZero) {
  const Model m = all_types();
  const State s = random_state(m, 10);
  Data unit(m);
  compute_all(m, unit, s);
  const Numbers M = field(m, unit, "M"), tau = field(m, unit, "tau"), ddq = field(m, unit, "ddq");
  const std::pair<const char*, std::pair<int, int>> blocks[] = {
      {"free", {3, 4}}, {"ball", {0, 4}}, {"compound", {1, 4}}, {"dial", {0, 2}}};
  for (double scale : {2.0, 1e-8, 1e8, 1e-200, 1e200, 0x1p-1020, 1e308, -1.0}) {
    State t = s;
    for (const auto& [name, block] : blocks) {
      if (scale < 0 && block.second == 2) continue;  // (-c, -s) is another angle
      dynJointInfo info{};
      info.struct_size = sizeof info;
      ASSERT_EQ(DYN_OK, dyn_model_joint_info(m, dyn_model_joint_id(m, name), &info));
      double big = 0;
      for (int k = 0; k < block.second; ++k) big = std::max(big, std::abs(s.q[std::size_t(info.idx_q + block.first + k)]));
      for (int k = 0; k < block.second; ++k) {
        double& x = t.q[std::size_t(info.idx_q + block.first + k)];
        x = x / big * scale;
      }
    }
    Data d(m);
    compute_all(m, d, t);
    auto near = [&](const Numbers& a, const Numbers& b, const char* what) {
      double worst = 0, size = 0;
      for (std::size_t k = 0; k < a.size(); ++k)
        worst = std::max(worst, std::abs(a[k] - b[k])), size = std::max(size, std::abs(a[k]));
      EXPECT_LE(worst, 1e-11 * size) << what << " at " << scale;
    };
    near(M, field(m, d, "M"), "M"), near(tau, field(m, d, "tau"), "tau"), near(ddq, field(m, d, "ddq"), "ddq");
  }
  // the smallest number there is, too
  State t = s;
  for (const auto& [name, block] : blocks) {
    dynJointInfo info{};
    info.struct_size = sizeof info;
    ASSERT_EQ(DYN_OK, dyn_model_joint_info(m, dyn_model_joint_id(m, name), &info));
    std::fill_n(t.q.begin() + info.idx_q + block.first, block.second, 0.0);
    t.q[std::size_t(info.idx_q + block.first)] = 4.9406564584124654e-324;
  }
  Data d(m);
  compute_all(m, d, t);
  EXPECT_TRUE(finite(field(m, d, "M")) && finite(field(m, d, "ddq")));
}

}  // namespace
}  // namespace dyn_test
