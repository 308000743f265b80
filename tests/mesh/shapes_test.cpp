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

Made height_field(const std::vector<double>& h, int columns, int rows, double x = 0.5, double y = 0.5, double bottom = -1) {
  dynMesh* m = nullptr;
  const dynStatus status = dyn_mesh_from_height_field(with<dynHeightField>({0, columns, rows, h.data(), x, y, bottom}), &m);
  EXPECT_EQ(status == DYN_OK, m != nullptr);
  return {status, status == DYN_OK ? "" : dyn_last_error(), MeshHandle(m)};
}

// an L shape: 2 x 2 x 1 less a quarter
Solid corner_piece() {
  Solid s;
  const double xy[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const double z : {0.0, 1.0})
    for (const auto& p : xy) s.vertices.insert(s.vertices.end(), {p[0], p[1], z});
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    s.triangles.insert(s.triangles.end(), {i, j, j + 6, i, j + 6, i + 6});
  }
  for (const auto& t : {std::array<int, 3>{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}})
    s.triangles.insert(s.triangles.end(), {t[0] + 6, t[1] + 6, t[2] + 6, t[0], t[2], t[1]});
  return s;
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

struct Robot {
  dynModel* m = nullptr;
  dynData* d = nullptr;
  dynStatus status = DYN_OK;
  std::string error;
  Robot() = default;
  Robot(Robot&& r) noexcept : m(std::exchange(r.m, nullptr)), d(std::exchange(r.d, nullptr)), status(r.status), error(r.error) {}
  Robot& operator=(Robot&& r) noexcept {
    std::swap(m, r.m), std::swap(d, r.d), std::swap(status, r.status), std::swap(error, r.error);
    return *this;
  }
  ~Robot() { dyn_data_free(d), dyn_model_free(m); }
  dynShapeInfo shape(int k) const {
    dynShapeInfo s{};
    s.struct_size = sizeof s;
    EXPECT_EQ(DYN_OK, dyn_model_shape_info(m, k, &s));
    return s;
  }
  std::string report() const {
    std::string all;
    for (int k = 0; k < dyn_model_report_count(m); ++k) {
      dynReportEntry e{};
      e.struct_size = sizeof e;
      EXPECT_EQ(DYN_OK, dyn_model_report_entry(m, k, &e));
      all += std::string(e.level == DYN_REPORT_LEVEL_WARNING ? "warning: " : "info: ") + e.message + "\n";
    }
    return all;
  }
  std::vector<double> distances(const std::vector<double>& q) {
    std::vector<double> out(std::size_t(dyn_model_npairs(m)), -77);
    EXPECT_EQ(DYN_OK, dyn_distances(m, d, q.data(), out.data())) << dyn_last_error();
    return out;
  }
};
Robot data_of(Robot r) {
  if (r.m) {
    EXPECT_EQ(DYN_OK, dyn_data_new(r.m, DYN_PART_COLLISION, &r.d)) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_data_set_pair(r.m, r.d, -1, 1));  // enables pairs that overlap at q = 0 too
  }
  return r;
}
Robot load(const std::string& path, dynMeshUse use) {
  dynLoadOptions o;
  dyn_load_options_init(&o);
  o.base = DYN_BASE_FIXED, o.meshes = use;
  Robot r;
  r.status = dyn_model_load(path.c_str(), &o, &r.m);
  r.error = r.status == DYN_OK ? "" : dyn_last_error();
  return data_of(std::move(r));
}
bool holds(const std::string& text, const std::string& words) {
  if (text.find(words) != text.npos) return true;
  ADD_FAILURE() << "'" << words << "' is not in: " << text;
  return false;
}

