// Steps whose errors are controlled leave out the same redundant rows from their beginning to their end: their order needs smooth motion.
// Rows are left out if they are redundant along the motion, too: a mechanism that passes a singular configuration needs all its rows.
#pragma once

#include "algorithm/constrained/redundant_rows.hpp"
#include "integrator/chart.hpp"

namespace dyn::integrator {

// Redundant rows at d.q, marked in their constraints. misaligned: whether some of them are not redundant to rounding.
inline Index mark_redundant_rows(const Model& m, Data<double>& d, bool& misaligned) {
  keep_all_rows(m, d);
  if (constraint_factor(m, d)) return 0;
  evaluate_rows(m, d, static_cast<const double*>(nullptr), static_cast<const double*>(nullptr));
  propagate_rows(m, d);
  const Index dropped = drop_redundant_rows(m, d, misalignment_tolerance);
  misaligned = d.row_moved[0] > tuning::aligned;
  return dropped;
}

// Marks the rows that are redundant but for a misalignment at d.q and beside it along a motion that the other rows allow.
inline void settle_redundant_rows(const Model& m, Data<double>& d, const Stages<double>& s) {
  bool misaligned;
  const Index dropped = mark_redundant_rows(m, d, misaligned);
  if (dropped == 0 || !misaligned) return keep_all_rows(m, d);
  s.begin(m, d);
  Random random{1};
  for (Index k = 0; k < m.n.nv; ++k) s.y[k] = random.uniform(-1, 1);
  dynConstraintResult result;
  project_velocity(m, d, static_cast<const double*>(s.y), s.y, result);
  const double fast = largest(static_cast<const double*>(s.y), m.n.nv);
  for (Index k = 0; k < m.n.nv && fast > 0; ++k) s.y[k] *= tuning::beside / fast;
  integrate(m, static_cast<const double*>(s.q0), static_cast<const double*>(s.y), d.q);
  const Index beside = mark_redundant_rows(m, d, misaligned);
  s.undo(m, d);
  if (beside < dropped) keep_all_rows(m, d);
  else mark_redundant_rows(m, d, misaligned);
}

}  // namespace dyn::integrator
