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

// ---------------------------------------------------------------------------------------------------- parts of formats

// A mesh's size, volume and place: low and high ends.
void expect_solid(const Made& m, const std::array<double, 6>& ends, double volume, double tolerance = 1e-6) {
  ASSERT_EQ(DYN_OK, m.status) << m.error;
  const dynMeshInfo i = m.info();
  EXPECT_EQ(1, i.closed);
  EXPECT_EQ(1, i.orientation);
  EXPECT_NEAR(volume, i.volume, tolerance * volume);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(ends[k], i.lower[k], tolerance) << k;
    EXPECT_NEAR(ends[k + 3], i.upper[k], tolerance) << k;
  }
}
constexpr std::array<double, 6> unit_cube = {0, 0, 0, 1, 1, 1};

TEST(MeshFile, CornersOfObj) {
  NEEDS_MODULE();
  const Folder folder;
  // counted from the last vertex so far, with texture coordinates and normals, on joined lines, with comments
  const std::string first = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -3\n", fourth = "v 0 0 1 # up\n";
  for (const char* faces : {"f -4 -3 -1\nf -3 -2 -1\nf -2 -4 -1\n", "f 1/1/1 2/2/2 4/4/4\nf 2//1 3//1 4//1\nf 3/1 1/1 4/1\n",
                            "f 1 \\\n2 4\nf 2 3 \\\n4\r\nf 3 1 4 # last\n"})
    expect_solid(mesh_file(folder.write("a.obj", first + fourth + faces)), unit_cube, 1.0 / 6, 1e-14);
  // a face may name vertices that follow it; names of materials have blanks
  folder.write("a.mtl", "newmtl dark red\nKd 0.9 0.1 0.2\n");
  EXPECT_EQ((Count{{none, 1}, {paint, 1}}),
            colours_of(mesh_file(folder.write(
                "b.obj", "mtllib a.mtl\nf 1 2 3\nusemtl dark red\nf 3 2 4\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n"))));
  // a vertex's colour times that of the material
  EXPECT_EQ((Count{{{115, 26, 51}, 1}}),
            colours_of(mesh_file(folder.write("c.obj",
                                              "mtllib a.mtl\nusemtl dark red\nv 0 0 0 0.5 1 1\nv 1 0 0 0.5 1 1\n"
                                              "v 0 1 0 0.5 1 1\nf 1 2 3\n"))));
}

TEST(MeshFile, ColoursOfStl) {
  NEEDS_MODULE();
  const Folder folder;
  const std::pair<std::uint16_t, Colour> facets[] = {
      {0x8000 | 31 << 10, {255, 0, 0}}, {0x8000 | 31 << 5, {0, 255, 0}}, {0x8000 | 31, {0, 0, 255}}, {31, none}};
  for (const auto& [word, colour] : facets) {
    std::string s = binary_stl(brick);
    for (std::size_t t = 0; t < 12; ++t) std::memcpy(&s[84 + 50 * t + 48], &word, 2);
    EXPECT_EQ((Count{{colour, 12}}), colours_of(mesh_file(folder.write("s.stl", s)))) << word;
  }
}

TEST(MeshFile, NodesOfGltf) {
  NEEDS_MODULE();
  const Folder folder;
  folder.write("a.bin", gltf_buffer(box(1, 2, 3)));
  const auto placed = [&](const std::string& node) {
    return mesh_file(folder.write("a.gltf", gltf(box(1, 2, 3), "a.bin", node)));
  };
  // by columns: x to 2 y, y to -z, z to x, moved by (5, 6, 7)
  expect_solid(placed(",\"matrix\":[0,2,0,0, 0,0,-1,0, 1,0,0,0, 5,6,7,1]"), {5, 6, 5, 8, 8, 7}, 12);
  // scaled, turned by 90 degrees about z (any length), moved
  expect_solid(placed(",\"scale\":[1,2,3],\"rotation\":[0,0,2,2],\"translation\":[10,20,30]"), {6, 20, 30, 10, 21, 39}, 36);
  expect_solid(placed(",\"rotation\":[0.7071067811865476,0,0,0.7071067811865476]"), {0, -3, 0, 1, 0, 2}, 6);
  expect_solid(placed(",\"rotation\":[0,0.7071067811865476,0,0.7071067811865476]"), {0, 0, -1, 3, 2, 0}, 6);
  // a child in its parent's frame
  std::string nested = replaced(gltf(box(1, 2, 3), "a.bin"), "\"nodes\":[{\"mesh\":0}]",
                                "\"nodes\":[{\"scale\":[2,2,2],\"children\":[1]},{\"mesh\":0,\"translation\":[1,1,1]}]");
  expect_solid(mesh_file(folder.write("b.gltf", nested)), {2, 2, 2, 4, 6, 8}, 48);
}

