// Mesh files: each format gives the same solid; units, axes, scales, colours, and the search for files.
#include <sys/stat.h>

#include <clocale>
#include <cstdlib>

#include "mesh/meshes.hpp"

namespace dyn_test {
namespace {

// The brick in every format, by name.
std::map<std::string, std::string> all_formats(const Folder& folder) {
  folder.write("sub/brick.bin", gltf_buffer(brick));
  return {{"ascii", folder.write("ascii.stl", ascii_stl(brick))},
          {"binary", folder.write("binary.STL", binary_stl(brick))},
          {"solid", folder.write("solid.stl", binary_stl(brick, "solid made by a program that says so in binary files"))},
          {"obj", folder.write("brick.obj", obj(brick))},
          {"dae", folder.write("brick.dae", dae(brick))},
          {"gltf", folder.write("sub/brick.gltf", gltf(brick, "brick.bin"))},
          {"glb", folder.write("brick.glb", glb(brick))}};
}

// tolerance: relative. Text formats are exact, binary ones have single precision.
void expect_brick(const Made& m, double tolerance) {
  ASSERT_EQ(DYN_OK, m.status) << m.error;
  const dynMeshInfo i = m.info();
  EXPECT_EQ(8, i.vertices);
  EXPECT_EQ(12, i.triangles);
  EXPECT_EQ(1, i.closed);
  EXPECT_EQ(1, i.orientation);
  EXPECT_EQ(1, i.convex);
  EXPECT_EQ(0, i.skipped + i.degenerate + i.duplicates);
  const double low[3] = {-3, 1, 0.3}, high[3] = {-2.9, 1.25, 1};
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(low[k], i.lower[k], 3 * tolerance) << k;
    EXPECT_NEAR(high[k], i.upper[k], 3 * tolerance) << k;
    EXPECT_NEAR((low[k] + high[k]) / 2, i.com[k], 3 * tolerance) << k;
  }
  EXPECT_NEAR(0.0175, i.volume, 0.0175 * 60 * tolerance);
}

constexpr double single = 6e-8, exact = 1e-15;

TEST(MeshFile, EveryFormat) {
  NEEDS_MODULE();
  const Folder folder;
  for (const auto& [name, path] : all_formats(folder)) {
    SCOPED_TRACE(name);
    expect_brick(mesh_file(path), name == "ascii" || name == "obj" || name == "dae" ? exact : single);
  }
}

using Colour = std::array<double, 3>;

// Counts of triangles by colour (8 bits).
std::map<Colour, int> colours_of(const Made& m) {
  EXPECT_EQ(DYN_OK, m.status) << m.error;
  std::map<Colour, int> out;
  const std::vector<double> all = m.colours();
  for (std::size_t k = 0; k < all.size(); k += 3) {
    Colour c;
    for (std::size_t i = 0; i < 3; ++i) c[i] = all[k + i] < 0 ? -1 : std::round(255 * all[k + i]);
    ++out[c];
  }
  return out;
}
using Count = std::map<Colour, int>;
const Colour none = {-1, -1, -1}, paint = {230, 26, 51};  // Kd 0.9 0.1 0.2

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(text.npos, at) << what;
  return text.replace(at, what.size(), by);
}

