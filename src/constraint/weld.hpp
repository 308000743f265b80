// A and B coincide.
//   C = [r; log3 R]        dC/dt = [v; w] where C = 0: d(log3 R)/dt = Jlog^T w, and Jlog is 1 there        d2C/dt2 = [dv; dw]
#pragma once

#include "constraint/orientation.hpp"

namespace dyn::constraint {

struct Weld {
  static constexpr dynConstraintType type = DYN_CONSTRAINT_TYPE_WELD;
  static int rows(const Constraint&) { return 6; }
  template <class T, class Out>
  static DYN_INLINE void evaluate(const Constraint&, const Relative<T>& X, Out&& out) {
    const Vec3<T> turn = log3(X.R);
    for (int i = 0; i < 3; ++i) out(i, unit3<T>(i), Vec3<T>::zero(), X.r[i], T(0));
    for (int i = 0; i < 3; ++i) out(3 + i, Vec3<T>::zero(), unit3<T>(i), turn[i], T(0), [&](auto& by) { set_turn(turn, i, by); });
  }
};

}  // namespace dyn::constraint