// A tetrahedron whose corners are floats with 4 bytes between them, by modes, widths of indices, and colours.
TEST(MeshFile, PrimitivesOfGltf) {
  NEEDS_MODULE();
  const Folder folder;
  const auto file = [&](const std::vector<int>& indices, int component, int mode, const std::string& attributes = "",
                        const std::string& more = "", const std::string& extra_buffer = "") {
    std::string bytes;
    for (const float x : {0.f, 0.f, 0.f, 9.f, 1.f, 0.f, 0.f, 9.f, 0.f, 1.f, 0.f, 9.f, 0.f, 0.f, 1.f, 9.f}) append(bytes, x);
    for (const int i : indices) {
      if (component == 5121) append(bytes, std::uint8_t(i));
      if (component == 5123) append(bytes, std::uint16_t(i));
      if (component == 5125) append(bytes, std::uint32_t(i));
    }
    const std::size_t end = bytes.size();
    bytes += extra_buffer;
    folder.write("t a.bin", bytes);
    const std::string n = std::to_string(indices.size());
    return mesh_file(
        folder.write("t.gltf",
                     "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
                     "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0" +
                         attributes + "},\"indices\":1,\"mode\":" + std::to_string(mode) + more +
                         "}]}],\"buffers\":[{\"uri\":\"t%20a.bin\",\"byteLength\":" + std::to_string(bytes.size()) +
                         "}],\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":"
                         "[0.5,1,1,1]}}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":64,\"byteStride\":16},"
                         "{\"buffer\":0,\"byteOffset\":64,\"byteLength\":" +
                         std::to_string(end - 64) + "},{\"buffer\":0,\"byteOffset\":" + std::to_string(end) +
                         ",\"byteLength\":" + std::to_string(extra_buffer.size()) +
                         "}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,"
                         "\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":" +
                         std::to_string(component) + ",\"count\":" + n +
                         ",\"type\":\"SCALAR\"},{\"bufferView\":2,\"componentType\":5121,\"normalized\":true,\"count\":4,"
                         "\"type\":\"VEC4\"},{\"bufferView\":2,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}]}"));
  };
  const std::vector<int> triangles = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  for (const int component : {5121, 5123, 5125}) expect_solid(file(triangles, component, 4), unit_cube, 1.0 / 6);
  expect_solid(file({0, 2, 1, 3, 0, 2}, 5125, 5), unit_cube, 1.0 / 6);  // every other one of a strip is turned round
  // three of a fan about a corner, without the triangle opposite to it
  const Made fan = file({3, 0, 1, 2, 0}, 5125, 6);
  ASSERT_EQ(DYN_OK, fan.status) << fan.error;
  EXPECT_EQ(3, fan.info().triangles);
  EXPECT_EQ(3, fan.info().open_edges);
  EXPECT_NEAR(1 + std::sqrt(3.0) / 2, fan.info().area, 1e-6);
  // corners of lines are no triangles
  EXPECT_TRUE(file(triangles, 5125, 1).says("only 6 points and lines"));
  EXPECT_TRUE(file(triangles, 5125, 0).says("only 12 points and lines"));
  // colours of corners are linear, and multiply the material's: (.5, 1, 1) times the mean of four corners' numbers
  std::string bytes, floats;
  for (int i = 0; i < 4; ++i) bytes += std::string("\xff\x33\x00\xff", 4);
  for (int i = 0; i < 4; ++i) append(floats, 1.f), append(floats, .2f), append(floats, 0.f);
  const Colour plain = {255, 124, 0}, painted = {188, 124, 0};  // .2 is 124, .5 is 188 of 255 (IEC 61966-2-1)
  EXPECT_EQ((Count{{plain, 4}}), colours_of(file(triangles, 5125, 4, ",\"COLOR_0\":2", "", bytes)));
  EXPECT_EQ((Count{{plain, 4}}), colours_of(file(triangles, 5125, 4, ",\"COLOR_0\":3", "", floats)));
  EXPECT_EQ((Count{{painted, 4}}), colours_of(file(triangles, 5125, 4, ",\"COLOR_0\":2", ",\"material\":0", bytes)));
  EXPECT_EQ((Count{{{188, 255, 255}, 4}}), colours_of(file(triangles, 5125, 4, "", ",\"material\":0")));
}

