// The last error, and what the library says of itself.
#include <cstdarg>

#include "base/format.hpp"
#include "guard.hpp"

namespace dyn::capi {

namespace {

#if DYN_NO_HOST
char last_error[DYN_MESSAGES ? 192 : 1];
#else
thread_local char last_error[1024];
#endif

}  // namespace

#if DYN_MESSAGES
#if DYN_MESSAGES == 2
dynStatus fail(dynStatus status, const char* format, ...) {
#else
dynStatus fail_with(dynStatus status, const char* format, ...) {
#endif
  va_list args;
  va_start(args, format);
  vwrite_text(last_error, sizeof last_error, format, args);
  va_end(args);
  for (char* c = last_error; *c; ++c)  // names of the caller's: a message is one line
    if (static_cast<unsigned char>(*c) < 0x20 || *c == 0x7f) *c = ' ';
  return status;
}
#endif

void touch_last_error() { static_cast<volatile char*>(last_error)[0] = last_error[0]; }

}  // namespace dyn::capi

extern "C" {

const char* dyn_last_error(void) { return dyn::capi::last_error; }

const char* dyn_status_name(dynStatus status) {
  static constexpr const char* const names[] = {
#include "table/statuses.inc"
  };
  return dyn::is_value(status) ? names[status] : "DYN_ERROR_UNKNOWN";
}

#define DYN_TEXT_(x) #x
#define DYN_TEXT(x) DYN_TEXT_(x)

const char* dyn_version(void) {
  return DYN_TEXT(DYN_VERSION_MAJOR) "." DYN_TEXT(DYN_VERSION_MINOR) "." DYN_TEXT(DYN_VERSION_PATCH);
}

#ifndef DYN_ARCH_NAME
#define DYN_ARCH_NAME "unknown instruction set"
#endif

const char* dyn_build_info(void) {
  return "libdyn " DYN_TEXT(DYN_VERSION_MAJOR) "." DYN_TEXT(DYN_VERSION_MINOR) "." DYN_TEXT(
      DYN_VERSION_PATCH) ", " DYN_ARCH_NAME ", compiler " __VERSION__
#if DYN_CHECKED
                         ", checked"
#endif
#if DYN_REPRODUCIBLE
                         ", reproducible"
#endif
      ;
}

}  // extern "C"
