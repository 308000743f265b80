// Limits of a joint. At a limit
//   C = q - limit        dC/dt = v        d2C/dt2 = a
// lambda >= 0 at the lower limit, lambda <= 0 at the upper one, and 0 between them.
#pragma once

#include "constraint/constraint.hpp"

namespace dyn::constraint {

struct Limit {
  static constexpr dynConstraintType type = DYN_CONSTRAINT_TYPE_LIMIT;
  static int rows(const Constraint&) { return 1; }
  template <class T>
  static DYN_INLINE JointRow<T> evaluate(const Constraint& c, T q1, T) {
    const T below = q1 - T(c.lower), above = q1 - T(c.upper);
    return {below <= T(0) ? below : above >= T(0) ? above : T(0), T(1), T(0), T(0), T(below <= T(0) || above >= T(0))};
  }
  // bounds of lambda
  template <class T>
  static void bounds(const Constraint& c, T q1, T& lower, T& upper) {
    lower = upper = T(0);
    if (q1 <= T(c.lower)) upper = T(HUGE_VAL);
    if (q1 >= T(c.upper)) lower = T(-HUGE_VAL);
  }
};

}  // namespace dyn::constraint
