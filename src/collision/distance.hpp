// Signed distance, normal and witness points of any two shapes.
#pragma once

#include "collision/result.hpp"
#include "collision/workspace.hpp"

namespace dyn::collision {

// X_WA, X_WB: the shapes' frames in the world. Never allocates; the workspace is scratch.
Result distance(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, Workspace& workspace,
                const Options& options = Options());

// Of the shape's farthest point from its frame's origin.
double bounding_radius(const shape::Shape& s);

}  // namespace dyn::collision
