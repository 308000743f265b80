// Enumerations by name, and infos that a caller's struct takes.
#pragma once

#include "guard.hpp"

namespace dyn::capi {

struct EnumValue {
  const char *identifier, *name;  // "DYN_INTEGRATOR_RK4", "rk4"
  int value;
  const char* sentence;
};

// nullptr: the enumeration has no such value.
const EnumValue* find_value(const char* type, int value);

// Fails: the argument of that name holds no value of the enumeration. The message lists the values.
dynStatus no_value(const char* type, const char* function, const char* name, int value);

template <class E>
dynStatus check_value(const E& e, const char* function, const char* name) {
  return is_value(e) ? DYN_OK : no_value(Members<E>::type, function, name, raw(e));
}

// The same where errors are thrown.
template <class E>
void require_value(const E& e, const char* function, const char* name) {
  if (check_value(e, function, name) != DYN_OK) throw Error(DYN_ERROR_ARGUMENT, dyn_last_error());
}

// Writes an info into a caller's struct, which says its size.
template <class S>
dynStatus fill(S* out, S info, const char* function, const char* type) {
  if (!out) return fail(DYN_ERROR_ARGUMENT, "%s: info is NULL", function);
  if (out->struct_size < sizeof info)
    return fail(DYN_ERROR_SIZE, "%s: struct_size is %u, needs %zu: set it to sizeof(%s)", function, out->struct_size, sizeof info, type);
  info.struct_size = out->struct_size;
  *out = info;
  return DYN_OK;
}

}  // namespace dyn::capi
