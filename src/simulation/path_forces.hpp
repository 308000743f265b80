// Forces along paths (tendons, and actuators on paths) in an Euler step of h. Those that explicit steps resolve well are added to
// tau at the beginning of the step. The others are rows of the step's problem, taken at its end: with the rate l' there,
//   lambda / h = f - K h l' - D (l' - l'_0) - a (l' - l'_0) / h        within [lower, upper]
// K, D, a: stiffness, damping and armature, f: the force at the beginning. With the moment arms J of the beginning, the row has
// l' - l'_0 = J (v - v_0): f has -a J' v of a SPATIAL tendon.
#pragma once

#include "algorithm/actuators.hpp"
#include "algorithm/path_bias.hpp"
#include "integrator/free_flight.hpp"
#include "simulation/step.hpp"

namespace dyn::simulation {

inline Index spring_row(Index tendon) { return path_rows_of_tendon * tendon + 1; }
inline Index actuator_row(const Model& m, const ActuatorRecord& r) {
  return path_rows_of_tendon * m.n.tendons + m.n.couplings + r.row;
}

// Rate of a path's length under velocities v, with the moment arms in d.
inline double rate_along(const Model& m, const Data<double>& d, Index path, const double* v) {
  double sum = 0;
  const PathRecord& p = m.paths()[path];
  for (Index k = p.first_dof; k < p.first_dof + p.dofs; ++k) sum += d.path_moment[k] * v[m.path_dofs()[k]];
  return sum;
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

// Whether activations act as they are at the beginning of a step. Steps for an accuracy take those at their end: either is right
// in the limit, and these get nearer with fewer steps.
template <class T>
bool acts_late(const ActuatorRecord& r, const Data<T>& d) {
  return r.spec.late && !(d.step->closed_gap > 0);
}

// Force of an actuator on a path, with what its gear makes of it, at the beginning of a step. w: what drives it.
template <class T>
PathForce<T> path_force_of(const ActuatorRecord& r, const Data<T>& d, const T* w) {
  const T gear = T(r.spec.gear);
  const PathLaw<T> law = path_law(r, d, w);
  PathForce<T> x{law.force + law.beside, law.stiffness, law.damping, T(0), T(r.spec.force_range[0]) + law.beside,
                 T(r.spec.force_range[1]) + law.beside, 0};
  if (is_muscle(r)) x.upper = std::min(T(0), x.upper);
  x.force *= gear, x.stiffness *= gear * gear, x.damping *= gear * gear, x.lower *= gear, x.upper *= gear;
  if (gear < T(0)) std::swap(x.lower, x.upper);
  return x;
}

// The same in a step of h, from the activations in d: filtered and integrated ones at its end, unless they are late.
template <class T>
PathForce<T> path_force_in_step(const ActuatorRecord& r, const Data<T>& d, T h) {
  T w[max_activations] = {};
  if (r.act < 0) return path_force_of(r, d, driving(r, d, w[0]));
  const T* const now = d.act + r.act;
  activations_after(r, d, now, h, w);
  if (!has_driver(r.spec)) return path_force_of(r, d, acts_late(r, d) ? now : w);
  // a limited rate acts at once; temperature and friction are those of the beginning
  const driver::Slots slot(r.spec);
  const bool motor = r.spec.type == DYN_ACTUATOR_TYPE_DC_MOTOR;
  const bool late = acts_late(r, d);
  for (const int k : {slot.temperature, slot.bristle, motor || late ? slot.integral : -1, late ? slot.current : -1})
    if (k >= 0) w[k] = now[k];
  return path_force_of(r, d, w);
}

// Limits of sums, of the forces in d.path_forces. What reaches a limit keeps its force in the step.
template <class T>
void limit_path_forces(const Model& m, Data<T>& d) {
  const auto of = [&](const ActuatorRecord& r) -> PathForce<T>& { return d.path_forces[actuator_row(m, r)]; };
  take_force_limits(m, d, [&](const ActuatorRecord& r, Index) {
    const PathForce<T>& x = of(r);
    return !on_tendon(r) ? std::clamp(x.force, x.lower, x.upper) : r.spec.gear != 0 ? x.force / T(r.spec.gear) : T(0);
  });
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index) {
    if (r.limit < 0 || d.force_sums[2 * r.limit + 1] == T(0)) return;
    PathForce<T>& x = of(r);
    x.stiffness = x.damping = T(0), x.acts = 0;
    if (on_tendon(r)) return void(x.force *= d.force_sums[2 * r.limit]);
    T& back = d.force_sums[2 * r.limit];  // the first actuator takes it
    x.force = std::clamp(x.force, x.lower, x.upper) + back, x.lower = T(-HUGE_VAL), x.upper = T(HUGE_VAL), back = T(0);
  });
}

template <class T>
PathForce<T> path_force_of(const dynTendon& t, T length, T rate) {
  using effect::Tendons;
  return {Tendons::force(t, length, rate), T(Tendons::slope(t, length)), T(t.damping), T(t.armature), T(-HUGE_VAL), T(HUGE_VAL),
      0};
}

// J' v of a tendon in a step, in which v of free flyers is in axes that are fixed (integrator/free_flight.hpp): the step has
// v' = ddq + (w x v_c, 0) there; in steps for an accuracy also without gyroscopic terms (extrapolated.hpp).
inline double bias_in_step(const Model& m, const Data<double>& d, Index tendon) {
  double bias = path_bias(m, d, tendon);
  const PathRecord& p = m.paths()[tendon];
  integrator::for_each_free_flyer<double>(m, AllTrees{}, [&](const Body& b, Index i, const Vec3<double>& center) {
    const Vec3<double> w = load3(d.v + b.user_v + 3), c = has_file_rows(d) ? Vec3<double>::zero() : center;
    const Vec3<double> turn = cross(w, load3(d.v + b.user_v) + cross(w, c));
    Vec3<double> gyroscopic = Vec3<double>::zero();
    if (d.step->closed_gap > 0 && m.subtree_end()[i] == i + 1 && b.m > 0) {
      const Mat3<double> I = integrator::central_inertia(b, center);
      gyroscopic = integrator::solve3(I, cross(w, I * w));
    }
    for (Index k = p.first_dof; k < p.first_dof + p.dofs; ++k)
      if (const Index at = m.path_dofs()[k] - b.user_v; at >= 0 && at < 6)
        bias -= d.path_moment[k] * (at < 3 ? turn[int(at)] : gyroscopic[int(at - 3)]);
  });
  return bias;
}

// Those that are no rows, to tau.
template <class T>
void add_explicit(const Model& m, const Data<T>& d, Index row, Index path, T* tau) {
  const PathForce<T>& x = d.path_forces[row];
  if (!x.acts) add_path_force(m, d, path, std::clamp(x.force, x.lower, x.upper), tau);
}

}  // namespace dyn::simulation
