// Small meshes as arrays and files, for tests.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/with.hpp"
#include "dyn.h"

namespace dyn_test {

struct FreeMesh {
  void operator()(dynMesh* m) const { dyn_mesh_free(m); }
};
using MeshHandle = std::unique_ptr<dynMesh, FreeMesh>;

// Vertices (3 each) and triangles (3 indices each).
struct Solid {
  std::vector<double> vertices;
  std::vector<std::int32_t> triangles;

  std::size_t n() const { return vertices.size() / 3; }
  std::size_t m() const { return triangles.size() / 3; }
  Solid& moved(double x, double y, double z) {
    for (std::size_t i = 0; i < vertices.size(); i += 3) vertices[i] += x, vertices[i + 1] += y, vertices[i + 2] += z;
    return *this;
  }
  Solid& add(const Solid& other) {
    const std::int32_t first = std::int32_t(n());
    vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
    for (std::int32_t i : other.triangles) triangles.push_back(first + i);
    return *this;
  }
  Solid& turned_round() {
    for (std::size_t t = 0; t < m(); ++t) std::swap(triangles[3 * t + 1], triangles[3 * t + 2]);
    return *this;
  }
};

// [0, x] x [0, y] x [0, z]
inline Solid box(double x, double y, double z) {
  Solid s;
  for (int i = 0; i < 8; ++i) s.vertices.insert(s.vertices.end(), {i & 1 ? x : 0, i & 2 ? y : 0, i & 4 ? z : 0});
  s.triangles = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  return s;
}

// An icosahedron with triangles split in four some times, corners on the unit sphere.
inline Solid icosphere(int levels) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  Solid s;
  s.vertices = {-1, g,  0,  1, g, 0,  -1, -g, 0,  1, -g, 0, 0,  -1, g,  0,  1, g,
                0,  -1, -g, 0, 1, -g, g,  0,  -1, g, 0,  1, -g, 0,  -1, -g, 0, 1};
  s.triangles = {0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4, 11, 10, 2, 10, 7, 6, 7, 1, 8,
                 3, 9, 4, 3, 4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9, 4, 9, 5, 2, 4, 11, 6, 2, 10, 8, 6, 7, 9, 8, 1};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [at, added] = middles.try_emplace({std::min(a, b), std::max(a, b)}, std::int32_t(s.n()));
      if (added)
        for (int k = 0; k < 3; ++k)
          s.vertices.push_back((s.vertices[std::size_t(3 * a + k)] + s.vertices[std::size_t(3 * b + k)]) / 2);
      return at->second;
    };
    std::vector<std::int32_t> finer;
    for (std::size_t t = 0; t < s.triangles.size(); t += 3) {
      const std::int32_t a = s.triangles[t], b = s.triangles[t + 1], c = s.triangles[t + 2], ab = middle(a, b), bc = middle(b, c),
                         ca = middle(c, a);
      finer.insert(finer.end(), {a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca});
    }
    s.triangles = finer;
  }
  for (std::size_t i = 0; i < s.vertices.size(); i += 3) {
    const double r = std::hypot(s.vertices[i], s.vertices[i + 1], s.vertices[i + 2]);
    for (std::size_t k = i; k < i + 3; ++k) s.vertices[k] /= r;
  }
  return s;
}

struct Made {
  dynStatus status;
  std::string error;
  MeshHandle mesh;

  dynMeshInfo info() const {
    dynMeshInfo out{};
    out.struct_size = sizeof out;
    EXPECT_EQ(DYN_OK, dyn_mesh_info(mesh.get(), &out)) << dyn_last_error();
    return out;
  }
  dynMeshArrays arrays() const {
    dynMeshArrays out{};
    out.struct_size = sizeof out;
    EXPECT_EQ(DYN_OK, dyn_mesh_arrays(mesh.get(), &out)) << dyn_last_error();
    return out;
  }
  std::vector<double> colours() const {
    std::vector<double> out(3 * arrays().triangle_count);
    EXPECT_EQ(DYN_OK, dyn_mesh_rgb(mesh.get(), out.data())) << dyn_last_error();
    return out;
  }
  Made hull() const {
    dynMesh* h = nullptr;
    const dynStatus s = dyn_mesh_hull(mesh.get(), &h);
    EXPECT_EQ(s == DYN_OK, h != nullptr);
    return {s, s == DYN_OK ? "" : dyn_last_error(), MeshHandle(h)};
  }
  bool says(const std::string& words) const {
    if (error.find(words) != error.npos) return true;
    ADD_FAILURE() << "'" << words << "' is not in: " << error;
    return false;
  }
};

