// A shape and itself at one place, of every type; sizes that are zero, of every type and each of them.
#include "capi/surfaces.hpp"

namespace dyn_test {
namespace {

constexpr double identity[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};

struct Plain {
  dynShapeType type;
  int sizes;
  double size[3], depth;  // depth: the way out of itself
};
constexpr Plain plain[] = {
    {DYN_SHAPE_TYPE_SPHERE, 1, {0.5, 0, 0}, 1}, {DYN_SHAPE_TYPE_CAPSULE, 2, {0.3, 2, 0}, 0.6},
    {DYN_SHAPE_TYPE_BOX, 3, {1, 2, 3}, 1},      {DYN_SHAPE_TYPE_CYLINDER, 2, {0.5, 3, 0}, 1},
    {DYN_SHAPE_TYPE_CONE, 2, {0.5, 9, 0}, 0},   {DYN_SHAPE_TYPE_ELLIPSOID, 3, {0.3, 0.4, 0.5}, 0.6},
};
dynGeometry geometry(const Plain& p) {
  dynGeometry g;
  dyn_geometry_init(&g);
  g.type = p.type;
  std::copy(p.size, p.size + 3, g.size);
  return g;
}

// distance, contacts and sweep of g with itself
dynDistance with_itself(const dynGeometry& g) {
  dynDistance d{};
  d.struct_size = sizeof d;
  EXPECT_EQ(DYN_OK, dyn_geometry_distance(&g, identity, &g, identity, nullptr, &d)) << dyn_last_error();
  dynContact contacts[DYN_MAX_CONTACTS_PER_PAIR];
  int count = -1;
  EXPECT_EQ(DYN_OK, dyn_geometry_contacts(with<dynGeometryPair>({0, &g, &g, identity, identity, nullptr, nullptr}), 0, 0,
                                          contacts, &count))
      << dyn_last_error();
  EXPECT_TRUE(count >= 0 && count <= DYN_MAX_CONTACTS_PER_PAIR);
  for (int k = 0; k < count; ++k)
    for (const double x :
         {contacts[k].distance, contacts[k].position[0], contacts[k].position[1], contacts[k].position[2], contacts[k].normal[2]})
      EXPECT_TRUE(std::isfinite(x));
  const double motion[6] = {1, 0, 0, 0, 0, 0};
  dynImpact impact{};
  impact.struct_size = sizeof impact;
  EXPECT_EQ(DYN_OK, dyn_geometry_sweep(with<dynGeometryPair>({0, &g, &g, identity, identity, nullptr, motion}), 1, 0, &impact))
      << dyn_last_error();
  EXPECT_EQ(DYN_SWEEP_STATUS_HIT, impact.status);
  EXPECT_EQ(0, impact.time);
  return d;
}

TEST(SameShape, AtOnePlace) {
  for (const Plain& p : plain) {
    SCOPED_TRACE(int(p.type));
    const dynDistance d = with_itself(geometry(p));
    EXPECT_EQ(DYN_DISTANCE_STATUS_PENETRATING, d.status);
    EXPECT_EQ(0, d.unique);  // the other way is as short
    EXPECT_TRUE(std::isfinite(d.normal[0] + d.normal[1] + d.normal[2] + d.point_a[0] + d.point_b[0]));
    if (p.depth > 0) {
      EXPECT_NEAR(-p.depth, d.distance, 1e-9);
    }
  }
}
TEST(SameShape, SurfacesAtOnePlace) {
  const Surfaces s;
  for (const dynShapeType type : {DYN_SHAPE_TYPE_TRIANGLES, DYN_SHAPE_TYPE_HEIGHT_FIELD, DYN_SHAPE_TYPE_CONVEX}) {
    if (!s.of(type)) continue;
    SCOPED_TRACE(int(type));
    dynGeometry g;
    dyn_geometry_init(&g);
    g.type = type, g.surface = s.of(type);
    const dynDistance d = with_itself(g);
    EXPECT_NE(DYN_DISTANCE_STATUS_FAILED, d.status);
    EXPECT_LE(d.distance, 1e-9);
  }
}
TEST(SameShape, HalfSpaceAtOnePlace) {
  dynGeometry g;
  dyn_geometry_init(&g);
  g.type = DYN_SHAPE_TYPE_HALF_SPACE;
  dynDistance d{};
  d.struct_size = sizeof d;
  EXPECT_EQ(DYN_OK, dyn_geometry_distance(&g, identity, &g, identity, nullptr, &d));
  EXPECT_EQ(-inf, d.distance);
}

TEST(ZeroSize, IsRefusedByName) {
  for (const Plain& p : plain)
    for (int k = 0; k < p.sizes; ++k)
      for (const double bad : {0., -0., -1., 1e-300}) {
        SCOPED_TRACE(testing::Message() << int(p.type) << ", size " << k << " = " << bad);
        dynGeometry g = geometry(p), ball = geometry(plain[0]);
        g.size[k] = bad;
        dynDistance d{};
        d.struct_size = sizeof d, d.distance = 7;
        const std::string where = "size[" + std::to_string(k) + "]";
        EXPECT_EQ(DYN_ERROR_INVALID, dyn_geometry_distance(&g, identity, &ball, identity, nullptr, &d));
        EXPECT_TRUE(says({"a: " + where})) << dyn_last_error();
        EXPECT_EQ(DYN_ERROR_INVALID, dyn_geometry_distance(&ball, identity, &g, identity, nullptr, &d));
        EXPECT_TRUE(says({"b: " + where})) << dyn_last_error();
        EXPECT_EQ(7, d.distance);
      }
}

// Two shapes or more and no pair of them: of one body, or of a body and its parent.
TEST(ZeroPairs, IsAWarning) {
  for (const int shapes : {1, 2, 3})
    for (const bool child : {false, true}) {
      Builder b;
      b.joint(Spec("j", DYN_JOINT_TYPE_FREE_FLYER)).body("l", "j").joint(Spec("k", DYN_JOINT_TYPE_REVOLUTE, "l")).body("m", "k");
      for (int k = 0; k < shapes; ++k) {
        dynShapeSpec s;
        dyn_shape_spec_init(&s);
        s.body = child && k == 0 ? "m" : "l", s.type = DYN_SHAPE_TYPE_SPHERE, s.size[0] = 0.1;
        ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &s)) << dyn_last_error();
      }
      const Model m = b.finish();
      EXPECT_EQ(0, dyn_model_npairs(m));
      int found = 0;
      for (int k = 0; k < dyn_model_report_count(m); ++k) {
        dynReportEntry e{};
        e.struct_size = sizeof e;
        ASSERT_EQ(DYN_OK, dyn_model_report_entry(m, k, &e));
        found += e.level == DYN_REPORT_LEVEL_WARNING &&
                 std::string(e.message).find("no pair of the collision shapes is tested") != std::string::npos;
      }
      EXPECT_EQ(shapes >= 2, found);
    }
}

}  // namespace
}  // namespace dyn_test
