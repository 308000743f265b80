// Robots with meshes: names alone, hulls, triangles, and files that cannot be read.
#include <limits>
#include <utility>

#include "mesh/meshes.hpp"

namespace dyn_test {
namespace {

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
      all += std::string(e.level != DYN_REPORT_LEVEL_INFO ? "warning: " : "info: ") + e.message + "\n";
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