// A table, an arm with a mesh used twice, a ball that slides along x.
std::string robot(const std::string& mesh, const std::string& scale = "1 1 1") {
  const std::string part = "<geometry><mesh filename='" + mesh + "' scale='" + scale + "'/></geometry>";
  return "<robot name='r'><link name='base'><visual>" + part + "</visual><collision>" + part +
         "</collision></link>"
         "<link name='ball'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>"
         "<collision><geometry><sphere radius='0.1'/></geometry></collision></link>"
         "<link name='other'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>"
         "<collision><origin xyz='0 0 0'/>" +
         part +
         "</collision></link>"
         "<joint name='slide' type='prismatic'><parent link='base'/><child link='ball'/><origin xyz='0 1.5 0.5'/><axis xyz='1 0 "
         "0'/><limit effort='1' velocity='1' lower='-9' upper='9'/></joint>"
         "<joint name='lift' type='prismatic'><parent link='ball'/><child link='other'/><origin xyz='0 -1.5 -0.5'/><axis xyz='0 "
         "0 1'/><limit effort='1' velocity='1' lower='-9' upper='9'/></joint></robot>";
}

TEST(MeshRobots, NamesAlone) {
  Folder folder;
  const Robot r = load(folder.write("r.urdf", robot("missing.stl")), DYN_MESH_USE_NONE);
  ASSERT_EQ(DYN_OK, r.status) << r.error;
  EXPECT_EQ(DYN_SHAPE_TYPE_MESH, r.shape(1).type);
  for (int k = 0; k < dyn_model_npairs(r.m); ++k) {
    dynPairReason reason;
    EXPECT_EQ(DYN_OK, dyn_model_pair(r.m, k, nullptr, nullptr, &reason));
    EXPECT_EQ(DYN_PAIR_REASON_MESH, reason);
  }
  dynMesh* mesh = nullptr;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_shape_mesh(r.m, 1, &mesh));
  holds(dyn_last_error(), "load the robot with meshes");
}

#ifdef DYN_MESH_MODULE
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

TEST(MeshRobots, HullsAndTriangles) {
  Folder folder;
  folder.write("l.stl", binary_stl(corner_piece()));
  const std::string path = folder.write("r.urdf", robot("l.stl", "1 1 2"));
  Robot hull = load(path, DYN_MESH_USE_HULL), triangles = load(path, DYN_MESH_USE_TRIANGLES);
  ASSERT_EQ(DYN_OK, hull.status) << hull.error;
  ASSERT_EQ(DYN_OK, triangles.status) << triangles.error;
  EXPECT_EQ(DYN_SHAPE_TYPE_MESH, hull.shape(0).type);
  EXPECT_EQ(DYN_SHAPE_TYPE_CONVEX, hull.shape(1).type);
  EXPECT_EQ(DYN_SHAPE_TYPE_TRIANGLES, triangles.shape(1).type);
  EXPECT_NE(nullptr, std::strstr(hull.shape(1).mesh, "l.stl"));
  // 7/2 instead of 3
  holds(hull.report(), "warning: link 'base': mesh ");
  holds(hull.report(),
        "not convex, and its hull of 10 vertices replaces it: hull_volume_ratio: the hull's volume is 1.16667 times the mesh's; "
        "hull_depth:");
  holds(triangles.report(), "info: link 'base': mesh ");
  holds(triangles.report(), "20 triangles that enclose a solid");
  // base and ball, and ball and other, are parent and child; base and other remain
  ASSERT_EQ(1, dyn_model_npairs(hull.m));
  EXPECT_NEAR(0.5, hull.distances({0, 2.5})[0], 1e-9);
  EXPECT_NEAR(0.5, triangles.distances({0, 2.5})[0], 1e-9);
  EXPECT_NEAR(1, hull.distances({3, 0})[0], 1e-9);
  // two L shapes that fit into each other touch by their hulls only
  EXPECT_NEAR(1, triangles.distances({3, 0})[0], 1e-9);

  // the mesh is stored once and can be read back
  dynMesh* mesh = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_shape_mesh(triangles.m, 3, &mesh)) << dyn_last_error();
  const Made back{DYN_OK, "", MeshHandle(mesh)};
  EXPECT_NEAR(6, back.info().volume, 1e-12);
  ASSERT_EQ(DYN_OK, dyn_model_shape_mesh(hull.m, 1, &mesh)) << dyn_last_error();
  const Made body{DYN_OK, "", MeshHandle(mesh)};
  EXPECT_NEAR(7, body.info().volume, 1e-12);
  EXPECT_EQ(10u, body.arrays().vertex_count);
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_shape_mesh(hull.m, 2, &mesh));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_shape_mesh(hull.m, 4, &mesh));

  // a builder made from the model gives the same
  for (Robot* r : {&hull, &triangles}) {
    dynBuilder* b = nullptr;
    Robot again;
    ASSERT_EQ(DYN_OK, dyn_builder_from_model(r->m, &b));
    ASSERT_EQ(DYN_OK, dyn_builder_finish(b, &again.m)) << dyn_last_error();
    dyn_builder_free(b);
    again = data_of(std::move(again));
    EXPECT_EQ(dyn_model_size(r->m), dyn_model_size(again.m));
    EXPECT_EQ(r->distances({2.5, 0.3}), again.distances({2.5, 0.3}));
  }
}

