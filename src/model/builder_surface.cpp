// Trees of boxes: over triangles, split at the median of their middles across the longest side; over the cells of a grid, two by
// two.
#include "builder_surface.hpp"

#include <algorithm>
#include <cmath>

#include "builder_impl.hpp"
#include "shape/geometry.hpp"

namespace dyn {

namespace {

using shape::Bounds, shape::Grid, shape::TriangleTree, shape::Vec;
using shape::axis, shape::greater, shape::infinity, shape::lesser, shape::norm;

struct TreeMaker {
  const std::vector<double>& vertices;
  const std::vector<Index>& triangles;
  std::vector<Index> order;     // triangles, as the leaves have them
  std::vector<Vec3<double>> middles;
  std::vector<double> boxes, slabs;
  std::vector<Index> links;

  const double* corner(Index t, int k) const {
    return vertices.data() + 3 * std::ptrdiff_t(triangles[3 * std::size_t(t) + std::size_t(k)]);
  }

  void run() {
    const Index n = Index(triangles.size() / 3);
    for (Index t = 0; t < n; ++t)
      order.push_back(t), middles.push_back((load3(corner(t, 0)) + load3(corner(t, 1)) + load3(corner(t, 2))) * (1.0 / 3));
    node(0, n);
  }

  void add_slab(Index begin, Index end) {
    Vec sum = Vec::zero();
    for (Index i = begin; i < end; ++i) {
      const Vec a = load3(corner(order[std::size_t(i)], 0));
      sum += cross(load3(corner(order[std::size_t(i)], 1)) - a, load3(corner(order[std::size_t(i)], 2)) - a);
    }
    const double length = norm(sum);
    const Vec n = length > 0 ? sum * (1 / length) : axis(2);
    double low = infinity, high = -infinity;
    for (Index i = begin; i < end; ++i)
      for (int k = 0; k < 3; ++k) {
        const double h = dot(n, load3(corner(order[std::size_t(i)], k)));
        low = std::min(low, h), high = std::max(high, h);
      }
    slabs.insert(slabs.end(), {n[0], n[1], n[2], low, high});
  }

