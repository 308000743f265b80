// Shapes, and the hulls, trees and grids that they are: where their arrays lie, and the indices in them.
#include <algorithm>
#include <limits>

#include "block_check.hpp"
#include "model/contact_capacity.hpp"
#include "shape/geometry.hpp"
#include "model/data.hpp"
#include "shape/material.hpp"
#include "table/enums.hpp"

namespace dyn {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool is_length(double x) { return x >= shape::min_length && x <= shape::max_length; }

}  // namespace

// f(view) when all of its arrays are in the block.
template <class T, class F>
bool BlockChecker::surface(const Stored<T>& s, F&& f) {
  std::uint64_t number = s.numbers, entry = s.indices;
  const std::uint64_t max_numbers = std::uint64_t(n.surface_numbers), max_indices = std::uint64_t(n.surface_indices);
  bool good = number <= max_numbers && entry <= max_indices;
  T header = s.header;
  header.each_array([&]<class X>(const X*&, std::size_t count) {
    good = good && std::uint64_t(count) <= std::uint64_t(1) << 31;
    if (!good) return;
    if constexpr (std::is_same_v<X, double>) number += pool_capacity(count);
    else entry += count;
    good = number <= max_numbers && entry <= max_indices;
  });
  return require(good, "a surface is larger than the file") &&
         f(view(s.header, m.surface_numbers() + s.numbers, m.surface_indices() + s.indices));
}

// Offsets of `lists` lists in `total` entries, each below `most`.
bool BlockChecker::lists(const Index* start, Index lists, const Index* entry, Index total, Index most) {
  return require(start[0] == 0 && start[lists] == total, "lists of a hull") &&
      each(lists, [&](Index k) { return require(start[k] <= start[k + 1], "lists of a hull"); }) &&
         each(total, [&](Index k) { return index(entry[k], most, "vertex of a hull"); });
}

bool BlockChecker::hull(const Stored<shape::Hull>& s) {
  const shape::Hull& h = s.header;
  return require(h.vertices >= 1 && h.faces >= 0 && h.corners >= 0 && std::max({h.vertices, h.faces, h.corners}) <= 1 << 26,
                 "size of a hull") &&
         require(std::isfinite(h.extent) && h.extent >= 0 && is_finite(h.center), "numbers of a hull") &&
         surface(s, [&](const shape::Hull& v) {
           return lists(v.face_start, v.faces, v.face_vertices, v.corners, v.vertices) &&
               lists(v.neighbour_start, v.vertices, v.neighbours, v.corners, v.vertices);
         });
}

bool BlockChecker::tree(const Stored<shape::TriangleTree>& s) {
  using shape::TriangleTree;
  const TriangleTree& h = s.header;
  if (!require(h.vertices >= 1 && h.triangles >= 1 && h.nodes >= 1 && std::max({h.vertices, h.triangles, h.nodes}) <= 1 << 26 &&
      (h.closed == 0 || h.closed == 1) &&
                   std::isfinite(h.extent) && h.extent >= 0,
               "header of a tree"))
    return false;
  return surface(s, [&](const TriangleTree& v) {
    if (!each(3 * v.triangles, [&](Index k) { return index(v.corner[k], v.vertices, "vertex of a triangle"); })) return false;
    // depth first: every node once, a first child behind its parent, and none too deep for the stacks that descend
    struct Entry {
      Index node, depth;
    } stack[TriangleTree::max_depth + 2] = {{0, 0}};
    Index visited = 0;
    for (int count = 1; count > 0;) {
      const auto [node, depth] = stack[--count];
      if (!require(node == visited++ && node < v.nodes, "nodes of a tree")) return false;
      const Index first = v.link[2 * std::ptrdiff_t(node)], triangles = v.link[2 * std::ptrdiff_t(node) + 1];
      if (triangles > 0) {
        if (!require(triangles <= TriangleTree::leaf_size && first >= 0 && first <= v.triangles - triangles,
                     "triangles of a leaf"))
          return false;
      } else {
        if (!require(triangles == 0 && first > node + 1 && first < v.nodes && depth < TriangleTree::max_depth,
                     "children of a node"))
          return false;
        stack[count++] = {first, depth + 1}, stack[count++] = {node + 1, depth + 1};
      }
    }
    return require(visited == v.nodes, "nodes of a tree");
  });
}

