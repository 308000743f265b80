// Sizes of a shape as users give them, turned into the core that queries read.
#pragma once

#include "dyn.h"
#include "shape/shape.hpp"

namespace dyn::shape {

// Bounds of lengths in metres: within them no product of sizes and distances overflows or underflows.
inline constexpr double min_length = 1e-12, max_length = 1e12;

// Number of sizes of a type, which are positive lengths. A mesh has scale factors instead.
inline int size_count(dynShapeType type) {
  switch (type) {
    case DYN_SHAPE_TYPE_BOX: case DYN_SHAPE_TYPE_ELLIPSOID: return 3;
    case DYN_SHAPE_TYPE_SPHERE: return 1;
    case DYN_SHAPE_TYPE_CYLINDER: case DYN_SHAPE_TYPE_CAPSULE: case DYN_SHAPE_TYPE_CONE: return 2;
    case DYN_SHAPE_TYPE_HALF_SPACE: case DYN_SHAPE_TYPE_MESH: case DYN_SHAPE_TYPE_CONVEX: case DYN_SHAPE_TYPE_TRIANGLES: case DYN_SHAPE_TYPE_HEIGHT_FIELD: break;
  }
  return 0;
}

// From a model's sizes (radius, length) to those of the core (semi-axes, half lengths). Pointers stay null. Returns false for
// meshes, of which only the name is known.
inline bool geometry_of(dynShapeType type, const double* size, double radius, Shape& out) {
  out = {Type::Sphere, radius, Vec::zero(), nullptr};
  switch (type) {
    case DYN_SHAPE_TYPE_BOX: out.type = Type::Box, out.size = load3(size) * 0.5; return true;
    case DYN_SHAPE_TYPE_SPHERE: out.radius += size[0]; return true;
    case DYN_SHAPE_TYPE_CYLINDER: out.type = Type::Cylinder, out.size = Vec::make(size[0], size[0], size[1] / 2); return true;
    case DYN_SHAPE_TYPE_CAPSULE: out.type = Type::Capsule, out.size = Vec::make(0, 0, size[1] / 2), out.radius += size[0]; return true;
    case DYN_SHAPE_TYPE_CONE: out.type = Type::Cone, out.size = Vec::make(size[0], size[0], size[1] / 2); return true;
    case DYN_SHAPE_TYPE_ELLIPSOID: out.type = Type::Ellipsoid, out.size = load3(size); return true;
    case DYN_SHAPE_TYPE_HALF_SPACE: out.type = Type::HalfSpace; return true;
    case DYN_SHAPE_TYPE_CONVEX: out.type = Type::Convex; return true;
    case DYN_SHAPE_TYPE_TRIANGLES: out.type = Type::Triangles; return true;
    case DYN_SHAPE_TYPE_HEIGHT_FIELD: out.type = Type::HeightField; return true;
    case DYN_SHAPE_TYPE_MESH: break;
  }
  return false;
}

}  // namespace dyn::shape
