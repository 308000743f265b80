// Meshes as collision shapes: alone, on links of a builder, and from robot files.
#include <limits>
#include <utility>

#include "mesh/meshes.hpp"

namespace dyn_test {
namespace {

using Pose = std::array<double, 12>;

Pose at(double x, double y, double z) { return {1, 0, 0, 0, 1, 0, 0, 0, 1, x, y, z}; }

dynGeometry geometry(dynShapeType type, const dynMesh* surface = nullptr, std::array<double, 3> size = {1, 1, 1}) {
  dynGeometry g;
  dyn_geometry_init(&g);
  g.type = type, g.surface = surface;
  if (!surface) std::copy(size.begin(), size.end(), g.size);
  return g;
}
dynStatus distance(const dynGeometry& a, const dynGeometry& b, const Pose& B, dynDistance& out) {
  out = {};
  out.struct_size = sizeof out;
  return dyn_geometry_distance(&a, at(0, 0, 0).data(), &b, B.data(), 0, &out);
}
double distance(const dynGeometry& a, const dynGeometry& b, const Pose& B) {
  dynDistance out;
  EXPECT_EQ(DYN_OK, distance(a, b, B, out)) << dyn_last_error();
  EXPECT_NE(DYN_DISTANCE_STATUS_FAILED, out.status);
  return out.distance;
}

TEST(MeshShapes, TrianglesOfABox) {
  const Made mesh = mesh_of(box(1, 1, 1).moved(-0.5, -0.5, -0.5));
  const dynGeometry a = geometry(DYN_SHAPE_TYPE_TRIANGLES, mesh.mesh.get()), b = geometry(DYN_SHAPE_TYPE_BOX);
  dynShapeTypeInfo info{};
  info.struct_size = sizeof info;
  for (int type = DYN_SHAPE_TYPE_BOX; dyn_shape_type_info(dynShapeType(type), &info) == DYN_OK; ++type) {
    if (info.sizes == 0) continue;
    const dynGeometry c = geometry(dynShapeType(type), nullptr, {0.3, 0.4, 0.5});
    for (const Pose& X : {at(1, 0.2, 0.1), at(0.9, 0.8, 1.1), at(-2, 0, 0)}) {
      EXPECT_NEAR(distance(b, c, X), distance(a, c, X), 1e-9);
      EXPECT_NEAR(distance(b, c, X), distance(c, a, at(-X[9], -X[10], -X[11])), 1e-9);
    }
  }
  const dynGeometry floor = geometry(DYN_SHAPE_TYPE_HALF_SPACE);
  EXPECT_NEAR(0.2, distance(a, floor, at(0, 0, -0.7)), 1e-12);
  EXPECT_NEAR(-0.1, distance(a, floor, at(0, 0, -0.4)), 1e-12);
  EXPECT_NEAR(0.5, distance(a, a, at(1.5, 0, 0)), 1e-9);
}

TEST(MeshShapes, RaysClosestPointsSweepsAndContacts) {
  const Made mesh = mesh_of(box(1, 1, 1).moved(-0.5, -0.5, -0.5));
  const dynGeometry a = geometry(DYN_SHAPE_TYPE_TRIANGLES, mesh.mesh.get()),
                    ball = geometry(DYN_SHAPE_TYPE_SPHERE, nullptr, {0.1, 0, 0});
  const Pose here = at(0, 0, 0), side = at(0, 0.8, 0), above = at(0.1, 0.2, 0.65);
  dynRayHit hit{};
  hit.struct_size = sizeof hit;
  const double from[] = {2, 0.1, 0.2}, along[] = {-2, 0, 0};
  ASSERT_EQ(DYN_OK, dyn_geometry_ray(&a, here.data(), from, along, &hit)) << dyn_last_error();
  EXPECT_NEAR(0.75, hit.t, 1e-12);
  EXPECT_NEAR(1, hit.normal[0], 1e-12);
  dynClosestPoint near{};
  near.struct_size = sizeof near;
  ASSERT_EQ(DYN_OK, dyn_geometry_closest_point(&a, here.data(), from, &near)) << dyn_last_error();
  EXPECT_NEAR(1.5, near.distance, 1e-12);
  // past the side of the box, perpendicular to its normal, into a wall far ahead
  Solid two = box(1, 1, 1).moved(-0.5, -0.5, -0.5);
  two.add(box(1, 1, 1).moved(3, 0.3, -0.5));
  const Made walls = mesh_of(two);
  const dynGeometry b = geometry(DYN_SHAPE_TYPE_TRIANGLES, walls.mesh.get());
  const double still[6] = {}, motion[6] = {1, 0, 0, 0, 0, 0};
  dynImpact impact{};
  impact.struct_size = sizeof impact;
  ASSERT_EQ(DYN_OK,
            dyn_geometry_sweep(with<dynGeometryPair>({0, &b, &ball, here.data(), side.data(), still, motion}), 5, 0, &impact))
      << dyn_last_error();
  EXPECT_EQ(DYN_SWEEP_STATUS_HIT, impact.status);
  EXPECT_NEAR(2.9, impact.time, 1e-3);
  dynContact contacts[DYN_MAX_CONTACTS_PER_PAIR];
  int count = 0;
  ASSERT_EQ(DYN_OK, dyn_geometry_contacts(with<dynGeometryPair>({0, &a, &ball, here.data(), above.data(), nullptr, nullptr}), 0.1,
                                          0, contacts, &count))
      << dyn_last_error();
  ASSERT_EQ(1, count);
  EXPECT_NEAR(0.05, contacts[0].distance, 1e-12);
  EXPECT_NEAR(0.525, contacts[0].position[2], 1e-12);
}

TEST(MeshShapes, HeightFields) {
  const Made flat = height_field(std::vector<double>(15, 0.5), 5, 3);  // 2 x 1, from -1 to 0.5
  ASSERT_EQ(DYN_OK, flat.status) << flat.error;
  EXPECT_EQ(15, flat.info().vertices);
  EXPECT_EQ(16, flat.info().triangles);
  EXPECT_NEAR(2, flat.info().area, 1e-14);
  const dynGeometry field = geometry(DYN_SHAPE_TYPE_HEIGHT_FIELD, flat.mesh.get()),
                    ball = geometry(DYN_SHAPE_TYPE_SPHERE, nullptr, {0.2, 0, 0}),
                    cube = geometry(DYN_SHAPE_TYPE_BOX, nullptr, {0.4, 0.4, 0.4});
  EXPECT_NEAR(0.3, distance(field, ball, at(0.3, 0.1, 1)), 1e-12);
  EXPECT_NEAR(-0.1, distance(field, ball, at(0.3, 0.1, 0.6)), 1e-12);
  EXPECT_NEAR(-0.4, distance(field, ball, at(0.3, 0.1, 0.3)), 1e-12);
  EXPECT_NEAR(0.3, distance(field, cube, at(0.3, 0.1, 1)), 1e-9);
  EXPECT_NEAR(-0.05, distance(field, cube, at(0.3, 0.1, 0.65)), 1e-9);
  EXPECT_NEAR(0.8, distance(field, ball, at(2, 0, 0)), 1e-12);
  // the top of a pyramid
  const Made peak = height_field({0, 0, 0, 0, 1, 0, 0, 0, 0}, 3, 3);
  EXPECT_NEAR(0.8, distance(geometry(DYN_SHAPE_TYPE_HEIGHT_FIELD, peak.mesh.get()), ball, at(0, 0, 2)), 1e-12);
}

TEST(MeshShapes, BadHeightFields) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto refused = [](dynStatus status, const char* words, const Made& m) {
    EXPECT_EQ(status, m.status);
    m.says(words);
  };
  refused(DYN_ERROR_INVALID, "1 x 3 points", height_field({0, 0, 0}, 1, 3));
  refused(DYN_ERROR_INVALID, "-2 x 3 points", height_field({0, 0, 0}, -2, 3));
  refused(DYN_ERROR_LIMIT, "limit is 5000000", height_field({0, 0, 0}, 100000, 100000));
  refused(DYN_ERROR_NONFINITE, "column 1, row 1", height_field({0, 0, 0, nan}, 2, 2));
  refused(DYN_ERROR_INVALID, "not above the bottom", height_field({0, 0, -3, 0}, 2, 2));
  refused(DYN_ERROR_INVALID, "a step of 0 m", height_field({0, 0, 0, 0}, 2, 2, 0));
  refused(DYN_ERROR_NONFINITE, "a step of", height_field({0, 0, 0, 0}, 2, 2, 1, inf));
  refused(DYN_ERROR_NONFINITE, "bottom", height_field({0, 0, 0, 0}, 2, 2, 1, 1, nan));
  refused(DYN_ERROR_LIMIT, "reaches", height_field(std::vector<double>(8, 0), 4, 2, 1e12, 1e12));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_mesh_from_height_field(with<dynHeightField>({0, 2, 2, nullptr, 1, 1, 0}), nullptr));
}

