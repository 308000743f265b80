// Scalar and index types, and the one width that decides how 3-vectors are computed with.
#pragma once

#include <cstddef>
#include <cstdint>

namespace dyn {

using Index = std::int32_t;

// Lanes that a double 3-vector is computed in: 4 (one AVX register, two of SSE or NEON) or 3 (no SIMD, as on a Cortex-M). It lies in
// memory as four numbers either way.
// With DYN_REPRODUCIBLE 4 everywhere: sums are then formed in one order.
#ifndef DYN_LANES
#if defined(__SSE2__) || defined(__ARM_NEON) || DYN_REPRODUCIBLE
#define DYN_LANES 4
#else
#define DYN_LANES 3
#endif
#endif

#define DYN_INLINE inline __attribute__((always_inline))
#define DYN_INLINE_LAMBDA __attribute__((always_inline))

}  // namespace dyn
