// Contacts, rays, closest points, sweeps and groups through the C interface.
#include "capi/geometry.hpp"

namespace dyn_test {
namespace {

template <class T>
T view_of() {
  T x{};
  x.struct_size = sizeof x;
  return x;
}
const dynGeometry box = geometry(DYN_SHAPE_TYPE_BOX, 2, 2, 2), ball = geometry(DYN_SHAPE_TYPE_SPHERE, 0.5),
                  ground = geometry(DYN_SHAPE_TYPE_HALF_SPACE, 0);

TEST(ShapeContacts, BoxOnTheGround) {
  dynContact c[DYN_MAX_CONTACTS_PER_PAIR];
  int count = -1;
  ASSERT_EQ(DYN_OK,
            dyn_geometry_contacts(with<dynGeometryPair>({0, &ground, &box, identity, at(0, 0, 0.99).data(), nullptr, nullptr}), 0,
                                  0, c, &count))
      << dyn_last_error();
  ASSERT_EQ(4, count);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(-0.01, c[k].distance, 1e-12);
    EXPECT_NEAR(1, std::abs(c[k].position[0]), 1e-12);
    EXPECT_NEAR(-0.005, c[k].position[2], 1e-12);
    EXPECT_NEAR(1, c[k].normal[2], 1e-12);
    EXPECT_EQ(-1, c[k].pair);
    EXPECT_TRUE(k == 0 || c[k - 1].feature < c[k].feature);
  }
  ASSERT_EQ(DYN_OK,
            dyn_geometry_contacts(with<dynGeometryPair>({0, &ground, &box, identity, at(0, 0, 1.1).data(), nullptr, nullptr}), 0,
                                  0, c, &count));
  EXPECT_EQ(0, count);
  ASSERT_EQ(DYN_OK,
            dyn_geometry_contacts(with<dynGeometryPair>({0, &ground, &box, identity, at(0, 0, 1.1).data(), nullptr, nullptr}),
                                  0.2, 0, c, &count));
  EXPECT_EQ(4, count);
}

TEST(ShapeContacts, BadArguments) {
  dynContact c[DYN_MAX_CONTACTS_PER_PAIR];
  int count = -7;
  auto refused = [&](dynStatus status, const dynGeometry* a, const double* X, double margin, double tolerance, dynContact* out,
                     int* n, std::initializer_list<std::string> words) {
    EXPECT_EQ(status, dyn_geometry_contacts(with<dynGeometryPair>({0, &ground, a, identity, X, nullptr, nullptr}), margin,
                                            tolerance, out, n));
    EXPECT_TRUE(says(words)) << dyn_last_error();
    EXPECT_EQ(-7, count);
  };
  refused(DYN_ERROR_ARGUMENT, nullptr, identity, 0, 0, c, &count, {"dyn_geometry_contacts", "b is NULL"});
  refused(DYN_ERROR_ARGUMENT, &box, nullptr, 0, 0, c, &count, {"placement_b is NULL"});
  refused(DYN_ERROR_ARGUMENT, &box, identity, -1, 0, c, &count, {"margin is -1"});
  refused(DYN_ERROR_NONFINITE, &box, identity, nan, 0, c, &count, {"margin"});
  refused(DYN_ERROR_ARGUMENT, &box, identity, 0, 2, c, &count, {"tolerance is 2"});
  refused(DYN_ERROR_ARGUMENT, &box, identity, 0, 0, nullptr, &count, {"contacts is NULL"});
  refused(DYN_ERROR_ARGUMENT, &box, identity, 0, 0, c, nullptr, {"count is NULL"});
}

TEST(ShapeRay, HitsAndMisses) {
  dynRayHit h = view_of<dynRayHit>();
  const double from[3] = {0, 0.3, 5}, down[3] = {0, 0, -2}, up[3] = {0, 0, 1};
  ASSERT_EQ(DYN_OK, dyn_geometry_ray(&box, identity, from, down, &h)) << dyn_last_error();
  EXPECT_EQ(0, h.shape);
  EXPECT_NEAR(2, h.t, 1e-12);
  EXPECT_NEAR(1, h.position[2], 1e-12);
  EXPECT_NEAR(1, h.normal[2], 1e-12);
  ASSERT_EQ(DYN_OK, dyn_geometry_ray(&box, identity, from, up, &h));
  EXPECT_EQ(-1, h.shape);
  EXPECT_EQ(inf, h.t);
  const dynRayHit before = h;
  const double nowhere[3] = {0, 0, 0}, bad[3] = {0, nan, 0};
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_geometry_ray(&box, identity, from, nowhere, &h));
  EXPECT_TRUE(says({"direction"}));
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_geometry_ray(&box, identity, bad, down, &h));
  EXPECT_TRUE(says({"origin[1]"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_geometry_ray(nullptr, identity, from, down, &h));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_geometry_ray(&box, identity, nullptr, down, &h));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_geometry_ray(&box, identity, from, down, nullptr));
  EXPECT_EQ(0, std::memcmp(&before, &h, sizeof h));
  h.struct_size = 4;
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_geometry_ray(&box, identity, from, down, &h));
}

