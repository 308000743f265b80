// The closed list of shapes and the one place that dispatches on them: visit expands to a switch, so that each case inlines. A new
// shape is a file, a line here, and a line in Type (shape.hpp).
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

#define DYN_SHAPES(X) X(HalfSpace) X(Sphere) X(Capsule) X(Box) X(Cylinder) X(Cone) X(Ellipsoid) X(Convex)
// not convex: see surface.hpp
#define DYN_SURFACES(X) X(Triangles) X(HeightField)

// of convex types, which come first
inline constexpr int type_count = 0
#define DYN_COUNT(S) +1
    DYN_SHAPES(DYN_COUNT)
#undef DYN_COUNT
    ;

// f(S(shape))
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
