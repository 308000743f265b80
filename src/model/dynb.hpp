// .dynb: a model's block as it is, behind a header that is its handle: a file, or memory (flash) in which the model is used where
// it lies. Read by the same layout of memory alone: the tag is made of the sizes of all that a block holds. It is that of every
// little-endian machine with 8-byte alignment of doubles and as many lanes to a vector, whatever the size of its pointers.
// Effects may add coefficients (effect/coefficients.def): their number is the tag's lowest byte, and files with another number
// are translated (load/dynb_translate.cpp).
#pragma once

#include "model/model.hpp"

namespace dyn {

// What is so many bytes from here: true wherever the two lie together.
template <class T>
class OffsetTo {
 public:
  const T* get() const { return reinterpret_cast<const T*>(reinterpret_cast<const char*>(this) + std::ptrdiff_t(distance)); }
  const T* operator->() const { return get(); }
  const T& operator*() const { return *get(); }
  void operator=(const T* x) { distance = reinterpret_cast<const char*>(x) - reinterpret_cast<const char*>(this); }

  std::int64_t distance;
};

inline constexpr std::uint64_t live_model = 0x6c65646f6d6e7964u;

}  // namespace dyn

// Behind what users call a model.
struct dynModel {
  std::uint64_t magic;
  dyn::OffsetTo<dyn::Model> m;
  std::uint64_t in_place;  // 1: in a buffer, which is not ours to free; else the block's address, which leak checkers look for
};

namespace dyn {

struct DynbHeader {
  char magic[8];
  std::uint32_t version, byte_order;
  std::uint64_t tag;       // of the layout
  std::uint64_t bytes;     // of the block
  std::uint64_t checksum;  // the tag, xor that of all that follows: FNV-1a, 64 bits, by words of eight bytes
  dynModel handle;
};
static_assert(sizeof(DynbHeader) == 64);  // the block keeps its boundary

inline constexpr char dynb_magic[9] = "DYNB\r\n\x1a\n";  // a transfer as text changes it
inline constexpr std::uint32_t dynb_version = 5, dynb_byte_order = 0x01020304;
std::uint64_t dynb_checksum(const char* from, std::size_t bytes);

// How what a block holds lies in memory: here, or where 3-vectors have three lanes (save_dynb.cpp).
struct OwnLayout {
  template <class T>
  static constexpr std::size_t size = sizeof(T);
  template <class T>
  static constexpr std::size_t alignment = alignof(T);
};
// Number of coefficients of a degree of freedom. They follow one another in a block, and in a JointRecord before its last member.
#define COEFFICIENT(name, has, sentence) +1
inline constexpr std::size_t coefficient_count = 0
#include "effect/coefficients.def"
    ;
inline constexpr std::size_t first_coefficient = std::size_t(Model::Field::armature);
constexpr bool is_coefficient_field(Model::Field field) {
  return std::size_t(field) - first_coefficient < coefficient_count;
}
static_assert(std::size_t(Model::Field::spring_reference) == first_coefficient + coefficient_count &&
              offsetof(JointRecord, spring_reference) == offsetof(JointRecord, armature) + coefficient_count * sizeof(double));

// Layout of all but coefficients, in the upper 56 bits.
template <class Layout = OwnLayout>
constexpr std::uint64_t dynb_layout() {
  std::uint64_t sum = 0xcbf29ce484222325u;
  const auto add = [&](std::uint64_t x) { sum = (sum ^ x) * 0x100000001b3u; };
  for (const std::size_t size : {sizeof(DynbHeader), sizeof(ModelSizes), sizeof(Index), offsetof(Model, offset),
                                 Layout::template size<Vec3<double>>, Layout::template alignment<Vec3<double>>,
                                 offsetof(JointRecord, armature) - sizeof(JointRecord::C)})
    add(size);
  const auto add_field = [&](Model::Field field, std::size_t size, std::size_t alignment, const char* name) {
    if (is_coefficient_field(field)) return;
    if (field != Model::Field::joints) add(size), add(alignment);
    for (; *name; ++name) add(std::uint64_t(*name));
  };
#define FIELD(type, name, count, sentence) \
  add_field(Model::Field::name, Layout::template size<type>, Layout::template alignment<type>, #name);
#include "model/model_fields.def"
#undef FIELD
  return sum << 8;
}
template <class Layout = OwnLayout>
constexpr std::uint64_t dynb_tag() {
  return dynb_layout<Layout>() | coefficient_count;
}
static_assert(coefficient_count < 256);
static_assert(DYN_LANES == 3 || (alignof(Vec3<double>) == 32 && sizeof(FrameRecord) == 256 && sizeof(Stored<shape::Hull>) == 160),
    "a .dynb of another layout than everywhere else");

// What is wrong with a buffer: nothing, or a sentence without its end. value of count, where these are not -1.
struct Damage {
  dynStatus status = DYN_OK;
  const char* what = nullptr;
  std::int64_t value = -1, count = -1;
  explicit operator bool() const { return what != nullptr; }
};

// Looks at the header and the checksum; at whatever of the block is read: sizes, offsets, indices, strings, types, numbers. No
// heap. What follows from something else must be what follows. Trusted: that the planes and neighbours of a hull are those of its
// vertices, and that the boxes of a tree hold its triangles, which decide about distances alone.
Damage check_dynb(const void* buffer, std::size_t bytes);
Damage check_header(const void* buffer, std::size_t bytes);
Damage check_block(const Model& m, std::size_t bytes);

}  // namespace dyn