bool BlockChecker::grid(const Stored<shape::Grid>& s) {
  using shape::Grid;
  const Grid& h = s.header;
  if (!require(h.columns >= 2 && h.rows >= 2 && std::int64_t(h.columns) * h.rows <= Grid::max_heights && h.levels >= 1 &&
      h.levels <= Grid::max_levels, "size of a height field"))
    return false;
  Index first = 0;
  for (Index level = 0; level < h.levels; ++level) {
    const Index x = h.cells_x(level), y = h.cells_y(level);
    if (!require(h.first[level] == first && (x == 1 && y == 1) == (level == h.levels - 1), "levels of a height field"))
      return false;
    first += x * y;
  }
  if (!require(is_length(h.step_x) && is_length(h.step_y) && std::isfinite(h.bottom) && h.extent >= 0 &&
      h.extent <= shape::max_length, "numbers of a height field")) return false;
  return surface(s, [&](const Grid& v) {
    if (!each(v.columns * v.rows,
              [&](Index k) { return require(v.height[k] > v.bottom && std::isfinite(v.height[k]), "height of a height field"); }))
      return false;
    return each(v.levels, [&](Index level) {
      return each(v.cells_x(level) * v.cells_y(level), [&](Index cell) {
        const Index i = cell % v.cells_x(level), j = cell / v.cells_x(level);
        double low = infinity, high = -infinity;
        for (Index b = 0; b < 2; ++b)
          for (Index a = 0; a < 2; ++a) {
            if (level == 0) {
              const double z = v.height[std::ptrdiff_t(j + b) * v.columns + i + a];
              low = std::min(low, z), high = std::max(high, z);
            } else if (const Index x = 2 * i + a, y = 2 * j + b; x < v.cells_x(level - 1) && y < v.cells_y(level - 1)) {
              const double* r = v.range + 2 * (v.first[level - 1] + std::ptrdiff_t(y) * v.cells_x(level - 1) + x);
              low = std::min(low, r[0]), high = std::max(high, r[1]);
            }
          }
        const double* r = v.range + 2 * (v.first[level] + std::ptrdiff_t(cell));
        return require(r[0] == low && r[1] == high, "boxes of a height field");
      });
    });
  });
}

bool BlockChecker::surfaces() {
  return numbers(m.surface_numbers(), n.surface_numbers, "numbers of a surface", [](double x) { return std::isfinite(x); }) &&
         each(n.hulls, [&](Index k) { return hull(m.hulls()[k]); }) &&
         each(n.trees, [&](Index k) { return tree(m.trees()[k]); }) && each(n.grids, [&](Index k) { return grid(m.grids()[k]); });
}

bool BlockChecker::shape(Index k) {
  const ShapeRecord& r = m.shapes()[k];
  if (!text(r.name) || !text(r.mesh) || !index(r.frame, n.frames, "frame of a shape") ||
      !index(r.material, n.materials, "material of a shape"))
    return false;
  if (!require(r.frame == 0 || m.frames()[r.frame].type == DYN_FRAME_TYPE_BODY, "a shape is on no link") ||
      !require(is_value(dynShapeType(r.type)), "type of a shape") ||
      !require(r.role == DYN_SHAPE_ROLE_COLLISION || r.role == DYN_SHAPE_ROLE_VISUAL, "role of a shape"))
    return false;
  static_assert(std::uint32_t(PairFilter::SameBody) == 3);  // any two bits are a filter
  const bool made =
      r.type == DYN_SHAPE_TYPE_CONVEX || r.type == DYN_SHAPE_TYPE_TRIANGLES || r.type == DYN_SHAPE_TYPE_HEIGHT_FIELD;
  const Index surfaces = r.type == DYN_SHAPE_TYPE_CONVEX ? n.hulls : r.type == DYN_SHAPE_TYPE_TRIANGLES ? n.trees : n.grids;
  if (made ? !index(r.surface, surfaces, "surface of a shape") : !require(r.surface == -1, "surface of a shape")) return false;
  return each(shape::size_count(r.type), [&](Index i) { return require(is_length(r.size[i]), "size of a shape"); }) &&
         require(r.radius >= 0 && r.radius <= shape::max_length && are_finite(r.size) && are_finite(r.placement),
                 "numbers of a shape");
}

bool BlockChecker::shapes() {
  Index geoms = 0;
  if (!each(n.materials, [&](Index k) { return require(!shape::bad_number(m.materials()[k]).name, "a material"); }) ||
      !each(n.shapes,
            [&](Index k) {
              if (!shape(k)) return false;
              if (m.shapes()[k].role != DYN_SHAPE_ROLE_COLLISION) return true;
              if (!index(geoms, n.geoms, "a collision shape") || !require(m.geoms()[geoms++].shape == k, "a collision shape"))
                return false;
              return true;
            }) ||
      !require(geoms == n.geoms, "collision shapes"))
    return false;
  // without a wish the file's own room counts, by the rule of the library that wrote it
  const bool room = m.contact_capacity > 0 ? m.contact_capacity <= max_contacts && n.contacts == contact_capacity_of(m)
                                           : m.contact_capacity == 0 && n.contacts >= 0 && n.contacts <= max_default_contacts;
  return require(room, "room for contacts") && each(n.pairs, [&](Index k) {
    const PairRecord& p = m.pairs()[k];
    if (!index(p.a, n.geoms, "shape of a pair") || !index(p.b, n.geoms, "shape of a pair") ||
        !index(p.material(), n.materials + 1, "material of a pair")) return false;
    const bool ascends = k == 0 || m.pairs()[k - 1].a < p.a || (m.pairs()[k - 1].a == p.a && m.pairs()[k - 1].b < p.b);
    return require(p.a < p.b && ascends && carrier(p.a) != carrier(p.b), "order of the pairs") &&
        require(is_value(dynPairReason(p.reason)) && p.reason != DYN_PAIR_REASON_OFF, "reason of a pair") &&
           require(p.reason == DYN_PAIR_REASON_MESH || (m.shapes()[m.geoms()[p.a].shape].type != DYN_SHAPE_TYPE_MESH &&
               m.shapes()[m.geoms()[p.b].shape].type != DYN_SHAPE_TYPE_MESH), "a pair with a mesh is tested");
  });
}

}  // namespace dyn
