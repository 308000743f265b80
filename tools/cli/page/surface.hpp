// Triangles for a page, few enough of them.
#pragma once

#include <array>

#include "pack.hpp"

namespace cli::page {

struct Surface {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::uint32_t> triangles;  // 3 each
  std::size_t bytes() const { return 6 * vertices.size() + (vertices.size() > 65535 ? 4 : 2) * triangles.size(); }
};
Surface surface_of(const dynMesh* mesh);
// Vertices within a cell of a grid made one, the grid as fine as so many bytes allow (Rossignac and Borrel 1993).
Surface simplified(const Surface& fine, std::size_t bytes);
json packed(const Surface& surface, Pack& pack);

}  // namespace cli::page
