// Forces along paths (tendons, and actuators on paths) in an Euler step of h. Those that explicit steps resolve well are added to
// tau at the beginning of the step. The others are rows of the step's problem, taken at its end: with the rate l' there,
//   lambda / h = f - K h l' - D (l' - l'_0) - a (l' - l'_0) / h        within [lower, upper]
// K, D, a: stiffness, damping and armature, f: the force at the beginning.
#pragma once

#include "algorithm/actuators.hpp"
#include "simulation/step.hpp"

namespace dyn::simulation {

inline Index spring_row(Index tendon) { return path_rows_of_tendon * tendon + 1; }
inline Index actuator_row(const Model& m, const ActuatorRecord& r) {
  return path_rows_of_tendon * m.n.tendons + m.n.couplings + r.row;
}

// Lower bound of the inertia that a degree of freedom moves: that of its own body, and its armature.
template <class T>
T own_inertia(const Data<T>& d, const Body& b, int k) {
  const bool linear = b.type == BodyType::Prismatic || (b.type == BodyType::FreeFlyer && k < 3);
  const bool ball = b.type == BodyType::Spherical || b.type == BodyType::FreeFlyer;
  const double own = linear ? b.m : ball ? std::min({b.I(0, 0), b.I(1, 1), b.I(2, 2)}) : b.I(2, 2);
  return T(own) + d.armature[b.user_v + k];
}

// At most so much is the acceleration of a path's length by a unit force along it.
template <class T>
T path_response(const Model& m, const Data<T>& d, Index path) {
  const PathRecord& p = m.paths()[path];
  T sum = T(0);
  for (Index k = p.first_dof; k < p.first_dof + p.dofs; ++k) {
    const T arm = d.path_moment[k];
    if (arm == T(0)) continue;
    const Index dof = m.path_dofs()[k];
    const Body& b = m.bodies()[body_of_dof(m, m.has_mimic ? m.own_v()[dof] : dof)];
    sum += arm * arm / std::max(own_inertia(d, b, int(dof - b.user_v)), std::numeric_limits<T>::min());
  }
  return sum;
}

// Enters a force and decides whether it is a row.
template <class T>
void set_path_force(const Model& m, Data<T>& d, Index row, Index path, T h, PathForce<T> x) {
  if constexpr (std::is_same_v<T, double>) {
    const T stiff = h * (h * x.stiffness + x.damping);
    x.acts = x.armature > T(0) ||
             (stiff > T(0) && (d.step->closed_gap > 0 || stiff * path_response(m, d, path) > T(tuning::stiff_spring)));
  }
  d.path_forces[row] = x;
}

// Force of an actuator on a path, with what its gear makes of it, at the beginning of a step with the activation w at its end.
template <class T>
PathForce<T> path_force_of(const ActuatorRecord& r, const Data<T>& d, T w) {
  const T gear = T(r.spec.gear), l = gear * d.path_length[r.path], rate = gear * d.path_velocity[r.path];
  PathForce<T> x{};
  if (is_muscle(r)) {
    const muscle::Force<T> f = muscle::force(r.spec.muscle, w, l, rate);
    x = {f.force, f.stiffness, f.damping, T(0), T(r.spec.force_range[0]), std::min(T(0), T(r.spec.force_range[1])), 0};
  } else {
    x = {unbounded_force(r, d, w, d.path_length[r.path], d.path_velocity[r.path]), T(std::max(0.0, -r.bias[1])),
         T(std::max(0.0, -r.bias[2])), T(0), T(r.spec.force_range[0]), T(r.spec.force_range[1]), 0};
  }
  x.force *= gear, x.stiffness *= gear * gear, x.damping *= gear * gear, x.lower *= gear, x.upper *= gear;
  if (gear < T(0)) std::swap(x.lower, x.upper);
  return x;
}

template <class T>
PathForce<T> path_force_of(const dynTendon& t, T length, T rate) {
  using effect::Tendons;
  return {Tendons::force(t, length, rate), T(Tendons::slope(t, length)), T(t.damping), T(t.armature), T(-HUGE_VAL), T(HUGE_VAL),
      0};
}

// Those that are no rows, to tau.
template <class T>
void add_explicit(const Model& m, const Data<T>& d, Index row, Index path, T* tau) {
  const PathForce<T>& x = d.path_forces[row];
  if (!x.acts) add_path_force(m, d, path, std::clamp(x.force, x.lower, x.upper), tau);
}

}  // namespace dyn::simulation
