// The origins of A and B coincide.
//   C = r        dC/dt = v        d2C/dt2 = dv
#pragma once

#include "constraint/constraint.hpp"

namespace dyn::constraint {

struct Connect {
  static constexpr dynConstraintType type = DYN_CONSTRAINT_TYPE_CONNECT;
  static int rows(const Constraint&) { return 3; }
  template <class T, class Out>
  static DYN_INLINE void evaluate(const Constraint&, const Relative<T>& X, Out&& out) {
    for (int i = 0; i < 3; ++i) out(i, unit3<T>(i), Vec3<T>::zero(), X.r[i], T(0));
  }
};

}  // namespace dyn::constraint
