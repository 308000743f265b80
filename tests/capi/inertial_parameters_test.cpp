// Tests the functions of numbers alone: inertial parameters, their forms, and the regressor of a body; what they refuse.
#include <functional>

#include "capi/support.hpp"

namespace dyn_test {
namespace {

using Function = std::function<dynStatus(const double*, double*)>;
struct Row {
  const char *name, *input;
  std::size_t in, out;
  Function call;
};
const Numbers still(6, 0.25);
const Row rows[] = {
    {"dyn_pseudo_inertia_from_parameters", "pi", 10, 16, dyn_pseudo_inertia_from_parameters},
    {"dyn_parameters_from_pseudo_inertia", "J", 16, 10, dyn_parameters_from_pseudo_inertia},
    {"dyn_log_cholesky_from_parameters", "pi", 10, 10, dyn_log_cholesky_from_parameters},
    {"dyn_parameters_from_log_cholesky", "theta", 10, 10, dyn_parameters_from_log_cholesky},
    {"dyn_log_cholesky_jacobian", "theta", 10, 100, dyn_log_cholesky_jacobian},
    {"dyn_is_physically_consistent", "pi", 10, 1,
     [](const double* pi, double* out) {
       int consistent = -7;
       const dynStatus s = dyn_is_physically_consistent(pi, out ? &consistent : nullptr);
       if (consistent != -7) *out = consistent;
       return s;
     }},
    {"dyn_body_regressor", "velocity", 6, 60, [](const double* v, double* Y) { return dyn_body_regressor(v, still.data(), Y); }},
    {"dyn_body_regressor", "acceleration", 6, 60,
     [](const double* a, double* Y) { return dyn_body_regressor(still.data(), a, Y); }},
};

// Good input of any of them: the parameters of a unit ball twice as heavy, or its pseudo-inertia.
Numbers good(const Row& r) {
  if (r.in == 16) return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2};
  Numbers x = {2, 0.1, 0, -0.1, 1.5, 0.1, 1.5, 0, 0, 1.5};
  x.resize(r.in);
  return x;
}

TEST(InertialParameters, WrittenWhole) {
  for (const Row& r : rows) {
    Numbers out(r.out + 1, 777);
    EXPECT_EQ(DYN_OK, r.call(good(r).data(), out.data())) << r.name << dyn_last_error();
    for (std::size_t k = 0; k <= r.out; ++k) EXPECT_EQ(k == r.out, out[k] == 777) << r.name << " " << k;
  }
}

TEST(InertialParameters, RefusesNullAndWhatIsNotFinite) {
  for (const Row& r : rows) {
    Numbers out(r.out, 777);
    EXPECT_EQ(DYN_ERROR_ARGUMENT, r.call(nullptr, out.data())) << r.name;
    EXPECT_TRUE(says({r.name, std::string(r.input) + " is NULL"}));
    EXPECT_EQ(DYN_ERROR_ARGUMENT, r.call(good(r).data(), nullptr)) << r.name;
    EXPECT_TRUE(says({r.name, "is NULL"}));
    for (std::size_t k = 0; k < r.in; ++k)
      for (double bad : {nan, inf, -inf}) {
        Numbers in = good(r);
        in[k] = bad;
        EXPECT_EQ(DYN_ERROR_NONFINITE, r.call(in.data(), out.data())) << r.name;
        EXPECT_TRUE(says({r.name, std::string(r.input) + "[" + std::to_string(k) + "]", std::isnan(bad) ? "NaN" : "infinite"}));
      }
    EXPECT_EQ(Numbers(r.out, 777), out) << r.name;
  }
}

// Numbers that overflow on the way: an error that says so, or a finite result.
TEST(InertialParameters, Overflow) {
  int refused = 0;
  for (const Row& r : rows)
    for (double size : {1e160, 1e300, -1e300, 1.7e308}) {
      Numbers in(r.in, size), out(r.out, 777);
      const dynStatus s = r.call(in.data(), out.data());
      if (s == DYN_OK) EXPECT_TRUE(finite(out)) << r.name;
      else {
        ++refused;
        EXPECT_TRUE(s == DYN_ERROR_NUMERIC || s == DYN_ERROR_INVALID) << r.name << dyn_last_error();
        EXPECT_TRUE(says({r.name}));
        EXPECT_EQ(Numbers(r.out, 777), out) << r.name;
      }
    }
  EXPECT_GT(refused, 10);
}

TEST(InertialParameters, BodiesThatCannotExist) {
  const double massless[10] = {0, 0, 0, 0, 1, 0, 1, 0, 0, 1}, rod[10] = {1, 0, 0, 0, 2, 0, 1, 0, 0, 1};
  double theta[10] = {777};
  int consistent = 7;
  for (const double* pi : {massless, rod}) {
    EXPECT_EQ(DYN_OK, dyn_is_physically_consistent(pi, &consistent));
    EXPECT_EQ(0, consistent);
    EXPECT_EQ(DYN_ERROR_INVALID, dyn_log_cholesky_from_parameters(pi, theta));
    EXPECT_TRUE(says(
        {"dyn_log_cholesky_from_parameters", pi == rod ? "pseudo-inertia is not positive definite" : "mass is not positive"}));
    EXPECT_EQ(777, theta[0]);
  }
  Numbers J = good(rows[1]), pi(10);
  J[1] = 0.5;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_parameters_from_pseudo_inertia(J.data(), pi.data()));
  EXPECT_TRUE(says({"J is not symmetric", "J[0, 1]", "J[1, 0] is 0.5"}));
}