TEST(MeshShapes, BadSurfaces) {
  const Made mesh = mesh_of(box(1, 1, 1)), cloud = mesh_of({{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, {}});
  dynDistance out;
  const dynGeometry b = geometry(DYN_SHAPE_TYPE_BOX);
  const auto refused = [&](dynStatus status, const char* words, dynShapeType type, const dynMesh* surface) {
    dynGeometry g = geometry(type, surface);
    std::fill_n(g.size, 3, 1);
    EXPECT_EQ(status, distance(g, b, at(3, 0, 0), out)) << words;
    EXPECT_NE(nullptr, std::strstr(dyn_last_error(), words)) << dyn_last_error();
    EXPECT_EQ(status, distance(b, g, at(3, 0, 0), out)) << words;
  };
  for (const dynShapeType type : {DYN_SHAPE_TYPE_CONVEX, DYN_SHAPE_TYPE_TRIANGLES, DYN_SHAPE_TYPE_HEIGHT_FIELD})
    refused(DYN_ERROR_ARGUMENT, "surface is NULL", type, nullptr);
  refused(DYN_ERROR_ARGUMENT, "no hull", DYN_SHAPE_TYPE_CONVEX, mesh.mesh.get());
  refused(DYN_ERROR_ARGUMENT, "no height field", DYN_SHAPE_TYPE_HEIGHT_FIELD, mesh.mesh.get());
  refused(DYN_ERROR_ARGUMENT, "a cloud of points", DYN_SHAPE_TYPE_TRIANGLES, cloud.mesh.get());
  refused(DYN_ERROR_ARGUMENT, "leave surface NULL", DYN_SHAPE_TYPE_BOX, mesh.mesh.get());
  refused(DYN_ERROR_UNSUPPORTED, "a name alone", DYN_SHAPE_TYPE_MESH, mesh.mesh.get());
  dynMesh* gone = mesh_of(box(1, 1, 1)).mesh.release();
  dyn_mesh_free(gone);
  refused(DYN_ERROR_HANDLE, "freed", DYN_SHAPE_TYPE_TRIANGLES, gone);
}

TEST(MeshShapes, HullsOfPoints) {
  const Made hull = mesh_of({box(1, 1, 1).moved(-0.5, -0.5, -0.5).vertices, {}}).hull();
  ASSERT_EQ(DYN_OK, hull.status) << hull.error;
  const dynGeometry a = geometry(DYN_SHAPE_TYPE_CONVEX, hull.mesh.get()), b = geometry(DYN_SHAPE_TYPE_BOX),
                    c = geometry(DYN_SHAPE_TYPE_CYLINDER, nullptr, {0.3, 0.5, 0});
  for (const Pose& X : {at(1, 0.2, 0.1), at(0.9, 0.8, 1.1), at(0.3, 0.2, 0), at(-2, 0, 0)}) {
    EXPECT_NEAR(distance(b, c, X), distance(a, c, X), 1e-9);
    EXPECT_NEAR(distance(b, b, X), distance(a, a, X), 1e-9);
  }
  EXPECT_EQ(DYN_ERROR_INVALID, mesh_of({{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, {}}).hull().status);
}

// A hull of thousands of vertices, which uses hill climbing.
TEST(MeshShapes, LargeHulls) {
  const Made hull = mesh_of(icosphere(5)).hull();
  ASSERT_GT(hull.info().vertices, 10000);
  const dynGeometry a = geometry(DYN_SHAPE_TYPE_CONVEX, hull.mesh.get()),
                    ball = geometry(DYN_SHAPE_TYPE_SPHERE, nullptr, {1, 0, 0});
  for (int k = 0; k < 50; ++k) {
    const Pose X = at(3 * std::cos(k), 3 * std::sin(k), 2 * std::sin(3 * k));
    for (const dynGeometry& b : {geometry(DYN_SHAPE_TYPE_BOX), geometry(DYN_SHAPE_TYPE_CAPSULE, nullptr, {0.2, 1, 0}),
                                 geometry(DYN_SHAPE_TYPE_CYLINDER, nullptr, {0.2, 1, 0})}) {
      const double d = distance(a, b, X), expected = distance(ball, b, X);
      EXPECT_GE(d, expected - 1e-9);
      EXPECT_LE(d, expected + 2e-3);
    }
  }
}

}  // namespace
}  // namespace dyn_test