TEST(ShapeClosestPoint, InsideAndOutside) {
  dynClosestPoint c = view_of<dynClosestPoint>();
  const double above[3] = {0.2, 0, 3}, within[3] = {0.5, 0, 0}, middle[3] = {0, 0, 0};
  ASSERT_EQ(DYN_OK, dyn_geometry_closest_point(&box, identity, above, &c)) << dyn_last_error();
  EXPECT_NEAR(2, c.distance, 1e-12);
  EXPECT_TRUE(c.unique && std::abs(c.point[2] - 1) < 1e-12 && std::abs(c.normal[2] - 1) < 1e-12);
  ASSERT_EQ(DYN_OK, dyn_geometry_closest_point(&box, identity, within, &c));
  EXPECT_NEAR(-0.5, c.distance, 1e-12);
  EXPECT_NEAR(1, c.point[0], 1e-12);
  ASSERT_EQ(DYN_OK, dyn_geometry_closest_point(&box, identity, middle, &c));
  EXPECT_EQ(0, c.unique);
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_geometry_closest_point(&box, identity, nullptr, &c));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_geometry_closest_point(&box, identity, above, nullptr));
  const double far[3] = {0, 0, 1e300};
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_geometry_closest_point(&box, identity, far, &c));
}

TEST(ShapeSweep, BulletAndErrors) {
  dynImpact i = view_of<dynImpact>();
  const dynGeometry wall = geometry(DYN_SHAPE_TYPE_BOX, 1e-4, 2, 2);
  const double motion[6] = {1e4, 0, 0, 0, 0, 0}, turn[6] = {0, 0, 0, 1, 0, 0};
  ASSERT_EQ(DYN_OK, dyn_geometry_sweep(with<dynGeometryPair>({0, &ball, &wall, at(-5, 0, 0).data(), identity, motion, nullptr}),
                                       1, 0, &i))
      << dyn_last_error();
  EXPECT_EQ(DYN_SWEEP_STATUS_HIT, i.status);
  EXPECT_NEAR((5 - 0.5 - 0.5e-4) / 1e4, i.time, 1e-10);
  EXPECT_NEAR(1, i.normal[0], 1e-9);
  ASSERT_EQ(DYN_OK, dyn_geometry_sweep(with<dynGeometryPair>({0, &ball, &wall, at(-5, 0, 0).data(), identity, nullptr, nullptr}),
                                       1, 0, &i));
  EXPECT_EQ(DYN_SWEEP_STATUS_NONE, i.status);
  EXPECT_EQ(1, i.time);
  EXPECT_EQ(
      DYN_ERROR_UNSUPPORTED,
      dyn_geometry_sweep(with<dynGeometryPair>({0, &ground, &ball, identity, at(0, 0, 1).data(), turn, nullptr}), 1, 0, &i));
  EXPECT_TRUE(says({"half-space"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT,
            dyn_geometry_sweep(with<dynGeometryPair>({0, &ball, &wall, identity, identity, motion, nullptr}), -1, 0, &i));
  EXPECT_EQ(DYN_ERROR_NONFINITE,
            dyn_geometry_sweep(with<dynGeometryPair>({0, &ball, &wall, identity, identity, motion, nullptr}), nan, 0, &i));
  EXPECT_EQ(DYN_ERROR_ARGUMENT,
            dyn_geometry_sweep(with<dynGeometryPair>({0, &ball, &wall, identity, identity, motion, nullptr}), 1, 0, nullptr));
  const double bad[6] = {0, 0, nan, 0, 0, 0};
  EXPECT_EQ(DYN_ERROR_NONFINITE,
            dyn_geometry_sweep(with<dynGeometryPair>({0, &ball, &wall, identity, identity, bad, nullptr}), 1, 0, &i));
  EXPECT_TRUE(says({"motion_a[2]"}));
}

// A floor, and two boxes and a ball that fly.
struct Scene : testing::Test {
  Model m = make();
  Data d{m, DYN_PART_COLLISION};
  Numbers q = Numbers(std::size_t(m.nq()));
  static Model make() {
    Builder b("scene");
    b.joint(Spec("f1", DYN_JOINT_TYPE_FREE_FLYER))
        .body("one", "f1")
        .joint(Spec("f2", DYN_JOINT_TYPE_FREE_FLYER))
        .body("two", "f2");
    b.joint(Spec("f3", DYN_JOINT_TYPE_FREE_FLYER)).body("three", "f3");
    b.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {})
        .shape("one", DYN_SHAPE_TYPE_BOX, {1, 1, 1})
        .shape("two", DYN_SHAPE_TYPE_BOX, {1, 1, 1})
        .shape("three", DYN_SHAPE_TYPE_SPHERE, {0.5, 0, 0});
    return b.finish();
  }
  void place(std::size_t i, double x, double y, double z) { q[7 * i] = x, q[7 * i + 1] = y, q[7 * i + 2] = z, q[7 * i + 6] = 1; }
  void SetUp() override {
    place(0, 0, 0, 0.499), place(1, 0, 0, 1.498), place(2, 3, 0, 0.6);
    ASSERT_EQ(DYN_OK, dyn_data_set_pair(m, d, -1, 1));  // all lie at the origin in the neutral configuration
  }
};

TEST_F(Scene, ContactsOfAStack) {
  ASSERT_EQ(6, dyn_model_npairs(m));
  std::vector<dynContact> c(20);
  int count = -1;
  ASSERT_EQ(DYN_OK, dyn_contacts(m, d, q.data(), 0, c.data(), 20, &count)) << dyn_last_error();
  ASSERT_EQ(8, count);  // four below, four between
  for (int k = 0; k < count; ++k) {
    int a, b;
    ASSERT_EQ(DYN_OK, dyn_model_pair(m, c[std::size_t(k)].pair, &a, &b, nullptr));
    EXPECT_TRUE(a == c[std::size_t(k)].shape_a && b == c[std::size_t(k)].shape_b);
    EXPECT_NEAR(-1e-3, c[std::size_t(k)].distance, 1e-9);
    EXPECT_NEAR(1, c[std::size_t(k)].normal[2], 1e-9);
  }
  std::vector<dynContact> few(20, dynContact{});
  ASSERT_EQ(DYN_OK, dyn_contacts(m, d, nullptr, 0, few.data(), 5, &count));
  EXPECT_EQ(8, count);
  EXPECT_EQ(0, std::memcmp(few.data(), c.data(), 5 * sizeof(dynContact)));
  EXPECT_EQ(0, few[5].distance);
  ASSERT_EQ(DYN_OK, dyn_contacts(m, d, nullptr, 0.2, c.data(), 20, &count));
  EXPECT_EQ(9, count);  // and the ball
  count = -3;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contacts(m, d, nullptr, -1, c.data(), 20, &count));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contacts(m, d, nullptr, 0, c.data(), -1, &count));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contacts(m, d, nullptr, 0, nullptr, 20, &count));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contacts(m, d, nullptr, 0, c.data(), 20, nullptr));
  EXPECT_EQ(-3, count);
}

