// For how many contact points a step has room by default. A body that flies freely may lie in a heap, where a convex shape
// touches up to twelve others: six pairs a shape, each with as many points as its faces make. Not all shapes of a robot lie on
// others at once: two points a shape are the average. A hull around a mesh has large faces, and overlaps those of other links: of
// an arm of eleven hulls that fell, each had six. Of more hulls than a dozen few meet anything at once.
#pragma once

#include <algorithm>

#include "model/model.hpp"

namespace dyn {

inline constexpr std::int64_t any_contacts = 16, most_of_pair = 8, pairs_in_heap = 6, least_in_heap = 8, most_of_part = 2;
inline constexpr std::int64_t most_of_hull = 6, hulls_that_meet = 12;
inline constexpr std::int64_t max_default_contacts = 50000;  // 150 MB

// Most contact points of a shape with a plane.
inline std::int64_t points_of_shape(dynShapeType type) {
  switch (type) {
    case DYN_SHAPE_TYPE_SPHERE:
    case DYN_SHAPE_TYPE_ELLIPSOID: return 1;
    case DYN_SHAPE_TYPE_CAPSULE: return 2;
    default: return 4;
  }
}

inline bool has_large_faces(dynShapeType type) { return type == DYN_SHAPE_TYPE_CONVEX || type == DYN_SHAPE_TYPE_TRIANGLES; }

inline std::int64_t contact_capacity_of(const Model& m) {
  const auto carries = [&](Index joint) { return joint + 1 < m.n.joints && m.joints()[joint + 1].parent == joint; };
  std::int64_t room = any_contacts, moving = 0, hulls = 0;
  for (Index k = 0; k < m.n.geoms; ++k) {
    const ShapeRecord& s = m.shapes()[m.geoms()[k].shape];
    const Index joint = m.frames()[s.frame].joint;
    if (joint == 0) continue;
    const bool flies = m.joints()[joint].type == DYN_JOINT_TYPE_FREE_FLYER && m.joints()[joint].parent == 0;
    const std::int64_t points = points_of_shape(dynShapeType(s.type));
    if (flies && !carries(joint)) room += std::max(least_in_heap, pairs_in_heap * points);
    else if (has_large_faces(dynShapeType(s.type)) && hulls++ < hulls_that_meet) room += most_of_hull;
    else room += std::min(points, most_of_part);
    ++moving;
  }
  if (moving == 0) return 0;
  const std::int64_t wanted = m.contact_capacity > 0 ? m.contact_capacity : std::min(room, max_default_contacts);
  return lists_pairs(m) ? std::min(wanted, most_of_pair * m.n.pairs) : wanted;
}

}  // namespace dyn
