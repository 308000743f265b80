// Mesh files that lie about their sizes: each is refused with a sentence that names the file and what is wrong, and takes memory
// and time of its own size alone.
#include "common/mutants.hpp"
#include "mesh/meshes.hpp"

namespace dyn_test {
namespace {

constexpr std::uint64_t memory = std::uint64_t(1) << 30;

std::string changed(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(text.npos, at) << what;
  return text.replace(at, what.size(), by);
}

// status, and words that the error has beside the file's name
void refuse(const std::string& name, const std::string& content, dynStatus status, const std::string& words) {
  SCOPED_TRACE(name + ": " + words);
  in_child(memory, 10, [&] {
    const Folder folder;
    const Made m = mesh_file(folder.write(name, content));
    EXPECT_EQ(status, m.status) << m.error;
    EXPECT_TRUE(m.says(words));
    EXPECT_TRUE(m.says("/" + name)) << "the file is named";
  });
}

TEST(MeshHostile, CountsOfCollada) {
  const std::string good = dae(brick);
  refuse("zero.dae", changed(good, "id=\"a\" count=\"24\"", "id=\"a\" count=\"0\""), DYN_ERROR_PARSE,
         "states a count of 0, and holds 24");
  refuse("word.dae", changed(good, "id=\"a\" count=\"24\"", "id=\"a\" count=\"x\""), DYN_ERROR_PARSE,
         "count='x': a whole number");
  refuse("inf.dae", changed(good, "id=\"a\" count=\"24\"", "id=\"a\" count=\"inf\""), DYN_ERROR_PARSE,
         "count='inf': a whole number");
  refuse("none.dae", changed(good, "id=\"a\" count=\"24\"", "id=\"a\""), DYN_ERROR_PARSE, "<float_array> has no attribute count");
  refuse("three.dae", changed(good, "id=\"a\" count=\"24\"", "id=\"a\" count=\"3\""), DYN_ERROR_PARSE,
         "states a count of 3, and holds 24");
  refuse("huge.dae", changed(good, "id=\"a\" count=\"24\"", "id=\"a\" count=\"1000000000\""), DYN_ERROR_PARSE,
         "states a count of 1000000000, and holds 24");
  refuse("elements.dae", changed(good, "source=\"#a\" count=\"8\"", "source=\"#a\" count=\"9\""), DYN_ERROR_PARSE,
         "states 9 elements of 3 numbers, and its array has 24");
  refuse("stride.dae", changed(good, "stride=\"3\"", "stride=\"2\""), DYN_ERROR_PARSE, "a stride of 2: three numbers are needed");
  refuse("triangles.dae", changed(good, "<triangles count=\"12\"", "<triangles count=\"13\""), DYN_ERROR_PARSE,
         "states a count of 13, and holds 12");
  refuse("nan.dae", changed(good, "-3 1 0.3 ", "-3 nan 0.3 "), DYN_ERROR_PARSE, "'nan' is not finite");
}

TEST(MeshHostile, IndicesOfCollada) {
  const std::string good = dae(brick);
  refuse("word.dae", changed(good, "<p>0 2 3", "<p>0 x 3"), DYN_ERROR_PARSE, "'x' is not an index");
  refuse("real.dae", changed(good, "<p>0 2 3", "<p>0 2.5 3"), DYN_ERROR_PARSE, "'2.5' is not an index");
  refuse("large.dae", changed(good, "<p>0 2 3", "<p>0 8 3"), DYN_ERROR_PARSE, "index 8 is not one of the 8 vertices");
  refuse("negative.dae", changed(good, "<p>0 2 3", "<p>-1 2 3"), DYN_ERROR_PARSE, "index -1 is not one of the 8 vertices");
  refuse("offset.dae", changed(good, "offset=\"0\"", "offset=\"1000000\""), DYN_ERROR_PARSE, "a whole number from 0 to 63");
  refuse("short.dae", changed(good, "offset=\"0\"", "offset=\"6\""), DYN_ERROR_PARSE, "ends within a corner of 7 indices");
  refuse("corner.dae", changed(good, "</p>", " 1</p>"), DYN_ERROR_PARSE, "ends within a triangle");
  refuse("gone.dae", changed(good, "url=\"#g\"", "url=\"#gone\""), DYN_ERROR_PARSE, "there is no <geometry> of this id");
  const std::string polylist =
      changed(changed(good, "<triangles count=\"12\">", "<polylist count=\"1\">"), "</triangles>", "</polylist>");
  refuse("sizes.dae", changed(polylist, "<p>", "<vcount>1000000000</vcount><p>"), DYN_ERROR_PARSE,
         "asks for more corners than <p> holds");
}

// Each node holds the next one twice: 2^40 paths.
TEST(MeshHostile, NodesOfColladaThatMultiply) {
  std::string nodes, good = dae(brick);
  for (int k = 0; k < 40; ++k) {
    const std::string next = "<instance_node url=\"#k" + std::to_string(k + 1) + "\"/>";
    nodes += "<node id=\"k" + std::to_string(k) + "\">" + next + next + "</node>";
  }
  good = changed(good, "<instance_geometry", "<instance_node url=\"#k0\"/><instance_geometry");
  const std::string library = "<library_nodes>" + nodes + "<node id=\"k40\"/></library_nodes><library_visual_scenes>";
  refuse("doubling.dae", changed(good, "<library_visual_scenes>", library), DYN_ERROR_LIMIT, "does a node hold itself?");
  const std::string itself =
      "<library_nodes><node id=\"k0\"><instance_node url=\"#k0\"/></node></library_nodes><library_visual_scenes>";
  refuse("itself.dae", changed(good, "<library_visual_scenes>", itself), DYN_ERROR_LIMIT, "does a node hold itself?");
}

TEST(MeshHostile, AccessorsOfGltf) {
  const std::string good = glb(brick);
  const auto damaged = [&](const std::string& what, const std::string& by) {
    std::string text = changed(good, what, by);
    const auto set = [&](std::size_t at, std::uint32_t x) { std::memcpy(text.data() + at, &x, 4); };
    std::uint32_t json;
    std::memcpy(&json, good.data() + 12, 4);
    set(8, std::uint32_t(text.size())), set(12, json + std::uint32_t(text.size() - good.size()));
    return text;
  };
  refuse("count.glb", damaged("5126,\"count\":8", "5126,\"count\":9"), DYN_ERROR_PARSE,
         "accessors[0] states 9 elements, and bufferViews[0] has 96 bytes");
  refuse("huge.glb", damaged("5126,\"count\":8", "5126,\"count\":1000000000"), DYN_ERROR_PARSE,
         "accessors[0] states 1000000000 elements");
  refuse("word.glb", damaged("5126,\"count\":8", "5126,\"count\":\"x\""), DYN_ERROR_PARSE,
         "accessors[0].count is no whole number");
  refuse("none.glb", damaged("5126,\"count\":8", "5126"), DYN_ERROR_PARSE, "accessors[0].count is missing");
  refuse("view.glb", damaged("\"bufferView\":0", "\"bufferView\":7"), DYN_ERROR_PARSE,
         "accessors[0].bufferView is no whole number from 0 to 1");
  refuse("type.glb", damaged("5126", "5127"), DYN_ERROR_PARSE, "accessors[0].componentType is unknown");
  refuse("offset.glb", damaged("\"byteOffset\":96", "\"byteOffset\":97"), DYN_ERROR_PARSE,
         "bufferViews[1] ends at byte 241, and its buffer has 240");
  refuse("length.glb", damaged("\"byteLength\":240", "\"byteLength\":2400"), DYN_ERROR_PARSE,
         "buffers[0] states 2400 bytes, and the binary chunk has 240");
  refuse("deep.gltf", std::string(1000000, '['), DYN_ERROR_LIMIT, "nested more than 100 deep");
  std::string index = good;
  const std::uint32_t nine = 9;
  std::memcpy(index.data() + index.size() - 4, &nine, 4);
  refuse("index.glb", index, DYN_ERROR_PARSE, "index 9 is not one of the 8 vertices");
  refuse("scene.glb", damaged("\"nodes\":[0]", "\"nodes\":[0,0]"), DYN_ERROR_PARSE, "nodes[0] has two parents");
  refuse("compressed.glb", damaged("\"scene\":0", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"scene\":0"),
         DYN_ERROR_UNSUPPORTED, "KHR_draco_mesh_compression");
}

TEST(MeshHostile, CornersOfObj) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  refuse("large.obj", vertices + "f 1 2 9\n", DYN_ERROR_PARSE, "large.obj:4: corner '9' is not one of the 3 vertices");
  refuse("zero.obj", vertices + "f 0 1 2\n", DYN_ERROR_PARSE, "corner '0'");
  refuse("before.obj", vertices + "f -4 1 2\n", DYN_ERROR_PARSE, "corner '-4'");
  refuse("word.obj", vertices + "f 1 2 x/1\n", DYN_ERROR_PARSE, "corner 'x/1'");
  refuse("short.obj", vertices + "v 1 2\n", DYN_ERROR_PARSE, "a vertex has 2 numbers");
  refuse("inf.obj", vertices + "v 1 inf 3\n", DYN_ERROR_PARSE, "'inf' is not finite");
}

TEST(MeshHostile, VerticesOfStl) {
  std::string good = ascii_stl(brick);
  refuse("two.stl", changed(good, "vertex -3 1 0.3\n", ""), DYN_ERROR_PARSE, "a facet has 2 vertices");
  refuse("word.stl", changed(good, "vertex -3 1 0.3\n", "vertex -3 x 0.3\n"), DYN_ERROR_PARSE, "'x' is not a number");
}

// A polygon of so many corners is triangulated in time that does not grow with their square.
TEST(MeshHostile, PolygonsOfManyCorners) {
  const int n = 300000;
  std::string text, face = "f";
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * 3.14159265358979 * k / n, r = 1 + 0.1 * (k % 2);  // a star: each other corner is concave
    text += "v " + decimal(r * std::cos(angle)) + " " + decimal(r * std::sin(angle)) + " 0\n";
    face += " " + std::to_string(k + 1);
  }
  in_child(memory, 20, [&] {
    const Folder folder;
    const Made m = mesh_file(folder.write("star.obj", text + face + "\n"));
    EXPECT_EQ(DYN_OK, m.status) << m.error;
  });
}

// Concave polygons keep their area: an L of six corners, whose fan from the first corner would leave it.
TEST(MeshFile, ConcavePolygons) {
  const Folder folder;
  const Made m = mesh_file(folder.write("l.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 3 4 5 6 1 2\n"));
  ASSERT_EQ(DYN_OK, m.status) << m.error;
  EXPECT_EQ(4, m.info().triangles);
  EXPECT_NEAR(3, m.info().area, 1e-12);
}

}  // namespace
}  // namespace dyn_test
