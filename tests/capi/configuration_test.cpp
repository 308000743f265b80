// Tests what the operations on configurations refuse: NULL, NaN, infinity, zero quaternions, overflow; outputs untouched.
#include <functional>

#include "capi/support.hpp"

namespace dyn_test {
namespace {

struct Arguments {
  Numbers one, two;  // the first and the second array
  double u = 0.5;
};
struct Operation {
  const char* name;
  bool second_is_v;
  std::vector<const char*> arrays;
  std::function<dynStatus(const dynModel*, const double*, const double*, double, double*)> call;
};
const Operation operations[] = {
    {"dyn_integrate",
     true,
     {"q", "v"},
     [](auto* m, auto* x, auto* y, double, double* out) { return dyn_integrate(m, x, y, out); }},
    {"dyn_difference",
     false,
     {"q0", "q1"},
     [](auto* m, auto* x, auto* y, double, double* out) { return dyn_difference(m, x, y, out); }},
    {"dyn_interpolate",
     false,
     {"q0", "q1"},
     [](auto* m, auto* x, auto* y, double u, double* out) { return dyn_interpolate(m, x, y, u, out); }},
    {"dyn_configuration_distance",
     false,
     {"q0", "q1"},
     [](auto* m, auto* x, auto* y, double, double* out) { return dyn_configuration_distance(m, x, y, out); }},
    {"dyn_integrate_jacobians",
     true,
     {"q", "v"},
     [](auto* m, auto* x, auto* y, double, double* out) {
       return dyn_integrate_jacobians(m, x, y, out, out ? out + dyn_model_nv(m) * dyn_model_nv(m) : nullptr);
     }},
    {"dyn_difference_jacobians",
     false,
     {"q0", "q1"},
     [](auto* m, auto* x, auto* y, double, double* out) {
       return dyn_difference_jacobians(m, x, y, out, out ? out + dyn_model_nv(m) * dyn_model_nv(m) : nullptr);
     }},
};

class Configurations : public ::testing::Test {
 protected:
  Model m = all_types();
  Numbers q0 = random_state(m, 51).q, q1 = random_state(m, 52).q, v = random_state(m, 53).v, out;

