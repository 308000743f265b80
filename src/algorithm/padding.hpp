// Sizes of arrays that are read several lanes at a time.
#pragma once

#include <cstddef>

#include "model/model.hpp"

namespace dyn {

// Numbers of degrees of freedom in whole tiles of four (tiles.hpp).
inline std::ptrdiff_t padded_tiles(std::ptrdiff_t n) { return (n + 3) / 4 * 4; }

// And in whole packs of eight (cholesky.hpp).
inline std::ptrdiff_t padded_factor(const Model& m) { return (std::ptrdiff_t(m.n.nv) + 7) & ~std::ptrdiff_t(7); }

// Capacity for one component of all columns of S, to be read eight at a time.
inline std::ptrdiff_t padded_regressor(const Model& m) { return (std::ptrdiff_t(m.n.nvx) + 14) / 8 * 8; }

}  // namespace dyn
