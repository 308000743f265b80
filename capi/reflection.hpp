// Range checks of enumerations, with messages.
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

// The value of dynEffects of one bit; nullptr: it is none.
const EnumValue* effect_value(std::uint32_t bit);

// Fails: the argument of that name holds no value of the enumeration. The message lists the values.
dynStatus no_value(const char* type, const char* function, const char* name, int value);

template <class E>
dynStatus check_value(const E& e, const char* function, const char* name) {
  return is_value(e) ? DYN_OK : no_value(Members<E>::type, function, name, raw(e));
}

}  // namespace dyn::capi
