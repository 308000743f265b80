// Steps whose errors are controlled leave out the same redundant rows from their beginning to their end: their order needs smooth
// motion.
#pragma once

#include "algorithm/constrained/algorithms.hpp"
#include "algorithm/constrained/redundant_rows.hpp"
#include "integrator/tuning.hpp"

namespace dyn::integrator {

// Marks the rows that are redundant at d.q but for a misalignment. Rows that are redundant to rounding stay.
[[gnu::noinline]] inline void settle_redundant_rows(const Model& m, Data<double>& d) {
  if (active_rows(m, d) == 0 || constraint_factor(m, d)) return;
  evaluate_rows(m, d, static_cast<const double*>(nullptr), static_cast<const double*>(nullptr));
  propagate_rows(m, d);
  drop_redundant_rows(m, d, misalignment_tolerance);
  if (!(d.row_moved[0] > tuning::aligned_rows)) keep_all_rows(m, d);
}

// Fixed steps leave out rows that are redundant up to a misalignment anew in each evaluation; others settle them at their
// beginning.
template <class T>
DYN_INLINE void begin_rows(const Model& m, Data<T>& d, bool fixed) {
  if constexpr (std::is_same_v<T, double>) {
    if (m.n.slots == 0) return;
    keep_all_rows(m, d), d.misalignment[0] = fixed ? misalignment_tolerance : 0;
    if (!fixed) settle_redundant_rows(m, d);
  }
}

}  // namespace dyn::integrator