TEST(MeshFile, ColoursOfMaterials) {
  NEEDS_MODULE();
  const Folder folder;
  for (const auto& [name, path] : all_formats(folder)) EXPECT_EQ((Count{{none, 12}}), colours_of(mesh_file(path))) << name;

  // red from the fourth triangle on; two with a texture, whose factor is white; one without a colour
  folder.write("m.mtl", "newmtl red\nKd 0.9 0.1 0.2\nnewmtl wood\nKd 1 1 1\nmap_Kd wood.png\nnewmtl bare\n");
  std::string text = obj(brick), faces[12];
  for (std::string& face : faces) {
    const std::size_t at = text.rfind("\nf ");
    face = text.substr(at + 1), text.resize(at + 1);
  }
  std::string parts = text + "usemtl bare\n" + faces[0] + faces[1] + faces[2] + "usemtl red\n";
  for (int k = 3; k < 9; ++k) parts += faces[k];
  parts += "usemtl wood\n" + faces[9] + faces[10] + "usemtl bare\n" + faces[11];
  EXPECT_EQ((Count{{none, 6}, {paint, 6}}), colours_of(mesh_file(folder.write("parts.obj", "mtllib m.mtl\n" + parts))));
  EXPECT_EQ((Count{{none, 12}}), colours_of(mesh_file(folder.write("gone.obj", "mtllib gone.mtl\n" + parts))));
  EXPECT_EQ((Count{{none, 12}}),
            colours_of(mesh_file(folder.write("sub/outside.obj", "mtllib ../m.mtl\n" + parts))));  // not in its folder

  // dropped triangles lose their colours, mirrored ones keep them
  const std::string twice = replaced(parts, "usemtl red\n", "usemtl red\n" + faces[0] + "f 1 1 2\n");
  MeshOptions mirrored;
  mirrored.scale[0] = -1;
  const Made plain = mesh_file(folder.write("twice.obj", "mtllib m.mtl\n" + twice)),
             turned = mesh_file(folder.write("twice.obj", "mtllib m.mtl\n" + twice), mirrored);
  EXPECT_EQ(12, plain.info().triangles);
  EXPECT_EQ((Count{{none, 6}, {paint, 6}}), colours_of(plain));
  EXPECT_EQ(plain.colours(), turned.colours());

  std::string collada = replaced(dae(brick), "<library_geometries>",
                                 "<library_effects><effect id=\"e\"><profile_COMMON><technique "
                                 "sid=\"t\"><lambert><diffuse><color>0.9 0.1 0.2 1</color></diffuse></lambert></technique>"
                                 "</profile_COMMON></effect></library_effects><library_materials><material id=\"m\" "
                                 "name=\"paint\"><instance_effect url=\"#e\"/></material></library_materials>"
                                 "<library_geometries>");
  collada = replaced(collada, "<triangles ", "<triangles material=\"x\" ");
  collada = replaced(collada, "<instance_geometry url=\"#g\"/>",
                     "<instance_geometry url=\"#g\"><bind_material><technique_common><instance_material symbol=\"x\" "
                     "target=\"#m\"/></technique_common></bind_material></instance_geometry>");
  EXPECT_EQ((Count{{paint, 12}}), colours_of(mesh_file(folder.write("paint.dae", collada))));

  // glTF has linear colours: 0.5 is 188 of 255 (IEC 61966-2-1)
  folder.write("brick.bin", gltf_buffer(brick));
  std::string g = replaced(gltf(brick, "brick.bin"), "\"indices\":1}", "\"indices\":1,\"material\":0}");
  g = replaced(g, "\"scene\":0",
               "\"materials\":[{\"name\":\"paint\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0,1,1]}}],\"scene\":0");
  EXPECT_EQ((Count{{{188, 0, 255}, 12}}), colours_of(mesh_file(folder.write("paint.gltf", g))));
}

TEST(MeshFile, ColoursOfVerticesAndTriangles) {
  NEEDS_MODULE();
  const Folder folder;
  // the mean of the corner colours: one red of three
  EXPECT_EQ((Count{{{85, 0, 170}, 1}}),
            colours_of(mesh_file(folder.write("v.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 0 1\nv 0 1 0 0 0 1\nf 1 2 3\n"))));
  // STL: 5 bits per channel in the two bytes after a triangle, bit 15 set
  std::string s = binary_stl(brick);
  for (std::size_t t = 0; t < 12; ++t) s[84 + 50 * t + 49] = char(0xfc);
  EXPECT_EQ((Count{{{255, 0, 0}, 12}}), colours_of(mesh_file(folder.write("s.stl", s))));
}

