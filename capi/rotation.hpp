// What counts as a rotation where one is given.
#pragma once

#include <cmath>

#include "spatial/mat3.hpp"

namespace dyn::capi {

inline bool mirrors(const Mat3<double>& R) { return !(dot(cross(R.x, R.y), R.z) > 0); }
// Right-handed, and orthonormal to 1e-6 in every entry of R^T R.
inline bool is_rotation(const Mat3<double>& R) {
  const Mat3<double> E = transpose(R) * R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (!(std::abs(E(i, j) - (i == j)) <= 1e-6)) return false;
  return !mirrors(R);
}

}  // namespace dyn::capi
