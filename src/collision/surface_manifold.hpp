// Contact points of triangle meshes and height fields, each alone, together, or against a convex shape or a half-space.
#pragma once

#include "collision/manifold.hpp"
#include "collision/manifold_clip.hpp"

namespace dyn::collision {

// What contacts are cut from: the nearest points of two shapes are known, others count up to the margin.
struct ContactSearch {
  const Result& nearest;
  double margin, band;  // m; band: how far below the nearest point a surface may lie
  double eps, same;     // m; within eps points are on one line or one plane, within same they are one
  const ContactPlane& plane;
};

// The corners of the overlaps of all triangles that turn to the other shape: their convex hull seen along the normal, which merges triangles
// of one plane, and the deepest of all points. At least one shape is a surface.
void surface_overlap(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, const ContactSearch& s, Overlap& out);

}  // namespace dyn::collision
