// What the cases build their scenes of.
#pragma once

#include <array>

#include "case.hpp"

namespace cli::stress {

using dyn::Builder;
using dyn::Data;
using dyn::JointSpec;
using dyn::Model;
using dyn::Placement;

inline constexpr double g = 9.81, pi = 3.14159265358979323846, eps = 2.220446049250313e-16;

inline std::array<double, 9> diagonal(double x, double y, double z) { return {x, 0, 0, 0, y, 0, 0, 0, z}; }
inline std::array<double, 9> no_inertia() { return diagonal(0, 0, 0); }
inline std::array<double, 9> box_inertia(double mass, const Vector3& s) {
  const double a = s[0] * s[0], b = s[1] * s[1], c = s[2] * s[2];
  return diagonal(mass / 12 * (b + c), mass / 12 * (a + c), mass / 12 * (a + b));
}

inline Placement at(double x, double y, double z) { return {1, 0, 0, 0, 1, 0, 0, 0, 1, x, y, z}; }
// A rotation by angle about a unit axis (Rodrigues), then the translation.
inline Placement turned(const Vector3& a, double angle, const Vector3& p = {0, 0, 0}) {
  const double c = std::cos(angle), s = std::sin(angle), t = 1 - c;
  return {c + a[0] * a[0] * t,        a[0] * a[1] * t + a[2] * s, a[0] * a[2] * t - a[1] * s, a[0] * a[1] * t - a[2] * s,
          c + a[1] * a[1] * t,        a[1] * a[2] * t + a[0] * s, a[0] * a[2] * t + a[1] * s, a[1] * a[2] * t - a[0] * s,
          c + a[2] * a[2] * t,        p[0],                       p[1],                       p[2]};
}

inline JointSpec hinge(const std::string& name, const std::string& parent, const Vector3& axis,
                       const Placement& X = at(0, 0, 0)) {
  JointSpec s(name, DYN_JOINT_TYPE_REVOLUTE, parent);
  return s.axis(axis).placement(X);
}
inline JointSpec slide(const std::string& name, const std::string& parent, const Vector3& axis,
                       const Placement& X = at(0, 0, 0)) {
  JointSpec s(name, DYN_JOINT_TYPE_PRISMATIC, parent);
  return s.axis(axis).placement(X);
}

// first and second, points of bodies, are one.
inline dynConstraint connect(const Vector3& on_first, const Vector3& on_second) {
  dynConstraint c;
  dyn_constraint_init(&c, DYN_CONSTRAINT_TYPE_CONNECT);
  for (std::size_t k = 0; k < 3; ++k) c.placement1[9 + k] = on_first[k], c.placement2[9 + k] = on_second[k];
  return c;
}

inline dynMaterial material(double friction, double restitution = 0) {
  dynMaterial m{};
  m.friction = friction, m.restitution = restitution;
  return m;
}
inline void add_shape(Builder& b, const std::string& body, dynShapeType type, const Vector3& size, const dynMaterial& m,
                      const Placement& X = at(0, 0, 0)) {
  dynShapeSpec s;
  dyn_shape_spec_init(&s);
  s.body = body.empty() ? nullptr : body.c_str(), s.type = type, s.material = m;
  for (std::size_t k = 0; k < 3; ++k) s.size[k] = size[k];
  for (std::size_t k = 0; k < 12; ++k) s.placement[k] = X[k];
  dyn::check(dyn_builder_add_shape(b.get(), &s));
}
// The half-space below a plane through the origin.
inline void add_ground(Builder& b, const dynMaterial& m = material(0), const Placement& X = at(0, 0, 0)) {
  add_shape(b, "", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, m, X);
}
// A body that flies freely.
inline void add_free(Builder& b, const std::string& name, double mass, const std::array<double, 9>& inertia) {
  b.add_joint(name + "_joint", DYN_JOINT_TYPE_FREE_FLYER).add_body(name, name + "_joint", mass, {0, 0, 0}, inertia);
}
inline void add_box(Builder& b, const std::string& name, double mass, const Vector3& size, const dynMaterial& m) {
  add_free(b, name, mass, box_inertia(mass, size));
  add_shape(b, name, DYN_SHAPE_TYPE_BOX, size, m);
}
inline void add_sphere(Builder& b, const std::string& name, double mass, double radius, const dynMaterial& m) {
  const double I = 0.4 * mass * radius * radius;
  add_free(b, name, mass, diagonal(I, I, I));
  add_shape(b, name, DYN_SHAPE_TYPE_SPHERE, {radius, 0, 0}, m);
}

// A data that steps, all effects on.
struct Play : Data {
  explicit Play(const Model& model, dynIntegrator integrator = DYN_INTEGRATOR_REFERENCE, double dt = 0.1)
      : Data(model, DYN_PART_SIMULATION | DYN_PART_ENERGY | DYN_PART_KINEMATICS | DYN_PART_CENTROIDAL) {
    set_effects(DYN_EFFECT_ALL & ~DYN_EFFECT_SLEEPING);
    set_step_options(integrator, dt);
  }
  // f(time) before the first step of dt and after each of them.
  template <class F>
  void steps(int n, F&& f) {
    f(time());
    for (int k = 0; k < n; ++k) step(), f(time());
  }
  void steps(int n) {
    for (int k = 0; k < n; ++k) step();
  }
  double mechanical() { return energy().mechanical(); }
  // Of a point of a frame, in the world.
  Vector3 point(int frame, const Vector3& x = {0, 0, 0}) {
    forward_kinematics();
    const Placement X = frame_placement(frame);
    Vector3 out;
    for (std::size_t k = 0; k < 3; ++k) out[k] = X[9 + k] + X[k] * x[0] + X[3 + k] * x[1] + X[6 + k] * x[2];
    return out;
  }
};

// Largest distance of the energy from its first value, divided by scale; drawn.
class EnergyDrift {
 public:
  EnergyDrift(Outcome& out, Play& play, double scale) : out_(out), play_(play), first_(play.mechanical()), scale_(scale) {
    out.picture = {"time, s", "|E - E0| / scale", true, {}};
    out.curve("energy");
  }
  void look() {
    const double off = std::abs(play_.mechanical() - first_) / scale_;
    out_.off_by(off);
    out_.picture.curves.front().add(play_.time(), off);
  }

 private:
  Outcome& out_;
  Play& play_;
  double first_, scale_;
};

}  // namespace cli::stress
