// Shapes by themselves, and placements along the axes of the world.
#pragma once

#include "capi/support.hpp"

namespace dyn_test {

inline constexpr double identity[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};

inline dynGeometry geometry(dynShapeType type, double x, double y = 0, double z = 0, double radius = 0) {
  dynGeometry g;
  dyn_geometry_init(&g);
  g.type = type, g.size[0] = x, g.size[1] = y, g.size[2] = z, g.radius = radius;
  return g;
}
inline std::array<double, 12> at(double x, double y, double z) {
  std::array<double, 12> X;
  std::copy(identity, identity + 12, X.begin());
  X[9] = x, X[10] = y, X[11] = z;
  return X;
}

}  // namespace dyn_test
