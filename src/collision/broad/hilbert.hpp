// Index of a cell on the Hilbert curve through a cube of 1024^3 cells. Cells near on the curve are near in space.
// Source: Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707, 2004.
#pragma once

#include <cstdint>

namespace dyn::collision {

inline std::uint32_t hilbert(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  std::uint32_t X[3] = {x, y, z};
  for (std::uint32_t q = 512; q > 1; q >>= 1) {
    const std::uint32_t p = q - 1;
    for (std::uint32_t& v : X) {
      if (v & q) {
        X[0] ^= p;
      } else {
        const std::uint32_t t = (X[0] ^ v) & p;
        X[0] ^= t, v ^= t;
      }
    }
  }
  X[1] ^= X[0], X[2] ^= X[1];
  std::uint32_t t = 0;
  for (std::uint32_t q = 512; q > 1; q >>= 1)
    if (X[2] & q) t ^= q - 1;
  for (std::uint32_t& v : X) v ^= t;
  // interleave the bits of the three
  auto spread = [](std::uint32_t v) {
    v = (v | v << 16) & 0x030000ff, v = (v | v << 8) & 0x0300f00f, v = (v | v << 4) & 0x030c30c3;
    return (v | v << 2) & 0x09249249;
  };
  return spread(X[0]) << 2 | spread(X[1]) << 1 | spread(X[2]);
}

}  // namespace dyn::collision
