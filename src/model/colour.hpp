// How a shape looks: red, green, blue, opacity, 8 bits each from the top; 0: its file does not say.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace dyn {

inline std::uint32_t packed_colour(const double* rgba) {
  std::uint32_t out = 0;
  for (int i = 0; i < 4; ++i) out = out << 8 | std::uint32_t(std::lround(255 * std::clamp(rgba[i], 0.0, 1.0)));
  return out ? out : 0x01000000u;  // black that is not seen says something, too
}

// 0 to 1; -1 where nothing is said.
inline std::array<double, 4> rgba_of(std::uint32_t colour) {
  std::array<double, 4> out = {-1, -1, -1, -1};
  for (std::size_t i = 0; colour && i < 4; ++i) out[i] = double(colour >> (24 - 8 * i) & 255u) / 255;
  return out;
}

}  // namespace dyn
