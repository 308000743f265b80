// For how many contact points a step has room by default. A body that flies freely may lie in a heap, where a convex shape
// touches up to twelve others: six pairs a shape, each with as many points as its faces make. Shapes of robots have eight.
#pragma once

#include "model/model.hpp"

namespace dyn {

inline constexpr std::int64_t pairs_in_heap = 6, max_default_contacts = 50000;  // the latter: 250 MB

// Most contact points of a shape with another.
inline std::int64_t points_of_shape(dynShapeType type) {
  switch (type) {
    case DYN_SHAPE_TYPE_SPHERE:
    case DYN_SHAPE_TYPE_ELLIPSOID: return 1;
    case DYN_SHAPE_TYPE_CAPSULE: return 2;
    default: return 4;
  }
}

inline std::int64_t default_contact_capacity(const Model& m, std::int64_t moving) {
  const std::int64_t least = contact_capacity_of(m, moving);  // what was asked for, or 8 a shape
  if (m.contact_capacity > 0) return least;
  std::int64_t in_heap = 16;
  for (Index k = 0; k < m.n.geoms; ++k) {
    const ShapeRecord& s = m.shapes()[m.geoms()[k].shape];
    const Index joint = m.frames()[s.frame].joint;
    const bool flies = joint > 0 && m.joints()[joint].type == DYN_JOINT_TYPE_FREE_FLYER;
    const std::int64_t own = flies ? pairs_in_heap * points_of_shape(dynShapeType(s.type)) : 0;
    if (lists_pairs(m) || joint > 0) in_heap += std::max<std::int64_t>(8, own);
  }
  if (lists_pairs(m)) in_heap = std::min(in_heap, 8 * std::int64_t(m.n.pairs));
  return std::max(least, std::min(in_heap, max_default_contacts));
}

}  // namespace dyn
