#include "model/dynb.hpp"

#include <cstddef>

namespace dyn {

std::uint64_t dynb_checksum(const char* from, std::size_t bytes) {
  std::uint64_t sum = 0xcbf29ce484222325u;
  for (std::size_t k = 0; k < bytes; k += 8) {
    std::uint64_t word = 0;
    __builtin_memcpy(&word, from + k, bytes - k < 8 ? bytes - k : 8);
    sum = (sum ^ word) * 0x100000001b3u;
    sum ^= sum >> 32;  // so that high bits of a word reach low ones of the sum
  }
  return sum;
}

Damage check_header(const void* buffer, std::size_t bytes) {
  DynbHeader h;
  if (bytes < sizeof h) return {DYN_ERROR_PARSE, "it ends within its header"};
  __builtin_memcpy(&h, buffer, sizeof h);
  if (__builtin_memcmp(h.magic, dynb_magic, sizeof h.magic) != 0)
    return {DYN_ERROR_PARSE, "its first eight bytes are not those of a .dynb"};
  if (h.byte_order != dynb_byte_order) return {DYN_ERROR_UNSUPPORTED, "it is of a machine with another order of bytes"};
  if (h.version != dynb_version)
    return {DYN_ERROR_UNSUPPORTED, "it is of another version of the format: the version", h.version, dynb_version};
  constexpr std::uint64_t tag = dynb_tag();
  if (h.tag >> 8 != tag >> 8) return {DYN_ERROR_UNSUPPORTED, "it is of a build whose models lie in memory in another way"};
  if (h.bytes != bytes - sizeof h)
    return {DYN_ERROR_PARSE, "the number of bytes after its header", std::int64_t(bytes - sizeof h), std::int64_t(h.bytes)};
  constexpr std::size_t summed = offsetof(DynbHeader, handle), to_block = sizeof(DynbHeader) - summed - offsetof(dynModel, m);
  if (h.checksum != (h.tag ^ dynb_checksum(static_cast<const char*>(buffer) + summed, bytes - summed)))
    return {DYN_ERROR_PARSE, "its checksum is wrong"};
  if (h.bytes < sizeof(Model)) return {DYN_ERROR_PARSE, "it is too short for a model"};
  if (h.handle.magic != live_model || h.handle.m.distance != std::int64_t(to_block) || h.handle.in_place != 1)
    return {DYN_ERROR_PARSE, "its handle is wrong"};
  if (h.tag != tag)
    return {DYN_ERROR_UNSUPPORTED, "it is of a library with other effects: its number of coefficients of a joint",
            std::int64_t(h.tag & 255), std::int64_t(coefficient_count)};
  return {};
}

Damage check_dynb(const void* buffer, std::size_t bytes) {
  if (const Damage d = check_header(buffer, bytes)) return d;
  return check_block(*reinterpret_cast<const Model*>(static_cast<const char*>(buffer) + sizeof(DynbHeader)),
                     bytes - sizeof(DynbHeader));
}

}  // namespace dyn
