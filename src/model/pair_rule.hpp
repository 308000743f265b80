// Which pairs of collision shapes are none, beside those of one body: SimulationRecord::as_written.
#pragma once

#include "base/types.hpp"

namespace dyn {

enum class PairRule : Index {
  Filter = 0,          // a body and its parent; pairs that overlap in most configurations
  Stated = 1,          // MuJoCo's rule: a body and its parent, but the world is nobody's parent
  StatedParents = 2,   // nothing (filterparent="disable")
  Srdf = 3             // a body and its parent; the SRDF disables others
};

}  // namespace dyn
