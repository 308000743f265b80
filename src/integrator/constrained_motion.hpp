// Smooth motion under bilateral constraints: every stage uses constrained dynamics (index 1), and each step ends with a
// projection of q and v onto the constraints, which keeps the order (Hairer and Wanner 1996, VII.2).
#pragma once

#include "base/portable.hpp"
#include "algorithm/constrained/algorithms.hpp"
#include "algorithm/constrained/redundant_rows.hpp"
#include "algorithm/external_forces.hpp"
#include "integrator/tuning.hpp"

namespace dyn::integrator {

// Forward dynamics at d.q, d.v with all forces and constraints. Returns 0, or the joint that is singular.
template <class T>
Index constrained_forward_dynamics(const Model& m, Data<T>& d) {
  const T *tau = d.acting & driving_effects ? actuated(m, d, d.tau_applied) : d.tau_applied, *fext = forces_on_bodies(m, d);
  if constexpr (std::is_same_v<T, double>)
    if (active_rows(m, d) > 0) {
      ProximalOptions options;
      options.misalignment = d.misalignment[0];
      dynConstraintResult result;
      return constrained_dynamics(m, d, static_cast<const T*>(d.v), tau, fext, options, d.ddq, result);
    }
  return forward_dynamics(m, d, d.v, tau, fext, d.ddq);
}

// After constrained_forward_dynamics: returns whether some row is open. Rows with gains close by themselves.
inline bool is_open(const Model& m, Data<double>& d) {
  double lengths = 0, angles = 0, reach = 0;
  const auto look = [&](const double* F, Index r, bool& linear) {
    const auto size = [&](int from) {
      return math::hypot(F[row_lanes * from + r], F[row_lanes * (from + 1) + r], F[row_lanes * (from + 2) + r]);
    };
    const double force = size(0);
    if (force > 0) linear = true, reach = std::max(reach, size(3) / force);
  };
  for_each_constraint(m, d, [&](const ConstraintInstance<double>& s, Index) {
    if (s.c.stiffness > 0 || s.c.damping > 0) return;
    for (Index r = 0; r < s.rows; ++r) {
      if (s.dropped >> r & 1) continue;
      bool linear = false;
      if (!between_joints(s.c.type)) {
        if (s.c.body1) look(s.F1, r, linear);
        if (s.c.body2) look(s.F2, r, linear);
      }
      double& most = linear ? lengths : angles;
      most = std::max(most, std::abs(s.error[r]));
    }
  });
  return angles > tuning::open_rows || lengths > tuning::open_rows * (reach > 0 ? reach : 1);
}

// Removes from the error estimate x (2 nv) the components that the constraint projection will remove.
// Near singular configurations the accelerations in these directions, and only these, are inaccurate.
inline void remove_constrained_errors(const Model& m, Data<double>& d, double* x) {
  dynConstraintResult result;
  project_velocity(m, d, static_cast<const double*>(x), x, result),
      project_velocity(m, d, static_cast<const double*>(x + m.n.nv), x + m.n.nv, result);
}

// Projects q and v onto the constraints at the end of a step (least squares if they are inconsistent).
template <class T>
Index project_to_constraints(const Model& m, Data<T>& d) {
  if constexpr (std::is_same_v<T, double>) {
    bool gains = false;
    for_each_constraint(m, d,
                        [&](const ConstraintInstance<T>& s, Index) { gains = gains || s.c.stiffness > 0 || s.c.damping > 0; });
    if (gains || active_rows(m, d) == 0) return 0;
    dynConstraintResult result;
    return project(m, d, 1, true, T(0), d.v, result, d.misalignment[0],
                   T(tuning::projection_damping));  // Newton converges quadratically: one iteration reaches rounding
  }
  return 0;
}

}  // namespace dyn::integrator
