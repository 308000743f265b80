// Scenes for long runs: each with controls that change all the time, and bounds on its state. They use dyn.h alone.
// No number comes from the C library, so inputs have the same bits on every machine.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "dyn.h"

namespace soak {

inline void check(dynStatus status) {
  if (status == DYN_OK) return;
  std::fprintf(stderr, "%s\n", dyn_last_error());
  std::abort();
}

// SplitMix64
struct Dice {
  std::uint64_t state = 1;
  std::uint64_t next() {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  double operator()() { return double(std::int64_t(next()) >> 11) * 0x1p-52; }  // in [-1, 1)
};

class Builder {
 public:
  explicit Builder(const char* name) { check(dyn_builder_new(name, &b_)); }
  Builder(const Builder&) = delete;
  ~Builder() { dyn_builder_free(b_); }

  struct Joint : dynJointSpec {
    Joint(const char* name_, dynJointType type_, const char* parent_ = nullptr, std::array<double, 3> at = {},
          std::array<double, 3> about = {0, 0, 1}) {
      dyn_joint_spec_init(this);
      name = name_, type = type_, parent = parent_;
      for (std::size_t k = 0; k < 3; ++k) placement[9 + k] = at[k], axis[k] = about[k];
    }
    Joint& limits(const double* lower_, const double* upper_) { return lower = lower_, upper = upper_, *this; }
    Joint& losses(const double* armature_, const double* damping_, const double* friction_) {
      return armature = armature_, damping = damping_, friction = friction_, *this;
    }
  };
  Builder& joint(const dynJointSpec& s) { return check(dyn_builder_add_joint(b_, &s)), *this; }
  // a link of its joint's name, with the inertia of a box
  Builder& body(const std::string& joint, double mass, std::array<double, 3> box, std::array<double, 3> com = {}) {
    const double x = box[0] * box[0], y = box[1] * box[1], z = box[2] * box[2], s = mass / 12;
    const double I[9] = {s * (y + z), 0, 0, 0, s * (x + z), 0, 0, 0, s * (x + y)};
    return check(dyn_builder_add_body(b_, ("link_" + joint).c_str(), joint.c_str(), nullptr, mass, com.data(), I)), *this;
  }
  Builder& shape(const std::string& joint, dynShapeType type, std::array<double, 3> size, std::array<double, 3> at = {},
                 double friction = 0.6, double restitution = 0, double rolling = 0) {
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    const std::string link = "link_" + joint;
    s.body = joint.empty() ? nullptr : link.c_str(), s.type = type;
    for (std::size_t k = 0; k < 3; ++k) s.size[k] = size[k], s.placement[9 + k] = at[k];
    s.material.friction = friction, s.material.restitution = restitution, s.material.rolling = s.material.torsion = rolling;
    return check(dyn_builder_add_shape(b_, &s)), *this;
  }
  // a floor and four walls: half-spaces rotated by quarter turns
  Builder& room(double half) {
    shape("", DYN_SHAPE_TYPE_HALF_SPACE, {});
    const double walls[4][9] = {
        {0, 0, -1, 0, 1, 0, 1, 0, 0}, {0, 0, 1, 0, 1, 0, -1, 0, 0}, {1, 0, 0, 0, 0, -1, 0, 1, 0}, {1, 0, 0, 0, 0, 1, 0, -1, 0}};
    for (int k = 0; k < 4; ++k) {
      dynShapeSpec s;
      dyn_shape_spec_init(&s);
      s.type = DYN_SHAPE_TYPE_HALF_SPACE;
      for (int i = 0; i < 9; ++i) s.placement[i] = walls[k][i];
      s.placement[9 + k / 2] = k % 2 ? half : -half;
      check(dyn_builder_add_shape(b_, &s));
    }
    return *this;
  }
  operator dynBuilder*() const { return b_; }
  dynModel* finish() {
    dynModel* m = nullptr;
    check(dyn_builder_finish(b_, &m));
    return m;
  }

