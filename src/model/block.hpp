// The memory of a model or of a data: one block, on a boundary of 64 bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "base/aligned.hpp"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace dyn {

inline constexpr std::size_t large_page = std::size_t(1) << 21;

// Asks for large pages, where the memory has room for two: matrices whose columns lie a page apart would spend much of their time on
// translating addresses.
inline void ask_for_large_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  char* const begin = reinterpret_cast<char*>((reinterpret_cast<std::uintptr_t>(memory) + large_page - 1) / large_page * large_page);
  const std::ptrdiff_t inside = (static_cast<char*>(memory) + bytes - begin) / std::ptrdiff_t(large_page) * std::ptrdiff_t(large_page);
  if (inside >= std::ptrdiff_t(2 * large_page)) madvise(begin, std::size_t(inside), MADV_HUGEPAGE);  // a wish: nothing depends on it
#endif
}

// Null when there is no memory; free_aligned gives it back.
inline void* allocate_block(std::size_t bytes) {
  const std::size_t boundary = bytes >= 2 * large_page ? large_page : 64;
  bytes = (bytes + boundary - 1) / boundary * boundary;
  void* const block = allocate_aligned(boundary, bytes);
  if (block) ask_for_large_pages(block, bytes);
  return block;
}

// Under AddressSanitizer the heap's blocks are watched, mapped ones are not.
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
inline constexpr std::size_t least_mapped = std::size_t(1) << 18;
#else
inline constexpr std::size_t least_mapped = ~std::size_t(0);
#endif

// The same, filled with zeros. Of a large block, pages that nobody touches take no memory. free_zeros gives it back.
inline void* allocate_zeros(std::size_t bytes) {
#ifdef __linux__
  if (bytes >= least_mapped) {
    void* const block = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return block == MAP_FAILED ? nullptr : block;
  }
#endif
  void* const block = allocate_block(bytes);
  return block ? std::memset(block, 0, bytes) : nullptr;
}
inline void free_zeros(void* block, std::size_t bytes) {
#ifdef __linux__
  if (bytes >= least_mapped) return void(munmap(block, bytes));
#endif
  (void)bytes;
  free_aligned(block);
}
// Zeros, given back at the end; memory is null where there was none.
struct Zeros {
  const std::size_t bytes;
  void* const memory;
  explicit Zeros(std::size_t count) : bytes(count), memory(allocate_zeros(bytes)) {}
  ~Zeros() {
    if (memory) free_zeros(memory, bytes);
  }
  Zeros(const Zeros&) = delete;
};

}  // namespace dyn
