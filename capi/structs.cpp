#include "structs.hpp"

#include <algorithm>
#include <cstring>

namespace dyn::capi {

dynStatus check_size(const char* function, StructName name, std::uint32_t size) {
  if (size >= smallest_struct && size <= largest_struct && size % name.align == 0) return DYN_OK;
  return name.init
             ? fail(DYN_ERROR_SIZE, "%s: %s: struct_size is %u: call %s first", function, name.type, size, name.init)
             : fail(DYN_ERROR_SIZE, "%s: %s: struct_size is %u: set it to sizeof(%s)", function, name.type, size, name.type);
}

dynStatus read_resized(const char* function, StructName name, const void* given, void* copy, std::uint32_t known) {
  std::uint32_t size;
  std::memcpy(&size, given, sizeof size);
  if (const dynStatus s = check_size(function, name, size)) return s;
  const char* bytes = static_cast<const char*>(given);
  for (std::uint32_t k = known; k < size; ++k)
    if (bytes[k])
      return fail(
          DYN_ERROR_ARGUMENT,
          "%s: %s: struct_size is %u, this library's is %u, and byte %u is not zero: the program's dyn.h is newer than the "
          "library: leave its new fields zero, or update the library",
          function, name.type, size, known, k);
  std::memcpy(static_cast<char*>(copy) + sizeof size, bytes + sizeof size, std::min(size, known) - sizeof size);
  return DYN_OK;
}

void write_resized(const void* from, std::uint32_t known, void* to) {
  std::uint32_t size;
  std::memcpy(&size, to, sizeof size);
  std::memcpy(static_cast<char*>(to) + sizeof size, static_cast<const char*>(from) + sizeof size,
              std::min(size, known) - sizeof size);
  if (size > known) std::memset(static_cast<char*>(to) + known, 0, size - known);
}

}  // namespace dyn::capi

extern "C" {

#define DYN_READ(type, init) \
  void(init)(type * s, uint32_t size) { dyn::capi::initialize(s, size, dyn::capi::defaults<type>()); }
#define DYN_READ_KIND(type, init, kind)  // beside their defaults
#include "structs.def"

}  // extern "C"
