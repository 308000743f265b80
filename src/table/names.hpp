// The names of the values of dyn.h's enumerations, made of the header when the library is built (reflect.py).
#pragma once

#include <string_view>

#include "dyn.h"

namespace dyn {

struct ValueName {
  const char* name;  // "half_space" for DYN_SHAPE_TYPE_HALF_SPACE
  int value;
};
template <class E>
inline constexpr ValueName value_names[1] = {};

#include "table/names.inc"

// Returns the name of a value, or "unknown".
template <class E>
constexpr const char* name_of(E value) {
  static_assert(value_names<E>[0].name, "it is no enumeration of dyn.h");
  for (const ValueName& v : value_names<E>)
    if (v.value == int(value)) return v.name;
  return "unknown";
}

// Finds the value of a name; returns false, and changes nothing, if there is none.
template <class E>
constexpr bool value_of(std::string_view name, E& value) {
  for (const ValueName& v : value_names<E>)
    if (name == v.name) return value = E(v.value), true;
  return false;
}

}  // namespace dyn