TEST(MeshRobots, MirroredScale) {
  Folder folder;
  folder.write("l.stl", binary_stl(corner_piece()));
  Robot r = load(folder.write("r.urdf", robot("l.stl", "-1 1 1")), DYN_MESH_USE_TRIANGLES);
  ASSERT_EQ(DYN_OK, r.status) << r.error;
  dynMesh* mesh = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_shape_mesh(r.m, 1, &mesh));
  const Made back{DYN_OK, "", MeshHandle(mesh)};
  EXPECT_EQ(1, back.info().orientation);
  EXPECT_NEAR(-2, back.info().lower[0], 1e-12);
}

TEST(MeshRobots, Gradients) {
  Folder folder;
  folder.write("l.stl", binary_stl(corner_piece()));
  for (const dynMeshUse use : {DYN_MESH_USE_HULL, DYN_MESH_USE_TRIANGLES}) {
    Robot r = load(folder.write("r.urdf", robot("l.stl")), use);
    const std::vector<double> q = {2.4, 1.3};
    r.distances(q);
    double g[2];
    ASSERT_EQ(DYN_OK, dyn_distance_gradients(r.m, r.d, g)) << dyn_last_error();
    dynDistance found{};
    found.struct_size = sizeof found;
    ASSERT_EQ(DYN_OK, dyn_pair_distance(r.m, r.d, 0, &found));
    EXPECT_NEAR(std::hypot(0.4, 0.3), found.distance, 1e-9);
    EXPECT_FALSE(found.unique);  // two edges along y
    EXPECT_EQ(0, g[0]);
  }
}

TEST(MeshRobots, WhatCannotBeReadIsAnError) {
  Folder folder;
  const auto refused = [&](dynStatus status, const std::string& mesh, const std::vector<std::string>& words) {
    for (const dynMeshUse use : {DYN_MESH_USE_HULL, DYN_MESH_USE_TRIANGLES}) {
      const Robot r = load(folder.write("r.urdf", robot(mesh)), use);
      EXPECT_EQ(status, r.status) << mesh;
      for (const std::string& w : words) holds(r.error, w);
    }
  };
  refused(DYN_ERROR_FILE, "none.stl", {"r.urdf:1:", "link 'base'", "none.stl", "tried"});
  refused(DYN_ERROR_FILE, "package://robot/none.stl", {"package_dirs"});
  folder.write("cut.stl", binary_stl(box(1, 1, 1)).substr(0, 300));
  refused(DYN_ERROR_PARSE, "cut.stl", {"link 'base'", "cut.stl", "cut off"});
  std::string many = binary_stl(box(1, 1, 1));
  many[83] = 1;  // 2^24 triangles and 12
  refused(DYN_ERROR_PARSE, (folder.write("many.stl", many), "many.stl"), {"16777228 triangles, and the limit is 10000000"});
  Solid flat;
  flat.vertices = {0, 0, 0, 1, 0, 0, 0, 1, 0}, flat.triangles = {0, 1, 2};
  folder.write("flat.stl", binary_stl(flat));
  const Robot r = load(folder.write("r.urdf", robot("flat.stl")), DYN_MESH_USE_HULL);  // which has no hull
  ASSERT_EQ(DYN_OK, r.status) << r.error;
  EXPECT_EQ(DYN_SHAPE_TYPE_TRIANGLES, r.shape(1).type);
  holds(r.report(), "flat");
  const Robot t = load(folder.write("r.urdf", robot("flat.stl")), DYN_MESH_USE_TRIANGLES);
  ASSERT_EQ(DYN_OK, t.status) << t.error;
  holds(t.report(), "warning: link 'base'");
  holds(t.report(), "1 triangle that do not enclose a solid (3 open edges)");
}
#endif

