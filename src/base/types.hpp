// Scalar and index types, and the one width that decides how 3-vectors lie in memory.
#pragma once

#include <cstddef>
#include <cstdint>

namespace dyn {

using Index = std::int32_t;

// Instructions on several doubles at once.
#if defined(__SSE2__) || defined(__aarch64__)
#define DYN_SIMD 1
#else
#define DYN_SIMD 0
#endif

// Lanes of a double 3-vector: 4 (one AVX register, two of SSE or NEON) or 3 (no SIMD, as on a Cortex-M). With DYN_REPRODUCIBLE 4
// everywhere: sums are then formed in one order.
#ifndef DYN_LANES
#if DYN_SIMD || DYN_REPRODUCIBLE
#define DYN_LANES 4
#else
#define DYN_LANES 3
#endif
#endif

// Forces inlining; with DYN_SMALL the compiler decides (small flash).
#if DYN_SMALL
#define DYN_INLINE inline
#define DYN_INLINE_LAMBDA
#else
#define DYN_INLINE inline __attribute__((always_inline))
#define DYN_INLINE_LAMBDA __attribute__((always_inline))
#endif

}  // namespace dyn