inline Made mesh_of(const Solid& s) {
  dynMesh* m = nullptr;
  const dynStatus status =
      dyn_mesh_from_arrays(s.vertices.data(), s.n(), s.triangles.empty() ? nullptr : s.triangles.data(), s.m(), &m);
  EXPECT_EQ(status == DYN_OK, m != nullptr);
  return {status, status == DYN_OK ? "" : dyn_last_error(), MeshHandle(m)};
}

struct MeshOptions : dynMeshOptions {
  MeshOptions() { dyn_mesh_options_init(this); }
};
inline Made mesh_file(const std::string& path, const dynMeshOptions& options = MeshOptions()) {
  dynMesh* m = nullptr;
  const dynStatus status = dyn_mesh_load(path.c_str(), &options, &m);
  EXPECT_EQ(status == DYN_OK, m != nullptr);
  return {status, status == DYN_OK ? "" : dyn_last_error(), MeshHandle(m)};
}

// A folder for files, removed at the end.
struct Folder {
  std::filesystem::path path;
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "dyn_mesh_XXXXXX").string();
    EXPECT_TRUE(mkdtemp(name.data()));
    path = name;
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string write(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories((path / name).parent_path());
    std::ofstream(path / name, std::ios::binary) << content;
    return (path / name).string();
  }
};

// ---------------------------------------------------------------------------------------------------- files

