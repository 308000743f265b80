// The memory of a model or of a data: one block, on a boundary of 64 bytes.
#pragma once

#include <cstddef>
#include <cstdlib>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace dyn {

// Large blocks ask for large pages: matrices whose columns lie a page apart would spend much of their time on translating
// addresses. Null when there is no memory; std::free gives it back.
inline void* allocate_block(std::size_t bytes) {
  constexpr std::size_t large_page = std::size_t(1) << 21;
  const bool large = bytes >= 2 * large_page;
  const std::size_t boundary = large ? large_page : 64;
  bytes = (bytes + boundary - 1) / boundary * boundary;
  void* block = std::aligned_alloc(boundary, bytes);
#ifdef MADV_HUGEPAGE
  if (block && large) madvise(block, bytes, MADV_HUGEPAGE);  // a wish: nothing depends on it
#endif
  return block;
}

}  // namespace dyn
