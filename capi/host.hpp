// The boundary where there is an operating system: exceptions to statuses, and models and builders on the heap.
#pragma once

#include "guard.hpp"
#include "model/builder.hpp"
#include "reflection.hpp"

namespace dyn::capi {

inline constexpr std::size_t max_package_dirs = 10000;

// The status of the exception that is being handled. What a caller can cause is never DYN_ERROR_INTERNAL.
dynStatus fail_of_exception() noexcept;

// Runs f, which returns a status and may throw.
template <class F>
dynStatus guarded(F&& f) noexcept {
  const DefaultFloatingPoint settings;
  try {
    return f();
  } catch (...) {
    return fail_of_exception();
  }
}

// Wraps a finished model.
dynStatus make_handle(ModelPtr model, dynModel** out);

// f(Builder) of a handle that is checked.
template <class F>
dynStatus with(dynBuilder* builder, F&& f) {
  if (const dynStatus s = check(builder)) return s;
  return guarded([&] {
    builder->b->forget_parameters();
    f(*builder->b);
    return DYN_OK;
  });
}
inline const char* text(const char* s) { return s ? s : ""; }

// check_value where errors are thrown.
template <class E>
void require_value(const E& e, const char* function, const char* name) {
  if (check_value(e, function, name) != DYN_OK) throw Error(DYN_ERROR_ARGUMENT, dyn_last_error());
}

}  // namespace dyn::capi
