// Contact points of triangle meshes and height fields with any shape.
#pragma once

#include "collision/manifold.hpp"
#include "collision/manifold_clip.hpp"

namespace dyn::collision {

// Input of the search: the nearest points of the two shapes, and tolerances.
struct ContactSearch {
  const Result& nearest;
  double margin, band;  // m; band: depth below the nearest point that is searched
  double eps, same;     // m; eps: tolerance of lines and planes; same: points closer are one
  const ContactPlane& plane;
};

// Corners of the overlaps of all facing triangles: their convex hull along the normal and the deepest point. The hull merges
// coplanar triangles. At least one shape is a surface.
void surface_overlap(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, const ContactSearch& s,
                     Overlap& out);

}  // namespace dyn::collision
