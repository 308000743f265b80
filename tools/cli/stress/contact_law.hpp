// Whether the forces and velocities of a step hold the laws of motion and of contact: by themselves, without the solver's residual.
#pragma once

#include <algorithm>

#include "scene.hpp"

namespace cli::stress {

// Free bodies of these masses on a ground, which is shape 0; body k is shape k + 1. All contacts have the friction mu, none bounces.
class ContactLaw {
 public:
  ContactLaw(Play& play, std::vector<double> masses, double mu, double dt) : play_(play), m_(std::move(masses)), mu_(mu), dt_(dt) {}

  // A step. The largest of: what a body's momentum lacks, relative to the forces on it; what friction exceeds its cone by, and
  // pulls, relative to the normal force; speeds, m/s: at which shapes enter each other, part although they press, and that
  // friction does not oppose.
  double step() {
    const Vector q = play_.q().copy(), v = play_.v().copy();
    play_.step();
    const Vector q_after = play_.q().copy(), after = play_.v().copy();
    const std::size_t n = m_.size();
    std::vector<Vector3> force(n);
    std::vector<double> size(n);
    double worst = 0;
    const auto contacts = play_.step_contacts();
    for (const auto& c : contacts) {
      const std::size_t a = static_cast<std::size_t>(c.contact.shape_a), b = static_cast<std::size_t>(c.contact.shape_b);
      const Vector3 f = vector(c.force_on_b), normal = vector(c.contact.normal), p = vector(c.contact.position);
      if (a > 0) add(force[a - 1], f, -1), size[a - 1] += length(f);
      if (b > 0) add(force[b - 1], f, 1), size[b - 1] += length(f);
      Vector3 slip = b > 0 ? velocity(q, q_after, after, b - 1, p) : Vector3{};
      if (a > 0) add(slip, velocity(q, q_after, after, a - 1, p), -1);
      const double pressure = dot(f, normal), parting = dot(slip, normal) + std::max(0.0, c.contact.distance) / dt_;
      Vector3 friction = f;
      add(friction, normal, -pressure), add(slip, normal, -dot(slip, normal));
      worst = std::max(worst, -parting);
      if (length(f) == 0) continue;
      worst = std::max({worst, -pressure / length(f), (length(friction) - mu_ * pressure) / length(f)});
      if (pressure <= 0) continue;
      worst = std::max({worst, parting, length(slip) + dot(friction, slip) / (mu_ * pressure)});
    }
    for (std::size_t k = 0; k < n; ++k) {
      Vector3 lacks = turned(q_after, k, part(after, 6 * k));
      add(lacks, turned(q, k, part(v, 6 * k)), -1);
      for (double& x : lacks) x *= m_[k] / dt_;
      lacks[2] += m_[k] * g;
      add(lacks, force[k], -1);
      worst = std::max(worst, length(lacks) / (size[k] + m_[k] * g));
    }
    return worst;
  }

 private:
  static Vector3 vector(const double* x) { return {x[0], x[1], x[2]}; }
  static Vector3 part(const Vector& x, std::size_t i) { return {x[i], x[i + 1], x[i + 2]}; }
  static double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
  static double length(const Vector3& a) { return std::sqrt(dot(a, a)); }
  static Vector3 cross(const Vector3& a, const Vector3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  static void add(Vector3& a, const Vector3& b, double times) {
    for (std::size_t i = 0; i < 3; ++i) a[i] += times * b[i];
  }
  // A vector of body k's axes in the world: x + 2 w (r x x) + 2 r x (r x x) for the quaternion (r, w).
  static Vector3 turned(const Vector& q, std::size_t k, const Vector3& x) {
    const Vector3 r = part(q, 7 * k + 3), t = cross(r, x);
    Vector3 out = x;
    add(out, t, 2 * q[7 * k + 6]), add(out, cross(r, t), 2);
    return out;
  }
  // After the step, of body k's point that was at p before it.
  static Vector3 velocity(const Vector& q, const Vector& q_after, const Vector& v, std::size_t k, Vector3 p) {
    add(p, part(q, 7 * k), -1);
    Vector3 out = turned(q_after, k, part(v, 6 * k));
    add(out, cross(turned(q_after, k, part(v, 6 * k + 3)), p), 1);
    return out;
  }

  Play& play_;
  std::vector<double> m_;
  double mu_, dt_;
};

}  // namespace cli::stress
