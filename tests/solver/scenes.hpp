// Contact problems of textbook scenes as a caller of dyn.h builds them: masses, inertias, contact Jacobians, G = J M^-1 J'.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "common/every.hpp"
#include "dyn.h"

namespace dyn_test {

using Vector = std::vector<double>;
using Point = std::array<double, 3>;
inline constexpr double gravity = 9.81, pi = 3.14159265358979323846;

// A problem and its arrays.
struct Scene {
  dynContactProblem problem;
  Vector G, g, friction, torsion, rolling, restitution, v_minus, compliance, bias, lower, upper;
  std::vector<std::int32_t> rows_of;
  Vector J, minv;  // rows x dof (column-major), dof

  Scene() { dyn_contact_problem_init(&problem); }
  int rows() const { return int(g.size()); }
  // G from J and minv, g = J v.
  void from_jacobian(int rows, const Vector& v) {
    const int dof = int(minv.size());
    G.assign(std::size_t(rows) * rows, 0), g.assign(rows, 0);
    for (int k = 0; k < dof; ++k)
      for (int j = 0; j < rows; ++j) {
        const double x = J[j + rows * k] * minv[k];
        g[j] += J[j + rows * k] * v[k];
        for (int i = 0; i < rows; ++i) G[i + rows * j] += J[i + rows * k] * x;
      }
    // exactly symmetric
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < j; ++i) G[i + rows * j] = G[j + rows * i];
  }
  const dynContactProblem* get() {
    const auto data = [](auto& x) { return x.empty() ? nullptr : x.data(); };
    problem.G = data(G), problem.g = data(g), problem.friction = data(friction), problem.torsion = data(torsion),
    problem.rolling = data(rolling);
    problem.restitution = data(restitution), problem.v_minus = data(v_minus), problem.compliance = data(compliance),
    problem.bias = data(bias);
    problem.lower = data(lower), problem.upper = data(upper), problem.contact_rows = data(rows_of);
    problem.contacts = int(friction.size());
    return &problem;
  }
};

// Free bodies (v = [linear; angular], world axes), point contacts with normal z of one body on another or on the world.
struct Bodies {
  std::vector<double> mass, inertia;  // the same about every axis
  struct Contact {
    int a, b;  // b pushes a up; -1: the world
    Point on_a, on_b;  // from the centres
  };
  std::vector<Contact> contacts;

  Scene scene(double mu, const Vector& v) const {
    const int nc = int(contacts.size()), rows = 3 * nc, dof = 6 * int(mass.size());
    Scene s;
    s.J.assign(std::size_t(rows) * dof, 0), s.minv.assign(dof, 0);
    for (std::size_t b = 0; b < mass.size(); ++b)
      for (int i = 0; i < 3; ++i) s.minv[6 * b + i] = 1 / mass[b], s.minv[6 * b + 3 + i] = 1 / inertia[b];
    for (int c = 0; c < nc; ++c)
      for (const auto& [body, p, sign] :
           {std::tuple(contacts[c].a, contacts[c].on_a, 1.0), std::tuple(contacts[c].b, contacts[c].on_b, -1.0)}) {
        if (body < 0) continue;
        for (int i = 0; i < 3; ++i) {
          const int j = (i + 1) % 3, k = (i + 2) % 3, row = 3 * c + i;
          s.J[row + rows * (6 * body + i)] += sign;
          s.J[row + rows * (6 * body + 3 + j)] += sign * p[k], s.J[row + rows * (6 * body + 3 + k)] -= sign * p[j];  // (w x p)_i
        }
      }
    s.friction.assign(nc, mu);
    s.from_jacobian(rows, v);
    return s;
  }
  // Velocities after gravity acted for dt.
  Vector falling(double dt) const {
    Vector v(6 * mass.size(), 0.0);
    for (std::size_t b = 0; b < mass.size(); ++b) v[6 * b + 2] = -gravity * dt;
    return v;
  }
};

// A stack of cubes with four contact points each.
inline Bodies stack(const std::vector<double>& masses, double side = 0.2) {
  Bodies all;
  for (std::size_t b = 0; b < masses.size(); ++b) {
    all.mass.push_back(masses[b]), all.inertia.push_back(masses[b] * side * side / 6);
    for (int k = 0; k < 4; ++k) {
      const double x = (k & 1 ? 1 : -1) * side / 2, y = (k & 2 ? 1 : -1) * side / 2;
      all.contacts.push_back({int(b), int(b) - 1, {x, y, -side / 2}, {x, y, side / 2}});
    }
  }
  return all;
}

// Legs on a circle of 1 m; the centre of mass is offset by x and 0.7 m high. Each contact is repeated `copies` times.
inline Bodies table(int legs, int copies, double x) {
  Bodies t;
  t.mass = {1}, t.inertia = {0.1};
  for (int l = 0; l < legs; ++l)
    for (int k = 0; k < copies; ++k)
      t.contacts.push_back({0, -1, {std::cos(2 * pi * (l + 0.5) / legs) - x, std::sin(2 * pi * (l + 0.5) / legs), -0.7}, {}});
  return t;
}

// J with normally distributed entries, M = 1.
inline Scene random_scene(int contacts, int dof, double mu, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Scene s;
  s.J.resize(std::size_t(3) * contacts * dof), s.minv.assign(dof, 1), s.friction.assign(contacts, mu);
  for (double& x : s.J) x = normal(generator);
  Vector v(dof);
  for (double& x : v) x = normal(generator);
  s.from_jacobian(3 * contacts, v);
  return s;
}

// Painleve's rod: 1 kg, half length 1 m, its tip on the ground, theta from the horizontal, in the x-z plane.
inline Scene painleve(double theta, double mu, double vx, double vz, double omega) {
  Scene s;
  s.J.assign(3 * 4, 0), s.minv = {1, 1, 1, 3}, s.friction = {mu};  // x, y, z, angle (from x to z)
  s.J[0] = 1, s.J[9] = std::sin(theta);
  s.J[1 + 3] = 1;
  s.J[2 + 6] = 1, s.J[2 + 9] = -std::cos(theta);
  s.from_jacobian(3, {vx, 0, vz, omega});
  return s;
}

struct Answer {
  Vector lambda, velocity;
  dynContactReport report{};
  dynStatus status;
};

struct Solver {
  dynContactSolver* s = nullptr;
  explicit Solver(int rows) { EXPECT_EQ(DYN_OK, dyn_contact_solver_new(rows, &s)) << dyn_last_error(); }
  ~Solver() { dyn_contact_solver_free(s); }
  Solver(const Solver&) = delete;
};

inline dynContactOptions with(dynContactSolverType type, int max_iterations = 1000, double tolerance = 1e-10) {
  dynContactOptions o;
  dyn_contact_options_init(&o);
  o.solver = type, o.max_iterations = max_iterations, o.tolerance = tolerance;
  return o;
}

inline Answer solve(Scene& s, const dynContactOptions& options, const Vector& guess = {}) {
  const Solver solver(std::max(1, s.rows()));
  Answer a;
  a.lambda = guess.empty() ? Vector(s.rows(), 7.0) : guess, a.velocity.resize(s.rows());
  a.report.struct_size = sizeof a.report;
  a.status = dyn_contact_solver_solve(solver.s, s.get(), &options, a.lambda.data(), a.velocity.data(), &a.report);
  EXPECT_EQ(DYN_OK, a.status) << dyn_last_error();
  return a;
}

inline const std::vector<dynContactSolverType> all_solvers = every<dynContactSolverType>("dynContactSolverType");
inline constexpr const char* solver_names[] = {"pgs", "admm", "newton"};

}  // namespace dyn_test
