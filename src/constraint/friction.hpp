// Dry friction in a joint: a force of at most `force` that opposes the velocity.
//   C = 0        dC/dt = v        d2C/dt2 = a = -damping v, subject to |lambda| <= force
#pragma once

#include "constraint/constraint.hpp"

namespace dyn::constraint {

struct Friction {
  static constexpr dynConstraintType type = DYN_CONSTRAINT_TYPE_FRICTION;
  static int rows(const Constraint&) { return 1; }
  template <class T>
  static DYN_INLINE JointRow<T> evaluate(const Constraint&, T, T) {
    return {T(0), T(1), T(0), T(0)};
  }
  template <class T>
  static void bounds(const Constraint& c, T, T& lower, T& upper) {
    lower = T(-c.force), upper = T(c.force);
  }
};

}  // namespace dyn::constraint