// A box that rocks over the floor: the gradient is that of the smoothed distance, and has no jump where its face lies flat.
TEST_F(Scene, SmoothDistances) {
  const int pairs = dyn_model_npairs(m), nv = m.nv();
  const double s = 1e-2;
  auto at = [&](double angle, Numbers* gradient, int* points) {
    Numbers x = q, d_s(static_cast<std::size_t>(pairs)), g(static_cast<std::size_t>(pairs * nv));
    std::vector<int> n(static_cast<std::size_t>(pairs));
    x[3] = std::sin(angle / 2), x[6] = std::cos(angle / 2);
    EXPECT_EQ(DYN_OK, dyn_smooth_distances(m, d, x.data(), s, d_s.data(), g.data(), n.data())) << dyn_last_error();
    if (gradient) *gradient = g;
    if (points) *points = n[0];
    return d_s[0];
  };
  Numbers flat, g;
  int points = 0;
  EXPECT_NEAR(-1e-3 - s * std::log(4), at(0, &flat, &points), 1e-12);
  EXPECT_EQ(4, points);
  EXPECT_NEAR(1, flat[std::size_t(2 * pairs)], 1e-9);  // by height
  EXPECT_NEAR(0, flat[std::size_t(3 * pairs)], 1e-9);  // by tilt: the plain distance has a kink here
  for (double angle : {-0.3, -0.02, -1e-3, -1e-6, 0.0, 1e-6, 1e-3, 0.02, 0.3}) {
    at(angle, &g, nullptr);
    const double h = 1e-6, slope = (at(angle + h, nullptr, nullptr) - at(angle - h, nullptr, nullptr)) / (2 * h);
    EXPECT_NEAR(slope, g[std::size_t(3 * pairs)], 1e-6) << angle;
  }
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_smooth_distances(m, d, nullptr, 0, nullptr, nullptr, nullptr));
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_smooth_distances(m, d, nullptr, nan, nullptr, nullptr, nullptr));
  EXPECT_TRUE(says({"smoothing"}));
}

