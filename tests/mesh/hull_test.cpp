// Convex hulls: points inside, Euler's formula, consistent neighbours and faces; and tests of convexity.
#include <algorithm>
#include <random>
#include <set>

#include "mesh/meshes.hpp"

namespace dyn_test {
namespace {

using Points = std::vector<double>;

Made cloud(const Points& p) { return mesh_of({p, {}}); }

// All properties of a hull of these points.
void expect_hull(const Points& points, const Made& hull, double tolerance) {
  ASSERT_EQ(DYN_OK, hull.status) << hull.error;
  const dynMeshArrays h = hull.arrays();
  ASSERT_GE(h.vertex_count, 4u);
  ASSERT_GE(h.face_count, 4u);
  double size = 0;
  for (double x : points) size = std::max(size, std::abs(x));
  // every point is inside, every plane has a unit normal
  for (std::size_t f = 0; f < h.face_count; ++f) {
    const double* n = h.planes + 4 * f;
    EXPECT_NEAR(1, std::hypot(n[0], n[1], n[2]), 1e-15 * 4);
    for (std::size_t i = 0; i < points.size(); i += 3)
      ASSERT_LE(n[0] * points[i] + n[1] * points[i + 1] + n[2] * points[i + 2], n[3] + tolerance * size)
          << "face " << f << " point " << i / 3;
  }
  // corners are given points
  std::set<std::array<double, 3>> given, corners;
  for (std::size_t i = 0; i < points.size(); i += 3) given.insert({points[i], points[i + 1], points[i + 2]});
  for (std::size_t c = 0; c < h.vertex_count; ++c) {
    const std::array<double, 3> x = {h.vertices[3 * c], h.vertices[3 * c + 1], h.vertices[3 * c + 2]};
    EXPECT_TRUE(given.count(x)) << c;
    EXPECT_TRUE(corners.insert(x).second) << c;
  }
  // corners of a face lie on it counter-clockwise; each edge lies between two faces
  std::set<std::pair<int, int>> edges;
  for (std::size_t f = 0; f < h.face_count; ++f) {
    const double* n = h.planes + 4 * f;
    double area[3] = {0, 0, 0};
    for (std::int32_t k = h.face_start[f]; k < h.face_start[f + 1]; ++k) {
      const int a = h.face_corners[k], b = h.face_corners[k + 1 < h.face_start[f + 1] ? k + 1 : h.face_start[f]];
      EXPECT_TRUE(edges.insert({a, b}).second) << a << " " << b;
      const double *p = h.vertices + 3 * a, *q = h.vertices + 3 * b;
      EXPECT_NEAR(n[3], n[0] * p[0] + n[1] * p[1] + n[2] * p[2], tolerance * size) << "face " << f;
      for (int c = 0; c < 3; ++c) area[c] += p[(c + 1) % 3] * q[(c + 2) % 3] - p[(c + 2) % 3] * q[(c + 1) % 3];
    }
    EXPECT_GT(area[0] * n[0] + area[1] * n[1] + area[2] * n[2], 0) << "face " << f;
  }
  for (const auto& [a, b] : edges) EXPECT_TRUE(edges.count({b, a})) << a << " " << b;
  EXPECT_EQ(2, int(h.vertex_count) - int(edges.size() / 2) + int(h.face_count));
  // neighbours are the edges
  std::set<std::pair<int, int>> neighbours;
  for (std::size_t c = 0; c < h.vertex_count; ++c) {
    EXPECT_GE(h.neighbour_start[c + 1] - h.neighbour_start[c], 3);
    for (std::int32_t k = h.neighbour_start[c]; k < h.neighbour_start[c + 1]; ++k) neighbours.insert({int(c), h.neighbours[k]});
  }
  EXPECT_EQ(edges, neighbours);
  const dynMeshInfo i = hull.info();
  EXPECT_EQ(1, i.closed);
  EXPECT_EQ(1, i.orientation);
  EXPECT_EQ(1, i.convex);
  EXPECT_EQ(1, i.components);
  EXPECT_NEAR(1, i.hull_volume_ratio, 1e-9);
}

Points random_points(int n, unsigned seed, bool on_sphere) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Points p;
  for (int i = 0; i < n; ++i) {
    const double x[3] = {normal(random), normal(random), normal(random)}, r = on_sphere ? std::hypot(x[0], x[1], x[2]) : 1;
    p.insert(p.end(), {x[0] / r, x[1] / r, x[2] / r});
  }
  return p;
}

TEST(MeshHull, RandomPoints) {
  NEEDS_MODULE();
  for (int n : {4, 5, 10, 100, 2000})
    for (unsigned seed = 1; seed <= 5; ++seed) {
      SCOPED_TRACE(std::to_string(n) + " points, seed " + std::to_string(seed));
      const Points p = random_points(n, seed, seed % 2);
      expect_hull(p, cloud(p).hull(), 1e-13);
    }
}

TEST(MeshHull, CoplanarTrianglesAreOneFace) {
  NEEDS_MODULE();
  Points grid;  // lattice points, whose hull is a cube of 8 corners and 6 faces
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 6; ++y)
      for (int z = 0; z < 6; ++z) grid.insert(grid.end(), {0.1 * x, 0.1 * y, 0.1 * z});
  const Made hull = cloud(grid).hull();
  expect_hull(grid, hull, 1e-13);
  EXPECT_EQ(8u, hull.arrays().vertex_count);
  EXPECT_EQ(6u, hull.arrays().face_count);
  EXPECT_NEAR(0.125, hull.info().volume, 1e-14);
}

