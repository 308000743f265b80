#include "surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

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
    if (a == b || b == c || c == a) continue;
    out.triangles.insert(out.triangles.end(), {a, b, c});
    if (!fine.colours.empty()) out.colours.push_back(fine.colours[t / 3]);
  }
  return out;
}

// The different ones, and in their place which of them each triangle has. Where they are many: of four bits each of red, green
// and blue.
std::vector<std::uint32_t> palette_of(std::vector<std::uint32_t>& colours) {
  if (std::set<std::uint32_t>(colours.begin(), colours.end()).size() > 256)
    for (std::uint32_t& c : colours) c &= 0xf0f0f0 | no_colour;
  std::map<std::uint32_t, std::uint32_t> index;
  std::vector<std::uint32_t> palette;
  for (std::uint32_t& c : colours) {
    const auto [at, fresh] = index.try_emplace(c, static_cast<std::uint32_t>(palette.size()));
    if (fresh) palette.push_back(c);
    c = at->second;
  }
  return palette;
}

}  // namespace

Surface surface_of(const dynMesh* mesh) {
  dynMeshArrays arrays{};
  arrays.struct_size = sizeof arrays;
  check(dyn_mesh_arrays(mesh, &arrays));
  Surface out;
  for (std::size_t k = 0; k < arrays.vertex_count; ++k)
    out.vertices.push_back({arrays.vertices[3 * k], arrays.vertices[3 * k + 1], arrays.vertices[3 * k + 2]});
  out.triangles.assign(arrays.triangles, arrays.triangles + 3 * arrays.triangle_count);
  Vector rgb(3 * arrays.triangle_count);
  check(dyn_mesh_rgb(mesh, rgb.data()));
  for (std::size_t k = 0; k < rgb.size(); k += 3) {
    const auto bits = [&](std::size_t i) { return static_cast<std::uint32_t>(std::lround(255 * rgb[k + i])); };
    out.colours.push_back(rgb[k] < 0 ? no_colour : bits(0) << 16 | bits(1) << 8 | bits(2));
  }
  if (std::all_of(out.colours.begin(), out.colours.end(), [](std::uint32_t c) { return c == no_colour; })) out.colours.clear();
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
  json out = {{"vertices", pack.q16(x, 3)}, {"triangles", pack.indices(surface.triangles)}};
  if (surface.colours.empty()) return out;
  std::vector<std::uint32_t> which = surface.colours;
  out["palette"] = json::array();
  for (const std::uint32_t c : palette_of(which)) out["palette"].push_back(c == no_colour ? json() : json(c));
  if (out["palette"].size() > 1) out["colours"] = pack.indices(which);
  return out;
}

}  // namespace cli::page
