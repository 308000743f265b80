// Distances of surfaces (triangle meshes, height fields) to any shape.
#pragma once

#include "collision/distance.hpp"

namespace dyn::collision {

constexpr bool is_surface(shape::Type t) { return t >= shape::Type::Triangles; }

// Least signed distance between pieces of the two shapes; one may be convex as a whole. A shape inside a closed mesh that touches
// no triangle is separated by the nearest triangle's plane. That depth has no gradient.
Result surface_distance(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, Workspace& workspace,
                        const Options& options);

}  // namespace dyn::collision