TEST(MeshFile, WithACommaAsDecimalPoint) {
  NEEDS_MODULE();
  const Folder folder;
  const auto files = all_formats(folder);
  const std::string before = std::setlocale(LC_ALL, nullptr);
  if (!std::setlocale(LC_ALL, "de_DE.UTF-8")) GTEST_SKIP() << "no such locale";
  for (const auto& [name, path] : files) {
    SCOPED_TRACE(name);
    expect_brick(mesh_file(path), single);
  }
  std::setlocale(LC_ALL, before.c_str());
}

TEST(MeshFile, UnitsOfCollada) {
  NEEDS_MODULE();
  const Folder folder;
  const Solid centimetres = box(10, 25, 70).moved(-300, 100, 30);
  expect_brick(mesh_file(folder.write("a.dae", dae(centimetres, "<unit name=\"centimeter\" meter=\"0.01\"/>"))), exact * 10);
  // a node's translation is in the file's unit too
  expect_brick(mesh_file(folder.write("b.dae", dae(box(10, 25, 70), "<unit name=\"centimeter\" meter=\"0.01\"/>",
                                                   "<translate>-300 100 30</translate>"))),
               exact * 10);
}

// URDF meshes are in the axes of their link. The file's up axis is used on request only.
TEST(MeshFile, UpAxis) {
  NEEDS_MODULE();
  const Folder folder;
  MeshOptions up;
  up.up_z = 1;
  const auto expect_box = [](const Made& m, double x, double y, double z) {
    ASSERT_EQ(DYN_OK, m.status) << m.error;
    const dynMeshInfo i = m.info();
    EXPECT_NEAR(x, i.upper[0] - i.lower[0], 1e-6);
    EXPECT_NEAR(y, i.upper[1] - i.lower[1], 1e-6);
    EXPECT_NEAR(z, i.upper[2] - i.lower[2], 1e-6);
    EXPECT_EQ(1, i.orientation);
  };
  const Solid s = box(1, 2, 3);
  for (const std::string axis : {"X_UP", "Y_UP", "Z_UP"}) {
    SCOPED_TRACE(axis);
    const std::string path = folder.write(axis + ".dae", dae(s, "<up_axis>" + axis + "</up_axis>"));
    expect_box(mesh_file(path), 1, 2, 3);
    const Made turned = mesh_file(path, up);
    if (axis == "X_UP") expect_box(turned, 2, 3, 1);
    if (axis == "Y_UP") expect_box(turned, 1, 3, 2);
    if (axis == "Z_UP") expect_box(turned, 1, 2, 3);
  }
  const std::string path = folder.write("a.glb", glb(s));
  expect_box(mesh_file(path), 1, 2, 3);
  expect_box(mesh_file(path, up), 1, 3, 2);
  EXPECT_NEAR(-3, mesh_file(path, up).info().lower[1], 1e-6);  // (x, y, z) is at (x, -z, y)
  expect_box(mesh_file(folder.write("a.stl", binary_stl(s)), up), 1, 2, 3);
}

TEST(MeshFile, ScaleAndMirror) {
  NEEDS_MODULE();
  const Folder folder;
  MeshOptions o;
  o.scale[0] = 0.001, o.scale[1] = -0.001, o.scale[2] = 0.001;
  const dynMeshInfo i = mesh_file(folder.write("a.stl", binary_stl(box(100, 200, 300))), o).info();
  EXPECT_NEAR(0.006, i.volume, 1e-15);
  EXPECT_NEAR(-0.2, i.lower[1], 1e-16);
  EXPECT_EQ(1, i.orientation);  // still counter-clockwise from outside
  // likewise in a node
  EXPECT_EQ(1, mesh_file(folder.write("a.dae", dae(box(1, 1, 1), "", "<scale>1 -1 1</scale>"))).info().orientation);
  EXPECT_EQ(1, mesh_file(folder.write("a.gltf", gltf(box(1, 1, 1), "a.bin", ",\"scale\":[1,1,-1]"))).status !=
                   DYN_OK);  // a.bin is missing
  folder.write("a.bin", gltf_buffer(box(1, 1, 1)));
  EXPECT_EQ(1, mesh_file(folder.write("a.gltf", gltf(box(1, 1, 1), "a.bin", ",\"scale\":[1,1,-1]"))).info().orientation);
  for (double bad : {0.0, double(NAN), double(INFINITY)}) {
    o.scale[1] = bad;
    const Made m = mesh_file((folder.path / "a.stl").string(), o);
    EXPECT_EQ(DYN_ERROR_ARGUMENT, m.status);
    m.says("the scale of mesh");
  }
}

