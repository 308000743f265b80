// A face of B rests on A: the rows of Weld as contact force and moment in A's axes.
#pragma once

#include "constraint/weld.hpp"

namespace dyn::constraint {

struct FrameContact : Weld {
  static constexpr dynConstraintType type = DYN_CONSTRAINT_TYPE_FRAME;
};

}  // namespace dyn::constraint
