// Triangle meshes and height fields for tests, and brute-force queries over all pieces.
#pragma once

#include "collision/scene.hpp"
#include "model/builder.hpp"
#include "shape/list.hpp"
#include "model/builder_surface.hpp"

namespace dyn_test {

struct Faceted {
  std::vector<double> vertices;
  std::vector<Index> triangles;
  SurfacePtr surface;
  shape::TriangleTree tree{};
  shape::Grid grid{};
  Shape shape{};

  Faceted() = default;
  Faceted(const Faceted&) = delete;  // the shape points to its own arrays
  Faceted& operator=(const Faceted&) = delete;

  Index count() const { return Index(triangles.size() / 3); }
  Vec corner(Index t, int k) const { return load3(vertices.data() + 3 * triangles[3 * std::size_t(t) + std::size_t(k)]); }
  void vertex(const Vec& p) { vertices.insert(vertices.end(), {p[0], p[1], p[2]}); }
  void triangle(Index a, Index b, Index c) { triangles.insert(triangles.end(), {a, b, c}); }
  void finish(bool closed, double radius = 0) {
    surface = triangle_tree(vertices, triangles, closed);
    tree = std::get<Held<shape::TriangleTree>>(surface->held).view();
    shape = {Type::Triangles, radius, Vec::zero(), nullptr, &tree};
  }
  void finish_field(const std::vector<double>& heights, Index columns, Index rows, double step_x, double step_y, double bottom,
                    double radius = 0) {
    surface = height_grid(heights.data(), columns, rows, step_x, step_y, bottom);
    grid = std::get<Held<shape::Grid>>(surface->held).view();
    shape = {Type::HeightField, radius, Vec::zero(), nullptr, nullptr, &grid};
    for (Index j = 0; j < rows; ++j)
      for (Index i = 0; i < columns; ++i) vertex(grid.at(i, j));
    for (Index j = 0; j + 1 < rows; ++j)
      for (Index i = 0; i + 1 < columns; ++i) {
        const Index a = j * columns + i, b = a + columns;
        triangle(a, a + 1, b + 1), triangle(a, b + 1, b);
      }
  }
  // the piece of a triangle
  void piece(Index t, shape::Facet& f) const {
    if (shape.type == Type::Triangles) f.triangle(corner(t, 0), corner(t, 1), corner(t, 2));
    else f.prism(corner(t, 0), corner(t, 1), corner(t, 2), grid.bottom);
  }
};

// The box of make_convex(corners(x, y, z)), two triangles a side.
inline void box_mesh(Faceted& m, double x, double y, double z) {
  for (const Vec& p : corners(x, y, z)) m.vertex(p);
  const Index sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& s : sides) m.triangle(s[0], s[1], s[2]), m.triangle(s[0], s[2], s[3]);
  m.finish(true);
}

// A ring whose tube varies, so that no two triangles are alike. n around, m around the tube.
inline void ring_mesh(Faceted& r, Index n, Index m, double radius = 1, double tube = 0.3) {
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < m; ++j) {
      const double a = 2 * pi * i / n, b = 2 * pi * j / m, t = tube * (1 + 0.2 * std::sin(3 * a + 1));
      r.vertex(Vec::make((radius + t * std::cos(b)) * std::cos(a), (radius + t * std::cos(b)) * std::sin(a), t * std::sin(b)));
    }
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < m; ++j) {
      const Index a = i * m + j, b = (i + 1) % n * m + j, c = (i + 1) % n * m + (j + 1) % m, d = i * m + (j + 1) % m;
      r.triangle(a, b, c), r.triangle(a, c, d);
    }
  r.finish(true);
}

inline void sphere_mesh(Faceted& s, Index n, double radius) {
  s.vertex(Vec::make(0, 0, radius)), s.vertex(Vec::make(0, 0, -radius));
  for (Index i = 1; i < n; ++i)
    for (Index j = 0; j < 2 * n; ++j) {
      const double a = pi * i / n, b = pi * j / n;
      s.vertex(Vec::make(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)) * radius);
    }
  auto at = [&](Index i, Index j) { return i == 0 ? 0 : i == n ? 1 : 2 + (i - 1) * 2 * n + j % (2 * n); };
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < 2 * n; ++j) {
      if (i + 1 < n) s.triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      if (i > 0) s.triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  s.finish(true);
}

inline void hills(Faceted& f, Chance& g, Index columns, Index rows) {
  std::vector<double> h;
  for (Index k = 0; k < columns * rows; ++k) h.push_back(g.uniform(0, 0.4));
  f.finish_field(h, columns, rows, 0.25, 0.2, -0.5);
}

inline Result query(const Shape& a, const Pose& A, const Shape& b, const Pose& B, const collision::Options& o = {}) {
  return collision::distance(a, A, b, B, workspace(), o);
}

// Least distance over the pieces.
inline double every_piece(const Faceted& a, const Pose& A, const Shape& b, const Pose& B) {
  double least = shape::infinity;
  shape::Facet f;
  for (Index t = 0; t < a.count(); ++t) {
    a.piece(t, f);
    least = std::min(least, query(f.shape(a.shape.radius), {A.R, A.act(f.origin)}, b, B).distance);
  }
  return least;
}

inline Pose random_pose(Chance& g, double far) { return {g.rotation(), g.direction() * g.uniform(0, far)}; }

}  // namespace dyn_test
