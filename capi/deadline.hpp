// The clock of time budgets: monotonic, and read without a system call on most machines.
#pragma once

#include <chrono>

#include "solver/time_limit.hpp"
#include "structs.hpp"

#if DYN_NO_HOST
extern "C" __attribute__((weak)) double dyn_clock(void);  // seconds; a program on a board defines it for time budgets
#endif

namespace dyn::capi {

inline double clock_seconds() {
#if DYN_NO_HOST
  return dyn_clock();
#else
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
#endif
}

// DYN_ERROR_UNSUPPORTED for a budget without a clock.
inline dynStatus check_clock([[maybe_unused]] const char* function, [[maybe_unused]] double budget) {
#if DYN_NO_HOST
  if (budget > 0 && !dyn_clock)
    return fail(DYN_ERROR_UNSUPPORTED, "%s: time_budget needs a clock: define double dyn_clock(void)", function);
#endif
  return DYN_OK;
}

}  // namespace dyn::capi
