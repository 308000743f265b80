// The clock of time budgets: monotonic, and read without a system call on most machines.
#pragma once

#include <chrono>

#include "solver/time_limit.hpp"

namespace dyn::capi {

inline double clock_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace dyn::capi
