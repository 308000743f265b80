// Contact points between a robot's collision shapes.
#pragma once

#include "collision/manifold.hpp"
#include "model/data.hpp"

namespace dyn::collision {

// As dyn.h has them; of no pair.
inline dynContact contact_of(const Manifold& m, int i) {
  dynContact c{};
  c.pair = c.shape_a = c.shape_b = -1;
  c.feature = m.points[i].feature, c.distance = m.points[i].distance;
  store3(m.points[i].position, c.position), store3(m.normal, c.normal);
  return c;
}

// By shapes (which is by pairs), then by features.
inline bool comes_before(const dynContact& a, const dynContact& b) {
  return a.shape_a != b.shape_a ? a.shape_a < b.shape_a : a.shape_b != b.shape_b ? a.shape_b < b.shape_b : a.feature < b.feature;
}

// Of all tested pairs, at a distance of at most margin, by shapes, then by features: the first `capacity` of them. Answers how many
// there are.
Index contacts(const Model& m, Data<double>& d, double margin, dynContact* out, Index capacity);

}  // namespace dyn::collision
