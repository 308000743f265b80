// Robot files on disk: unreadable files, the search for meshes, and size limits.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "load/urdf.hpp"

namespace dyn_test {
namespace {

namespace fs = std::filesystem;

// A folder for each test, removed at its end.
class Files : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "dyn_load_XXXXXX").string();
    ASSERT_NE(nullptr, mkdtemp(name.data()));
    folder = name;
    unsetenv("ROS_PACKAGE_PATH");
  }
  void TearDown() override {
    unsetenv("ROS_PACKAGE_PATH");
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
  std::string write(const std::string& name, const std::string& text) {
    const fs::path path = folder / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
    return path.string();
  }
  static std::string with_mesh(const std::string& mesh) {
    return robot(link("a", solid + "\n<visual><geometry><mesh filename=\"" + mesh + "\" scale=\"1 -1 1\"/></geometry></visual>"));
  }
  static std::string mesh_of(const Loaded& l) {
    dynShapeInfo s{};
    s.struct_size = sizeof s;
    EXPECT_EQ(DYN_OK, dyn_model_shape_info(l.model.get(), 0, &s));
    return s.mesh;
  }
  fs::path folder;
};

TEST_F(Files, MessagesBeginWithFileAndLine) {
  const std::string path =
      write("arm.urdf", robot(link("a") + link("b") + joint("elbow", "revolute", "a", "b", "<axis xyz=\"0 0 0\"/>")));
  const Loaded l = load_path(path);
  EXPECT_EQ(DYN_ERROR_INVALID, l.status);
  EXPECT_EQ(path + ":4: joint 'elbow': axis is zero: give a direction such as xyz=\"0 0 1\"", l.error);
}

TEST_F(Files, WhatCannotBeRead) {
  EXPECT_EQ(DYN_ERROR_FILE, load_path((folder / "no.urdf").string()).status);
  EXPECT_NE(std::string::npos, load_path((folder / "no.urdf").string()).error.find("no.urdf"));
  EXPECT_EQ(DYN_ERROR_FILE, load_path(folder.string()).status);
  EXPECT_NE(std::string::npos, load_path(folder.string()).error.find("directory"));
  EXPECT_EQ(DYN_ERROR_FILE, load_path("").status);
  EXPECT_EQ(DYN_ERROR_PARSE, load_path(write("empty.urdf", "")).status);
  EXPECT_EQ(DYN_ERROR_PARSE, load_path(write("wide.urdf", std::string("<\0r\0o\0b\0o\0t\0", 12))).status);
  EXPECT_EQ(DYN_ERROR_UNSUPPORTED, load_path(write("model.dynb", std::string("\x7F"
                                                                             "DYN\0\1\2",
                                                                             7)))
                                       .status);
  EXPECT_EQ(DYN_ERROR_PARSE, load_path(write("zero.urdf", robot(link("a")) + std::string(1000, ' ') + '\0')).status);
  const std::string secret = write("secret.urdf", robot(link("a")));
  fs::permissions(secret, fs::perms::none);
  if (!std::ifstream(secret)) {  // root can read every file
    EXPECT_EQ(DYN_ERROR_FILE, load_path(secret).status);
  }
}

TEST_F(Files, TheContentDecidesAndNotTheName) {
  EXPECT_EQ(DYN_OK, load_path(write("robot.xml", robot(link("a")))).status);
  EXPECT_EQ(DYN_OK, load_path(write("robot.urdf", "<mujoco/>")).status);
}

TEST_F(Files, RelativeAndAbsoluteMeshes) {
  const std::string stl = write("meshes/a.stl", "solid");
  const std::string path = write("robot.urdf", with_mesh("meshes/a.stl"));
  const Loaded l = load_path(path);
  ASSERT_EQ(DYN_OK, l.status) << l.error;
  EXPECT_EQ(stl, mesh_of(l));
  EXPECT_EQ(0, l.warnings());
  EXPECT_EQ(stl, mesh_of(load_path(write("other/robot.urdf", with_mesh(stl)))));
  EXPECT_EQ(stl, mesh_of(load_path(write("other/robot.urdf", with_mesh("file://" + stl)))));
  const std::string space = write("a b.stl", "solid");
  EXPECT_EQ(space, mesh_of(load_path(write("robot.urdf", with_mesh("file://" + (folder / "a%20b.stl").string())))));
}

