// The enumerations of dyn.h: which integers are values. Made of the header when the library is built (reflect.py).
#pragma once

#include "dyn.h"

namespace dyn {

// type: its name; first, last, count: of its values; has(x): whether x is one.
template <class E>
struct Members;

#include "table/members.inc"

// The integer where an enumeration is: a caller may have put any there.
template <class E>
int raw(const E& e) {
  int x;
  static_assert(sizeof x == sizeof e);
  __builtin_memcpy(&x, &e, sizeof x);
  return x;
}

template <class E>
bool is_value(const E& e) {
  return Members<E>::has(raw(e));
}

}  // namespace dyn