inline std::string decimal(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", x);
  return text;
}
inline std::string point(const Solid& s, std::int32_t i) {
  return decimal(s.vertices[std::size_t(3 * i)]) + " " + decimal(s.vertices[std::size_t(3 * i + 1)]) + " " +
         decimal(s.vertices[std::size_t(3 * i + 2)]);
}
inline std::string ascii_stl(const Solid& s) {
  std::string out = "solid test\n";
  for (std::size_t t = 0; t < s.m(); ++t) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (std::size_t k = 0; k < 3; ++k) out += "vertex " + point(s, s.triangles[3 * t + k]) + "\n";
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid test\n";
}
template <class T>
void append(std::string& out, T x) {
  char bytes[sizeof x];
  std::memcpy(bytes, &x, sizeof x);
  out.append(bytes, sizeof x);
}
inline std::string binary_stl(const Solid& s, const std::string& head = "test") {
  std::string out = head;
  out.resize(80, ' ');
  append(out, std::uint32_t(s.m()));
  for (std::size_t t = 0; t < s.m(); ++t) {
    for (int k = 0; k < 3; ++k) append(out, 0.0f);
    for (std::size_t k = 0; k < 3; ++k)
      for (int c = 0; c < 3; ++c) append(out, float(s.vertices[std::size_t(3 * s.triangles[3 * t + k] + c)]));
    append(out, std::uint16_t(0));
  }
  return out;
}
inline std::string obj(const Solid& s) {
  std::string out = "# test\n";
  for (std::size_t i = 0; i < s.n(); ++i) out += "v " + point(s, std::int32_t(i)) + "\n";
  for (std::size_t t = 0; t < s.m(); ++t) {
    out += "f";
    for (std::size_t k = 0; k < 3; ++k) out += " " + std::to_string(s.triangles[3 * t + k] + 1);
    out += "\n";
  }
  return out;
}
// node: text in the node before the geometry; head: of <asset>
inline std::string dae(const Solid& s, const std::string& head = "", const std::string& node = "") {
  std::string points, indices;
  for (std::size_t i = 0; i < s.n(); ++i) points += point(s, std::int32_t(i)) + " ";
  for (std::int32_t i : s.triangles) indices += std::to_string(i) + " ";
  return "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">\n<asset>" +
         head + "</asset>\n<library_geometries><geometry id=\"g\"><mesh>\n<source id=\"p\"><float_array id=\"a\" count=\"" +
         std::to_string(s.vertices.size()) + "\">" + points + "</float_array><technique_common><accessor source=\"#a\" count=\"" +
         std::to_string(s.n()) +
         "\" stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" "
         "type=\"float\"/></accessor></technique_common></source>\n"
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\n<triangles count=\"" +
         std::to_string(s.m()) + "\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>" + indices +
         "</p></triangles>\n</mesh></geometry></library_geometries>\n"
         "<library_visual_scenes><visual_scene id=\"s\"><node id=\"n\">" +
         node +
         "<instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>\n<scene><instance_visual_scene "
         "url=\"#s\"/></scene>\n</COLLADA>\n";
}
// The buffer of a glTF: positions, then indices.
inline std::string gltf_buffer(const Solid& s) {
  std::string out;
  for (double x : s.vertices) append(out, float(x));
  for (std::int32_t i : s.triangles) append(out, std::uint32_t(i));
  return out;
}
inline std::string gltf(const Solid& s, const std::string& uri, const std::string& node = "") {
  const std::string points = std::to_string(12 * s.n()), indices = std::to_string(12 * s.m());
  return "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0" + node +
         "}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],\"buffers\":[{" +
         (uri.empty() ? "" : "\"uri\":\"" + uri + "\",") + "\"byteLength\":" + std::to_string(12 * s.n() + 12 * s.m()) +
         "}],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":" + points +
         "},{\"buffer\":0,\"byteOffset\":" + points + ",\"byteLength\":" + indices +
         "}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":" + std::to_string(s.n()) +
         ",\"type\":\"VEC3\",\"min\":[-9,-9,-9],\"max\":[9,9,9]},{\"bufferView\":1,\"componentType\":5125,\"count\":" +
         std::to_string(3 * s.m()) + ",\"type\":\"SCALAR\"}]}";
}
inline std::string glb(const Solid& s) {
  std::string json = gltf(s, ""), binary = gltf_buffer(s), out = "glTF";
  while (json.size() % 4) json += ' ';
  append(out, std::uint32_t(2)), append(out, std::uint32_t(12 + 8 + json.size() + 8 + binary.size()));
  append(out, std::uint32_t(json.size())), out += "JSON", out += json;
  append(out, std::uint32_t(binary.size())), out += std::string("BIN\0", 4), out += binary;
  return out;
}

// Tests of hulls need the module.
#ifdef DYN_MESH_MODULE
#define NEEDS_MODULE()
#else
#define NEEDS_MODULE() GTEST_SKIP() << "built without qhull"
#endif

// The solid of tests of files.
inline const Solid brick = box(0.1, 0.25, 0.7).moved(-3, 1, 0.3);

inline Made height_field(const std::vector<double>& h, int columns, int rows, double x = 0.5, double y = 0.5,
                         double bottom = -1) {
  dynMesh* m = nullptr;
  const dynStatus status = dyn_mesh_from_height_field(with<dynHeightField>({0, columns, rows, h.data(), x, y, bottom}), &m);
  EXPECT_EQ(status == DYN_OK, m != nullptr);
  return {status, status == DYN_OK ? "" : dyn_last_error(), MeshHandle(m)};
}

// An L shape: 2 x 2 x 1 less a quarter
inline Solid corner_piece() {
  Solid s;
  const double xy[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const double z : {0.0, 1.0})
    for (const auto& p : xy) s.vertices.insert(s.vertices.end(), {p[0], p[1], z});
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    s.triangles.insert(s.triangles.end(), {i, j, j + 6, i, j + 6, i + 6});
  }
  for (const auto& t : {std::array<int, 3>{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}})
    s.triangles.insert(s.triangles.end(), {t[0] + 6, t[1] + 6, t[2] + 6, t[0], t[2], t[1]});
  return s;
}

}  // namespace dyn_test
