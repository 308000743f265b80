// Surfaces (triangle meshes, height fields) against everything.
#pragma once

#include "collision/distance.hpp"

namespace dyn::collision {

constexpr bool is_surface(shape::Type t) { return t >= shape::Type::Triangles; }

// The least signed distance between a piece of the one and a piece of the other, one of which may be convex as a whole. A shape that
// touches no triangle of a closed mesh but lies inside is parted by the plane of the nearest triangle: that depth has no gradient.
Result surface_distance(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, Workspace& workspace,
                        const Options& options);

}  // namespace dyn::collision
