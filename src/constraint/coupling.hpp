// q1 = p(q2), a polynomial: gears, differentials, cams.
//   C = q1 - p(q2)        dC/dt = v1 - p' v2        d2C/dt2 = a1 - p' a2 - p'' v2^2
#pragma once

#include "constraint/constraint.hpp"

namespace dyn::constraint {

struct Coupling {
  static constexpr dynConstraintType type = DYN_CONSTRAINT_TYPE_COUPLING;
  static int rows(const Constraint&) { return 1; }
  template <class T>
  static DYN_INLINE JointRow<T> evaluate(const Constraint& c, T q1, T q2) {
    T p = T(0), dp = T(0), ddp = T(0), dddp = T(0);  // Horner's scheme: ddp is half of p'', dddp a sixth of p'''
    for (int k = 4; k >= 0; --k) dddp = dddp * q2 + ddp, ddp = ddp * q2 + dp, dp = dp * q2 + p, p = p * q2 + T(c.coefficients[k]);
    return {q1 - p, T(1), -dp, T(-2) * ddp, T(1), T(-6) * dddp};
  }
};

}  // namespace dyn::constraint