// A buffer in the file itself.
TEST(MeshFile, DataOfGltf) {
  NEEDS_MODULE();
  const Folder folder;
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/", bytes = gltf_buffer(brick);
  std::string text;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t x = 0;
    for (std::size_t i = 0; i < 3; ++i) x = x << 8 | (k + i < bytes.size() ? std::uint8_t(bytes[k + i]) : 0u);
    for (int i = 3; i >= 0; --i) text += letters[x >> 6 * i & 63];
  }
  expect_brick(mesh_file(folder.write("a.gltf", gltf(brick, "data:application/octet-stream;base64," + text))), single);
}

TEST(MeshFile, NodesOfCollada) {
  NEEDS_MODULE();
  const Folder folder;
  const auto placed = [&](const std::string& node) { return mesh_file(folder.write("a.dae", dae(box(1, 2, 3), "", node))); };
  // by rows
  expect_solid(placed("<matrix>0 0 1 5 2 0 0 6 0 -1 0 7 0 0 0 1</matrix>"), {5, 6, 5, 8, 8, 7}, 12, 1e-12);
  // from the outermost to the innermost
  expect_solid(placed("<translate>10 20 30</translate><rotate>0 0 2 90</rotate><scale>1 2 3</scale>"), {6, 20, 30, 10, 21, 39},
               36, 1e-12);
  expect_solid(placed("<rotate>1 0 0 90</rotate>"), {0, -3, 0, 1, 0, 2}, 6, 1e-12);
  expect_solid(placed("<rotate>0 1 0 90</rotate>"), {0, 0, -1, 3, 2, 0}, 6, 1e-12);
  expect_solid(placed("<rotate>1 1 1 120</rotate>"), {0, 0, 0, 3, 1, 2}, 6, 1e-12);
  // a node in a node, and one that another names
  const std::string nested =
      replaced(dae(box(1, 2, 3), "", "<scale>2 2 2</scale><node id=\"in\"><translate>1 1 1</translate>"),
               "<instance_geometry url=\"#g\"/></node>", "<instance_geometry url=\"#g\"/></node></node>");
  expect_solid(mesh_file(folder.write("b.dae", nested)), {2, 2, 2, 4, 6, 8}, 48, 1e-12);
  std::string named = replaced(dae(box(1, 2, 3), "", "<translate>1 1 1</translate>"), "<instance_geometry url=\"#g\"/>",
                               "<instance_node url=\"#part\"/>");
  named = replaced(named, "<library_visual_scenes>",
                   "<library_nodes><node id=\"part\"><scale>2 1 1</scale><instance_geometry "
                   "url=\"#g\"/></node></library_nodes><library_visual_scenes>");
  expect_solid(mesh_file(folder.write("c.dae", named)), {1, 1, 1, 3, 3, 4}, 12, 1e-12);
  // a skin, undeformed
  std::string skin = replaced(dae(box(1, 2, 3)), "<instance_geometry url=\"#g\"/>", "<instance_controller url=\"#c\"/>");
  skin = replaced(skin, "<library_visual_scenes>",
                  "<library_controllers><controller id=\"c\"><skin source=\"#g\"/></controller>"
                  "</library_controllers><library_visual_scenes>");
  expect_solid(mesh_file(folder.write("d.dae", skin)), {0, 0, 0, 1, 2, 3}, 6, 1e-12);
}

