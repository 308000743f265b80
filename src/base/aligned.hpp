// Memory on a boundary. Windows gives it back by another function than that of other memory.
#pragma once

#include <cstddef>
#include <cstdlib>
#ifdef _WIN32
#include <malloc.h>
#endif

namespace dyn {

// Null when there is no memory. bytes: a multiple of boundary.
inline void* allocate_aligned(std::size_t boundary, std::size_t bytes) {
#ifdef _WIN32
  return _aligned_malloc(bytes, boundary);
#else
  return std::aligned_alloc(boundary, bytes);
#endif
}
inline void free_aligned(void* memory) {
#ifdef _WIN32
  _aligned_free(memory);
#else
  std::free(memory);
#endif
}

}  // namespace dyn
