// Where the coefficients of kept rows in dropped ones lie: a column for each dropped row, over the kept rows in ascending order.
// There are at most a quarter as many as entries of a matrix between rows; the rest of d.row_dependence is free.
#pragma once

#include "model/model.hpp"

namespace dyn {

// Bytes of d.row_dependence that drop_redundant_rows may write.
inline std::size_t dependence_bytes(const Model& m) {
  const std::size_t rows = std::size_t(m.n.constraint_rows);
  return sizeof(double) * ((rows * rows + 3) / 4);
}

}  // namespace dyn
