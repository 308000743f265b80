// Contact points between a robot's collision shapes.
#pragma once

#include "collision/manifold.hpp"
#include "model/data.hpp"

namespace dyn::collision {

// As in dyn.h, without a pair.
inline dynContact contact_of(const Manifold& m, int i) {
  dynContact c{};
  c.pair = c.shape_a = c.shape_b = -1;
  c.feature = m.points[i].feature, c.distance = m.points[i].distance;
  store3(m.points[i].position, c.position), store3(m.normal, c.normal);
  return c;
}

// Order by shapes (that is, by pairs), then by features.
inline bool comes_before(const dynContact& a, const dynContact& b) {
  return a.shape_a != b.shape_a ? a.shape_a < b.shape_a : a.shape_b != b.shape_b ? a.shape_b < b.shape_b : a.feature < b.feature;
}

// Contacts of all tested pairs within the margin, in that order. Writes the first `capacity` and returns their total number.
Index contacts(const Model& m, Data<double>& d, double margin, dynContact* out, Index capacity);

}  // namespace dyn::collision
