// .dynb: a model's block as it is, behind a header. Read by the same layout of memory alone: the tag is made of the sizes of all that a block
// holds. Nothing of the block is used before it has been checked; of what is in it, only what a builder needs is taken, and the rest (runs,
// elimination tree, pairs, ...) is made anew. Trusted: that the planes and neighbours of a hull are those of its vertices, and that the boxes of a
// tree hold its triangles, which decide about distances alone.
#pragma once

#include <string>

#include "dyn/model/builder.hpp"
#include "dyn/model/load.hpp"
#include "dyn/model/model.hpp"

namespace dyn::load {

struct DynbHeader {
  char magic[8];
  std::uint32_t version, byte_order;
  std::uint64_t tag;       // of the layout
  std::uint64_t bytes;     // of the block
  std::uint64_t checksum;  // of the block: FNV-1a, 64 bits, by words of eight bytes
};

inline constexpr char dynb_magic[9] = "DYNB\r\n\x1a\n";  // a transfer as text changes it
inline constexpr std::uint32_t dynb_version = 1, dynb_byte_order = 0x01020304;
std::uint64_t dynb_tag();
std::uint64_t dynb_checksum(const char* block, std::size_t bytes);
// Writes the header of a file whose block is there.
void seal_dynb(std::string& file);

// Throws, saying what is wrong: sizes, offsets, indices, strings, types of what a builder will read. (dynb_check.cpp, dynb_surfaces.cpp)
void check_dynb_block(const Model& m, std::size_t bytes);
void check_dynb_surfaces(const Model& m);
[[noreturn]] void damaged(const std::string& what);

}  // namespace dyn::load
