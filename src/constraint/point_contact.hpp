// A point of B rests on A: the rows of Connect as contact force in A's axes.
#pragma once

#include "constraint/connect.hpp"

namespace dyn::constraint {

struct PointContact : Connect {
  static constexpr dynConstraintType type = DYN_CONSTRAINT_TYPE_POINT;
};

}  // namespace dyn::constraint
