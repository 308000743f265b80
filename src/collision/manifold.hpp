// Contact points between two convex shapes: where the features that face each other along the common normal overlap.
#pragma once

#include <cstdint>

#include "collision/distance.hpp"

namespace dyn::collision {

// One point, in the world. It lies half way between the two shapes, position -+ distance/2 normal on them.
struct Contact {
  Vec position;
  double distance;        // along the normal; below zero: depth
  std::uint64_t feature;  // what of A it lies on, and of B: 32 bits each (part_of in manifold_clip.hpp)
};

struct Manifold {
  static constexpr int most = 8;
  Vec normal;  // unit, from A to B
  int count = 0;
  Contact points[most];  // ascending by feature: identity and order stay while the features do
};

// Points at a distance of at most margin (m). Of more than eight the deepest stays, and those that span the largest area.
// Two half-spaces have none. Never allocates.
void contacts(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, double margin, Workspace& workspace,
              Manifold& out, const Options& options = Options());
// The same, where the distance is known.
void contacts(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, const Result& distance, double margin,
              Manifold& out);

}  // namespace dyn::collision
