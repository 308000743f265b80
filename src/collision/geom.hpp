// Collision shapes of a robot, as queries read them.
#pragma once

#include <algorithm>

#include "collision/distance.hpp"
#include "model/model.hpp"
#include "shape/geometry.hpp"

namespace dyn::collision {

// A hull of the model, and the faces around its vertices; null: they are not consistent.
struct PlacedHull {
  shape::Hull hull;
  const Index* vertex_faces;
};
inline std::ptrdiff_t hull_corners(const Model& m) {
  std::ptrdiff_t sum = 0;
  for (Index k = 0; k < m.n.hulls; ++k) sum += m.hulls()[k].header.corners;
  return sum;
}

// A shape and its pose in its body's internal frame.
struct Geom {
  shape::Shape shape;
  Pose X;
  Index body;
  double bounding_radius;  // about the shape's origin, m
  Vec box_center, box_half;  // of the box that holds a box or a hull without rounding, in the shape's axes

  bool has_box() const { return shape.type == shape::Type::Box || shape.type == shape::Type::Convex; }
};

inline void set_bounds(Geom& g) {
  g.bounding_radius = bounding_radius(g.shape);
  g.box_center = Vec::zero(), g.box_half = g.shape.size;
  if (g.shape.type == shape::Type::Convex) {
    const shape::Bounds b = shape::Convex(g.shape).bounds(Mat3<double>::identity());
    g.box_center = (b.lower + b.upper) * 0.5, g.box_half = (b.upper - b.lower) * 0.5;
  }
}

// Collision groups, a bit each: the groups of the shape, and those it collides with. Two shapes collide if one of them wants the
// other (MuJoCo's rule).
struct Masks {
  std::uint32_t contype, conaffinity;
};
inline bool masks_allow(const Masks& a, const Masks& b) {
  return (a.contype & b.conaffinity) != 0 || (b.contype & a.conaffinity) != 0;
}

// The geom of a shape of the model; -1: it is no collision shape. Geoms are ascending by shape.
inline Index geom_of_shape(const Model& m, Index shape) {
  const GeomRecord *const begin = m.geoms(), *const end = begin + m.n.geoms;
  const GeomRecord* const g =
      std::lower_bound(begin, end, shape, [](const GeomRecord& x, Index s) { return x.shape < s; });
  return g != end && g->shape == shape ? Index(g - begin) : -1;
}

// Whether a mocap body carries it.
inline bool on_mocap(const Model& m, Index geom) {
  return m.frames()[m.shapes()[m.geoms()[geom].shape].frame].place >= m.n.bodies;
}

using shape::geometry_of;
using shape::size_count;

// d: holds the hulls, trees and grids that shapes point to
template <class D>
Geom geom_of(const Model& m, const D& d, Index geom) {
  const ShapeRecord& s = m.shapes()[m.geoms()[geom].shape];
  const FrameRecord& f = m.frames()[s.frame];
  Geom g;
  if (!geometry_of(s.type, s.size, s.radius, g.shape))
    g.shape = {shape::Type::Sphere, 0, shape::Vec::zero(), nullptr};  // the name of a mesh: a point, in no tested pair
  if (g.shape.type == shape::Type::Convex)
    g.shape.hull = &d.hulls[s.surface].hull, g.shape.vertex_faces = d.hulls[s.surface].vertex_faces;
  if (g.shape.type == shape::Type::Triangles) g.shape.triangles = d.trees + s.surface;
  if (g.shape.type == shape::Type::HeightField) g.shape.grid = d.grids + s.surface;
  g.X = f.X * load_se3(s.placement);
  g.body = f.body;
  set_bounds(g);
  return g;
}

// Fills the fields of data that belong to shapes.
template <class D>
void set_up(const Model& m, D& d) {
  const auto placed = [&](const auto& s) {
    return view(s.header, m.surface_numbers() + s.numbers, m.surface_indices() + s.indices);
  };
  Index* faces = d.hull_faces;
  for (Index k = 0; k < m.n.hulls; ++k) {
    PlacedHull& h = d.hulls[k];
    h.hull = placed(m.hulls()[k]);
    h.vertex_faces = shape::list_vertex_faces(h.hull, faces) ? faces : nullptr;
    faces += h.hull.corners;
  }
  for (Index k = 0; k < m.n.trees; ++k) d.trees[k] = placed(m.trees()[k]);
  for (Index k = 0; k < m.n.grids; ++k) d.grids[k] = placed(m.grids()[k]);
  for (Index k = 0; k < m.n.geoms; ++k) {
    d.geoms[k] = geom_of(m, d, k);
    const ShapeRecord& s = m.shapes()[m.geoms()[k].shape];
    d.geom_masks[k] = {s.contype, s.conaffinity};
  }
  for (Index k = 0; k < m.n.pairs; ++k) d.pair_states[k] = dynPairReason(m.pairs()[k].reason);
}

}  // namespace dyn::collision
