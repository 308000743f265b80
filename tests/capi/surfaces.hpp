// Small surfaces for tests: a pyramid, a field of nine heights, the pyramid's hull (NULL without qhull).
#pragma once

#include <vector>

#include "capi/support.hpp"

namespace dyn_test {

struct Surfaces {
  dynMesh *pyramid = nullptr, *field = nullptr, *hull = nullptr;
  Surfaces() {
    const double corner[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, height[] = {0, 0.1, 0, 0.2, 0.3, 0, 0, 0.1, 0};
    const std::int32_t side[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    EXPECT_EQ(DYN_OK, dyn_mesh_from_arrays(corner, 4, side, 4, &pyramid));
    EXPECT_EQ(DYN_OK, dyn_mesh_from_height_field(with<dynHeightField>({0, 3, 3, height, 1, 1, -1}), &field));
    dyn_mesh_hull(pyramid, &hull);
  }
  Surfaces(const Surfaces&) = delete;
  ~Surfaces() { dyn_mesh_free(pyramid), dyn_mesh_free(field), dyn_mesh_free(hull); }
  // what a shape of this type is made of; NULL: of numbers, or not to be had
  const dynMesh* of(dynShapeType type) const {
    return type == DYN_SHAPE_TYPE_TRIANGLES      ? pyramid
           : type == DYN_SHAPE_TYPE_HEIGHT_FIELD ? field
           : type == DYN_SHAPE_TYPE_CONVEX       ? hull
                                                 : nullptr;
  }
};

// A shape of each type.
inline std::vector<dynGeometry> shapes_of(const Surfaces& surfaces) {
  std::vector<dynGeometry> shapes;
  dynShapeTypeInfo info{};
  info.struct_size = sizeof info;
  for (int k = DYN_SHAPE_TYPE_BOX; dyn_shape_type_info(dynShapeType(k), &info) == DYN_OK; ++k) {
    const dynShapeType type = dynShapeType(k);
    if (type == DYN_SHAPE_TYPE_MESH || (type == DYN_SHAPE_TYPE_CONVEX && !surfaces.hull)) continue;
    dynGeometry g;
    dyn_geometry_init(&g);
    g.type = type, g.surface = surfaces.of(type);
    if (!g.surface) g.size[0] = 0.4, g.size[1] = 0.5, g.size[2] = 0.6;
    shapes.push_back(g);
  }
  return shapes;
}

}  // namespace dyn_test
