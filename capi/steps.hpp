// What functions that make steps share.
#pragma once

#include "guard.hpp"

namespace dyn::capi {

// The error of steps that ended at t: from their return value and the state that they left.
dynStatus explain_step(const Model& m, const Data<double>& d, Index answer, const char* function, double t);

}  // namespace dyn::capi
