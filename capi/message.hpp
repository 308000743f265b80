// The thread's last error.
#pragma once

#include "dyn.h"

// Boards choose what dyn_last_error returns: 2, sentences; 1, their values (short_message.hpp); 0, "".
#ifndef DYN_MESSAGES
#define DYN_MESSAGES 2
#endif
#if DYN_MESSAGES == 1
#include "short_message.hpp"
#endif

namespace dyn::capi {

// Sets it by printf's format, without a heap. Returns the status.
#if DYN_MESSAGES == 2
dynStatus fail(dynStatus status, const char* format, ...)
#if !DYN_NO_HOST  // where an int32_t may be a long, which is as wide as an int
    __attribute__((format(printf, 2, 3)))
#endif
    ;
#elif DYN_MESSAGES == 1
dynStatus fail_with(dynStatus status, const char* format, ...);
template <class... Args>
dynStatus fail(dynStatus status, [[maybe_unused]] const char* format, Args... args) {
  if constexpr (sizeof...(Args) == 0)
    return fail_with(status, format);
  else
    return fail_with(status, format_of_values<Args...>.data(), args...);
}
#else
template <class... Args>
dynStatus fail(dynStatus status, const char*, const Args&...) {
  return status;
}
#endif

}  // namespace dyn::capi
