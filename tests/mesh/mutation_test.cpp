// Thousands of damaged mesh files a format (DYN_MUTANTS), each read in a process with 1 GB of memory: an error with a sentence,
// or a mesh.
#include <chrono>

#include "common/mutants.hpp"
#include "mesh/meshes.hpp"

namespace dyn_test {
namespace {

void read_mutants(const std::string& name, const std::string& good) {
  const std::uint64_t count = mutant_count(300), per_process = 500;
  for (std::uint64_t first = 1; first <= count; first += per_process)
    in_child(std::uint64_t(1) << 30, 120, [&] {
      const Folder folder;
      folder.write("brick.bin", gltf_buffer(brick));
      for (std::uint64_t seed = first; seed < first + per_process && seed <= count; ++seed) {
        const std::string path = folder.write(name, mutant(good, seed));
        const auto begin = std::chrono::steady_clock::now();
        const Made m = mesh_file(path);
        if (m.status == DYN_OK) m.info();
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        EXPECT_LT(seconds, 10) << name << ", seed " << seed;
        EXPECT_NE(DYN_ERROR_INTERNAL, m.status) << name << ", seed " << seed << ": " << m.error;
        EXPECT_NE(DYN_ERROR_MEMORY, m.status) << name << ", seed " << seed << ": " << m.error;
        EXPECT_TRUE(m.status == DYN_OK || m.error.find("/" + name) != m.error.npos)
            << name << ", seed " << seed << ": " << m.error;
      }
    });
}

// A scene with materials, vertex colours, polygons, and nodes within nodes.
std::string rich_dae() {
  std::string text = dae(brick, "<unit name=\"centimeter\" meter=\"0.01\"/><up_axis>Z_UP</up_axis>",
                         "<rotate>0 0 1 30</rotate><scale>1 -1 1</scale>");
  const auto insert = [&](const std::string& before, const std::string& what) { text.insert(text.find(before), what); };
  insert("<library_geometries>",
         "<library_effects><effect id=\"e\"><profile_COMMON><technique sid=\"t\"><phong><diffuse><color>0.9 0.1 0.2 "
         "1</color></diffuse></phong>"
         "</technique></profile_COMMON></effect></library_effects><library_materials><material id=\"m\"><instance_effect "
         "url=\"#e\"/>"
         "</material></library_materials>");
  insert("</mesh>",
         "<source id=\"c\"><float_array id=\"ca\" count=\"6\">1 0 0 0 1 0</float_array><technique_common><accessor "
         "source=\"#ca\" count=\"2\" "
         "stride=\"3\"/></technique_common></source><polylist count=\"2\" material=\"x\"><input semantic=\"VERTEX\" "
         "source=\"#v\" offset=\"0\"/>"
         "<input semantic=\"COLOR\" source=\"#c\" offset=\"1\"/><vcount>4 5</vcount><p>0 0 1 1 3 0 2 1 0 0 1 1 5 0 4 1 6 "
         "1</p></polylist>"
         "<tristrips count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 1 2 3 4</p></tristrips>");
  insert("</node>",
         "<node><matrix>1 0 0 3 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url=\"#g\"><bind_material><technique_common>"
         "<instance_material symbol=\"x\" target=\"#m\"/></technique_common></bind_material></instance_geometry></node>");
  return text;
}

TEST(MeshMutants, Stl) { read_mutants("m.stl", binary_stl(box(1, 2, 3))); }
TEST(MeshMutants, AsciiStl) { read_mutants("m.stl", ascii_stl(box(1, 2, 3))); }
TEST(MeshMutants, Obj) {
  read_mutants("m.obj", obj(brick) + "v 1 1 1 1 0 0\nf 1//2 2/3 3/1/1 -1 -2\nl 1 2\nusemtl a\nmtllib m.mtl\n");
}
TEST(MeshMutants, Collada) {
  const Folder folder;
  const Made good = mesh_file(folder.write("good.dae", rich_dae()));
  EXPECT_EQ(DYN_OK, good.status) << good.error;
  read_mutants("m.dae", rich_dae());
}
TEST(MeshMutants, Gltf) { read_mutants("m.gltf", gltf(brick, "brick.bin", ",\"rotation\":[0,0,1,0],\"scale\":[1,2,3]")); }
TEST(MeshMutants, BinaryGltf) { read_mutants("m.glb", glb(brick)); }

}  // namespace
}  // namespace dyn_test