TEST(MeshHull, PrismsAndScales) {
  NEEDS_MODULE();
  for (int sides : {3, 7, 64, 500})
    for (double scale : {1e-9, 1e-3, 1.0, 1e6}) {
      SCOPED_TRACE(std::to_string(sides) + " sides, scale " + std::to_string(scale));
      Points p;
      for (int i = 0; i < sides; ++i)
        for (double z : {-1.0, 1.0})
          p.insert(p.end(), {scale * std::cos(2 * M_PI * i / sides), scale * std::sin(2 * M_PI * i / sides), scale * z});
      const Made hull = cloud(p).hull();
      expect_hull(p, hull, 1e-13);
      EXPECT_EQ(std::size_t(sides + 2), hull.arrays().face_count);
    }
}

TEST(MeshHull, NearlyDegenerate) {
  NEEDS_MODULE();
  // noise of 1e-12 on the faces of a cube, and a plate of thickness 1e-4
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  Points cube, plate;
  for (int i = 0; i < 500; ++i) {
    double x[3] = {u(random), u(random), u(random)};
    x[i % 3] = (i & 8 ? 1 : -1) * (1 + 1e-12 * u(random));
    cube.insert(cube.end(), x, x + 3);
    plate.insert(plate.end(), {u(random), u(random), 1e-4 * u(random)});
  }
  expect_hull(cube, cloud(cube).hull(), 1e-11);
  expect_hull(plate, cloud(plate).hull(), 1e-13);
}

TEST(MeshHull, Errors) {
  NEEDS_MODULE();
  const auto refused = [](const Points& p, const std::string& words) {
    const Made h = cloud(p).hull();
    EXPECT_EQ(DYN_ERROR_INVALID, h.status);
    EXPECT_TRUE(h.says(words));
  };
  refused({0, 0, 0, 1, 0, 0, 0, 1, 0}, "four points");
  refused({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "four points");
  refused({0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4, 0, 0}, "plane");
  refused({0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1, 0.3, 0.4, 1}, "plane");
  Points tilted;
  for (int i = 0; i < 100; ++i) tilted.insert(tilted.end(), {std::cos(i), std::sin(i), 0.3 * std::cos(i) - 0.7 * std::sin(i)});
  refused(tilted, "plane");
  // flat meshes have no hull, and info reports it
  const Made flat = mesh_of({{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, {0, 1, 2, 1, 3, 2}});
  const dynMeshInfo i = flat.info();
  EXPECT_EQ(DYN_ERROR_INVALID, i.hull_status);
  EXPECT_TRUE(std::isnan(i.hull_volume));
  EXPECT_EQ(0, i.convex);
  EXPECT_EQ(4, i.open_edges);
}

TEST(MeshConvex, BoxAndSphere) {
  NEEDS_MODULE();
  for (const Solid& s : {box(1, 2, 3).moved(-5, 0, 0), icosphere(0), icosphere(4)}) {
    const dynMeshInfo i = mesh_of(s).info();
    EXPECT_EQ(1, i.convex);
    EXPECT_NEAR(1, i.hull_volume_ratio, 1e-12);
    EXPECT_LT(i.hull_depth, 1e-13);
  }
}

// Single precision, as in files, is still convex.
TEST(MeshConvex, Rounded) {
  NEEDS_MODULE();
  Solid s = icosphere(4);
  for (double& x : s.vertices) x = float(x * 0.1 + 0.37);
  EXPECT_EQ(1, mesh_of(s).info().convex);
}

TEST(MeshConvex, DentsAreSeen) {
  NEEDS_MODULE();
  Solid s = icosphere(3);
  for (std::size_t k = 300; k < 303; ++k) s.vertices[k] *= 1 - 0.02;
  dynMeshInfo i = mesh_of(s).info();
  EXPECT_EQ(0, i.convex);
  EXPECT_GT(i.hull_depth, 1e-4);
  EXPECT_GT(i.hull_volume_ratio, 1.00001);

  // not convex, though all vertices lie on the hull: a box whose top is split along the deep diagonal
  s = box(1, 1, 1);
  s.vertices[14] = s.vertices[23] = 1.1;  // corners 4 and 7 of the top are higher
  s.triangles[9] = 4, s.triangles[10] = 5, s.triangles[11] = 6, s.triangles[6] = 5, s.triangles[7] = 7, s.triangles[8] = 6,
  s.triangles[9] = 4, s.triangles[10] = 5, s.triangles[11] = 6;
  i = mesh_of(s).info();
  EXPECT_EQ(1, i.closed);
  EXPECT_EQ(0, i.convex);
  EXPECT_EQ(8, i.vertices);
  EXPECT_GT(i.hull_depth, 0.01);

  // an L shape
  Solid l = box(2, 1, 1);
  l.add(box(1, 1, 1).moved(0, 0, 1));
  i = mesh_of(l).info();
  EXPECT_EQ(0, i.convex);
  EXPECT_NEAR(3.5 / 3, i.hull_volume_ratio, 1e-12);
}

TEST(MeshConvex, TwoConvexPartsAreNotOne) {
  NEEDS_MODULE();
  Solid s = box(1, 1, 1);
  s.add(box(1, 1, 1).moved(1e-7, 0, 0));
  EXPECT_EQ(0, mesh_of(s).info().convex);
}

}  // namespace
}  // namespace dyn_test
