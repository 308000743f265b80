// Collision shapes of a robot, as queries read them.
#pragma once

#include "collision/distance.hpp"
#include "model/model.hpp"

namespace dyn::collision {

// A shape and its pose in its body's internal frame.
struct Geom {
  shape::Shape shape;
  Pose X;
  Index body;
  double bounding_radius;  // about the shape's origin, m
};

// Collision groups, a bit each: the groups of the shape, and those it collides with. Two shapes collide if one of them wants the
// other (MuJoCo's rule).
struct Masks {
  std::uint32_t contype, conaffinity;
};
inline bool masks_allow(const Masks& a, const Masks& b) { return (a.contype & b.conaffinity) != 0 || (b.contype & a.conaffinity) != 0; }

// Bounds of lengths in metres: within them no product of sizes and distances overflows or underflows.
inline constexpr double smallest = 1e-12, largest = 1e12;

// Number of sizes of a type, which are positive lengths. A mesh has scale factors instead.
inline int size_count(dynShapeType type) {
  switch (type) {
    case DYN_SHAPE_TYPE_BOX: case DYN_SHAPE_TYPE_ELLIPSOID: return 3;
    case DYN_SHAPE_TYPE_SPHERE: return 1;
    case DYN_SHAPE_TYPE_CYLINDER: case DYN_SHAPE_TYPE_CAPSULE: case DYN_SHAPE_TYPE_CONE: return 2;
    case DYN_SHAPE_TYPE_HALF_SPACE: case DYN_SHAPE_TYPE_MESH: case DYN_SHAPE_TYPE_CONVEX: case DYN_SHAPE_TYPE_TRIANGLES: case DYN_SHAPE_TYPE_HEIGHT_FIELD: break;
  }
  return 0;
}

// From a model's sizes (radius, length) to those of the core (semi-axes, half lengths). Pointers stay null. Returns false for
// meshes, of which only the name is known.
inline bool geometry_of(dynShapeType type, const double* size, double radius, shape::Shape& out) {
  using shape::Type;
  out = {Type::Sphere, radius, Vec::zero(), nullptr};
  switch (type) {
    case DYN_SHAPE_TYPE_BOX: out.type = Type::Box, out.size = load3(size) * 0.5; return true;
    case DYN_SHAPE_TYPE_SPHERE: out.radius += size[0]; return true;
    case DYN_SHAPE_TYPE_CYLINDER: out.type = Type::Cylinder, out.size = Vec::make(size[0], size[0], size[1] / 2); return true;
    case DYN_SHAPE_TYPE_CAPSULE: out.type = Type::Capsule, out.size = Vec::make(0, 0, size[1] / 2), out.radius += size[0]; return true;
    case DYN_SHAPE_TYPE_CONE: out.type = Type::Cone, out.size = Vec::make(size[0], size[0], size[1] / 2); return true;
    case DYN_SHAPE_TYPE_ELLIPSOID: out.type = Type::Ellipsoid, out.size = load3(size); return true;
    case DYN_SHAPE_TYPE_HALF_SPACE: out.type = Type::HalfSpace; return true;
    case DYN_SHAPE_TYPE_CONVEX: out.type = Type::Convex; return true;
    case DYN_SHAPE_TYPE_TRIANGLES: out.type = Type::Triangles; return true;
    case DYN_SHAPE_TYPE_HEIGHT_FIELD: out.type = Type::HeightField; return true;
    case DYN_SHAPE_TYPE_MESH: break;
  }
  return false;
}

// d: holds the hulls, trees and grids that shapes point to
template <class D>
Geom geom_of(const Model& m, const D& d, Index geom) {
  const ShapeRecord& s = m.shapes()[m.geoms()[geom].shape];
  const FrameRecord& f = m.frames()[s.frame];
  Geom g;
  geometry_of(s.type, s.size, s.radius, g.shape);
  if (g.shape.type == shape::Type::Convex) g.shape.hull = d.hulls + s.surface;
  if (g.shape.type == shape::Type::Triangles) g.shape.triangles = d.trees + s.surface;
  if (g.shape.type == shape::Type::HeightField) g.shape.grid = d.grids + s.surface;
  g.X = f.X * load_se3(s.placement);
  g.body = f.body;
  g.bounding_radius = bounding_radius(g.shape);
  return g;
}

// Fills the fields of data that belong to shapes.
template <class D>
void set_up(const Model& m, D& d) {
  auto place = [&]<class T>(T* to, const Stored<T>* from, Index count) {
    for (Index k = 0; k < count; ++k) to[k] = view(from[k].header, m.surface_numbers() + from[k].numbers, m.surface_indices() + from[k].indices);
  };
  place(d.hulls, m.hulls(), m.n.hulls), place(d.trees, m.trees(), m.n.trees), place(d.grids, m.grids(), m.n.grids);
  for (Index k = 0; k < m.n.geoms; ++k) {
    d.geoms[k] = geom_of(m, d, k);
    const ShapeRecord& s = m.shapes()[m.geoms()[k].shape];
    d.geom_masks[k] = {s.contype, s.conaffinity};
  }
  for (Index k = 0; k < m.n.pairs; ++k) d.pair_states[k] = dynPairReason(m.pairs()[k].reason);
}

}  // namespace dyn::collision