  void SetUp() override { out.assign(std::size_t(2 * m.nv() * m.nv()), -3.5); }
  void refuse(const Operation& op, const double* x, const double* y, double u, dynStatus status,
              const std::vector<std::string>& fragments) {
    EXPECT_EQ(status, op.call(m, x, y, u, out.data())) << op.name;
    EXPECT_TRUE(says(fragments)) << op.name;
    for (double e : out) ASSERT_EQ(-3.5, e) << op.name;
  }
  const Numbers& second(const Operation& op) const { return op.second_is_v ? v : q1; }
};

TEST_F(Configurations, NullAndNotFinite) {
  for (const Operation& op : operations) {
    refuse(op, nullptr, second(op).data(), 0.5, DYN_ERROR_ARGUMENT,
           {op.name, std::string(op.arrays[0]) + " is NULL", "required"});
    refuse(op, q0.data(), nullptr, 0.5, DYN_ERROR_ARGUMENT, {op.name, std::string(op.arrays[1]) + " is NULL"});
    for (double bad : {nan, inf, -inf})
      for (int which : {0, 1}) {
        const std::size_t n = which ? second(op).size() : q0.size();
        for (std::size_t at : {std::size_t(0), n / 2, n - 1}) {
          Numbers x = q0, y = second(op);
          (which ? y : x)[at] = bad;
          refuse(op, x.data(), y.data(), 0.5, DYN_ERROR_NONFINITE,
                 {op.name, std::string(op.arrays[std::size_t(which)]) + "[" + std::to_string(at) + "]", "finite"});
        }
      }
  }
  refuse(operations[2], q0.data(), q1.data(), nan, DYN_ERROR_NONFINITE, {"dyn_interpolate", "u[0]"});
  refuse(operations[2], q0.data(), q1.data(), inf, DYN_ERROR_NONFINITE, {"dyn_interpolate"});
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(DYN_ERROR_ARGUMENT, operations[k].call(m, q0.data(), second(operations[k]).data(), 0.5, nullptr))
        << operations[k].name;
    EXPECT_TRUE(says({operations[k].name, "output is NULL"}));
  }
  // Jacobians: either or both may be absent
  EXPECT_EQ(DYN_OK, dyn_integrate_jacobians(m, q0.data(), v.data(), nullptr, nullptr));
  EXPECT_EQ(DYN_OK, dyn_difference_jacobians(m, q0.data(), q1.data(), nullptr, nullptr));
}

TEST_F(Configurations, ZeroQuaternions) {
  for (const auto& [joint, offset, n] :
       {std::tuple("free", 3, 4), std::tuple("ball", 0, 4), std::tuple("compound", 1, 4), std::tuple("dial", 0, 2)}) {
    dynJointInfo info{};
    info.struct_size = sizeof info;
    ASSERT_EQ(DYN_OK, dyn_model_joint_info(m, dyn_model_joint_id(m, joint), &info));
    Numbers bad = q0;
    std::fill_n(bad.begin() + info.idx_q + offset, n, 0.0);
    for (const Operation& op : operations) {
      refuse(op, bad.data(), second(op).data(), 0.5, DYN_ERROR_QUATERNION, {op.name, joint, "zero", "norm 1"});
      if (!op.second_is_v) refuse(op, q0.data(), bad.data(), 0.5, DYN_ERROR_QUATERNION, {op.name, joint, op.arrays[1]});
    }
    const Numbers before = bad;
    EXPECT_EQ(DYN_ERROR_QUATERNION, dyn_configuration_normalize(m, bad.data()));
    EXPECT_TRUE(says({"dyn_configuration_normalize", joint}));
    EXPECT_TRUE(same_bits(before, bad));
    int answer = -7;
    EXPECT_EQ(DYN_OK, dyn_configuration_is_normalized(m, bad.data(), 0.1, &answer));
    EXPECT_EQ(0, answer);
  }
}

TEST_F(Configurations, Overflow) {
  int refused = 0;
  for (const Operation& op : operations)
    for (double size : {1e100, 1e160, 1e200, 1.7e308})
      for (int which : {0, 1, 2}) {
        Numbers x = q0, y = second(op);
        Random g{std::uint64_t(which)};
        if (which != 1)
          for (double& e : x) e = g.below(2) ? size : -size;
        if (which != 0)
          for (double& e : y) e = g.below(2) ? size : -size;
        std::fill(out.begin(), out.end(), -3.5);
        const dynStatus s = op.call(m, x.data(), y.data(), 0.5, out.data());
        if (s == DYN_OK) {
          EXPECT_TRUE(finite(out)) << op.name << " " << size;
          continue;
        }
        ++refused;
        EXPECT_EQ(DYN_ERROR_NUMERIC, s) << op.name;
        EXPECT_TRUE(says({op.name, "overflows", "too large"}));
        for (double e : out) ASSERT_EQ(-3.5, e) << op.name;
        // in place: as before
        if (std::string(op.name) == "dyn_integrate" || std::string(op.name) == "dyn_interpolate") {
          const Numbers before = x;
          EXPECT_EQ(DYN_ERROR_NUMERIC, op.call(m, x.data(), y.data(), 0.5, x.data()));
          EXPECT_TRUE(same_bits(before, x)) << op.name;
        }
      }
  EXPECT_GT(refused, 10);
  EXPECT_EQ(DYN_ERROR_NUMERIC, dyn_interpolate(m, q0.data(), q1.data(), 1.7e308, out.data()));
  // huge quaternions are rotations like others
  dynJointInfo info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(DYN_OK, dyn_model_joint_info(m, dyn_model_joint_id(m, "ball"), &info));
  Numbers x = q0;
  for (int k = 0; k < 4; ++k) x[std::size_t(info.idx_q + k)] *= 1e200;
  for (const Operation& op : operations)
    EXPECT_EQ(DYN_OK, op.call(m, x.data(), second(op).data(), 0.5, out.data())) << op.name << dyn_last_error();
}

TEST_F(Configurations, InPlace) {
  Numbers apart(q0.size()), x = q0;
  ASSERT_EQ(DYN_OK, dyn_integrate(m, q0.data(), v.data(), apart.data()));
  ASSERT_EQ(DYN_OK, dyn_integrate(m, x.data(), v.data(), x.data()));
  EXPECT_TRUE(same_bits(apart, x));
}

TEST_F(Configurations, NeutralRandomNormalize) {
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_configuration_neutral(m, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_configuration_random(m, 1, nullptr, nullptr, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_configuration_normalize(m, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_configuration_is_normalized(m, nullptr, 0, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_configuration_is_normalized(m, q0.data(), 1e-6, nullptr));
  int answer = -7;
  for (double tolerance : {-1.0, nan, -inf}) {
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_configuration_is_normalized(m, q0.data(), tolerance, &answer));
    EXPECT_TRUE(says({"tolerance", "negative or NaN"}));
  }
  EXPECT_EQ(-7, answer);
  const std::size_t n = q0.size();
  Numbers lower(n, -1.0), upper(n, 1.0), q(n, -3.5);
  lower[n - 1] = nan;
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_configuration_random(m, 1, lower.data(), nullptr, q.data()));
  EXPECT_TRUE(says({"dyn_configuration_random", "lower[" + std::to_string(n - 1) + "] is NaN"}));
  lower[n - 1] = -1, upper[0] = -2;
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_configuration_random(m, 1, lower.data(), upper.data(), q.data()));
  EXPECT_TRUE(says({"dyn_configuration_random", "lower[0] = -1 exceeds upper[0] = -2"}));
  lower[0] = upper[0] = inf;
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_configuration_random(m, 1, lower.data(), upper.data(), q.data()));
  lower[0] = upper[0] = -inf;
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_configuration_random(m, 1, lower.data(), upper.data(), q.data()));
  for (double e : q) EXPECT_EQ(-3.5, e);
  // whatever the box: finite, normalised, inside
  for (double a : {-1.7e308, -1e200, -1.0, 0.0, 1e200, 1.7e308, -inf})
    for (double b : {-1.7e308, -1.0, 0.0, 1e200, 1.7e308, inf})
      if (a <= b)
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
          std::fill(lower.begin(), lower.end(), a), std::fill(upper.begin(), upper.end(), b);
          ASSERT_EQ(DYN_OK, dyn_configuration_random(m, seed, lower.data(), upper.data(), q.data())) << dyn_last_error();
          ASSERT_TRUE(finite(q)) << a << " " << b;
          EXPECT_EQ(DYN_OK, dyn_configuration_is_normalized(m, q.data(), 1e-12, &answer));
          EXPECT_EQ(1, answer);
        }
}

}  // namespace
}  // namespace dyn_test
