// A height field: heights over a grid, two triangles a cell, solid down to a floor. The arrays lie elsewhere. They hold minimum
// and maximum heights of 2 x 2, 4 x 4, ... cells, which form a tree of boxes.
#pragma once

#include "shape/surface.hpp"

namespace dyn::shape {

// Arrays of a HeightField. The grid is centred: point (column i, row j) has x = (i - (columns - 1) / 2) step_x, y likewise. Cells
// have the number of their lower corner. A cell of level k covers 2^k x 2^k cells of the grid, fewer at the border.
struct Grid {
  static constexpr Index max_levels = 24;
  static constexpr std::int64_t max_heights = 5000000;  // 10^7 triangles

  Index columns, rows;  // of points, at least 2
  Index levels;         // the last one is a single cell
  double step_x, step_y, bottom;
  double extent;        // farthest point from the origin
  Index first[max_levels];  // start of each level in range
  alignas(8) const double* height; // columns * rows, row by row
  alignas(8) const double* range;  // 2 a cell: minimum and maximum height

  Index cells_x(Index level) const { return ((columns - 2) >> level) + 1; }
  Index cells_y(Index level) const { return ((rows - 2) >> level) + 1; }
  std::size_t cells() const { return std::size_t(first[levels - 1]) + 1; }

  // Calls f for the arrays, in stored order.
  template <class F>
  void each_array(F&& f) {
    f(height, std::size_t(columns) * std::size_t(rows)), f(range, 2 * cells());
  }
  double x(Index i) const { return (i - (columns - 1) * 0.5) * step_x; }
  double y(Index j) const { return (j - (rows - 1) * 0.5) * step_y; }
  Vec at(Index i, Index j) const { return Vec::make(x(i), y(j), height[std::ptrdiff_t(j) * columns + i]); }
};

struct HeightField : Surface<HeightField> {
  static constexpr Type type = Type::HeightField;
  static constexpr dynShapeType id = DYN_SHAPE_TYPE_HEIGHT_FIELD;
  static constexpr bool from_surface = true;
  const Grid& grid;
  double radius;

  explicit HeightField(const Shape& s) : grid(*s.grid), radius(s.radius) {}

  struct Node {
    Index level, i, j;
  };
  static constexpr Index max_children = 4, max_stack = 3 * Grid::max_levels + 4;
  static Node root(const HeightField& s) { return {s.grid.levels - 1, 0, 0}; }
  Bounds box(const Node& n) const {
    const double* r = grid.range + 2 * (grid.first[n.level] + std::ptrdiff_t(n.j) * grid.cells_x(n.level) + n.i);
    const Index i = std::min((n.i + 1) << n.level, grid.columns - 1), j = std::min((n.j + 1) << n.level, grid.rows - 1);
    return {Vec::make(grid.x(n.i << n.level), grid.y(n.j << n.level), grid.bottom), Vec::make(grid.x(i), grid.y(j), r[1])};
  }
  Slab slab(const Node& n) const {
    const Bounds b = box(n);
    return {axis(2), b.lower[2], b.upper[2]};
  }
  Index split(const Node& n, Node* out) const {
    if (n.level == 0) return 0;
    Index count = 0;
    const Index below = n.level - 1, nx = grid.cells_x(below), ny = grid.cells_y(below);
    for (Index j = 2 * n.j; j < std::min(2 * n.j + 2, ny); ++j)
      for (Index i = 2 * n.i; i < std::min(2 * n.i + 2, nx); ++i) out[count++] = {below, i, j};
    return count;
  }
  Index pieces(const Node&) const { return 2; }
  void triangle(const Node& n, Index k, Vec corner[3]) const {
    corner[0] = grid.at(n.i, n.j);
    corner[1] = k == 0 ? grid.at(n.i + 1, n.j) : grid.at(n.i + 1, n.j + 1);
    corner[2] = k == 0 ? grid.at(n.i + 1, n.j + 1) : grid.at(n.i, n.j + 1);
  }
  int number(const Node& n, Index piece, int k) const {
    const Index right = k == 0 || (piece == 1 && k == 2) ? 0 : 1, up = k == 0 || (piece == 0 && k == 1) ? 0 : 1;
    return (n.j + up) * grid.columns + n.i + right;
  }
  void piece(const Node& n, Index k, Facet& f) const {
    Vec corner[3];
    triangle(n, k, corner);
    f.prism(corner[0], corner[1], corner[2], grid.bottom);
  }
  bool closed() const { return true; }
  double extent() const { return grid.extent; }

  // Outside: nearest point of the pieces. Inside: of the triangles, the walls and the floor.
  Nearest nearest(const Vec& p) const {
    if (!inside(p)) return nearest_piece(p);
    Nearest n = nearest_triangle(p);
    n.normal = n.distance > 0 ? -n.normal : n.normal;
    n.distance = -n.distance;
    const double wall_x = grid.x(grid.columns - 1), wall_y = grid.y(grid.rows - 1);
    auto consider = [&](int axis_of, double sign, double at) {
      const double d = sign * p[axis_of] - at;  // negative inside
      if (d < n.distance) return;
      n.unique = d > n.distance;
      const Vec normal = axis(axis_of) * sign;
      n.normal = normal, n.distance = d, n.point = p - normal * d;
    };
    consider(0, 1, wall_x), consider(0, -1, wall_x), consider(1, 1, wall_y), consider(1, -1, wall_y),
        consider(2, -1, -grid.bottom);
    return n;
  }
  bool inside(const Vec& p) const {
    const double u = p[0] / grid.step_x + (grid.columns - 1) * 0.5, v = p[1] / grid.step_y + (grid.rows - 1) * 0.5;
    if (!(u >= 0 && v >= 0 && u <= grid.columns - 1 && v <= grid.rows - 1 && p[2] >= grid.bottom)) return false;
    const Index i = std::min(Index(u), grid.columns - 2), j = std::min(Index(v), grid.rows - 2);
    const double s = u - i, t = v - j, a = grid.at(i, j)[2], b = grid.at(i + 1, j)[2], c = grid.at(i + 1, j + 1)[2],
                 d = grid.at(i, j + 1)[2];
    return p[2] <= (s >= t ? a + s * (b - a) + t * (c - b) : a + t * (d - a) + s * (c - d));
  }

  Inertia<double> solid() const {
    Inertia<double> Y = Inertia<double>::zero();
    Facet f;
    for (Index j = 0; j + 1 < grid.rows; ++j)
      for (Index i = 0; i + 1 < grid.columns; ++i)
        for (Index k = 0; k < 2; ++k) {
          piece({0, i, j}, k, f);
          Y = Y + Convex(f.shape(0)).solid().shifted(f.origin);
        }
    return Y;
  }
};

}  // namespace dyn::shape
