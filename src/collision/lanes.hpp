// A vector's components as lanes.
#pragma once

#include "base/simd.hpp"
#include "shape/shape.hpp"

namespace dyn::collision {

// The entries as lanes; the fourth is 0.
DYN_INLINE Double4 lanes_of(const shape::Vec& a) {
#if DYN_LANES == 4
  return a.v;
#else
  return Double4(a[0], a[1], a[2], 0.0);
#endif
}

}  // namespace dyn::collision
