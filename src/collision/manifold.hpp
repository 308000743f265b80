// Contact points of two shapes: the overlap of the features that face each other along the common normal.
#pragma once

#include <cstdint>

#include "collision/distance.hpp"

namespace dyn::collision {

// One contact point in the world, half way between the shapes. The points on the shapes are position -+ distance/2 normal.
struct Contact {
  Vec position;
  double distance;        // along the normal, m; negative: depth
  std::uint64_t feature;  // features of A and B that the point lies on, 32 bits each (part_of in manifold_clip.hpp)
};

struct Manifold {
  static constexpr int most = 8;
  Vec normal;  // unit, from A to B
  int count = 0;
  Contact points[most];  // ascending by feature, so order and identity persist while the features do
};

inline void clear(Manifold& out) { out.count = 0, out.normal = Vec::zero(); }
inline constexpr Options default_options{};

// Points at a distance of at most margin (m). Of more than eight, keeps the deepest and those that span the largest area. Two
// half-spaces have none. Never allocates.
void contacts(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, double margin,
              Workspace& workspace, Manifold& out, const Options& options = default_options);
// The same with a known distance.
void contacts(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, const Result& distance,
              double margin, Manifold& out);

}  // namespace dyn::collision
