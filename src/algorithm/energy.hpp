// Kinetic and potential energy of what moves.
#pragma once

#include "algorithm/actuators.hpp"
#include "algorithm/effects.hpp"
#include "algorithm/kinematics.hpp"

namespace dyn {

// v^T M v / 2, rotors of joints and tendons included.
template <class T>
void kinetic_energy(const Model& m, Data<T>& d) {
  ensure_velocity(m, d);
  T twice = T(0);
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    const Vec3<T> wB = transpose_times(d.R[i], d.omega[i]), h = d.R[i] * cast<T>(b.h);
    twice += T(b.m) * dot(d.vel[i], d.vel[i]) + T(2) * dot(d.vel[i], cross(d.omega[i], h)) + dot(wB, cast<T>(b.I) * wB);
  }
  for (Index k = 0; k < m.n.nv; ++k) twice += d.armature[k] * d.v[k] * d.v[k];
  if (d.acting & DYN_EFFECT_TENDONS) measure_paths(m, d);
  d.kinetic[0] = T(0.5) * twice + tendon_kinetic_energy(m, d);
  d.mark_fresh(Stage::Kinetic);
}

// -m g . c, zero at the world's origin, and that of springs.
template <class T>
void potential_energy(const Model& m, Data<T>& d) {
  ensure_position(m, d);
  const Vec3<T> g = load3(d.world_gravity);
  T sum = T(0);
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    sum += dot(g, d.p[i] * T(b.m) + d.R[i] * cast<T>(b.h));
  }
  if (d.acting & DYN_EFFECT_TENDONS) measure_paths(m, d);
  d.potential[0] = spring_energy(m, d) + tendon_energy(m, d) - sum;
  d.mark_fresh(Stage::Potential);
}

}  // namespace dyn