TEST(MeshRobots, BadOptions) {
  dynLoadOptions o;
  dyn_load_options_init(&o);
  o.meshes = static_cast<dynMeshUse>(7);
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_load_string("<robot/>", &o, &m));
  holds(dyn_last_error(), "meshes is 7");
}

// A height field under a falling mesh.
TEST(MeshBuilders, TakeSurfaces) {
  dynBuilder* b = nullptr;
  ASSERT_EQ(DYN_OK, dyn_builder_new("scene", &b));
  const double zero[9] = {}, one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, com[3] = {};
  dynJointSpec slide;
  dyn_joint_spec_init(&slide);
  slide.name = "fall", slide.type = DYN_JOINT_TYPE_PRISMATIC, slide.placement[11] = 2;
  ASSERT_EQ(DYN_OK, dyn_builder_add_body(b, "ground", nullptr, nullptr, 0, com, zero));
  ASSERT_EQ(DYN_OK, dyn_builder_add_joint(b, &slide));
  dynJointSpec turn;
  dyn_joint_spec_init(&turn);
  turn.name = "turn", turn.parent = "fall";
  ASSERT_EQ(DYN_OK, dyn_builder_add_joint(b, &turn));
  ASSERT_EQ(DYN_OK, dyn_builder_add_body(b, "piece", "turn", nullptr, 1, com, one)) << dyn_last_error();
  dynShapeSpec s;
  dyn_shape_spec_init(&s);
  s.body = "ground", s.type = DYN_SHAPE_TYPE_HEIGHT_FIELD;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_add_shape(b, &s));
  {
    const Made field = height_field(std::vector<double>(15, 0.5), 5, 3), piece = mesh_of(box(0.2, 0.2, 0.2));
    s.surface = piece.mesh.get();
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_add_shape(b, &s));
    s.surface = field.mesh.get();
    ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &s)) << dyn_last_error();
    s.body = "piece", s.type = DYN_SHAPE_TYPE_TRIANGLES, s.surface = piece.mesh.get();
    ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &s)) << dyn_last_error();
  }  // surfaces were copied, so their handles can be freed
  Robot r;
  ASSERT_EQ(DYN_OK, dyn_builder_finish(b, &r.m)) << dyn_last_error();
  dyn_builder_free(b);
  r = data_of(std::move(r));
  ASSERT_EQ(1, dyn_model_npairs(r.m));
  EXPECT_NEAR(1.5, r.distances({0, 0.3})[0], 1e-9);
  EXPECT_NEAR(0.5, r.distances({-1, 0.1})[0], 1e-9);
  EXPECT_NEAR(-0.05, r.distances({-1.55, 0})[0], 1e-9);
  dynMesh* mesh = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_shape_mesh(r.m, 0, &mesh));
  const Made back{DYN_OK, "", MeshHandle(mesh)};
  EXPECT_EQ(16, back.info().triangles);
}

}  // namespace
}  // namespace dyn_test
