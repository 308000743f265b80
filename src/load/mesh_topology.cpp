#include <algorithm>
#include <cstdint>
#include <numeric>

#include "mesh.hpp"

namespace dyn::meshes {

namespace {

struct Edge {
  std::uint64_t ends;  // lower vertex, higher vertex
  Index triangle;
  bool back;  // from the higher to the lower
  bool operator<(const Edge& e) const { return ends < e.ends; }
};

Index root_of(std::vector<Index>& parent, Index i) {
  while (parent[std::size_t(i)] != i) i = parent[std::size_t(i)] = parent[std::size_t(parent[std::size_t(i)])];
  return i;
}

}  // namespace

Topology topology_of(const std::vector<Index>& triangles) {
  std::vector<Edge> edges;
  edges.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Index a = triangles[i], b = triangles[i % 3 == 2 ? i - 2 : i + 1];
    edges.push_back({std::uint64_t(std::min(a, b)) << 32 | std::uint64_t(std::max(a, b)), Index(i / 3), a > b});
  }
  std::sort(edges.begin(), edges.end());

  Topology out;
  out.components = Index(triangles.size() / 3);
  out.closed = !triangles.empty();
  std::vector<Index> parent(triangles.size() / 3);
  std::iota(parent.begin(), parent.end(), 0);
  for (std::size_t first = 0, end; first < edges.size(); first = end) {
    std::size_t back = 0;
    for (end = first; end < edges.size() && edges[end].ends == edges[first].ends; ++end) {
      back += edges[end].back;
      const Index a = root_of(parent, edges[first].triangle), b = root_of(parent, edges[end].triangle);
      if (a != b) parent[std::size_t(b)] = a, --out.components;
    }
    const std::size_t count = end - first;
    out.open += count == 1, out.crowded += count > 2, out.flipped += count == 2 && back != 1;
    out.closed &= 2 * back == count;
  }
  return out;
}

}  // namespace dyn::meshes
