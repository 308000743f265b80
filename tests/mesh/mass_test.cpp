// Mass properties of closed meshes against closed forms, and statistics of open meshes.
#include "mesh/meshes.hpp"

namespace dyn_test::mass_test {
namespace {

constexpr double exact = 1e-13;  // relative: rounding of a short sum

void expect_inertia(const dynMeshInfo& info, const std::array<double, 9>& expected, double tolerance) {
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(expected[k], info.inertia[k], tolerance) << k;
}

TEST(MeshMass, Box) {
  const double x = 0.3, y = 0.5, z = 1.1, at[3] = {4, -7, 2};
  const Made m = mesh_of(box(x, y, z).moved(at[0], at[1], at[2]));
  const dynMeshInfo i = m.info();
  EXPECT_EQ(8, i.vertices);
  EXPECT_EQ(12, i.triangles);
  EXPECT_EQ(1, i.components);
  EXPECT_EQ(1, i.closed);
  EXPECT_EQ(1, i.orientation);
  EXPECT_EQ(0, i.open_edges);
  EXPECT_EQ(0, i.flipped_edges);
  EXPECT_EQ(0, i.nonmanifold_edges);
  const double V = x * y * z;
  EXPECT_NEAR(V, i.volume, V * 1e-13);
  EXPECT_NEAR(2 * (x * y + y * z + z * x), i.area, 1e-13);
  const double size[3] = {x, y, z};
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(at[k] + size[k] / 2, i.com[k], 1e-14 * 8);
    EXPECT_EQ(at[k], i.lower[k]);
    EXPECT_EQ(at[k] + size[k], i.upper[k]);
  }
  expect_inertia(i, {V / 12 * (y * y + z * z), 0, 0, 0, V / 12 * (x * x + z * z), 0, 0, 0, V / 12 * (x * x + y * y)}, V * exact);
}

// Corners 0, a e_x, b e_y, c e_z: V = abc/6, com = (a, b, c)/4, integral of x^2 is a^2 V/10, of xy is ab V/20.
TEST(MeshMass, Tetrahedron) {
  const double a = 1.5, b = 0.4, c = 2.5, V = a * b * c / 6;
  const Made m = mesh_of({{0, 0, 0, a, 0, 0, 0, b, 0, 0, 0, c}, {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}});
  const dynMeshInfo i = m.info();
  EXPECT_EQ(1, i.orientation);
  EXPECT_NEAR(V, i.volume, V * exact);
  const double com[3] = {a / 4, b / 4, c / 4};
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(com[k], i.com[k], exact);
  const auto square = [&](double s) { return V * s * s * (0.1 - 1.0 / 16); };
  const auto product = [&](double s, double t) { return V * s * t * (1.0 / 20 - 1.0 / 16); };
  expect_inertia(i,
                 {square(b) + square(c), -product(a, b), -product(a, c), -product(a, b), square(a) + square(c), -product(b, c),
                  -product(a, c), -product(b, c), square(a) + square(b)},
                 V * exact * 10);
}

// Twenty equal pyramids: V = 5 (3 + sqrt 5) / 12 s^3, I = (5 + sqrt 5 ... ) by its isotropy: I = (3 + sqrt 5) / 20 m s^2 (edge
// s).
TEST(MeshMass, Icosahedron) {
  const Made m = mesh_of(icosphere(0));
  const dynMeshInfo i = m.info();
  const double g = (1 + std::sqrt(5.0)) / 2, edge = 2 / std::sqrt(1 + g * g),
               V = 5 * (3 + std::sqrt(5.0)) / 12 * edge * edge * edge;
  EXPECT_NEAR(V, i.volume, V * exact);
  const double I = V * g * g / 10 * edge * edge;
  expect_inertia(i, {I, 0, 0, 0, I, 0, 0, 0, I}, V * exact);
  EXPECT_NEAR(5 * std::sqrt(3.0) * edge * edge, i.area, 1e-12);
}

// Reference from the triangles in long double: pyramids from the centre. Also close to the ball's values.
TEST(MeshMass, Icosphere) {
  const Solid s = icosphere(4);
  const dynMeshInfo i = mesh_of(s).info();
  EXPECT_EQ(2562, i.vertices);
  EXPECT_EQ(5120, i.triangles);
  long double V = 0, xx = 0, yy = 0;
  for (std::size_t t = 0; t < s.m(); ++t) {
    const double *a = &s.vertices[std::size_t(3 * s.triangles[3 * t])], *b = &s.vertices[std::size_t(3 * s.triangles[3 * t + 1])],
                 *c = &s.vertices[std::size_t(3 * s.triangles[3 * t + 2])];
    const long double v = (a[0] * (b[1] * (long double)c[2] - b[2] * (long double)c[1]) +
                           a[1] * (b[2] * (long double)c[0] - b[0] * (long double)c[2]) +
                           a[2] * (b[0] * (long double)c[1] - b[1] * (long double)c[0])) /
                          6;
    V += v;
    xx += v / 10 * (a[0] * a[0] + b[0] * b[0] + c[0] * c[0] + a[0] * b[0] + b[0] * c[0] + c[0] * a[0]);
    yy += v / 10 * (a[1] * a[1] + b[1] * b[1] + c[1] * c[1] + a[1] * b[1] + b[1] * c[1] + c[1] * a[1]);
  }
  EXPECT_NEAR(double(V), i.volume, 1e-13);
  EXPECT_NEAR(double(xx + yy), i.inertia[8], 1e-13);
  EXPECT_NEAR(4 * M_PI / 3, i.volume, 0.01);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(0, i.com[k], 1e-14);
}

TEST(MeshMass, FarFromTheOrigin) {
  const dynMeshInfo i = mesh_of(box(1, 1, 1).moved(1e6, -1e6, 1e6)).info();
  EXPECT_NEAR(1, i.volume, 1e-12);
  EXPECT_NEAR(1.0 / 6, i.inertia[0], 1e-12);
  EXPECT_NEAR(0, i.inertia[1], 1e-12);
}

TEST(MeshMass, InsideOut) {
  const dynMeshInfo i = mesh_of(box(1, 2, 3).turned_round()).info();
  EXPECT_EQ(-1, i.orientation);
  EXPECT_EQ(1, i.closed);
  EXPECT_NEAR(6, i.volume, 1e-13);
  EXPECT_NEAR(6.0 / 12 * 13, i.inertia[0], 1e-12);
  EXPECT_NEAR(0.5, i.com[0], 1e-13);
}

TEST(MeshMass, CavityAndSeveralParts) {
  Solid hollow = box(3, 3, 3), hole = box(1, 1, 1);
  hollow.add(hole.moved(1, 1, 1).turned_round());
  dynMeshInfo i = mesh_of(hollow).info();
  EXPECT_EQ(2, i.components);
  EXPECT_EQ(1, i.orientation);
  EXPECT_NEAR(26, i.volume, 1e-12);
  EXPECT_NEAR((27 * 9 * 2 - 2) / 12.0, i.inertia[0], 1e-12);
  Solid two = box(1, 1, 1);
  two.add(box(1, 1, 1).moved(4, 0, 0));
  i = mesh_of(two).info();
  EXPECT_EQ(2, i.components);
  EXPECT_NEAR(2, i.volume, 1e-13);
  EXPECT_NEAR(2.5, i.com[0], 1e-13);
}

TEST(MeshMass, OpenFlippedAndCrowdedEdges) {
  Solid s = box(1, 1, 1);
  s.triangles.resize(s.triangles.size() - 3);  // a hole of one triangle
  dynMeshInfo i = mesh_of(s).info();
  EXPECT_EQ(3, i.open_edges);
  EXPECT_EQ(0, i.closed);
  EXPECT_EQ(0, i.orientation);
  EXPECT_EQ(0, i.convex);
  EXPECT_TRUE(std::isnan(i.volume) && std::isnan(i.com[1]) && std::isnan(i.inertia[8]) && std::isnan(i.hull_volume_ratio));

  s = box(1, 1, 1);
  std::swap(s.triangles[0], s.triangles[1]);  // one triangle inside out
  i = mesh_of(s).info();
  EXPECT_EQ(0, i.open_edges);
  EXPECT_EQ(3, i.flipped_edges);
  EXPECT_EQ(0, i.closed);
  EXPECT_TRUE(std::isnan(i.volume));

  s = box(1, 1, 1);
  s.add(box(1, 1, 1).moved(1, 1, 0));  // two that share an edge
  i = mesh_of(s).info();
  EXPECT_EQ(2, i.welded);
  EXPECT_EQ(1, i.nonmanifold_edges);
  EXPECT_EQ(1, i.closed);
  EXPECT_EQ(1, i.components);
  EXPECT_NEAR(2, i.volume, 1e-13);
}

TEST(MeshMass, WhatIsDropped) {
  Solid s = box(1, 1, 1);
  s.add(box(1, 1, 1));  // the same box again
  s.triangles.insert(s.triangles.end(), {0, 0, 1, 3, 11, 5});  // two equal corners, by index and by position
  s.vertices.insert(s.vertices.end(), {7, 7, 7});              // a vertex of no triangle
  const dynMeshInfo i = mesh_of(s).info();
  EXPECT_EQ(8, i.vertices);
  EXPECT_EQ(12, i.triangles);
  EXPECT_EQ(8, i.welded);
  EXPECT_EQ(12, i.duplicates);
  EXPECT_EQ(2, i.degenerate);
  EXPECT_NEAR(1, i.volume, 1e-13);
  EXPECT_EQ(1, i.upper[0]);
}

// A triangle without area still joins its neighbours: the solid stays closed without it.
TEST(MeshMass, NeedlesKeepTheMeshClosed) {
  // a tetrahedron with a point on one side of an edge only; the needle closes the gap
  const Solid s = {{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0, 0}, {0, 2, 4, 4, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 0, 4, 1}};
  const dynMeshInfo i = mesh_of(s).info();
  EXPECT_EQ(1, i.degenerate);
  EXPECT_EQ(5, i.triangles);
  EXPECT_EQ(1, i.closed);
  EXPECT_EQ(0, i.open_edges);
  EXPECT_NEAR(1.0 / 6, i.volume, 1e-14);
}

TEST(MeshMass, NegativeZeroIsZero) {
  const Solid s = {{-0.0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, -0.0, 0}, {0, 2, 1, 0, 1, 3, 4, 3, 2, 1, 2, 3}};
  const dynMeshInfo i = mesh_of(s).info();
  EXPECT_EQ(4, i.vertices);
  EXPECT_EQ(1, i.closed);
}

TEST(MeshArrays, AreViews) {
  const Made m = mesh_of(box(1, 2, 3));
  const dynMeshArrays a = m.arrays(), b = m.arrays();
  EXPECT_EQ(8u, a.vertex_count);
  EXPECT_EQ(12u, a.triangle_count);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(0u, a.face_count);
  EXPECT_EQ(nullptr, a.planes);
}

TEST(MeshErrors, Arrays) {
  const auto refused = [](const Solid& s, dynStatus status, const std::string& words) {
    const Made m = mesh_of(s);
    EXPECT_EQ(status, m.status);
    EXPECT_TRUE(m.says(words));
  };
  Solid s = box(1, 1, 1);
  s.vertices[7] = NAN;
  refused(s, DYN_ERROR_NONFINITE, "vertex 2 has y = NaN");
  s.vertices[7] = -INFINITY;
  refused(s, DYN_ERROR_NONFINITE, "vertex 2 has y = infinity");
  s.vertices[7] = 1e31;
  refused(s, DYN_ERROR_LIMIT, "the limit is 1e+30");
  s = box(1, 1, 1);
  s.triangles[4] = 8;
  refused(s, DYN_ERROR_ARGUMENT, "triangle 1 has the vertex 8: give 0 to 7");
  s.triangles[4] = -1;
  refused(s, DYN_ERROR_ARGUMENT, "triangle 1 has the vertex -1");
  refused({{0, 0, 0, 1, 1, 1, 2, 2, 2}, {0, 1, 2}}, DYN_ERROR_INVALID, "no triangle has an area");
  refused({{}, {}}, DYN_ERROR_ARGUMENT, "no vertices");

  dynMesh* m = nullptr;
  const double v[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::int32_t t[3] = {0, 1, 2};
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_mesh_from_arrays(nullptr, 3, t, 1, &m));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_mesh_from_arrays(v, 3, nullptr, 1, &m));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_mesh_from_arrays(v, 3, t, 1, nullptr));
  const std::vector<double> one(3);
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_mesh_from_arrays(one.data(), 1, t, 10000001, &m));
  EXPECT_NE(std::string::npos, std::string(dyn_last_error()).find("10000001 triangles, and the limit is 10000000"));
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_mesh_from_arrays(one.data(), SIZE_MAX, t, 1, &m));
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_mesh_from_arrays(one.data(), 30000001, t, 1, &m));
  EXPECT_NE(std::string::npos, std::string(dyn_last_error()).find("30000001 vertices, and the limit is 30000000"));
  EXPECT_EQ(nullptr, m);
}

