// Smooth motion under constraints that hold at every moment: accelerations are those of constrained dynamics in every stage (index 1), and
// each step ends with q and v brought back to what the rows allow, which keeps the order (Hairer and Wanner 1996, VII.2).
#pragma once

#include "dyn/algorithm/forward_dynamics.hpp"
#include "dyn/constraint/algorithms.hpp"

namespace dyn::integrator {

inline constexpr double open_rows = 1e-6;      // m, rad: rows that are farther apart close in steps of order 1 first
inline constexpr double closed_rows = 1e-14;
inline constexpr double rows_precision = 1e-15;  // of the accelerations

// Forward dynamics at d.q, d.v under the constraints. Returns 0, or the joint that is singular.
template <class T>
Index held_dynamics(const Model& m, Data<T>& d) {
  if constexpr (std::is_same_v<T, double>)
    if (active_rows(m, d) > 0) {
      ProximalOptions options;
      options.tolerance = rows_precision;
      dynConstraintResult result;
      return constrained_dynamics(m, d, static_cast<const T*>(d.v), static_cast<const T*>(d.tau_applied), static_cast<const T*>(nullptr), options, d.ddq, result);
    }
  return forward_dynamics(m, d, d.v, d.tau_applied, static_cast<const T*>(nullptr), d.ddq);
}

// After held_dynamics: whether some row is open; those with gains close by themselves.
inline bool is_open(const Model& m, Data<double>& d) {
  double most = 0;
  for_each_slot(m, d, [&](const Slot<double>& s, Index) {
    for (Index r = 0; r < s.rows; ++r)
      if (!(s.c.stiffness > 0 || s.c.damping > 0)) most = std::max(most, std::abs(s.error[r]));
  });
  return most > open_rows;
}

// The end of a step. Where rows contradict each other, as near as they come.
template <class T>
Index close_rows(const Model& m, Data<T>& d) {
  if constexpr (std::is_same_v<T, double>) {
    bool gains = false;
    for_each_slot(m, d, [&](const Slot<T>& s, Index) { gains = gains || s.c.stiffness > 0 || s.c.damping > 0; });
    if (gains || active_rows(m, d) == 0) return 0;
    dynConstraintResult result;
    return project(m, d, 10, true, closed_rows, d.v, result);
  }
  return 0;
}

}  // namespace dyn::integrator
