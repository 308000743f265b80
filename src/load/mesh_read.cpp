// Reads mesh files: resolves the path, checks the file, reads its format, scales and welds.
#include <cmath>
#include <filesystem>
#include <sstream>

#include "mesh.hpp"
#include "mesh_check.hpp"
#include "mesh_path.hpp"
#include "mesh_soup.hpp"
#include "file.hpp"
#include "base/portable.hpp"
#include "number.hpp"
#include "shape/geometry.hpp"
#include "report.hpp"

namespace dyn::meshes {

using namespace load;

namespace {

std::string found(const std::string& name, const MeshOptions& options) {
  if (name.empty()) throw Error(DYN_ERROR_FILE, "the path is empty: give the name of a mesh file");
  MeshPaths paths(options.relative_to, options.package_dirs);
  const MeshPaths::Found& f = paths.find(name);
  if (!f.path.empty()) return options.confined.check(f.path), f.path;
  std::string tried;
  for (const std::string& path : f.tried) {
    if (std::filesystem::exists(path)) check_mesh_file(path);  // throws with what is there instead of a file
    tried += (tried.empty() ? ": tried " : ", ") + in_quotes(path);
  }
  if (name.find("://") != name.npos)
    tried += tried.empty() ? ": give package_dirs" : "; give the folder above the package in package_dirs";
  throw Error(DYN_ERROR_FILE, "mesh " + in_quotes(name) + " is not found" + tried);
}

// Vertices of an OBJ without faces, lines and surfaces; none if it has any.
std::vector<double> points_of(const std::string& text, const std::string& path) {
  std::vector<double> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::vector<std::string_view> words = split(line);
    if (words.empty()) continue;
    if (words[0] == "f" || words[0] == "l" || words[0] == "surf") return {};
    if (words[0] != "v" || words.size() < 4) continue;
    for (std::size_t k = 1; k <= 3; ++k)
      if (const std::string wrong = parse_number(words[k], out.emplace_back()); !wrong.empty())
        throw Error(DYN_ERROR_PARSE, in_quotes(path) + ": '" + std::string(words[k].substr(0, 60)) + "' " + wrong);
  }
  return out;
}

}  // namespace

Mesh read_mesh(const std::string& name, const MeshOptions& options) {
  const std::string path = found(name, options);
  const Report report(path, false);
  const auto size = std::int64_t(check_mesh_file(path));
  if (options.budget) options.budget->add_bytes(bytes_of_mesh_file * size, report, 0);
  const double mirror = options.scale[0] * options.scale[1] * options.scale[2];
  for (double s : options.scale)
    if (!std::isfinite(s) || s == 0)
      throw Error(DYN_ERROR_ARGUMENT,
                  "the scale of mesh " + in_quotes(name) + " has " + text(s) + ": give finite numbers that are not zero");

  const std::string kind = extension(path);
  std::string bytes = read_file(path, "a mesh file", FileKind::Regular, kind == ".dae" ? max_file_bytes : max_mesh_bytes);
  if (options.points && kind == ".obj") {
    Mesh cloud;
    cloud.vertices = points_of(bytes, path);
    for (std::size_t i = 0; i < cloud.vertices.size(); ++i) cloud.vertices[i] *= options.scale[i % 3];
    if (!cloud.vertices.empty()) return cloud;
  }

  Soup soup = kind == ".stl"   ? read_stl(bytes, report)
              : kind == ".obj" ? read_obj(bytes, report)
              : kind == ".dae" ? read_collada(bytes, options.up_z, report)
                               : read_gltf(bytes, kind == ".glb", options.up_z, report);
  bytes = std::string();
  if (soup.triangles.empty())
    report.fail(DYN_ERROR_INVALID, 0,
                "no triangles" + (soup.skipped ? ", only " + std::to_string(soup.skipped) + " points and lines" : std::string()));
  for (std::size_t i = 0; i < soup.vertices.size(); ++i) soup.vertices[i] *= options.scale[i % 3];
  for (std::size_t i = 0; i < soup.vertices.size(); i += 3)
    if (const double far = math::hypot(soup.vertices[i], soup.vertices[i + 1], soup.vertices[i + 2]);
        far > shape::max_length && std::isfinite(far))
      report.fail(DYN_ERROR_LIMIT, 0,
                  "vertex " + std::to_string(i / 3) + " lies " + text(far) + " m from the origin: distances are measured up to " +
                      text(shape::max_length) + " m");
  if (mirror < 0)  // mirroring reverses the orientation of triangles
    for (std::size_t t = 0; t < soup.triangles.size(); t += 3) std::swap(soup.triangles[t + 1], soup.triangles[t + 2]);
  if (options.budget)
    options.budget->add_bytes(bytes_of_vertex * soup.vertex_count() + bytes_of_triangle * soup.triangle_count(), report, 0);
  Mesh out = make_mesh(soup.vertices.data(), soup.vertex_count(), soup.triangles.data(), soup.triangle_count(),
                       options.weld_tolerance, printable(path), soup.colours.data());
  out.skipped = soup.skipped;
  return out;
}

}  // namespace dyn::meshes