// Of a model's links: consistent, and the same after a round trip.
TEST(InertialParameters, OfRobots) {
  for (const Model& m : {all_types(), robot("panda"), robot("go2", DYN_BASE_FLOATING), robot("humanoid", DYN_BASE_FLOATING)}) {
    Numbers pi(10 * std::size_t(m.njoints() - 1) + 1, 777);
    ASSERT_EQ(DYN_OK, dyn_model_inertial_parameters(m, pi.data()));
    EXPECT_EQ(777, pi.back());
    double mass = 0;
    for (std::size_t j = 0; j + 1 < std::size_t(m.njoints()); ++j) {
      const double* body = pi.data() + 10 * j;
      double theta[10], back[10], J[16];
      int consistent = 7;
      mass += body[0];
      EXPECT_EQ(DYN_OK, dyn_is_physically_consistent(body, &consistent));
      EXPECT_EQ(1, consistent) << dyn_model_name(m) << " " << dyn_model_joint_name(m, int(j) + 1);
      ASSERT_EQ(DYN_OK, dyn_log_cholesky_from_parameters(body, theta)) << dyn_last_error();
      ASSERT_EQ(DYN_OK, dyn_parameters_from_log_cholesky(theta, back));
      for (int k = 0; k < 10; ++k) EXPECT_NEAR(body[k], back[k], 1e-12 * (1 + body[0]));
      ASSERT_EQ(DYN_OK, dyn_pseudo_inertia_from_parameters(body, J));
      ASSERT_EQ(DYN_OK, dyn_parameters_from_pseudo_inertia(J, back));
      for (int k = 0; k < 10; ++k) EXPECT_NEAR(body[k], back[k], 1e-14 * (1 + body[0]));
    }
    EXPECT_NEAR(dyn_model_total_mass(m), mass, 1e-12 * mass);
  }
  const Model m = all_types();
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_inertial_parameters(m, nullptr));
  EXPECT_TRUE(says({"dyn_model_inertial_parameters", "pi is NULL"}));
}

// The regressor of a frame is that of a body with the frame's velocity and acceleration.
TEST(InertialParameters, BodyRegressorOfAFrame) {
  const Model m = all_types();
  const State s = random_state(m, 5);
  Data d(m);
  ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, s.q.data(), s.v.data(), s.a.data()));
  const double* g = dyn_model_array(m, DYN_MODEL_ARRAY_GRAVITY);
  for (int frame = 0; frame < m.nframes(); ++frame) {
    double X[12], v[6], a[6], Y[60], of_frame[60];
    ASSERT_EQ(DYN_OK, dyn_frame_placement(m, d, frame, X));
    ASSERT_EQ(DYN_OK, dyn_frame_velocity(m, d, frame, DYN_REFERENCE_LOCAL, v));
    ASSERT_EQ(DYN_OK, dyn_frame_acceleration(m, d, frame, DYN_REFERENCE_LOCAL, a));
    for (int k = 0; k < 3; ++k) a[k] -= X[3 * k] * g[0] + X[3 * k + 1] * g[1] + X[3 * k + 2] * g[2];
    ASSERT_EQ(DYN_OK, dyn_body_regressor(v, a, Y));
    ASSERT_EQ(DYN_OK, dyn_frame_body_regressor(m, d, frame, of_frame));
    for (int k = 0; k < 60; ++k) EXPECT_NEAR(Y[k], of_frame[k], 1e-11) << frame << " " << k;
  }
}

}  // namespace
}  // namespace dyn_test
