// Search for the module of mesh files, and the message if it is missing. Runs a copy of the command in another process.
#include <dlfcn.h>

#include "mesh/meshes.hpp"

namespace dyn_test {
namespace {

namespace fs = std::filesystem;

// An installed tree: bin/dyn, and the library under test in a folder of lib.
struct Tree {
  Folder folder;
  std::string robot;
  explicit Tree(const std::string& where) {
    Dl_info library{};
    EXPECT_TRUE(dladdr(reinterpret_cast<const void*>(&dyn_version), &library));
    fs::create_directories(folder.path / "bin"), fs::create_directories(folder.path / where);
    fs::copy_file(DYN_CLI, folder.path / "bin/dyn");
    fs::copy_file(library.dli_fname, folder.path / where / "libdyn.so.1");
    folder.write("cube.stl", binary_stl(box(1, 2, 3)));
    robot = folder.write("cube.urdf",
                         "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh filename=\"cube.stl\" scale=\"1 1 "
                         "0.5\"/></geometry></collision></link></robot>");
  }
  std::string info() const {
    const std::string out = (folder.path / "out").string(),
                      command = "env -u LD_LIBRARY_PATH '" + (folder.path / "bin/dyn").string() +
                                "' info --fixed --json --meshes '" + robot + "' >'" + out + "' 2>&1";
    EXPECT_EQ(0, std::system(command.c_str()));
    std::ifstream file(out);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

void expect_in(const std::string& text, const std::string& words) {
  EXPECT_NE(std::string::npos, text.find(words)) << "'" << words << "' is not in: " << text;
}

TEST(MeshModule, MissingIsSaidWithAllPlaces) {
  const Tree tree("lib");
  const std::string text = tree.info();
  expect_in(text, "install it beside libdyn.so");
  expect_in(text, (tree.folder.path / "lib/libdyn_mesh.so").string() + " (no such file)");
  expect_in(text, ", libdyn_mesh.so (");
}

TEST(MeshModule, AnotherLibraryUnderItsName) {
  const Tree tree("lib");
  fs::copy_file(tree.folder.path / "lib/libdyn.so.1", tree.folder.path / "lib/libdyn_mesh.so");
  expect_in(tree.info(), "libdyn_mesh.so (another version than this libdyn)");
  tree.folder.write("lib/libdyn_mesh.so", "nothing");
  expect_in(tree.info(), "libdyn_mesh.so (");
}

#ifdef DYN_MESH_MODULE
TEST(MeshModule, IsFoundBesideTheLibrary) {
  const Tree tree("lib");
  fs::copy_file(DYN_MESH_MODULE, tree.folder.path / "lib/libdyn_mesh.so");
  const std::string text = tree.info();
  expect_in(text, "\"volume\":3.0");
  expect_in(text, "\"convex\":true");
}
#endif

// Arrays and their mass properties need no module; hulls do.
TEST(MeshModule, ArraysDoWithout) {
  const dynMeshInfo i = mesh_of(box(1, 1, 1)).info();
  EXPECT_NEAR(1, i.volume, 1e-14);
#ifndef DYN_MESH_MODULE
  EXPECT_EQ(DYN_ERROR_UNSUPPORTED, i.hull_status);
  EXPECT_EQ(-1, i.convex);
  EXPECT_TRUE(std::isnan(i.hull_volume));
#endif
}

}  // namespace
}  // namespace dyn_test
