// Meshes and height fields of MJCF files: masses by each rule, builtin meshes, fitted primitives, binary files.
#include "mesh/meshes.hpp"

namespace dyn_test::assets_test {
namespace {

// Files have single precision.
constexpr double single = 1e-6;

struct FreeModel {
  void operator()(dynModel* m) const { dyn_model_free(m); }
};
using Model = std::unique_ptr<dynModel, FreeModel>;

// A free body with a geom, in a file of the folder.
Model load(const Folder& folder, const std::string& assets, const std::string& geom, const std::string& compiler = "") {
  const std::string path = folder.write("m.xml", "<mujoco><compiler " + compiler + "/><asset>" + assets +
                                                     "</asset><worldbody><body><freejoint/><inertial pos='0 0 0' mass='1' "
                                                     "diaginertia='1 1 1'/><geom density='1' " +
                                                     geom + "/></body></worldbody></mujoco>");
  dynLoadOptions o;
  dyn_load_options_init(&o);
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_OK, dyn_model_load(path.c_str(), &o, &m)) << dyn_last_error();
  return Model(m);
}
const char* const from_geoms = "inertiafromgeom='true'";

// m, m c, and the moments about the origin: xx, xy, yy, xz, yz, zz.
std::array<double, 10> parameters(const Folder& folder, const std::string& mesh) {
  const Model m = load(folder, "<mesh name='m' " + mesh + "/>", "type='mesh' mesh='m' contype='0' conaffinity='0'", from_geoms);
  std::array<double, 10> pi{};
  EXPECT_EQ(DYN_OK, dyn_model_inertial_parameters(m.get(), pi.data()));
  return pi;
}
void expect_parameters(const std::array<double, 10>& expected, const std::array<double, 10>& pi, double tolerance = single) {
  for (std::size_t k = 0; k < 10; ++k) EXPECT_NEAR(expected[k], pi[k], tolerance * std::max(1.0, std::abs(expected[k]))) << k;
}
// Of a box from the origin to (x, y, z).
std::array<double, 10> of_box(double x, double y, double z) {
  const double V = x * y * z;
  return {V,
          V * x / 2,
          V * y / 2,
          V * z / 2,
          V / 3 * (y * y + z * z),
          -V * x * y / 4,
          V / 3 * (x * x + z * z),
          -V * x * z / 4,
          -V * y * z / 4,
          V / 3 * (x * x + y * y)};
}

std::string in_text(const Solid& s) {
  std::string vertices, faces;
  for (double x : s.vertices) vertices += decimal(x) + " ";
  for (std::int32_t i : s.triangles) faces += std::to_string(i) + " ";
  return "vertex='" + vertices + "' face='" + faces + "'";
}

TEST(MeshAssets, MassesOfEveryRule) {
  NEEDS_MODULE();
  const Folder folder;
  const std::string cube = in_text(box(1, 1, 1)), piece = in_text(corner_piece());
  for (const char* rule : {"", " inertia='legacy'", " inertia='exact'", " inertia='convex'"})
    expect_parameters(of_box(1, 1, 1), parameters(folder, cube + rule));
  // six faces of one kilogram: 5/18 m about the centre
  const double I = 6 * 5.0 / 18;
  expect_parameters({6, 3, 3, 3, I + 3, -1.5, I + 3, -1.5, -1.5, I + 3}, parameters(folder, cube + " inertia='shell'"));
  EXPECT_NEAR(3, parameters(folder, piece + " inertia='exact'")[0], single);
  EXPECT_NEAR(3.5, parameters(folder, piece + " inertia='convex'")[0], single);
  // open: pyramids over five of six sides, from their own centre. It lies at x = .4125: those from the centre of the surface,
  // x = .4, have the volumes .4 / 3 and 4 / 6, and their centres at x = .1 and .475.
  Solid open = box(1, 1, 1);
  open.triangles.resize(open.triangles.size() - 6);
  for (const char* rule : {"", " inertia='exact'"})
    EXPECT_NEAR(.4125 / 3 + 4.0 / 6, parameters(folder, in_text(open) + rule)[0], single) << rule;
  // a U: parts that its centre does not see count more than once by the rule of MuJoCo alone
  Solid u = box(3, 1, 1);
  u.add(box(.5, 3, 1).moved(0, 1, 0)).add(box(.5, 3, 1).moved(2.5, 1, 0));
  EXPECT_NEAR(6, parameters(folder, in_text(u) + " inertia='exact'")[0], single);
  EXPECT_GT(parameters(folder, in_text(u))[0], 6.5);
}

TEST(MeshAssets, FramesAndScales) {
  NEEDS_MODULE();
  const Folder folder;
  const std::string brick_ = in_text(box(1, 2, 3).moved(5, 6, 7));
  // moved to its own frame, then scaled; a mirrored one is still a solid
  expect_parameters(of_box(1, 2, 3), parameters(folder, brick_ + " refpos='5 6 7'"));
  expect_parameters(of_box(-2, 2, 3 * 4.0), [&] {
    auto pi = parameters(folder, brick_ + " refpos='5 6 7' scale='-2 1 4'");
    for (double& x : pi) x = -x;  // of_box has a negative volume
    return pi;
  }());
  // a frame turned by 90 degrees about z: (x, y, z) is at (y, -x, z) there
  expect_parameters(of_box(2, -1, -3), [&] {
    auto pi = parameters(folder, in_text(box(1, 2, 3).moved(0, 0, -3)) + " refquat='1 0 0 1'");
    return pi;
  }());
}

// The volumes of builtin meshes whose corners are few.
TEST(MeshAssets, BuiltinVolumes) {
  NEEDS_MODULE();
  const Folder folder;
  const double edge = 2 / std::sqrt(1 + std::pow((1 + std::sqrt(5.0)) / 2, 2)), hexagon = 1.5 * std::sqrt(3.0);
  struct Case {
    const char* mesh;
    double volume;
    double height;  // of the centre of mass
  };
  for (const Case& c : {
           Case{"builtin='sphere' params='0'", 5 * (3 + std::sqrt(5.0)) / 12 * edge * edge * edge, 0},
           Case{"builtin='sphere' params='1'", mesh_of(icosphere(1)).info().volume, 0},
           Case{"builtin='hemisphere' params='0'", 2.0 / 3, .25},  // half an octahedron
           Case{"builtin='cone' params='4 0'", 4.0 / 3, -.5},
           Case{"builtin='cone' params='4 1'", 4, 0},
           Case{"builtin='cone' params='6 .5'", 2.0 / 3 * hexagon * 1.75, -1 + 2 * (1 + 1 + .75) / (4 * 1.75)},
           Case{"builtin='supersphere' params='4 1 1'", 2.0 / 3 * (2 + std::sqrt(2.0)), 0},
           Case{"builtin='supersphere' params='4 1 2'", 4.0 / 3, 0},  // an octahedron
           Case{"builtin='supertorus' params='4 .3 1 1' inertia='exact'", .72, 0},
           Case{"builtin='plate' params='3 5'", 4.0 / 3 * 8 / 5, -1},
       }) {
    SCOPED_TRACE(c.mesh);
    const std::array<double, 10> pi = parameters(folder, c.mesh);
    EXPECT_NEAR(c.volume, pi[0], 2e-6 * c.volume);
    EXPECT_NEAR(0, pi[1], 2e-6);
    EXPECT_NEAR(0, pi[2], 2e-6);
    EXPECT_NEAR(c.height, pi[3] / pi[0], 2e-6);
  }
  // finer ones come near to what they stand for
  const double ball = 4 * M_PI / 3;
  EXPECT_NEAR(ball, parameters(folder, "builtin='sphere' params='4'")[0], .005 * ball);
  EXPECT_NEAR(ball / 2, parameters(folder, "builtin='hemisphere' params='10'")[0], .03 * ball);
  EXPECT_NEAR(
      3.0 / 8,
      [&] {
        const auto pi = parameters(folder, "builtin='hemisphere' params='10'");
        return pi[3] / pi[0];
      }(),
      .01);
  EXPECT_NEAR(ball, parameters(folder, "builtin='supersphere' params='40 1 1'")[0], .01 * ball);
  EXPECT_NEAR(8, parameters(folder, "builtin='supersphere' params='40 .01 .01'")[0], .3);  // nearly a cube
  EXPECT_NEAR(2 * M_PI * M_PI * .09, parameters(folder, "builtin='supertorus' params='60 .3 1 1' inertia='exact'")[0], .02);
  // directions of a field of view of 2 by 60 and 2 by 40 degrees, seen from the origin, of two cells each way
  const auto wedge = parameters(folder, "builtin='wedge' params='3 3 60 40 0'");
  EXPECT_LT(wedge[3] / wedge[0], -.6);
  EXPECT_NEAR(0, wedge[1], 1e-6);
  EXPECT_NEAR(0, wedge[2], 1e-6);
}

// Boxes of the mesh's volume and moments, or around it, and what is made of their half lengths.
TEST(MeshAssets, FittedPrimitives) {
  NEEDS_MODULE();
  const Folder folder;
  const std::string asset = "<mesh name='m' " + in_text(brick) + "/>";
  const double a = .05, b = .125, c = .35;  // the longest is along z
  struct Case {
    const char* type;
    bool bounds;
    std::array<double, 3> size;
  };
  const double round = (a + b) / 2, around = std::hypot(a, b);
  for (const Case& x :
       {Case{"box", false, {2 * a, 2 * b, 2 * c}}, Case{"box", true, {2 * a, 2 * b, 2 * c}},
        Case{"sphere", false, {(a + b + c) / 3}}, Case{"sphere", true, {c}},
        Case{"capsule", false, {round, 2 * (c - round / 2)}}, Case{"capsule", true, {around, 2 * (c - around)}},
        Case{"cylinder", false, {round, 2 * c}}, Case{"cylinder", true, {around, 2 * c}}, Case{"ellipsoid", false, {a, b, c}}})
    for (const double scale : {1.0, 2.0}) {
      SCOPED_TRACE(x.type + std::string(x.bounds ? " around" : ""));
      const Model m = load(folder, asset, "mesh='m' type='" + std::string(x.type) + "' fitscale='" + decimal(scale) + "'",
                           x.bounds ? "fitaabb='true'" : "");
      dynShapeInfo s{};
      s.struct_size = sizeof s;
      ASSERT_EQ(DYN_OK, dyn_model_shape_info(m.get(), 0, &s));
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(scale * x.size[k], s.size[k], single) << k;
      const double middle[3] = {-2.95, 1.125, .65};
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(middle[k], s.placement[9 + k], single) << k;
      EXPECT_NEAR(1, std::abs(s.placement[8]), single);
    }
}

// Four counts (vertices, normals, texture coordinates, faces), then the numbers.
TEST(MeshAssets, MujocosFormat) {
  NEEDS_MODULE();
  const Folder folder;
  const Solid s = box(1, 2, 3);
  std::string bytes;
  for (const std::int32_t n : {8, 1, 2, 12}) append(bytes, n);
  for (double x : s.vertices) append(bytes, float(x));
  for (int k = 0; k < 3 * 1 + 2 * 2; ++k) append(bytes, 7.0f);
  for (std::int32_t i : s.triangles) append(bytes, i);
  folder.write("parts/m.msh", bytes);
  expect_parameters(of_box(1, 2, 3), parameters(folder, "file='parts/m.msh'"));
}

// Two sizes, then rows from the nearest one; a text begins with the farthest. Heights are scaled to their range.
TEST(MeshAssets, HeightFields) {
  const Folder folder;
  std::string bytes;
  append(bytes, std::int32_t(2)), append(bytes, std::int32_t(3));
  for (const float h : {1.f, 2.f, 3.f, 4.f, 5.f, 9.f}) append(bytes, h);
  folder.write("h.bin", bytes);
  for (const char* of : {"file='h.bin'", "nrow='2' ncol='3' elevation='4 5 9 1 2 3'"}) {
    SCOPED_TRACE(of);
    const std::string path =
        folder.write("m.xml", "<mujoco><asset><hfield name='h' size='2 1 .8 .5' " + std::string(of) +
                                  "/></asset><worldbody><geom type='hfield' hfield='h'/></worldbody></mujoco>");
    dynLoadOptions o;
    dyn_load_options_init(&o);
    dynModel* loaded = nullptr;
    ASSERT_EQ(DYN_OK, dyn_model_load(path.c_str(), &o, &loaded)) << dyn_last_error();
    const Model m(loaded);
    dynMesh* surface = nullptr;
    ASSERT_EQ(DYN_OK, dyn_model_shape_mesh(m.get(), 0, &surface)) << dyn_last_error();
    const Made made{DYN_OK, "", MeshHandle(surface)};
    const dynMeshArrays a = made.arrays();
    ASSERT_EQ(6u, a.vertex_count);
    const double expected[18] = {-2, -1, 0, 0, -1, .1, 2, -1, .2, -2, 1, .3, 0, 1, .4, 2, 1, .8};
    for (int k = 0; k < 18; ++k) EXPECT_NEAR(expected[k], a.vertices[k], 1e-15) << k;
  }
}

}  // namespace
}  // namespace dyn_test::assets_test
