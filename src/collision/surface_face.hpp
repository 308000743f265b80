// Depth of a convex shape that penetrates a surface from the side of its centre. The shortest way out of a single triangle may
// lead sideways, past an edge behind which the surface continues. Example: a box corner over a vertex of a floor. The way out is
// then through the face above the lowest point.
#pragma once

#include "surface_bounds.hpp"

namespace dyn::collision {

struct FaceAbove {
  double depth = infinity;  // of the lowest point below the face's plane
  Vec normal, lowest;       // of the face, towards the shape; support point of the shape against it
};

// Corners of all triangles that touch a region, in the surface's frame. f returns false to end the search.
template <class S, class F>
inline void each_triangle(const S& s, const Bounds& region, F&& f) {
  double limit = 0;
  Vec corner[3];
  search(s, limit, [&](const auto& node) { return distance_between(s.box(node), region) > s.radius ? infinity : 0; },
         [&](auto node) {
           for (Index i = 0, count = s.pieces(node); i < count && limit == 0; ++i) {
             s.triangle(node, i, corner);
             if (!f(corner)) limit = -1;
           }
         });
}

// Returns whether the line through p along the normal meets the triangle. A tolerance at the edges leaves no gaps between
// neighbours.
inline bool above(const Vec corner[3], const Vec& p, const Vec& normal) {
  constexpr double edge = 1e-9;
  const Vec e = corner[1] - corner[0], f = corner[2] - corner[0], s = p - corner[0], n = cross(e, f);
  const double scale = dot(normal, n), u = dot(normal, cross(s, f)) / scale, v = dot(normal, cross(e, s)) / scale;
  return u >= -edge && v >= -edge && u + v <= 1 + edge;
}

template <class S, class B>
inline FaceAbove face_above(const S& s, const B& b, const Pose& X, const Vec& center, const Bounds& region) {
  FaceAbove best;
  each_triangle(s, region, [&](const Vec corner[3]) {
    const Vec n = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double length = norm(n), side = s.closed() ? 1 : std::copysign(1.0, dot(n, center - corner[0]));
    const Vec m = n * (side / length);
    const Vec lowest = farthest(b, X, -m);
    const double depth = dot(m, corner[0] - lowest) + s.radius;
    if (depth > 0 && depth < best.depth && above(corner, lowest, m)) best = {depth, m, lowest};
    return true;
  });
  return best;
}

// Returns whether the translation of r leaves the lowest point under the surface, not past its border.
template <class S>
inline bool stays_below(const S& s, const FaceAbove& face, const Result& r) {
  const Vec moved = face.lowest - r.normal * r.distance, around = Vec::make(face.depth, face.depth, face.depth) * 2;
  bool below = false;
  each_triangle(s, {moved - around, moved + around}, [&](const Vec corner[3]) {
    const Vec n = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double along = dot(face.normal, n);
    if (s.closed() ? along > 0 : along != 0) {
      const double height = dot(n, moved - corner[0]) / along - s.radius;
      below = height < -1e-6 * face.depth && height >= -2 * face.depth && above(corner, moved, face.normal);
    }
    return !below;
  });
  return below;
}

}  // namespace dyn::collision
