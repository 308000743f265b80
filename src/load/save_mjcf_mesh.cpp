// Model to MJCF: meshes, by the names of files that MuJoCo reads, or with their corners and triangles.
#include <filesystem>
#include <fstream>

#include "mesh.hpp"
#include "mesh_check.hpp"
#include "model/builder_surface.hpp"
#include "save_mjcf.hpp"
#include "system.hpp"

namespace dyn::load {

namespace {

// MuJoCo reads OBJ, its own format, and binary STL of at most 200,000 triangles.
bool mujoco_reads(const std::string& path) {
  const std::string kind = extension(path);
  if (kind != ".stl") return kind == ".obj" || kind == ".msh";
  std::ifstream file(utf8_path(path), std::ios::binary);
  unsigned char head[84];
  std::error_code none;
  if (!file.read(reinterpret_cast<char*>(head), sizeof head)) return false;
  const std::uint64_t triangles = head[80] | head[81] << 8 | head[82] << 16 | std::uint64_t(head[83]) << 24;
  return triangles <= 200000 && std::filesystem::file_size(utf8_path(path), none) == 84 + 50 * triangles;
}

}  // namespace

void MjcfWriter::put_mesh(XmlElement& mesh, std::span<const double> vertices, const Index* corners, size_t triangles) {
  put(mesh, "vertex", vertices);
  std::string face;  // whole numbers: MuJoCo does not read 1e+05
  for (size_t k = 0; k < 3 * triangles; ++k) face += (k ? " " : "") + std::to_string(corners[k]);
  if (triangles) put(mesh, "face", face);
}

XmlElement& MjcfWriter::new_mesh(const std::string& wish, std::string& name) {
  name = assets.claim(wish);
  XmlElement& mesh = *section("asset").InsertNewChildElement("mesh");
  put(mesh, "name", name),
      put(mesh, "inertia", std::string("shell"));  // masses stand in <inertial>; a solid's volume may be too small for MuJoCo
  return mesh;
}

std::string MjcfWriter::mesh_file(const ShapeRecord& s) {
  std::string path = m.string(s.mesh);
  std::error_code none;
  const bool there = std::filesystem::exists(utf8_path(path), none);
  if (there) path = std::filesystem::absolute(path).string();
  std::string& name = file_assets[path + " " + number_list(s.size)];
  if (!name.empty()) return name;
  const auto left_out = [&](const char* why) { return losses.loss(why, path), std::string(); };
  if (!there) return left_out("shapes are left out: their mesh file is not there");
  const std::string stem = std::filesystem::path(path).stem().string();
  if (!mujoco_reads(path)) try {
      meshes::MeshOptions how;
      how.scale = {s.size[0], s.size[1], s.size[2]};
      const meshes::Mesh read = meshes::read_mesh(path, how);
      put_mesh(new_mesh(stem, name), read.vertices, read.triangles.data(), size_t(read.triangle_count()));
      losses.note("meshes of formats that MuJoCo does not read are written into the file", path);
      return name;
    } catch (const Error& e) {
      return left_out("shapes are left out: neither MuJoCo nor libdyn reads their mesh");
    }
  XmlElement& mesh = new_mesh(stem, name);
  put(mesh, "file", path);
  if (s.size[0] != 1 || s.size[1] != 1 || s.size[2] != 1) put(mesh, "scale", std::span(s.size));
  return name;
}

std::string MjcfWriter::mesh_asset(const ShapeRecord& s) {
  const std::string path = m.string(s.mesh);
  const bool file = !path.empty() && std::filesystem::path(path).has_extension();
  if (file && (s.type == DYN_SHAPE_TYPE_MESH || mujoco_reads(path))) return mesh_file(s);
  std::string& name = surface_assets[{int(s.type), s.surface}];
  if (!name.empty()) return name;
  XmlElement& mesh = new_mesh(path.empty() ? "mesh" : file ? std::filesystem::path(path).stem().string() : path, name);
  if (s.type == DYN_SHAPE_TYPE_CONVEX) {
    const Stored<shape::Hull>& at = m.hulls()[s.surface];
    const shape::Hull h = view(at.header, m.surface_numbers() + at.numbers, m.surface_indices() + at.indices);
    std::vector<double> vertices;
    for (Index i = 0; i < h.vertices; ++i) vertices.insert(vertices.end(), {h.x[i], h.y[i], h.z[i]});
    put_mesh(mesh, vertices, nullptr, 0);
  } else if (s.type == DYN_SHAPE_TYPE_TRIANGLES) {
    const Stored<shape::TriangleTree>& at = m.trees()[s.surface];
    const shape::TriangleTree t = view(at.header, m.surface_numbers() + at.numbers, m.surface_indices() + at.indices);
    put_mesh(mesh, {t.vertex, 3 * size_t(t.vertices)}, t.corner, size_t(t.triangles));
  }
  return name;
}

}  // namespace dyn::load