 private:
  dynBuilder* b_ = nullptr;
};

// Bounds on the step report and the state.
struct Bounds {
  double speed, height;  // largest |v|, and a coordinate of q
  double penetration;    // m
};

struct Scene {
  const char* name;
  dynModel* (*build)();
  void (*place)(const dynModel*, double* q);
  double push;             // largest force or moment of the controls
  int hold;                // steps between changes
  dynIntegrator integrator;
  dynContactSolverType solver;
  double dt;
  Bounds bounds;
  int share;               // of the number of steps, in percent
};

inline void as_it_is(const dynModel*, double*) {}

// Seven hinges with limits, armature, damping and dry friction.
inline dynModel* arm() {
  Builder b("arm");
  static const double lower = -2.5, upper = 2.5, armature = 0.05, damping = 0.3, friction = 0.1;
  std::string parent;
  for (int k = 0; k < 7; ++k) {
    const std::string name = "j" + std::to_string(k);
    b.joint(Builder::Joint(name.c_str(), DYN_JOINT_TYPE_REVOLUTE, k ? parent.c_str() : nullptr, {0, 0, 0.2},
                           {double(k % 2), double(k % 3 == 1), double(k % 2 == 0)})
                .limits(&lower, &upper)
                .losses(&armature, &damping, &friction));
    b.body(name, 2 - 0.2 * k, {0.1, 0.1, 0.2}, {0, 0, 0.1});
    parent = name;
  }
  return b.finish();
}

// A trunk on four legs of three hinges, on a floor.
inline dynModel* quadruped() {
  Builder b("quadruped");
  static const double damping = 1.5, armature = 0.01, friction = 0.1, lower = -2.7, upper = 2.7;
  b.room(3);
  b.joint(Builder::Joint("trunk", DYN_JOINT_TYPE_FREE_FLYER))
      .body("trunk", 7, {0.4, 0.2, 0.1})
      .shape("trunk", DYN_SHAPE_TYPE_BOX, {0.4, 0.2, 0.1});
  for (int leg = 0; leg < 4; ++leg) {
    const std::string l = std::to_string(leg), hip = "hip" + l, thigh = "thigh" + l, calf = "calf" + l;
    const double x = leg < 2 ? 0.2 : -0.2, y = leg % 2 ? -0.12 : 0.12;
    const auto hinge = [&](const std::string& name, const std::string& parent, std::array<double, 3> at,
                           std::array<double, 3> axis) {
      b.joint(Builder::Joint(name.c_str(), DYN_JOINT_TYPE_REVOLUTE, parent.c_str(), at, axis)
                  .limits(&lower, &upper)
                  .losses(&armature, &damping, &friction));
    };
    hinge(hip, "trunk", {x, y, 0}, {1, 0, 0}), b.body(hip, 0.6, {0.08, 0.08, 0.08});
    hinge(thigh, hip, {0, 0, 0}, {0, 1, 0}), b.body(thigh, 1, {0.05, 0.05, 0.2}, {0, 0, -0.1});
    hinge(calf, thigh, {0, 0, -0.2}, {0, 1, 0}), b.body(calf, 0.2, {0.03, 0.03, 0.2}, {0, 0, -0.1});
    b.shape(calf, DYN_SHAPE_TYPE_SPHERE, {0.02, 0, 0}, {0, 0, -0.2}, 0.8)
        .shape(thigh, DYN_SHAPE_TYPE_CAPSULE, {0.025, 0.12, 0}, {0, 0, -0.1});
  }
  return b.finish();
}
inline void stand(const dynModel* m, double* q) {
  for (int k = 0; k < dyn_model_nq(m); ++k)
    q[k] = k == 2 ? 0.32 : k == 6 ? 1 : k < 7 ? 0 : (k - 7) % 3 == 1 ? 0.7 : (k - 7) % 3 == 2 ? -1.4 : 0;
}

// Shapes of six kinds that fall into a heap between walls.
inline dynModel* heap() {
  Builder b("heap");
  b.room(0.5);
  for (int k = 0; k < 12; ++k) {
    const std::string name = "body" + std::to_string(k);
    b.joint(Builder::Joint(name.c_str(), DYN_JOINT_TYPE_FREE_FLYER)).body(name, 1, {0.1, 0.12, 0.14});
    switch (k % 6) {
      case 0: b.shape(name, DYN_SHAPE_TYPE_BOX, {0.1, 0.12, 0.14}); break;
      case 1: b.shape(name, DYN_SHAPE_TYPE_SPHERE, {0.06, 0, 0}, {}, 0.5, 0.3, 1e-3); break;
      case 2: b.shape(name, DYN_SHAPE_TYPE_CAPSULE, {0.04, 0.1, 0}); break;
      case 3: b.shape(name, DYN_SHAPE_TYPE_CYLINDER, {0.05, 0.1, 0}, {}, 0.4); break;
      case 4: b.shape(name, DYN_SHAPE_TYPE_ELLIPSOID, {0.05, 0.06, 0.07}); break;
      default: b.shape(name, DYN_SHAPE_TYPE_CONE, {0.06, 0.12, 0}); break;
    }
  }
  return b.finish();
}
inline void drop(const dynModel* m, double* q) {
  for (int k = 0; k < dyn_model_nq(m) / 7; ++k, q += 7) {
    const double at[7] = {
        0.15 * (k % 3 - 1), 0.15 * (k / 3 % 2) - 0.07, 0.15 + 0.13 * (k / 6) + 0.02 * k, 0.1 * (k % 4), 0.2, 0, 0.9};
    double norm = 0;
    for (int i = 3; i < 7; ++i) norm += at[i] * at[i];
    double root = 1;
    for (int i = 0; i < 60; ++i) root = 0.5 * (root + norm / root);  // square root
    for (int i = 0; i < 7; ++i) q[i] = i < 3 ? at[i] : at[i] / root;
  }
}

// A four-bar linkage closed by a constraint, a mimic joint, a ball joint, a screw.
inline dynModel* linkage() {
  Builder b("linkage");
  static const double damping[3] = {0.2, 0.2, 0.2}, some[3] = {0.01, 0.01, 0.01};
  const auto hinge = [&](const char* name, const char* parent, double at, double length) {
    b.joint(Builder::Joint(name, DYN_JOINT_TYPE_CONTINUOUS, parent, {at, 0, 0}, {0, 1, 0}).losses(some, damping, nullptr))
        .body(name, 0.5, {length, 0.05, 0.05}, {length / 2, 0, 0});
  };
  hinge("crank", nullptr, 0, 0.2), hinge("coupler", "crank", 0.2, 0.5), hinge("rocker", nullptr, 0.5, 0.35);
  Builder::Joint follower("follower", DYN_JOINT_TYPE_CONTINUOUS, nullptr, {0, 1, 0}, {0, 1, 0});
  follower.mimic = "crank", follower.mimic_ratio = -0.5;
  b.joint(follower).body("follower", 0.3, {0.2, 0.05, 0.05}, {0.1, 0, 0});
  b.joint(Builder::Joint("ball", DYN_JOINT_TYPE_SPHERICAL, "follower", {0.2, 0, 0}).losses(some, damping, nullptr))
      .body("ball", 0.2, {0.05, 0.05, 0.1}, {0, 0, -0.1});
  Builder::Joint screw("screw", DYN_JOINT_TYPE_HELICAL, nullptr, {0, -1, 0});
  screw.pitch = 0.01, screw.losses(some, damping, nullptr);
  b.joint(screw).body("screw", 0.4, {0.1, 0.1, 0.1});
  dynConstraint pin;
  dyn_constraint_init(&pin, DYN_CONSTRAINT_TYPE_LOOP);
  pin.joint_type = DYN_JOINT_TYPE_REVOLUTE;
  pin.placement1[9] = 0.5, pin.placement2[9] = 0.35;
  const double y[3] = {0, 1, 0}, x[3] = {1, 0, 0};
  for (int k = 0; k < 3; ++k) pin.axis[k] = y[k], pin.axis2[k] = x[k];
  pin.stiffness = 100, pin.damping = 20;
  check(dyn_builder_add_constraint(b, "pin", &pin, "link_coupler", "link_rocker"));
  return b.finish();
}

inline void close(const dynModel* m, double* q) {
  const char* const names[] = {"crank", "coupler", "rocker"};
  const double near[] = {-1, 0.7, -1.3};
  std::int32_t at[3];
  check(dyn_model_q_permutation(m, names, 3, at, nullptr));
  for (int k = 0; k < 3; ++k) q[at[k]] = near[k];
  dynData* d = nullptr;
  check(dyn_data_new(m, DYN_PART_CONSTRAINTS, &d));
  check(dyn_project(m, d, q, nullptr, nullptr, q, nullptr, nullptr));
  dyn_data_free(d);
}

// Rolling and bouncing balls.
inline dynModel* balls() {
  Builder b("balls");
  b.room(1);
  for (int k = 0; k < 6; ++k) {
    const std::string name = "ball" + std::to_string(k);
    b.joint(Builder::Joint(name.c_str(), DYN_JOINT_TYPE_FREE_FLYER))
        .body(name, 0.3 + 0.1 * k, {0.1, 0.1, 0.1})
        .shape(name, DYN_SHAPE_TYPE_SPHERE, {0.08, 0, 0}, {}, 0.5, 0.1 * k, 2e-3);
  }
  return b.finish();
}

// Free bodies rotating about all axes.
inline dynModel* tops() {
  Builder b("tops");
  const double none[3] = {};
  check(dyn_builder_set_gravity(b, none));
  for (int k = 0; k < 3; ++k) {
    const std::string name = "top" + std::to_string(k);
    b.joint(Builder::Joint(name.c_str(), DYN_JOINT_TYPE_SPHERICAL, nullptr, {double(k), 0, 0}))
        .body(name, 1, {0.1, 0.2, 0.3 + 0.1 * k});
  }
  return b.finish();
}

inline const Scene scenes[] = {
    {"arm", arm, as_it_is, 20, 100, DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_CONTACT_SOLVER_TYPE_ADMM, 1e-3, {200, 3, 1}, 30},
    {"arm, rk4", arm, as_it_is, 5, 100, DYN_INTEGRATOR_RK4, DYN_CONTACT_SOLVER_TYPE_ADMM, 1e-3, {200, 3, 1}, 20},
    {"quadruped",
     quadruped,
     stand,
     15,
     150,
     DYN_INTEGRATOR_SEMI_IMPLICIT_EULER,
     DYN_CONTACT_SOLVER_TYPE_ADMM,
     1e-3,
     {300, 5, 0.02},
     6},
    {"heap", heap, drop, 4, 200, DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_CONTACT_SOLVER_TYPE_ADMM, 1e-3, {300, 5, 0.02}, 1},
    {"heap, newton",
     heap,
     drop,
     4,
     200,
     DYN_INTEGRATOR_SEMI_IMPLICIT_EULER,
     DYN_CONTACT_SOLVER_TYPE_NEWTON,
     1e-3,
     {300, 5, 0.02},
     1},
    {"balls, pgs", balls, drop, 3, 200, DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_CONTACT_SOLVER_TYPE_PGS, 1e-3, {300, 5, 0.02}, 2},
    {"linkage", linkage, close, 1, 100, DYN_INTEGRATOR_IMPLICIT_FAST, DYN_CONTACT_SOLVER_TYPE_ADMM, 1e-3, {300, 1e4, 1}, 20},
    {"tops, midpoint",
     tops,
     as_it_is,
     0.02,
     50,
     DYN_INTEGRATOR_IMPLICIT_MIDPOINT,
     DYN_CONTACT_SOLVER_TYPE_ADMM,
     1e-3,
     {500, 2, 1},
     20},
};

}  // namespace soak