TEST(MeshFile, WeldTolerance) {
  NEEDS_MODULE();
  const Folder folder;
  Solid cracked;  // every triangle has its own corners, off by 1e-5
  for (std::size_t t = 0; t < brick.m(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t c = 0; c < 3; ++c)
        cracked.vertices.push_back(brick.vertices[3 * std::size_t(brick.triangles[3 * t + k]) + c] +
                                   1e-5 * double((7 * t + 3 * k + c) % 3));
      cracked.triangles.push_back(std::int32_t(3 * t + k));
    }
  const std::string path = folder.write("a.obj", obj(cracked));
  EXPECT_GT(mesh_file(path).info().open_edges, 0);
  MeshOptions o;
  o.weld_tolerance = 1e-4;
  const dynMeshInfo i = mesh_file(path, o).info();
  EXPECT_EQ(8, i.vertices);
  EXPECT_EQ(1, i.closed);
  EXPECT_NEAR(0.0175, i.volume, 1e-5);
  for (double bad : {-1.0, double(NAN), double(INFINITY)}) {
    o.weld_tolerance = bad;
    EXPECT_EQ(DYN_ERROR_ARGUMENT, mesh_file(path, o).status);
  }
}

TEST(MeshFile, QuadsPointsAndLines) {
  NEEDS_MODULE();
  const Folder folder;
  const std::string quads =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 "
      "8 7\nf 4 1 5 8\n";
  EXPECT_NEAR(1, mesh_file(folder.write("quads.obj", quads)).info().volume, 1e-15);
  const Made lines = mesh_file(folder.write("lines.obj", quads.substr(0, quads.find("f ")) + "l 1 2\nl 2 3\n"));
  EXPECT_EQ(DYN_ERROR_INVALID, lines.status);
  lines.says("no triangles");
}

// ---------------------------------------------------------------------------------------------------- where files are

TEST(MeshFile, SearchAndWhatWasTried) {
  NEEDS_MODULE();
  const Folder folder;
  folder.write("ws/arm/meshes/a.stl", binary_stl(brick));
  const std::string robot = folder.write("ws/arm/urdf/arm.urdf", "");
  const std::string ws = (folder.path / "ws").string(), other = (folder.path / "other").string();
  const char* dirs[] = {other.c_str(), ws.c_str()};
  MeshOptions o;
  EXPECT_EQ(DYN_ERROR_FILE, mesh_file("package://arm/meshes/a.stl", o).status);
  o.package_dirs = dirs, o.package_dirs_count = 2;
  expect_brick(mesh_file("package://arm/meshes/a.stl", o), single);
  Made m = mesh_file("package://arm/meshes/b.stl", o);
  EXPECT_EQ(DYN_ERROR_FILE, m.status);
  for (const std::string& tried : {other + "/arm/meshes/b.stl", other + "/meshes/b.stl", ws + "/arm/meshes/b.stl"}) m.says(tried);
  MeshOptions relative;
  relative.relative_to = robot.c_str();
  expect_brick(mesh_file("../meshes/a.stl", relative), single);
  expect_brick(mesh_file("package://arm/meshes/a.stl", relative), single);  // above the robot file
  expect_brick(mesh_file("file://" + ws + "/arm/meshes/a.stl"), single);
  m = mesh_file("../meshes/c.stl", relative);
  m.says("is not found: tried");
  m = mesh_file("");
  EXPECT_EQ(DYN_ERROR_FILE, m.status);
  m.says("path is empty");
  m = mesh_file(ws);
  EXPECT_EQ(DYN_ERROR_FILE, m.status);
  m.says("directory");
}

}  // namespace
}  // namespace dyn_test