TEST(MeshErrors, Handles) {
  dynMeshInfo info{};
  info.struct_size = sizeof info;
  dynMeshArrays arrays{};
  arrays.struct_size = sizeof arrays;
  dynMesh* hull = nullptr;
  Made m = mesh_of(box(1, 1, 1));
  dynMesh* const freed = m.mesh.get();
  m.mesh.reset();
  dyn_mesh_free(freed), dyn_mesh_free(nullptr);
  alignas(64) static unsigned char zeros[256];
  for (const dynMesh* bad :
       {static_cast<const dynMesh*>(nullptr), static_cast<const dynMesh*>(freed), reinterpret_cast<const dynMesh*>(zeros)}) {
    EXPECT_EQ(DYN_ERROR_HANDLE, dyn_mesh_info(bad, &info));
    EXPECT_EQ(DYN_ERROR_HANDLE, dyn_mesh_arrays(bad, &arrays));
    EXPECT_EQ(DYN_ERROR_HANDLE, dyn_mesh_hull(bad, &hull));
    EXPECT_EQ(DYN_ERROR_HANDLE, dyn_mesh_rgb(bad, info.com));
    EXPECT_NE(std::string::npos, std::string(dyn_last_error()).find("mesh"));
  }
  EXPECT_EQ(nullptr, hull);
  m = mesh_of(box(1, 1, 1));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_mesh_info(m.mesh.get(), nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_mesh_arrays(m.mesh.get(), nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_mesh_hull(m.mesh.get(), nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_mesh_rgb(m.mesh.get(), nullptr));
  info.struct_size = 8, arrays.struct_size = 8;
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_mesh_info(m.mesh.get(), &info));
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_mesh_arrays(m.mesh.get(), &arrays));
}

}  // namespace
}  // namespace dyn_test::mass_test
