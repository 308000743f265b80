// Triangles for a page, few enough of them.
#pragma once

#include <array>

#include "pack.hpp"

namespace cli::page {

inline constexpr std::uint32_t no_colour = 0x1000000;
struct Surface {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::uint32_t> triangles;  // 3 each
  std::vector<std::uint32_t> colours;    // of the triangles: 0xrrggbb, or no_colour; empty: none has one
  std::size_t bytes() const {
    return 6 * vertices.size() + (vertices.size() > 65535 ? 4 : 2) * triangles.size() + 2 * colours.size();
  }
};
Surface surface_of(const dynMesh* mesh);
// Vertices within a cell of a grid made one, the grid as fine as so many bytes allow (Rossignac and Borrel 1993).
Surface simplified(const Surface& fine, std::size_t bytes);
// "palette": the colours of its triangles, null for one that has none; "colours": which each has, where there are several.
json packed(const Surface& surface, Pack& pack);

}  // namespace cli::page
