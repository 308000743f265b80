// A robot's collision shapes, as queries read them.
#pragma once

#include "dyn/collision/distance.hpp"
#include "dyn/model/model.hpp"

namespace dyn::collision {

// A shape, and where it is in its body's internal frame.
struct Geom {
  shape::Shape shape;
  Pose X;
  Index body;
};

// m: within them no product of sizes and distances overflows or vanishes.
inline constexpr double smallest = 1e-12, largest = 1e12;

// How many sizes a type has, lengths that must be positive; a mesh's are factors.
inline int size_count(dynShapeType type) {
  switch (type) {
    case DYN_SHAPE_BOX: case DYN_SHAPE_ELLIPSOID: return 3;
    case DYN_SHAPE_SPHERE: return 1;
    case DYN_SHAPE_CYLINDER: case DYN_SHAPE_CAPSULE: case DYN_SHAPE_CONE: return 2;
    case DYN_SHAPE_HALF_SPACE: case DYN_SHAPE_MESH: case DYN_SHAPE_CONVEX: case DYN_SHAPE_TRIANGLES: case DYN_SHAPE_HEIGHT_FIELD: break;
  }
  return 0;
}

// Shapes have radius and length where the core has semi-axes and half lengths. Pointers stay empty. False for meshes: of these only the
// name is known.
inline bool geometry_of(dynShapeType type, const double* size, double radius, shape::Shape& out) {
  using shape::Type;
  out = {Type::Sphere, radius, Vec::zero(), nullptr};
  switch (type) {
    case DYN_SHAPE_BOX: out.type = Type::Box, out.size = load3(size) * 0.5; return true;
    case DYN_SHAPE_SPHERE: out.radius += size[0]; return true;
    case DYN_SHAPE_CYLINDER: out.type = Type::Cylinder, out.size = Vec::make(size[0], size[0], size[1] / 2); return true;
    case DYN_SHAPE_CAPSULE: out.type = Type::Capsule, out.size = Vec::make(0, 0, size[1] / 2), out.radius += size[0]; return true;
    case DYN_SHAPE_CONE: out.type = Type::Cone, out.size = Vec::make(size[0], size[0], size[1] / 2); return true;
    case DYN_SHAPE_ELLIPSOID: out.type = Type::Ellipsoid, out.size = load3(size); return true;
    case DYN_SHAPE_HALF_SPACE: out.type = Type::HalfSpace; return true;
    case DYN_SHAPE_CONVEX: out.type = Type::Convex; return true;
    case DYN_SHAPE_TRIANGLES: out.type = Type::Triangles; return true;
    case DYN_SHAPE_HEIGHT_FIELD: out.type = Type::HeightField; return true;
    case DYN_SHAPE_MESH: break;
  }
  return false;
}

inline Geom geom_of(const Model& m, Index geom) {
  const ShapeRecord& s = m.shapes()[m.geoms()[geom].shape];
  const FrameRecord& f = m.frames()[s.frame];
  Geom g;
  geometry_of(s.type, s.size, 0, g.shape);
  g.X = f.X * load_se3(s.placement);
  g.body = f.body;
  return g;
}

// Fills in what of data belongs to shapes.
template <class D>
void set_up(const Model& m, D& d) {
  auto place = [&]<class T>(T* to, const Stored<T>* from, Index count) {
    for (Index k = 0; k < count; ++k) to[k] = view(from[k].header, m.surface_numbers() + from[k].numbers, m.surface_indices() + from[k].indices);
  };
  place(d.hulls, m.hulls(), m.n.hulls), place(d.trees, m.trees(), m.n.trees), place(d.grids, m.grids(), m.n.grids);
  for (Index k = 0; k < m.n.geoms; ++k) {
    d.geoms[k] = geom_of(m, k);
    const Index surface = m.shapes()[m.geoms()[k].shape].surface;
    shape::Shape& s = d.geoms[k].shape;
    if (s.type == shape::Type::Convex) s.hull = d.hulls + surface;
    if (s.type == shape::Type::Triangles) s.triangles = d.trees + surface;
    if (s.type == shape::Type::HeightField) s.grid = d.grids + surface;
  }
  for (Index k = 0; k < m.n.pairs; ++k) d.pair_states[k] = dynPairReason(m.pairs()[k].reason);
}

}  // namespace dyn::collision