  void node(Index begin, Index end) {
    const std::size_t at = links.size() / 2;
    Bounds box = {Vec::make(infinity, infinity, infinity), Vec::make(-infinity, -infinity, -infinity)}, spread = box;
    auto extend = [](Bounds& b, const Vec& p) { b = {lesser(b.lower, p), greater(b.upper, p)}; };
    for (Index i = begin; i < end; ++i) {
      const Index t = order[std::size_t(i)];
      for (int k = 0; k < 3; ++k) extend(box, load3(corner(t, k)));
      extend(spread, middles[std::size_t(t)]);
    }
    for (const Vec& p : {box.lower, box.upper}) boxes.insert(boxes.end(), {p[0], p[1], p[2]});
    add_slab(begin, end);
    links.insert(links.end(), {begin, end - begin});
    if (end - begin <= TriangleTree::leaf_size) return;
    const Vec side = spread.upper - spread.lower;
    const int along = side[0] >= side[1] && side[0] >= side[2] ? 0 : side[1] >= side[2] ? 1 : 2;
    const Index half = begin + (end - begin) / 2;
    std::nth_element(order.begin() + begin, order.begin() + half, order.begin() + end, [&](Index s, Index t) {
      const double a = middles[std::size_t(s)][along], b = middles[std::size_t(t)][along];
      return a != b ? a < b : s < t;
    });
    node(begin, half);
    links[2 * at] = Index(links.size() / 2), links[2 * at + 1] = 0;
    node(half, end);
  }
};

[[noreturn]] void too_far(double extent) {
  throw Error(DYN_ERROR_LIMIT, "a surface reaches " + number(extent) + " m from its origin: distances are measured up to " +
                                   number(shape::max_length));
}

}  // namespace

SurfacePtr surface_of(const Model& m, Index shape) {
  const ShapeRecord& s = m.shapes()[shape];
  auto take = [&]<class T>(const Stored<T>* list) {
    const Stored<T>& from = list[s.surface];
    return std::make_shared<SurfaceData>(
        SurfaceData{Held<T>(view(from.header, m.surface_numbers() + from.numbers, m.surface_indices() + from.indices))});
  };
  if (s.surface < 0) return nullptr;
  return s.type == DYN_SHAPE_TYPE_CONVEX      ? take(m.hulls())
         : s.type == DYN_SHAPE_TYPE_TRIANGLES ? take(m.trees())
                                              : take(m.grids());
}

dynShapeType type_of(const SurfaceData& s) {
  static constexpr dynShapeType types[] = {DYN_SHAPE_TYPE_CONVEX, DYN_SHAPE_TYPE_TRIANGLES, DYN_SHAPE_TYPE_HEIGHT_FIELD};
  return types[s.held.index()];
}

SurfacePtr triangle_tree(const std::vector<double>& vertices, const std::vector<Index>& triangles, bool closed) {
  TreeMaker maker{vertices, triangles, {}, {}, {}, {}, {}};
  maker.run();
  // vertices in the order in which the leaves meet them
  std::vector<Index> number(vertices.size() / 3, -1), corners;
  std::vector<double> met;
  TriangleTree t{};
  for (const Index k : maker.order)
    for (int c = 0; c < 3; ++c) {
      const Index v = triangles[3 * std::size_t(k) + std::size_t(c)];
      if (number[std::size_t(v)] < 0) {
        number[std::size_t(v)] = Index(met.size() / 3);
        const double* p = vertices.data() + 3 * std::ptrdiff_t(v);
        met.insert(met.end(), p, p + 3);
        t.extent = std::max(t.extent, norm(load3(p)));
      }
      corners.push_back(number[std::size_t(v)]);
    }
  if (!(t.extent <= shape::max_length)) too_far(t.extent);
  t.vertices = Index(met.size() / 3), t.triangles = Index(triangles.size() / 3), t.nodes = Index(maker.links.size() / 2);
  t.closed = closed;
  t.vertex = met.data(), t.box = maker.boxes.data(), t.slab = maker.slabs.data(), t.corner = corners.data(),
  t.link = maker.links.data();
  return std::make_shared<SurfaceData>(SurfaceData{Held<TriangleTree>(t)});
}

SurfacePtr height_grid(const double* heights, Index columns, Index rows, double step_x, double step_y, double bottom) {
  const auto refuse = [](dynStatus status, const std::string& message) { throw Error(status, "height field: " + message); };
  constexpr double largest = shape::max_length;
  if (columns < 2 || rows < 2)
    refuse(DYN_ERROR_INVALID, std::to_string(columns) + " x " + std::to_string(rows) + " points: two each way are the least");
  if (std::int64_t(columns) * rows > max_heights)
    refuse(DYN_ERROR_LIMIT,
           std::to_string(columns) + " x " + std::to_string(rows) + " points, and the limit is " + std::to_string(max_heights));
  for (const double step : {step_x, step_y})
    if (!(step >= shape::min_length && step <= largest))
      refuse(std::isfinite(step) ? DYN_ERROR_INVALID : DYN_ERROR_NONFINITE,
             "a step of " + number(step) + " m: give metres above zero");
  if (!std::isfinite(bottom)) refuse(DYN_ERROR_NONFINITE, "bottom is not finite");
  Grid g{};
  g.columns = columns, g.rows = rows, g.step_x = step_x, g.step_y = step_y, g.bottom = bottom;
  for (std::ptrdiff_t k = 0; k < std::ptrdiff_t(columns) * rows; ++k) {
    const auto which = [&] {
      return "the height of column " + std::to_string(k % columns) + ", row " + std::to_string(k / columns) + " is ";
    };
    if (!std::isfinite(heights[k])) refuse(DYN_ERROR_NONFINITE, which() + "not finite");
    if (!(heights[k] > bottom))
      refuse(DYN_ERROR_INVALID, which() + number(heights[k]) + " m, not above the bottom, " + number(bottom) + " m");
  }
  g.height = heights;
  for (Index j = 0; j < rows; ++j)
    for (Index i = 0; i < columns; ++i) g.extent = std::max(g.extent, norm(g.at(i, j)));
  for (const Index i : {0, columns - 1})
    for (const Index j : {0, rows - 1}) g.extent = std::max(g.extent, norm(Vec::make(g.x(i), g.y(j), bottom)));
  if (!(g.extent <= largest)) too_far(g.extent);

  std::vector<double> range;
  for (g.levels = 0;; ++g.levels) {
    g.first[g.levels] = Index(range.size() / 2);
    const Index nx = g.cells_x(g.levels), ny = g.cells_y(g.levels);
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i) {
        double low = infinity, high = -infinity;
        auto take = [&](double least, double most) { low = std::min(low, least), high = std::max(high, most); };
        for (Index v = 0; v < 2; ++v)
          for (Index u = 0; u < 2; ++u) {
            if (g.levels == 0) {
              const double h = g.at(i + u, j + v)[2];
              take(h, h);
            } else if (const Index a = 2 * i + u, b = 2 * j + v; a < g.cells_x(g.levels - 1) && b < g.cells_y(g.levels - 1)) {
              const double* r = range.data() + 2 * (g.first[g.levels - 1] + std::ptrdiff_t(b) * g.cells_x(g.levels - 1) + a);
              take(r[0], r[1]);
            }
          }
        range.insert(range.end(), {low, high});
      }
    if (nx == 1 && ny == 1) break;
  }
  ++g.levels;
  g.range = range.data();
  return std::make_shared<SurfaceData>(SurfaceData{Held<Grid>(g)});
}

}  // namespace dyn
