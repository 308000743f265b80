// Scalar and index types, and the one width that decides how 3-vectors lie in memory.
#pragma once

#include <cstddef>
#include <cstdint>

namespace dyn {

using Index = std::int32_t;

// Lanes of a double 3-vector: 4 (one AVX register, two of SSE or NEON) or 3 (no SIMD, as on a Cortex-M).
#ifndef DYN_LANES
#if defined(__SSE2__) || defined(__ARM_NEON)
#define DYN_LANES 4
#else
#define DYN_LANES 3
#endif
#endif

#define DYN_INLINE inline __attribute__((always_inline))
#define DYN_INLINE_LAMBDA __attribute__((always_inline))

}  // namespace dyn
