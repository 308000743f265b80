// Small surfaces for tests: a pyramid, a field of nine heights, the pyramid's hull (NULL without qhull).
#pragma once

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
    return type == DYN_SHAPE_TYPE_TRIANGLES ? pyramid : type == DYN_SHAPE_TYPE_HEIGHT_FIELD ? field : type == DYN_SHAPE_TYPE_CONVEX ? hull : nullptr;
  }
};

}  // namespace dyn_test
