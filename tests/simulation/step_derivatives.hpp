// What tests of derivatives of steps share: the call, and both of its methods side by side.
#pragma once

#include "simulation/scene.hpp"

namespace dyn_test {

struct Derivatives {
  Numbers A, B, B_control, q, v;
  std::vector<dynContactForce> contacts;
  std::vector<dynContactMode> modes;
  std::vector<std::int32_t> degenerate;
  dynStepDerivativeReport report{};
  dynStatus status = DYN_OK;
};

inline Derivatives derivatives(const dynModel* m, dynData* d, dynDerivativeMethod method, double epsilon = 1e-6, double margin = 1e-6) {
  const auto nq = static_cast<std::size_t>(dyn_model_nq(m)), nv = static_cast<std::size_t>(dyn_model_nv(m)),
             nu = static_cast<std::size_t>(dyn_model_nu(m)), room = static_cast<std::size_t>(dyn_model_contact_capacity(m));
  Derivatives x{Numbers(4 * nv * nv), Numbers(2 * nv * nv), Numbers(2 * nv * nu), Numbers(nq), Numbers(nv), {}, {}, {}};
  x.contacts.resize(room), x.modes.resize(room), x.degenerate.resize(room);
  dynStepDerivativeOptions options;
  dyn_step_derivative_options_init(&options);
  options.method = method, options.epsilon = epsilon, options.margin = margin;
  dynStepDerivatives out;
  dyn_step_derivatives_init(&out);
  x.report.struct_size = sizeof x.report;
  out.capacity = static_cast<std::int32_t>(room), out.A = x.A.data(), out.B = x.B.data(), out.B_control = x.B_control.data();
  out.q = x.q.data(), out.v = x.v.data(), out.contacts = x.contacts.data(), out.modes = x.modes.data();
  out.degenerate = x.degenerate.data(), out.report = &x.report;
  x.status = dyn_step_derivatives(m, d, &options, &out);
  const auto n = static_cast<std::size_t>(x.report.contacts);
  if (x.status == DYN_OK) x.contacts.resize(n), x.modes.resize(n), x.degenerate.resize(n);
  return x;
}

inline double largest(const Numbers& x) {
  double most = 0;
  for (double a : x) most = std::max(most, std::abs(a));
  return most;
}
inline double difference(const Numbers& a, const Numbers& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

struct Stepper {
  Model m;
  dynData* d = nullptr;
  dynStepOptions options;
  explicit Stepper(Model model, double dt = 1e-3) : m(std::move(model)) {
    EXPECT_EQ(DYN_OK, dyn_data_new(m, 0, &d));
    EXPECT_EQ(DYN_OK, dyn_model_step_options(m, (dyn_step_options_init(&options), &options)));
    options.dt = dt;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(m, d, &options));
  }
  Stepper(const Stepper&) = delete;
  ~Stepper() { dyn_data_free(d); }
  void integrate_by(dynIntegrator by) {
    options.integrator = by;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(m, d, &options));
  }
  void set(const Numbers& q, const Numbers& v = {}, const Numbers& tau = {}) {
    const auto p = [](const Numbers& x) { return x.empty() ? nullptr : x.data(); };
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, p(q), p(v), nullptr, p(tau))) << dyn_last_error();
  }
  void steps(int n) {
    for (int k = 0; k < n; ++k) ASSERT_EQ(DYN_OK, dyn_step(m, d)) << dyn_last_error();
  }
  Numbers value(const char* name) const {
    dynArray a{};
    a.struct_size = sizeof a;
    EXPECT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id(name), &a));
    return {a.data, a.data + a.rows};
  }
  Derivatives analytic() { return derivatives(m, d, DYN_DERIVATIVE_METHOD_ANALYTIC); }
  Derivatives central(double epsilon) { return derivatives(m, d, DYN_DERIVATIVE_METHOD_CENTRAL_DIFFERENCES, epsilon); }
  // The two methods agree to `within` of the largest entry of each matrix, at least 1.
  Derivatives agree(double within = 1e-6, bool strict = true, double epsilon = 1e-6) {
    const Derivatives a = analytic(), c = central(epsilon);
    EXPECT_EQ(DYN_OK, a.status) << dyn_last_error();
    EXPECT_EQ(DYN_OK, c.status) << dyn_last_error();
    if (a.status || c.status) return a;
    EXPECT_TRUE(!strict || a.report.degenerate + c.report.degenerate == 0) << modes(a);
    EXPECT_LE(difference(a.A, c.A), within * std::max(1.0, largest(c.A)));
    EXPECT_LE(difference(a.B, c.B), within * std::max(1.0, largest(c.B)));
    EXPECT_LE(difference(a.B_control, c.B_control), within * std::max(1.0, largest(c.B_control)));
    EXPECT_EQ(a.q, c.q);
    EXPECT_EQ(a.v, c.v);
    if (::testing::Test::HasFailure()) locate(a, c);
    return a;
  }
  static std::string modes(const Derivatives& x) {
    std::string out;
    for (std::size_t k = 0; k < x.modes.size(); ++k)
      out += "mode " + std::to_string(x.modes[k]) + " gap " + std::to_string(1e6 * x.contacts[k].contact.distance) +
             "e-6 force " +
             std::to_string(std::hypot(x.contacts[k].force_on_b[0], x.contacts[k].force_on_b[1], x.contacts[k].force_on_b[2])) +
             (x.degenerate[k] ? " degenerate\n" : "\n");
    return out;
  }
  // Where A differs, by blocks.
  void locate(const Derivatives& a, const Derivatives& c) const {
    const auto nv = static_cast<std::size_t>(m.nv());
    for (std::size_t block = 0; block < 4; ++block) {
      double most = 0;
      std::size_t row = 0, column = 0;
      for (std::size_t j = 0; j < nv; ++j)
        for (std::size_t i = 0; i < nv; ++i) {
          const std::size_t at = i + nv * (block & 1) + 2 * nv * (j + nv * (block >> 1));
          if (const double e = std::abs(a.A[at] - c.A[at]); e > most) most = e, row = i, column = j;
        }
      const std::size_t at = row + nv * (block & 1) + 2 * nv * (column + nv * (block >> 1));
      ADD_FAILURE() << "block d" << (block & 1 ? "v" : "q") << "'/d" << (block >> 1 ? "v" : "q") << " (" << row << ", " << column
                    << "): " << a.A[at] << ", not " << c.A[at];
    }
  }
};

inline Numbers joined(std::initializer_list<Numbers> parts) {
  Numbers out;
  for (const Numbers& x : parts) out.insert(out.end(), x.begin(), x.end());
  return out;
}
inline Numbers upright(double x, double y, double z) { return {x, y, z, 0, 0, 0, 1}; }

inline Model ball_on_ground(double friction, double restitution = 0) {
  Scene scene;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(friction))
      .sphere("ball", 1, 0.1, material(friction, restitution));
  return scene.finish();
}

// The gap of 1e-5 m closes in the step; the ball rolls on.
}  // namespace dyn_test
