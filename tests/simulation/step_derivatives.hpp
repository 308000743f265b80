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

inline Derivatives derivatives(const dynModel* m, dynData* d, dynDerivativeMethod method, double epsilon = 1e-6,
                               double margin = 1e-6) {
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

inline Numbers joined(std::initializer_list<Numbers> parts) {
  Numbers out;
  for (const Numbers& x : parts) out.insert(out.end(), x.begin(), x.end());
  return out;
}
// Infinite if a number is NaN, which std::max would leave out.
inline double larger(double most, double x) { return std::isnan(x) ? HUGE_VAL : std::max(most, std::abs(x)); }
inline double largest(const Numbers& x) {
  double most = 0;
  for (double a : x) most = larger(most, a);
  return most;
}
inline double difference(const Numbers& a, const Numbers& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = larger(most, a[k] - b[k]);
  return most;
}

// Products of a call of their own, of two vectors each, equal those with the matrices of x to 1e-10 of what they sum up.
inline void expect_products(const dynModel* m, dynData* d, const Derivatives& x, dynDerivativeMethod method) {
  const std::size_t rows = 2 * static_cast<std::size_t>(dyn_model_nv(m));
  const Numbers all = joined({x.A, x.B, x.B_control});
  const std::size_t inputs = rows ? all.size() / rows : 0;
  const auto vectors = [](std::size_t n) {  // of no symmetry
    Numbers out(2 * n);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = std::sin(1 + 2.7 * double(k)) + 0.1;
    return out;
  };
  const Numbers tangents = vectors(inputs), cotangents = vectors(rows);
  Numbers jvp(2 * rows), vjp(2 * inputs);
  dynStepDerivativeOptions options;
  dyn_step_derivative_options_init(&options);
  options.method = method;
  dynStepDerivativeReport report{};
  report.struct_size = sizeof report;
  dynStepDerivatives out;
  dyn_step_derivatives_init(&out);
  out.tangents = tangents.data(), out.jvp = jvp.data(), out.cotangents = cotangents.data(), out.vjp = vjp.data();
  out.tangent_count = out.cotangent_count = 2, out.report = &report;
  ASSERT_EQ(DYN_OK, dyn_step_derivatives(m, d, &options, &out)) << dyn_last_error();
  EXPECT_EQ(x.report.degenerate, report.degenerate);
  const auto compare = [&](const char* name, const Numbers& by, std::size_t n, const Numbers& result, std::size_t count,
                           auto&& entry) {
    double size = 0, off = 0;
    for (std::size_t t = 0; t < 2; ++t)
      for (std::size_t i = 0; i < count; ++i) {
        double sum = 0, most = 0;
        for (std::size_t k = 0; k < n; ++k) sum += entry(i, k) * by[n * t + k], most += std::abs(entry(i, k) * by[n * t + k]);
        size = std::max(size, most), off = larger(off, sum - result[count * t + i]);
      }
    EXPECT_LE(off, 1e-10 * size) << name;
  };
  compare("jvp", tangents, inputs, jvp, rows, [&](std::size_t i, std::size_t k) { return all[i + rows * k]; });
  compare("vjp", cotangents, rows, vjp, inputs, [&](std::size_t i, std::size_t k) { return all[k + rows * i]; });
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
    expect_products(m, d, a, DYN_DERIVATIVE_METHOD_ANALYTIC);
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

inline Numbers upright(double x, double y, double z) { return {x, y, z, 0, 0, 0, 1}; }

inline Model ball_on_ground(double friction, double restitution = 0) {
  Scene scene;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(friction))
      .sphere("ball", 1, 0.1, material(friction, restitution));
  return scene.finish();
}

// The stance of a quadruped or a humanoid under servos, its feet a little below the floor.
inline Model standing(const char* name, const Numbers& angles, Numbers& q, double depth) {
  const Model plain = robot(name, DYN_BASE_FLOATING);
  dynBuilder* b = nullptr;
  EXPECT_EQ(DYN_OK, dyn_builder_from_model(plain, &b));
  dynShapeSpec s;
  dyn_shape_spec_init(&s);
  s.body = "universe", s.type = DYN_SHAPE_TYPE_HALF_SPACE;
  EXPECT_EQ(DYN_OK, dyn_builder_add_shape(b, &s));
  for (int j = 2; j < plain.njoints(); ++j) {
    dynActuator a;
    dyn_actuator_init(&a, DYN_ACTUATOR_TYPE_POSITION);
    a.kp = 60, a.kv = 3;
    EXPECT_EQ(DYN_OK, dyn_builder_add_actuator(b, dyn_model_joint_name(plain, j), &a, dyn_model_joint_name(plain, j)))
        << dyn_last_error();
  }
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_OK, dyn_builder_finish(b, &m)) << dyn_last_error();
  dyn_builder_free(b);
  q.assign(static_cast<std::size_t>(dyn_model_nq(m)), 0);
  q[6] = 1;
  const double *const lower = dyn_model_array(m, DYN_MODEL_ARRAY_LOWER_LIMIT), *const upper = dyn_model_array(
                                                                                   m, DYN_MODEL_ARRAY_UPPER_LIMIT);
  for (std::size_t k = 7; k < q.size(); ++k) q[k] = std::clamp(angles[(k - 7) % angles.size()], lower[k] + 0.02, upper[k] - 0.02);
  int floor = 0;
  for (dynShapeInfo shape{}; floor < dyn_model_nshapes(m); ++floor) {
    shape.struct_size = sizeof shape;
    EXPECT_EQ(DYN_OK, dyn_model_shape_info(m, floor, &shape));
    if (shape.type == DYN_SHAPE_TYPE_HALF_SPACE) break;
  }
  // the height at which the lowest contact is `depth` deep
  dynData* d = nullptr;
  EXPECT_EQ(DYN_OK, dyn_data_new(m, 0, &d));
  double low = 0, high = 2;
  for (int n = 0; n < 60; ++n) {
    q[2] = (low + high) / 2;
    dynContact contacts[64];
    int count = 0;
    EXPECT_EQ(DYN_OK, dyn_contacts(m, d, q.data(), 0.0, contacts, 64, &count)) << dyn_last_error();
    double gap = 1;
    for (int k = 0; k < std::min(count, 64); ++k)
      if (contacts[k].shape_a == floor || contacts[k].shape_b == floor) gap = std::min(gap, contacts[k].distance);
    (gap < -depth ? low : high) = q[2];
  }
  dyn_data_free(d);
  return Model(m);
}

// Its servos hold q.
inline void hold(Stepper& run, const Numbers& q) {
  run.set(q);
  Numbers u(q.begin() + 7, q.end());
  ASSERT_EQ(DYN_OK, dyn_data_set_control(run.m, run.d, u.data()));
}

// A mechanism, its loops closed, at rest and in motion.
inline Model mechanism(const char* name) {
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_OK, dyn_model_load((std::string(DYN_MODELS_DIR "/mechanisms/") + name).c_str(), nullptr, &m)) << dyn_last_error();
  return Model(m);
}
inline void close_loops(Stepper& run, Numbers q, Numbers v) {
  ASSERT_EQ(DYN_OK, dyn_project(run.m, run.d, q.data(), v.data(), nullptr, q.data(), v.data(), nullptr)) << dyn_last_error();
  run.set(q, v);
}

}  // namespace dyn_test