// A tetrahedron by each kind of primitive, and of numbers in another order.
TEST(MeshFile, PrimitivesOfCollada) {
  NEEDS_MODULE();
  const Folder folder;
  const Solid s = {{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2}};
  const std::string whole = dae(s), begin = "<triangles count=\"4\">", end = "</triangles>";
  const std::size_t from = whole.find(begin), to = whole.find(end) + end.size();
  const auto with_primitives = [&](const std::string& text) {
    return mesh_file(folder.write("p.dae", whole.substr(0, from) + text + whole.substr(to)));
  };
  const std::string input = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>";
  expect_solid(
      with_primitives("<polylist count=\"4\">" + input + "<vcount>3 3 3 3</vcount><p>0 2 1 0 1 3 1 2 3 0 3 2</p></polylist>"),
      unit_cube, 1.0 / 6, 1e-14);
  expect_solid(
      with_primitives("<polygons count=\"4\">" + input + "<p>0 2 1</p><p>0 1 3</p><p>1 2 3</p><p>0 3 2</p></polygons>"),
      unit_cube, 1.0 / 6, 1e-14);
  expect_solid(with_primitives("<tristrips count=\"1\">" + input + "<p>0 2 1 3 0 2</p></tristrips>"), unit_cube, 1.0 / 6,
               1e-14);
  expect_solid(with_primitives("<trifans count=\"1\">" + input + "<p>3 0 1 2 0</p></trifans><triangles count=\"1\">" + input +
                               "<p>0 2 1</p></triangles>"),
               unit_cube, 1.0 / 6, 1e-14);
  // a corner has other indices, too, and the vertex is the second one
  expect_solid(
      with_primitives("<triangles count=\"4\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"1\"/><input "
                      "semantic=\"NORMAL\" source=\"#p\" offset=\"0\"/><p>7 0 7 2 7 1 7 0 7 1 7 3 7 1 7 2 7 3 7 0 7 3 7 "
                      "2</p></triangles>"),
      unit_cube, 1.0 / 6, 1e-14);
  EXPECT_TRUE(with_primitives("<lines count=\"5\">" + input + "<p>0 1</p></lines>").says("only 5 points and lines"));
  // the array has two numbers before, and each vertex z, x, y and one more
  std::string other = replaced(dae(box(1, 2, 3)),
                               "stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/>"
                               "<param name=\"Z\" type=\"float\"/>",
                               "stride=\"4\" offset=\"2\"><param name=\"Z\"/><param name=\"X\"/><param name=\"Y\"/>");
  std::string numbers = "8 8 ";
  for (int i = 0; i < 8; ++i)
    numbers += std::string(i & 4 ? "3 " : "0 ") + (i & 1 ? "1 " : "0 ") + (i & 2 ? "2 " : "0 ") + "9 ";
  const std::size_t array = other.find("count=\"24\">");
  ASSERT_NE(other.npos, array);
  other = other.substr(0, array) + "count=\"34\">" + numbers + other.substr(other.find("</float_array>"));
  expect_solid(mesh_file(folder.write("o.dae", other)), {0, 0, 0, 1, 2, 3}, 6, 1e-12);
  // the mean of the corners' colours, of one triangle alone
  const std::string colours =
      "<source id=\"c\"><float_array id=\"ca\" count=\"6\">1 0 0 0 0 1</float_array><technique_common>"
      "<accessor source=\"#ca\" count=\"2\" stride=\"3\"><param name=\"R\"/><param name=\"G\"/>"
      "<param name=\"B\"/></accessor></technique_common></source>";
  const std::string coloured =
      replaced(whole.substr(0, from) + "<triangles count=\"3\">" + input +
                   "<p>0 2 1 0 1 3 1 2 3</p></triangles><triangles count=\"1\">" + input +
                   "<input semantic=\"COLOR\" source=\"#c\" offset=\"1\"/><p>0 0 3 1 2 1</p></triangles>" + whole.substr(to),
               "<source id=\"p\">", colours + "<source id=\"p\">");
  EXPECT_EQ((Count{{{85, 0, 170}, 1}, {{255, 255, 255}, 3}}), colours_of(mesh_file(folder.write("c.dae", coloured))));
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