TEST_F(Scene, Rays) {
  const double origins[] = {0, 0, 9, 3, 0, 9, 9, 9, 9, 0, 0, 9, 0, 0, 0.5},
               directions[] = {0, 0, -1, 0, 0, -2, 0, 0, -1, 0, 0, 1, 1, 0, 0};
  double t[5], normals[15];
  int shapes[5];
  ASSERT_EQ(DYN_OK, dyn_rays(m, d, q.data(), with<dynRays>({0, 5, ~0u, origins, directions, inf}), t, shapes, normals))
      << dyn_last_error();
  const double expected_t[] = {9 - 1.998, (9 - 1.1) / 2, 9, inf, 0};
  const int expected[] = {2, 3, 0, -1, 1};
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(expected[k], shapes[k]) << k;
    EXPECT_TRUE(expected_t[k] == t[k] || std::abs(expected_t[k] - t[k]) < 1e-9) << k;
    if (k < 3) {
      EXPECT_NEAR(1, normals[3 * k + 2], 1e-9);
    }
  }
  // not so far; of some groups
  ASSERT_EQ(DYN_OK, dyn_rays(m, d, nullptr, with<dynRays>({0, 1, ~0u, origins, directions, 6}), t, shapes, nullptr));
  EXPECT_TRUE(shapes[0] == -1 && t[0] == inf);
  ASSERT_EQ(DYN_OK, dyn_data_set_shape_masks(m, d, 2, 2, 1));
  ASSERT_EQ(DYN_OK, dyn_rays(m, d, nullptr, with<dynRays>({0, 1, 1, origins, directions, inf}), nullptr, shapes, nullptr));
  EXPECT_EQ(1, shapes[0]);
  ASSERT_EQ(DYN_OK, dyn_rays(m, d, nullptr, with<dynRays>({0, 0, 1, nullptr, nullptr, inf}), nullptr, nullptr, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_rays(m, d, nullptr, with<dynRays>({0, 1, 1, nullptr, directions, inf}), t, shapes, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_rays(m, d, nullptr, with<dynRays>({0, -1, 1, origins, directions, inf}), t, shapes, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_rays(m, d, nullptr, with<dynRays>({0, 1, 1, origins, directions, 0}), t, shapes, nullptr));
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_rays(m, d, nullptr, with<dynRays>({0, 1, 1, origins, directions, nan}), t, shapes, nullptr));
  const double zero[3] = {};
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_rays(m, d, nullptr, with<dynRays>({0, 1, 1, origins, zero, inf}), t, shapes, nullptr));
}

