// The closed list of shapes and their only dispatch. visit expands to a switch, so each case inlines. A new shape is a file, its
// name in DYN_SHAPES (shape.hpp), and its include here.
#pragma once

#include "shape/box.hpp"
#include "shape/capsule.hpp"
#include "shape/cone.hpp"
#include "shape/convex.hpp"
#include "shape/cylinder.hpp"
#include "shape/ellipsoid.hpp"
#include "shape/half_space.hpp"
#include "shape/height_field.hpp"
#include "shape/sphere.hpp"
#include "shape/triangles.hpp"

namespace dyn::shape {

// number of convex types, which come first
inline constexpr int type_count = 0
#define DYN_COUNT(S) +1
    DYN_SHAPES(DYN_COUNT)
#undef DYN_COUNT
    ;

// Calls f.template operator()<S>() for each convex shape.
template <class F>
constexpr void each_shape(F&& f) {
#define DYN_EACH(S) f.template operator()<S>();
  DYN_SHAPES(DYN_EACH)
#undef DYN_EACH
}

// f.template operator()<S>() for the shape of that type; nothing for MESH and unknown types.
template <class F>
void visit_type(dynShapeType type, F&& f) {
#define DYN_TRY(S) \
  if (type == S::id) return f.template operator()<S>();
  DYN_SHAPES(DYN_TRY)
  DYN_SURFACES(DYN_TRY)
#undef DYN_TRY
}

// calls f(S(shape)) for the shape's class S
template <class F>
DYN_INLINE void visit(const Shape& shape, F&& f) {
  switch (shape.type) {
#define DYN_CASE(S) \
  case Type::S:     \
    f(S(shape));    \
    break;
    DYN_SHAPES(DYN_CASE)
    DYN_SURFACES(DYN_CASE)
#undef DYN_CASE
  }
}

}  // namespace dyn::shape
