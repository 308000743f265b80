// Structs that begin with struct_size, as programs with an older or a newer dyn.h pass them.
//   read     a shorter one: missing fields have their defaults. A longer one: the bytes beyond must be zero.
//   written  at most struct_size bytes; those that this library does not know become zero.
#pragma once

#include <cstdint>

#include "dyn.h"
#include "message.hpp"

namespace dyn::capi {

// Other sizes are mistakes: no struct was ever shorter (8 is the size of a pointer), and none is so long.
inline constexpr std::uint32_t smallest_struct = 12, largest_struct = 4096;

// The type's name, the function that sets struct_size (nullptr: the caller does), and what struct_size is a multiple of.
struct StructName {
  const char *type, *init;
  std::uint32_t align;
};
template <class S>
StructName struct_name();
// The values that init writes.
template <class S>
S defaults();

#define DYN_READ(type, init)                                                       \
  template <>                                                                      \
  inline StructName struct_name<type>() { return {#type, #init, alignof(type)}; }  \
  template <>                                                                      \
  type defaults<type>();
#define DYN_WRITTEN(type) \
  template <>             \
  inline StructName struct_name<type>() { return {#type, nullptr, alignof(type)}; }
#include "structs.def"

// DYN_ERROR_SIZE for a struct_size that no header has.
dynStatus check_size(const char* function, StructName name, std::uint32_t size);
// The first bytes of `given`, a struct of another size, replace those of `copy`.
dynStatus read_resized(const char* function, StructName name, const void* given, void* copy, std::uint32_t size);
// Writes `size` bytes of `from`, or as many as there are and then zeros. Keeps to's struct_size.
void write_resized(const void* from, std::uint32_t size, void* to);

// A struct that a call reads. nullptr: the defaults.
template <class S>
class Given {
 public:
  dynStatus status = DYN_OK;

  Given(const char* function, const S* given) : at(given) {
    if (given && given->struct_size == sizeof(S)) [[likely]] return;
    copy = defaults<S>();
    copy.struct_size = sizeof(S);
    at = &copy;
    if (given) status = read_resized(function, struct_name<S>(), given, &copy, sizeof(S));
  }
  Given(const Given&) = delete;
  const S& operator*() const { return *at; }
  const S* operator->() const { return at; }

 private:
  const S* at;
  S copy;
};

// A struct that a call writes: to be checked before any work. argument: its name.
template <class S>
dynStatus check_struct(const char* function, const char* argument, const S* out) {
  if (!out) return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, argument);
  return out->struct_size == sizeof(S) ? DYN_OK : check_size(function, struct_name<S>(), out->struct_size);
}
template <class S>
void write_struct(const S& from, S* out) {
  if (!out) return;
  if (out->struct_size != sizeof(S)) return write_resized(&from, sizeof(S), out);
  *out = from;
  out->struct_size = sizeof(S);
}

// dyn_..._init: writes the defaults, within size.
template <class S>
void initialize(S* s, std::uint32_t size, const S& values) {
  if (!s) return;
  s->struct_size = size >= smallest_struct && size <= largest_struct ? size : 0;
  if (s->struct_size) write_struct(values, s);
}

}  // namespace dyn::capi
