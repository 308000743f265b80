// Hulls, trees and grids of a block that came from a file: where their arrays lie, and the indices in them.
#include <cmath>
#include <cstring>

#include "dynb.hpp"
#include "model/builder_surface.hpp"

namespace dyn::load {

namespace {

void require(bool good, const char* what) {
  if (!good) damaged(what);
}

template <class T>
T checked_view(const Model& m, const Stored<T>& s) {
  std::uint64_t numbers = s.numbers, indices = s.indices;
  const std::uint64_t most_numbers = std::uint64_t(m.n.surface_numbers), most_indices = std::uint64_t(m.n.surface_indices);
  require(numbers <= most_numbers && indices <= most_indices, "place of a surface");
  T header = s.header;
  header.each_array([&]<class X>(const X*&, std::size_t n) {
    require(n <= std::size_t(1) << 32, "size of a surface");
    if constexpr (std::is_same_v<X, double>) numbers += pool_room(n);
    else indices += n;
    require(numbers <= most_numbers && indices <= most_indices, "a surface is larger than the file");
  });
  return view(s.header, m.surface_numbers() + s.numbers, m.surface_indices() + s.indices);
}

// Offsets of `lists` lists in `total` entries, each below `most`.
void check_lists(const Index* start, Index lists, const Index* entry, Index total, Index most) {
  require(start[0] == 0 && start[lists] == total, "lists of a hull");
  for (Index k = 0; k < lists; ++k) require(start[k] <= start[k + 1], "lists of a hull");
  for (Index k = 0; k < total; ++k) require(entry[k] >= 0 && entry[k] < most, "vertex of a hull");
}

void check(const Model& m, const Stored<shape::Hull>& s) {
  const shape::Hull& h = s.header;
  require(h.vertices >= 1 && h.faces >= 0 && h.corners >= 0 && h.vertices <= 1 << 28, "size of a hull");
  const shape::Hull v = checked_view(m, s);
  check_lists(v.face_start, v.faces, v.face_vertices, v.corners, v.vertices);
  check_lists(v.neighbour_start, v.vertices, v.neighbours, v.corners, v.vertices);
  require(std::isfinite(h.extent) && h.extent >= 0 && std::isfinite(h.center[0]) && std::isfinite(h.center[1]) && std::isfinite(h.center[2]), "numbers of a hull");
}

void check(const Model& m, const Stored<shape::TriangleTree>& s) {
  const shape::TriangleTree& h = s.header;
  require(h.vertices >= 1 && h.triangles >= 1 && h.nodes >= 1 && (h.closed == 0 || h.closed == 1) && std::isfinite(h.extent) && h.extent >= 0, "header of a tree");
  const shape::TriangleTree v = checked_view(m, s);
  for (std::ptrdiff_t k = 0; k < 3 * std::ptrdiff_t(v.triangles); ++k) require(v.corner[k] >= 0 && v.corner[k] < v.vertices, "vertex of a triangle");
  // depth first: every node once, a first child behind its parent, and none too deep for the stacks that descend
  std::vector<std::pair<Index, Index>> stack = {{0, 0}};  // node, depth
  Index visited = 0;
  while (!stack.empty()) {
    const auto [node, depth] = stack.back();
    stack.pop_back();
    require(node == visited++ && node < v.nodes && depth <= shape::TriangleTree::most_depth, "nodes of a tree");
    const Index first = v.link[2 * std::ptrdiff_t(node)], count = v.link[2 * std::ptrdiff_t(node) + 1];
    if (count > 0) {
      require(count <= shape::TriangleTree::leaf_size && first >= 0 && first <= v.triangles - count, "triangles of a leaf");
    } else {
      require(count == 0 && first > node + 1 && first < v.nodes, "children of a node");
      stack.emplace_back(first, depth + 1), stack.emplace_back(node + 1, depth + 1);
    }
  }
  require(visited == v.nodes, "nodes of a tree");
}

void check(const Model& m, const Stored<shape::Grid>& s) {
  const shape::Grid& h = s.header;
  require(h.columns >= 2 && h.rows >= 2 && std::int64_t(h.columns) * h.rows <= most_heights && h.levels >= 1 && h.levels <= shape::Grid::most_levels && h.first[h.levels - 1] >= 0,
          "header of a height field");
  const shape::Grid v = checked_view(m, s);
  const SurfacePtr made = height_grid(v.height, v.columns, v.rows, v.step_x, v.step_y, v.bottom);
  const shape::Grid again = std::get<Held<shape::Grid>>(made->held).view();
  require(again.levels == v.levels && again.extent == v.extent && std::equal(again.first, again.first + again.levels, v.first) &&
              std::memcmp(again.range, v.range, 2 * sizeof(double) * again.cells()) == 0,
          "boxes of a height field");
}

}  // namespace

void check_dynb_surfaces(const Model& m) {
  for (Index k = 0; k < m.n.surface_numbers; ++k) require(std::isfinite(m.surface_numbers()[k]), "numbers of a surface");
  for (Index k = 0; k < m.n.hulls; ++k) check(m, m.hulls()[k]);
  for (Index k = 0; k < m.n.trees; ++k) check(m, m.trees()[k]);
  for (Index k = 0; k < m.n.grids; ++k) check(m, m.grids()[k]);
}

}  // namespace dyn::load
