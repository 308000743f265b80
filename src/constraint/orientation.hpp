// Rows that fix an orientation: C = log3 R. A rotation from the left changes it by Jlog3^T.
#pragma once

#include "constraint/constraint.hpp"

namespace dyn::constraint {

template <class T>
DYN_INLINE void set_turn(const Vec3<T>& log, int i, RowChange<T>& by) {
  if (!by.of_error) return;
  const Mat3<T> J = Jlog3(log);
  by.error_turn = i == 0 ? J.x : i == 1 ? J.y : J.z;
}

}  // namespace dyn::constraint
