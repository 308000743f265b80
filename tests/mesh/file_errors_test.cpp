// Mesh files that are truncated, damaged, too large or hostile.
#include <sys/stat.h>

#include "mesh/meshes.hpp"

namespace dyn_test {
namespace {

void expect_refused(const std::string& path, dynStatus status, const std::string& words) {
  const Made m = mesh_file(path);
  EXPECT_EQ(status, m.status) << path;
  EXPECT_TRUE(m.says(words));
  EXPECT_TRUE(m.says(path.substr(path.rfind('/')))) << "the file is named";
}

TEST(MeshFileErrors, Stl) {
  NEEDS_MODULE();
  const Folder folder;
  const std::string good = binary_stl(brick), text = ascii_stl(brick);
  const auto with_count = [&](std::uint32_t n, std::string s) {
    std::memcpy(s.data() + 80, &n, 4);
    return s;
  };
  expect_refused(folder.write("empty.stl", ""), DYN_ERROR_PARSE, "the file is empty");
  expect_refused(folder.write("short.stl", good.substr(0, 50)), DYN_ERROR_PARSE, "50 bytes");
  expect_refused(folder.write("cut.stl", good.substr(0, good.size() - 1)), DYN_ERROR_PARSE, "cut off");
  expect_refused(folder.write("long.stl", good + "x"), DYN_ERROR_PARSE, "damaged");
  expect_refused(folder.write("none.stl", with_count(0, good.substr(0, 84))), DYN_ERROR_INVALID, "no triangles");
  expect_refused(folder.write("4GB.stl", with_count(85899345, good)), DYN_ERROR_PARSE, "85899345 triangles");
  expect_refused(folder.write("claim.stl", with_count(0xffffffffu, good)), DYN_ERROR_PARSE, "4294967295 triangles");
  expect_refused(folder.write("million.stl", with_count(1000000, good)), DYN_ERROR_PARSE, "cut off");
  expect_refused(folder.write("cut_text.stl", text.substr(0, text.size() / 2)), DYN_ERROR_PARSE, "endsolid");
  expect_refused(folder.write("nothing.stl", "solid a\nendsolid a\n"), DYN_ERROR_INVALID, "no triangles");
  std::string nan = good;
  const float bad = NAN;
  std::memcpy(nan.data() + 84 + 12 + 4, &bad, 4);
  expect_refused(folder.write("nan.stl", nan), DYN_ERROR_NONFINITE, "vertex 0 has y = NaN");
  expect_refused(folder.write("flat.stl", binary_stl({{0, 0, 0, 1, 1, 1, 2, 2, 2}, {0, 1, 2}})), DYN_ERROR_INVALID, "degenerate");
  expect_refused(folder.write("lfs.stl", "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 9\n"), DYN_ERROR_PARSE,
                 "git lfs pull");
  expect_refused(folder.write("a.ply", "ply\n"), DYN_ERROR_UNSUPPORTED, ".stl, .obj, .dae, .gltf and .glb");
}

// 10^7 triangles and one more: a sparse file of 500 MB.
TEST(MeshFileErrors, TooManyTriangles) {
  NEEDS_MODULE();
  const Folder folder;
  std::string head(80, ' ');
  append(head, std::uint32_t(10000001));
  const std::string path = folder.write("big.stl", head);
  std::filesystem::resize_file(path, 84 + 50ull * 10000001);
  expect_refused(path, DYN_ERROR_LIMIT, "10000001 triangles, and the limit is 10000000");
  std::filesystem::resize_file(path, 3ull << 30);
  expect_refused(path, DYN_ERROR_LIMIT, "bytes, and the limit is");
}

TEST(MeshFileErrors, OthersAreCutOff) {
  NEEDS_MODULE();
  const Folder folder;
  expect_refused(folder.write("a.obj", "hello\n"), DYN_ERROR_PARSE, "");
  expect_refused(folder.write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), DYN_ERROR_PARSE, "");
  const std::string d = dae(brick), g = gltf(brick, "brick.bin"), b = glb(brick);
  expect_refused(folder.write("a.dae", d.substr(0, d.size() / 2)), DYN_ERROR_PARSE, "");
  expect_refused(folder.write("b.dae", "<COLLADA/>"), DYN_ERROR_PARSE, "<COLLADA> has no <scene>");
  expect_refused(folder.write("c.dae", "<!DOCTYPE a [<!ENTITY b \"bbb\">]>" + d), DYN_ERROR_PARSE, "not allowed");
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<node>";
  expect_refused(folder.write("d.dae", "<COLLADA>" + deep), DYN_ERROR_LIMIT, "nested");
  expect_refused(folder.write("a.gltf", g.substr(0, g.size() / 2)), DYN_ERROR_PARSE, "cut off");
  expect_refused(folder.write("b.gltf", g), DYN_ERROR_FILE, "buffers[0]: ");  // its buffer is missing
  expect_refused(folder.write("c.gltf", std::string(1000000, '[')), DYN_ERROR_LIMIT, "nested");
  expect_refused(folder.write("a.glb", b.substr(0, b.size() - 4)), DYN_ERROR_PARSE, "cut off");
  expect_refused(folder.write("b.glb", "nonsense that is no glTF at all"), DYN_ERROR_PARSE, "not a binary glTF");
}

// A file truncated anywhere gives an error or a mesh, and never a crash.
TEST(MeshFileErrors, EveryPrefix) {
  NEEDS_MODULE();
  const Folder folder;
  const std::pair<const char*, std::string> files[] = {
      {"a.stl", binary_stl(brick)}, {"b.stl", ascii_stl(brick)},          {"a.obj", obj(brick)},
      {"a.dae", dae(brick)},        {"a.gltf", gltf(brick, "brick.bin")}, {"a.glb", glb(brick)}};
  folder.write("brick.bin", gltf_buffer(brick).substr(0, 100));
  for (const auto& [name, content] : files)
    for (std::size_t n = 0; n < content.size(); n += 1 + content.size() / 60) {
      const Made m = mesh_file(folder.write(name, content.substr(0, n)));
      EXPECT_TRUE(m.status == DYN_OK || !m.error.empty()) << name << " " << n;
      if (std::string(name) != "a.obj" && n + 10 < content.size()) {
        EXPECT_NE(DYN_OK, m.status) << name << " " << n;
      }
    }
}

TEST(MeshFileErrors, Options) {
  dynMeshOptions o;
  dyn_mesh_options_init(nullptr);
  dyn_mesh_options_init(&o);
  dynMesh* m = nullptr;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_mesh_load(nullptr, &o, &m));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_mesh_load("a.stl", &o, nullptr));
  o.struct_size -= 1;
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_mesh_load("a.stl", &o, &m));
  dyn_mesh_options_init(&o);
  o.package_dirs_count = 1;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_mesh_load("a.stl", &o, &m));
  const char* none[] = {nullptr};
  o.package_dirs = none;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_mesh_load("a.stl", &o, &m));
  EXPECT_EQ(DYN_ERROR_FILE, dyn_mesh_load("no/such/file.stl", nullptr, &m));
  EXPECT_EQ(nullptr, m);
}

}  // namespace
}  // namespace dyn_test
