#include "surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace cli::page {

namespace {

Surface clustered(const Surface& fine, int cells) {
  std::array<double, 3> lower{HUGE_VAL, HUGE_VAL, HUGE_VAL}, upper{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (const auto& v : fine.vertices)
    for (std::size_t i = 0; i < 3; ++i) lower[i] = std::min(lower[i], v[i]), upper[i] = std::max(upper[i], v[i]);
  const double size = std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]}) / cells;
  Surface out;
  std::vector<double> count;
  std::map<std::array<int, 3>, std::uint32_t> made;
  std::vector<std::uint32_t> name;
  for (const auto& v : fine.vertices) {
    std::array<int, 3> cell;
    for (std::size_t i = 0; i < 3; ++i) cell[i] = static_cast<int>((v[i] - lower[i]) / size);
    const auto [at, fresh] = made.try_emplace(cell, static_cast<std::uint32_t>(out.vertices.size()));
    if (fresh) out.vertices.push_back({}), count.push_back(0);
    for (std::size_t i = 0; i < 3; ++i) out.vertices[at->second][i] += v[i];
    ++count[at->second];
    name.push_back(at->second);
  }
  for (std::size_t k = 0; k < count.size(); ++k)
    for (double& x : out.vertices[k]) x /= count[k];  // the middle of what the cell holds
  for (std::size_t t = 0; t < fine.triangles.size(); t += 3) {
    const std::uint32_t a = name[fine.triangles[t]], b = name[fine.triangles[t + 1]], c = name[fine.triangles[t + 2]];
    if (a != b && b != c && c != a) out.triangles.insert(out.triangles.end(), {a, b, c});
  }
  return out;
}

}  // namespace

Surface surface_of(const dynMesh* mesh) {
  dynMeshArrays arrays{};
  arrays.struct_size = sizeof arrays;
  check(dyn_mesh_arrays(mesh, &arrays));
  Surface out;
  for (std::size_t k = 0; k < arrays.vertex_count; ++k) out.vertices.push_back({arrays.vertices[3 * k], arrays.vertices[3 * k + 1], arrays.vertices[3 * k + 2]});
  out.triangles.assign(arrays.triangles, arrays.triangles + 3 * arrays.triangle_count);
  return out;
}

Surface simplified(const Surface& fine, std::size_t bytes) {
  for (int cells = 256; cells > 4; cells = cells * 3 / 4)
    if (Surface coarse = clustered(fine, cells); coarse.bytes() <= bytes) return coarse;
  return clustered(fine, 4);
}

json packed(const Surface& surface, Pack& pack) {
  Vector x;
  for (const auto& v : surface.vertices) x.insert(x.end(), v.begin(), v.end());
  return {{"vertices", pack.q16(x, 3)}, {"triangles", pack.indices(surface.triangles)}};
}

}  // namespace cli::page
