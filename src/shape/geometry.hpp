// Sizes of a shape as users give them, turned into the core that queries read.
#pragma once

#include "dyn.h"
#include "shape/list.hpp"

namespace dyn::shape {

// Bounds of lengths in metres: within them no product of sizes and distances overflows or underflows.
inline constexpr double min_length = 1e-12, max_length = 1e12;

// Number of sizes of a type, which are positive lengths. A mesh has scale factors instead.
inline int size_count(dynShapeType type) {
  int count = 0;
  visit_type(type, [&]<class S>() { count = int(S::size_names.size()); });
  return count;
}

// From a model's sizes (radius, length) to those of the core (semi-axes, half lengths). Pointers stay null. Returns false for
// meshes, of which only the name is known.
inline bool geometry_of(dynShapeType type, const double* size, double radius, Shape& out) {
  bool known = false;
  visit_type(type, [&]<class S>() { out = {S::type, radius, Vec::zero(), nullptr}, S::store(size, out), known = true; });
  return known;
}

}  // namespace dyn::shape
