// Scenes of shapes on the ground, and their simulation.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "capi/support.hpp"

namespace dyn_test {

inline constexpr double g = 9.81;  // m/s^2, along -z

inline dynMaterial material(double friction, double restitution = 0) {
  dynMaterial x{};
  x.friction = friction, x.restitution = restitution;
  return x;
}

// Free bodies over a half-space with friction 0.
class Scene {
 public:
  explicit Scene(std::array<double, 3> gravity = {0, 0, -9.81}) {
    dyn_builder_new("scene", &b_);
    EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b_, gravity.data()));
  }
  Scene(const Scene&) = delete;
  ~Scene() { dyn_builder_free(b_); }
  operator dynBuilder*() const { return b_; }

  Scene& shape(const char* body, dynShapeType type, std::array<double, 3> size, const dynMaterial& x,
               std::array<double, 3> at = {0, 0, 0}) {
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    s.body = body, s.type = type, s.material = x;
    std::copy(size.begin(), size.end(), s.size), std::copy(at.begin(), at.end(), s.placement + 9);
    EXPECT_EQ(DYN_OK, dyn_builder_add_shape(b_, &s)) << dyn_last_error();
    return *this;
  }
  Scene& ground() { return shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0)); }
  Scene& free(const char* name, double mass, std::array<double, 3> inertia, std::array<double, 3> com = {0, 0, 0}) {
    const double I[9] = {inertia[0], 0, 0, 0, inertia[1], 0, 0, 0, inertia[2]};
    const std::string joint = std::string(name) + "_joint";
    const Spec spec(joint.c_str(), DYN_JOINT_TYPE_FREE_FLYER);
    EXPECT_EQ(DYN_OK, dyn_builder_add_joint(b_, &spec)) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_builder_add_body(b_, name, joint.c_str(), nullptr, mass, com.data(), I)) << dyn_last_error();
    return *this;
  }
  Scene& box(const char* name, double mass, std::array<double, 3> s, const dynMaterial& x) {
    auto two = [&](int i, int j) {
      return mass / 12 * (s[std::size_t(i)] * s[std::size_t(i)] + s[std::size_t(j)] * s[std::size_t(j)]);
    };
    return free(name, mass, {two(1, 2), two(0, 2), two(0, 1)}).shape(name, DYN_SHAPE_TYPE_BOX, s, x);
  }
  Scene& sphere(const char* name, double mass, double r, const dynMaterial& x) {
    const double I = 0.4 * mass * r * r;
    return free(name, mass, {I, I, I}).shape(name, DYN_SHAPE_TYPE_SPHERE, {r, 0, 0}, x);
  }
  // Thin, along z, with round ends beyond its length.
  Scene& rod(const char* name, double mass, double r, double length, const dynMaterial& x) {
    const double I = mass * length * length / 12;
    return free(name, mass, {I, I, mass * r * r / 2}).shape(name, DYN_SHAPE_TYPE_CAPSULE, {r, length, 0}, x);
  }
  dynBuilder* builder() { return b_; }
  Model finish() {
    dynModel* m = nullptr;
    EXPECT_EQ(DYN_OK, dyn_builder_finish(b_, &m)) << dyn_last_error();
    return Model(m);
  }

 private:
  dynBuilder* b_ = nullptr;
};

inline const double* array_of(const dynModel* m, dynData* d, const char* name) {
  dynArray a{};
  a.struct_size = sizeof a;
  EXPECT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id(name), &a)) << dyn_last_error();
  return a.data;
}
inline dynStepReport report_of(const dynModel* m, dynData* d) {
  dynStepReport r{};
  r.struct_size = sizeof r;
  EXPECT_EQ(DYN_OK, dyn_data_step_report(m, d, &r));
  return r;
}

// A model, its data and step options.
struct Simulation {
  Model m;
  dynData* d = nullptr;
  dynStepOptions options;
  double residual = 0;  // largest of all steps
  explicit Simulation(Model model, double dt = 1e-3, dynContactSolverType solver = DYN_CONTACT_SOLVER_TYPE_ADMM)
      : m(std::move(model)) {
    EXPECT_EQ(DYN_OK, dyn_data_new(m, DYN_PART_SIMULATION | DYN_PART_ENERGY | DYN_PART_CENTROIDAL, &d));
    q = array("q"), v = array("v");
    dyn_step_options_init(&options);
    options.dt = dt, options.solver = solver;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(m, d, &options));
  }
  Simulation(const Simulation&) = delete;
  // Solves contacts to a residual of 1e-9.
  void exactly() {
    options.tolerance = 1e-9;
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(m, d, &options));
  }
  ~Simulation() { dyn_data_free(d); }
  const double* array(const char* name) const { return array_of(m, d, name); }
  const double *q = nullptr, *v = nullptr;  // arrays of the data
  void set(const Numbers& at, const Numbers& velocity = {}) {
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, at.empty() ? nullptr : at.data(), velocity.empty() ? nullptr : velocity.data(),
                                         nullptr, nullptr))
        << dyn_last_error();
  }
  // Places free bodies upright.
  void place(const std::vector<std::array<double, 3>>& at) {
    Numbers x;
    for (const auto& p : at) x.insert(x.end(), {p[0], p[1], p[2], 0, 0, 0, 1});
    set(x);
  }
  dynStepReport report() const { return report_of(m, d); }
  void steps(int n) {
    for (int k = 0; k < n; ++k) {
      ASSERT_EQ(DYN_OK, dyn_step(m, d)) << dyn_last_error();
      residual = std::max(residual, report().residual);
    }
  }
  double energy() {
    double kinetic = 0, potential = 0;
    EXPECT_EQ(DYN_OK, dyn_energy(m, d, nullptr, nullptr, &kinetic, &potential)) << dyn_last_error();
    return kinetic + potential;
  }
  std::vector<dynContactForce> contacts() const {
    int n = 0;
    EXPECT_EQ(DYN_OK, dyn_data_step_contacts(m, d, nullptr, 0, &n));
    std::vector<dynContactForce> out(static_cast<std::size_t>(n));
    EXPECT_EQ(DYN_OK, dyn_data_step_contacts(m, d, out.data(), n, &n));
    return out;
  }
  // World velocity of a free body.
  std::array<double, 3> velocity(int body = 0) const {
    const double *x = q + 7 * body + 3, *u = v + 6 * body;
    const double t[3] = {2 * (x[1] * u[2] - x[2] * u[1]), 2 * (x[2] * u[0] - x[0] * u[2]), 2 * (x[0] * u[1] - x[1] * u[0])};
    return {u[0] + x[3] * t[0] + x[1] * t[2] - x[2] * t[1], u[1] + x[3] * t[1] + x[2] * t[0] - x[0] * t[2],
            u[2] + x[3] * t[2] + x[0] * t[1] - x[1] * t[0]};
  }
};

inline void control(Simulation& run, const Numbers& u) {
  ASSERT_EQ(DYN_OK, dyn_data_set_control(run.m, run.d, u.data())) << dyn_last_error();
}
inline void integrate_by(Simulation& run, dynIntegrator by) {
  run.options.integrator = by;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
}

}  // namespace dyn_test
