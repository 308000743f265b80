// Signed distance, normal and witness points of any two shapes.
#pragma once

#include "collision/result.hpp"
#include "collision/workspace.hpp"

namespace dyn::collision {

// X_WA, X_WB: poses of the shapes' frames in the world. Never allocates. The workspace is scratch.
Result distance(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, Workspace& workspace,
                const Options& options = Options());

// Radius of the smallest sphere about the frame's origin that holds the shape, m.
double bounding_radius(const shape::Shape& s);

}  // namespace dyn::collision