TEST_F(Scene, MasksSwitchPairs) {
  dynPairReason reason;
  auto reasons = [&] {
    std::vector<int> out;
    for (int k = 0; k < dyn_model_npairs(m); ++k) {
      EXPECT_EQ(DYN_OK, dyn_data_pair(m, d, k, &reason));
      out.push_back(reason);
    }
    return out;
  };
  const auto before = reasons();
  std::uint32_t contype = 7, conaffinity = 7;
  ASSERT_EQ(DYN_OK, dyn_data_shape_masks(m, d, 1, &contype, &conaffinity));
  EXPECT_TRUE(contype == 1 && conaffinity == 1);
  // one wants it: enough
  ASSERT_EQ(DYN_OK, dyn_data_set_shape_masks(m, d, 1, 1, 0));
  EXPECT_EQ(before, reasons());
  ASSERT_EQ(DYN_OK, dyn_data_set_shape_masks(m, d, 1, 2, 2));
  for (int k = 0; k < dyn_model_npairs(m); ++k) {
    int a, b;
    ASSERT_EQ(DYN_OK, dyn_model_pair(m, k, &a, &b, nullptr));
    EXPECT_EQ(a == 1 || b == 1
                  ? (before[std::size_t(k)] == DYN_PAIR_REASON_TESTED ? DYN_PAIR_REASON_MASK : before[std::size_t(k)])
                  : before[std::size_t(k)],
              reasons()[std::size_t(k)]);
  }
  ASSERT_EQ(DYN_OK, dyn_data_set_shape_masks(m, d, -1, 1, 1));
  EXPECT_EQ(before, reasons());
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_shape_masks(m, d, 4, 1, 1));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_shape_masks(m, d, -1, &contype, nullptr));
}

TEST(Builder, MasksRadiusAndNothingTested) {
  Builder b("two");
  b.joint(Spec("f1", DYN_JOINT_TYPE_FREE_FLYER)).body("one", "f1").joint(Spec("f2", DYN_JOINT_TYPE_FREE_FLYER)).body("two", "f2");
  dynShapeSpec s;
  dyn_shape_spec_init(&s);
  s.body = "one", s.type = DYN_SHAPE_TYPE_BOX, s.size[0] = s.size[1] = s.size[2] = 1, s.radius = 0.25, s.contype = 2,
  s.conaffinity = 4;
  ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &s)) << dyn_last_error();
  const double grey[4] = {0.2, 0.2, 0.2, 1}, bad[4] = {0, 0, 1.1, 1};
  ASSERT_EQ(DYN_OK, dyn_builder_set_shape_rgba(b, grey));
  s.body = "two", s.contype = 1, s.conaffinity = 1;
  ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &s));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_set_shape_rgba(b, bad));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_set_shape_rgba(b, nullptr));
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_set_shape_rgba(Builder("none"), grey));
  const Model m = b.finish();
  double rgba[4];
  ASSERT_EQ(DYN_OK, dyn_model_shape_rgba(m, 0, rgba));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(grey[i], rgba[i]);
  ASSERT_EQ(DYN_OK, dyn_model_shape_rgba(m, 1, rgba));
  EXPECT_EQ(-1, rgba[3]);
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_shape_rgba(m, 2, rgba));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_shape_rgba(m, 0, nullptr));
  dynShapeInfo info = view_of<dynShapeInfo>();
  ASSERT_EQ(DYN_OK, dyn_model_shape_info(m, 0, &info));
  EXPECT_TRUE(info.radius == 0.25 && info.contype == 2 && info.conaffinity == 4);
  dynPairReason reason;
  ASSERT_EQ(DYN_OK, dyn_model_pair(m, 0, nullptr, nullptr, &reason));
  EXPECT_EQ(DYN_PAIR_REASON_MASK, reason);
  // said in the report, once
  int warnings = 0;
  for (int k = 0; k < dyn_model_report_count(m); ++k) {
    dynReportEntry e = view_of<dynReportEntry>();
    ASSERT_EQ(DYN_OK, dyn_model_report_entry(m, k, &e));
    warnings += e.level == DYN_REPORT_LEVEL_WARNING && std::string(e.message).find("no pair") != std::string::npos;
  }
  EXPECT_EQ(1, warnings);
  // the radius counts
  const Data d(m, DYN_PART_COLLISION);
  Numbers q = {0, 0, 0, 0, 0, 0, 1, 3, 0, 0, 0, 0, 0, 1};
  double distance;
  ASSERT_EQ(DYN_OK, dyn_data_set_shape_masks(m, d, -1, 1, 1));
  ASSERT_EQ(DYN_OK, dyn_distances(m, d, q.data(), &distance));
  EXPECT_NEAR(3 - 1 - 0.5, distance, 1e-12);
  s.radius = -1;
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_add_shape(b, &s));
  s.radius = nan;
  EXPECT_NE(DYN_OK, dyn_builder_add_shape(b, &s));
}

}  // namespace
}  // namespace dyn_test
