// The declarations of dyn.h, as tables.
#include "reflection.hpp"

#include <bit>
#include <cstdio>
#include <cstring>

namespace dyn::capi {

namespace {

struct Enum {
  const char *name, *prefix;
  int bits, first, count;  // count values from enum_values[first] on
  const char* sentence;
};

#include "table/enums.inc"

constexpr int enum_count = int(sizeof enums / sizeof *enums);

int find(const char* name) {
  for (int k = 0; k < enum_count; ++k)
    if (name && std::strcmp(enums[k].name, name) == 0) return k;
  return -1;
}

}  // namespace

const EnumValue* find_value(const char* type, int value) {
  const Enum& e = enums[find(type)];
  for (int k = e.first; k < e.first + e.count; ++k)
    if (enum_values[k].value == value) return enum_values + k;
  return nullptr;
}

const EnumValue* effect_value(std::uint32_t bit) {
  return std::has_single_bit(bit) && bit & DYN_EFFECT_ALL ? find_value("dynEffects", int(bit)) : nullptr;
}

#if DYN_NO_HOST
// without the list: its texts are tens of kilobytes
dynStatus no_value(const char* type, const char* function, const char* name, int value) {
  return fail(DYN_ERROR_ARGUMENT, "%s: %s is %d, no %s", function, name, value, type);
}
#else
// "DYN_SHAPE_TYPE_BOX, _SPHERE, ...", or the first and the last of many.
static void list_values(const Enum& e, char* text, std::size_t size) {
  constexpr int many = 24;
  std::size_t used = 0;
  if (e.count > many) {
    const EnumValue &first = enum_values[e.first], &last = enum_values[e.first + e.count - 1];
    std::snprintf(text, size, "%s (%d) to %s (%d)", first.identifier, first.value, last.identifier, last.value);
    return;
  }
  for (int k = 0; k < e.count && used < size; ++k) {
    const char* identifier = enum_values[e.first + k].identifier;
    used += std::size_t(
        std::snprintf(text + used, size - used, "%s%s", k ? ", " : "", k ? identifier + std::strlen(e.prefix) - 1 : identifier));
  }
  if (used >= size) std::memcpy(text + size - 4, "...", 4);
}

dynStatus no_value(const char* type, const char* function, const char* name, int value) {
  char values[600];
  list_values(enums[find(type)], values, sizeof values);
  return fail(DYN_ERROR_ARGUMENT, "%s: %s is %d, no %s: use %s", function, name, value, type, values);
}
#endif

}  // namespace dyn::capi

using namespace dyn;
using namespace dyn::capi;

extern "C" {

int dyn_enum_count(void) { return enum_count; }

int dyn_enum_id(const char* name) {
  const int k = find(name);
  if (k < 0) fail(DYN_ERROR_NAME, "there is no enumeration '%.64s': dyn_enum_info lists them", name ? name : "(NULL)");
  return k;
}

dynStatus dyn_enum_info(int index, dynEnumInfo* info) {
  if (const dynStatus s = check_struct("dyn_enum_info", "info", info)) return s;
  if (index < 0 || index >= enum_count)
    return fail(DYN_ERROR_ARGUMENT, "dyn_enum_info: enumeration %d does not exist: there are %d", index, enum_count);
  const Enum& e = enums[index];
  write_struct({0, e.name, e.prefix, e.sentence, e.count, e.bits}, info);
  return DYN_OK;
}

dynStatus dyn_enum_value_info(int index, int k, dynEnumValueInfo* info) {
  if (const dynStatus s = check_struct("dyn_enum_value_info", "info", info)) return s;
  if (index < 0 || index >= enum_count)
    return fail(DYN_ERROR_ARGUMENT, "dyn_enum_value_info: enumeration %d does not exist: there are %d", index, enum_count);
  const Enum& e = enums[index];
  if (k < 0 || k >= e.count)
    return fail(DYN_ERROR_ARGUMENT, "dyn_enum_value_info: %s has %d values, no value %d", e.name, e.count, k);
  const EnumValue& v = enum_values[e.first + k];
  write_struct({0, v.value, v.identifier, v.identifier + std::strlen(e.prefix), v.sentence}, info);
  return DYN_OK;
}

const char* dyn_interface_json(void) {
  return
#include "table/interface.inc"
      ;
}

}  // extern "C"