TEST_F(Files, PackagesAreSearchedInOrder) {
  const std::string name = "package://arm_description/meshes/a.stl";
  const std::string robot_file = write("elsewhere/robot.urdf", with_mesh(name));
  // nowhere
  const Loaded missing = load_path(robot_file);
  ASSERT_EQ(DYN_OK, missing.status) << missing.error;
  EXPECT_EQ(name, mesh_of(missing));
  EXPECT_TRUE(missing.reports(name, DYN_REPORT_LEVEL_DROPPED, 3));
  // last resort: the environment
  const std::string ros = write("ros/arm_description/meshes/a.stl", "solid");
  setenv("ROS_PACKAGE_PATH", ("/nowhere:" + (folder / "ros").string()).c_str(), 1);
  EXPECT_EQ(ros, mesh_of(load_path(robot_file)));
  // before it: the folders above the file
  const std::string above = write("arm_description/meshes/a.stl", "solid");
  EXPECT_EQ(above, mesh_of(load_path(robot_file)));
  // before it: the list, DIR/NAME/rest and DIR/rest
  const std::string inside = write("packages/meshes/a.stl", "solid");
  const std::string directory = (folder / "packages").string();
  const char* dirs[] = {"/nowhere", directory.c_str()};
  Options o;
  o.package_dirs = dirs;
  o.package_dirs_count = 2;
  EXPECT_EQ(inside, mesh_of(load_path(robot_file, o)));
  const std::string named = write("packages/arm_description/meshes/a.stl", "solid");
  EXPECT_EQ(named, mesh_of(load_path(robot_file, o)));
}

TEST_F(Files, MissingMeshListsEveryPathTried) {
  const std::string path = write("x/robot.urdf", with_mesh("package://arm/a.stl"));
  const char* dirs[] = {"/one", "/two"};
  Options o;
  o.package_dirs = dirs;
  o.package_dirs_count = 2;
  setenv("ROS_PACKAGE_PATH", "/three", 1);
  const Loaded l = load_path(path, o);
  ASSERT_EQ(DYN_OK, l.status) << l.error;
  const auto all = l.report();
  const Entry* e = Loaded::find(all, "is not found");
  ASSERT_NE(nullptr, e);
  for (const std::string tried : {"/one/arm/a.stl", "/one/a.stl", "/two/arm/a.stl", "/two/a.stl", "/three/arm/a.stl"})
    EXPECT_NE(std::string::npos, e->message.find(tried)) << e->message;
  EXPECT_NE(std::string::npos, e->message.find((folder / "x/arm/a.stl").string())) << e->message;
  o.strict = 1;
  EXPECT_EQ(DYN_ERROR_STRICT, load_path(path, o).status);
}

TEST_F(Files, OneEntryForAMeshThatIsMissingTwice) {
  const std::string shape = "<visual><geometry><mesh filename=\"no.stl\"/></geometry></visual>";
  const Loaded l = load_path(write("robot.urdf", robot(link("a", solid + shape + shape))));
  ASSERT_EQ(DYN_OK, l.status) << l.error;
  EXPECT_EQ(2, dyn_model_nshapes(l.model.get()));
  EXPECT_EQ(1, l.warnings());
}

std::string chain(int links) {
  std::string text = "<robot name=\"chain\">\n" + link("l0");
  for (int i = 1; i < links; ++i) {
    const std::string n = std::to_string(i);
    text += link("l" + n) + joint("j" + n, "revolute", "l" + std::to_string(i - 1), "l" + n,
                                  "<origin xyz=\"0 0 0.1\"/><axis xyz=\"0 1 0\"/>" + limit);
  }
  return text + "</robot>";
}

TEST(BigUrdf, ChainOfThousands) {
  const Loaded l = load(chain(3000));
  ASSERT_EQ(DYN_OK, l.status) << l.error;
  EXPECT_EQ(2999, dyn_model_nv(l.model.get()));
}

TEST(BigUrdf, LargerThanTheLimit) {
  const Loaded l = load(robot(link("a")) + std::string(size_t(140) << 20, ' '));
  EXPECT_EQ(DYN_ERROR_LIMIT, l.status);
  EXPECT_NE(std::string::npos, l.error.find("limit")) << l.error;
}

TEST(BigUrdf, SlowChainOfAHundredThousand) {
  const Loaded l = load(chain(100000));
  ASSERT_EQ(DYN_OK, l.status) << l.error;
  EXPECT_EQ(99999, dyn_model_nv(l.model.get()));
}

}  // namespace
}  // namespace dyn_test
