// Collision through the C interface: shapes by themselves, a robot's pairs, and what is refused.
#include "capi/geometry.hpp"

namespace dyn_test {
namespace {

dynDistance distance(const dynGeometry& a, const std::array<double, 12>& X_a, const dynGeometry& b,
                     const std::array<double, 12>& X_b) {
  dynDistance d{};
  d.struct_size = sizeof d;
  EXPECT_EQ(DYN_OK, dyn_geometry_distance(&a, X_a.data(), &b, X_b.data(), nullptr, &d)) << dyn_last_error();
  return d;
}

TEST(ShapeDistance, ClosedForms) {
  const dynGeometry box = geometry(DYN_SHAPE_TYPE_BOX, 2, 2, 2), ball = geometry(DYN_SHAPE_TYPE_SPHERE, 0.5),
                    tube = geometry(DYN_SHAPE_TYPE_CYLINDER, 0.3, 2), pill = geometry(DYN_SHAPE_TYPE_CAPSULE, 0.3, 2),
                    cone = geometry(DYN_SHAPE_TYPE_CONE, 1, 2), egg = geometry(DYN_SHAPE_TYPE_ELLIPSOID, 1, 2, 3),
                    ground = geometry(DYN_SHAPE_TYPE_HALF_SPACE, 0);
  EXPECT_NEAR(1.5, distance(box, at(0, 0, 0), ball, at(0, 0, 3)).distance, 1e-12);
  EXPECT_NEAR(-0.5, distance(box, at(0, 0, 0), ball, at(1, 0, 0)).distance, 1e-12);
  EXPECT_NEAR(0.7, distance(box, at(0, 0, 0), tube, at(2, 0, 0)).distance, 1e-10);
  EXPECT_NEAR(5 - 1 - 0.3, distance(box, at(0, 0, 0), pill, at(0, 0, 6)).distance - 0.0, 1e-12);
  EXPECT_NEAR(1, distance(ground, at(0, 0, 0), cone, at(0, 0, 2)).distance, 1e-12);
  EXPECT_NEAR(2, distance(ground, at(0, 0, 0), egg, at(0, 0, 5)).distance, 1e-12);
  EXPECT_NEAR(1.4, distance(geometry(DYN_SHAPE_TYPE_SPHERE, 0.5, 0, 0, 0.1), at(0, 0, 0), box, at(3, 0, 0)).distance, 1e-12);
  const dynDistance d = distance(box, at(0, 0, 0), box, at(0, 0, 1.5));
  EXPECT_EQ(DYN_DISTANCE_STATUS_PENETRATING, d.status);
  EXPECT_NEAR(-0.5, d.distance, 1e-12);
  EXPECT_NEAR(1, d.normal[2], 1e-12);
  EXPECT_EQ(0, d.unique);  // two faces, parallel
  EXPECT_EQ(DYN_DISTANCE_STATUS_TOUCHING, distance(box, at(0, 0, 0), box, at(0, 0, 2)).status);
  EXPECT_EQ(DYN_DISTANCE_STATUS_SEPARATED, distance(box, at(0, 0, 0), box, at(0, 0, 2.1)).status);
}

TEST(ShapeDistance, BadArguments) {
  const dynGeometry ball = geometry(DYN_SHAPE_TYPE_SPHERE, 0.5), box = geometry(DYN_SHAPE_TYPE_BOX, 1, 1, 1);
  dynDistance out{}, before;
  out.struct_size = sizeof out, out.distance = 7;
  before = out;
  auto refused = [&](dynStatus status, const dynGeometry* a, const double* X, double tolerance,
                     std::initializer_list<std::string> words) {
    dynDistanceOptions options;
    dyn_distance_options_init(&options);
    options.tolerance = tolerance;
    EXPECT_EQ(status, dyn_geometry_distance(a, X, &box, identity, &options, &out));
    EXPECT_TRUE(says(words)) << dyn_last_error();
    EXPECT_EQ(0, std::memcmp(&before, &out, sizeof out));
  };
  refused(DYN_ERROR_ARGUMENT, nullptr, identity, 0, {"a is NULL"});
  refused(DYN_ERROR_ARGUMENT, &ball, nullptr, 0, {"placement_a is NULL"});
  for (const double bad : {nan, -inf}) {
    auto X = at(0, bad, 0);
    refused(DYN_ERROR_NONFINITE, &ball, X.data(), 0, {"placement_a[10]"});
    const dynGeometry b = geometry(DYN_SHAPE_TYPE_BOX, 1, bad, 1), r = geometry(DYN_SHAPE_TYPE_BOX, 1, 1, 1, bad);
    refused(DYN_ERROR_NONFINITE, &b, identity, 0, {"a: size[1]"});
    refused(DYN_ERROR_NONFINITE, &r, identity, 0, {"a: radius"});
    refused(DYN_ERROR_NONFINITE, &ball, identity, bad, {"tolerance"});
  }
  for (const double bad : {0., -1., 1e-300, 1e300}) {
    const dynGeometry b = geometry(DYN_SHAPE_TYPE_ELLIPSOID, 1, 1, bad), s = geometry(DYN_SHAPE_TYPE_SPHERE, bad);
    refused(DYN_ERROR_INVALID, &b, identity, 0, {"a: size[2]"});
    refused(DYN_ERROR_INVALID, &s, identity, 0, {"a: size[0]"});
  }
  const dynGeometry thick = geometry(DYN_SHAPE_TYPE_BOX, 1, 1, 1, -0.1), mesh = geometry(DYN_SHAPE_TYPE_MESH, 1, 1, 1);
  refused(DYN_ERROR_INVALID, &thick, identity, 0, {"radius is -0.1"});
  refused(DYN_ERROR_UNSUPPORTED, &mesh, identity, 0, {"mesh"});
  refused(DYN_ERROR_ARGUMENT, &ball, identity, -1e-3, {"tolerance"});
  refused(DYN_ERROR_ARGUMENT, &ball, identity, 2, {"tolerance"});
  auto far = at(1e300, 0, 0);
  refused(DYN_ERROR_INVALID, &ball, far.data(), 0, {"placement_a[9]"});
  auto skew = at(0, 0, 0), mirror = skew;
  skew[0] = 2, mirror[0] = -1;
  refused(DYN_ERROR_INVALID, &ball, skew.data(), 0, {"placement_a", "orthonormal"});
  refused(DYN_ERROR_INVALID, &ball, mirror.data(), 0, {"placement_a"});
  dynGeometry short_one = ball;
  short_one.struct_size = 4;
  refused(DYN_ERROR_SIZE, &short_one, identity, 0, {"dyn_geometry_init"});
  for (int bad : {0, -1, 99}) {
    dynGeometry g = ball;
    std::memcpy(&g.type, &bad, sizeof bad);
    refused(DYN_ERROR_ARGUMENT, &g, identity, 0, {"type is " + std::to_string(bad)});
  }
  dyn_geometry_init(nullptr);
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_geometry_distance(&ball, identity, &ball, identity, nullptr, nullptr));
  out.struct_size = 8;
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_geometry_distance(&ball, identity, &ball, identity, nullptr, &out));
}

TEST(ShapeDistance, OptionsAndTheSecondMethod) {
  const dynGeometry box = geometry(DYN_SHAPE_TYPE_BOX, 2, 2, 2), tube = geometry(DYN_SHAPE_TYPE_CYLINDER, 0.5, 2),
                    ball = geometry(DYN_SHAPE_TYPE_SPHERE, 0.5);
  dynDistanceOptions o;
  dyn_distance_options_init(nullptr);
  dyn_distance_options_init(&o);
  EXPECT_EQ(DYN_DISTANCE_METHOD_GJK, o.method);
  EXPECT_EQ(1e-10, o.tolerance);
  dynDistance out{};
  out.struct_size = sizeof out;
  auto ask = [&](const dynGeometry& a, const std::array<double, 12>& X) {
    return dyn_geometry_distance(&a, X.data(), &box, identity, &o, &out);
  };
  o.method = DYN_DISTANCE_METHOD_CCD;
  const dynStatus status = ask(tube, at(0, 0, 1.9));
  if (status == DYN_ERROR_UNSUPPORTED) GTEST_SKIP() << dyn_last_error();
  // the cap is 0.1 inside: by libccd, what holds of its answer
  ASSERT_EQ(DYN_OK, status) << dyn_last_error();
  EXPECT_NEAR(-0.1, out.distance, 1e-6);
  EXPECT_EQ(DYN_DISTANCE_METHOD_CCD, out.method);
  // closed forms, and shapes apart
  ASSERT_EQ(DYN_OK, ask(ball, at(0, 0, 1.4)));
  EXPECT_EQ(DYN_DISTANCE_METHOD_GJK, out.method);
  ASSERT_EQ(DYN_OK, ask(tube, at(0, 0, 3)));
  EXPECT_EQ(DYN_DISTANCE_METHOD_GJK, out.method);
  EXPECT_NEAR(1, out.distance, 1e-10);
  for (int bad : {-1, 2, 99}) {
    std::memcpy(&o.method, &bad, sizeof bad);
    EXPECT_EQ(DYN_ERROR_ARGUMENT, ask(tube, at(0, 0, 3)));
    EXPECT_TRUE(says({"method is " + std::to_string(bad)})) << dyn_last_error();
  }
  dyn_distance_options_init(&o);
  o.struct_size = 4;
  EXPECT_EQ(DYN_ERROR_SIZE, ask(tube, at(0, 0, 3)));
}

struct Collision : testing::Test {
  Model m = robot("go2", DYN_BASE_FLOATING);
  Data d{m, DYN_PART_COLLISION};
  const State s = random_state(m, 5);
  const int pairs = dyn_model_npairs(m);
  Numbers distances() {
    Numbers out(std::size_t(pairs), nan);
    EXPECT_EQ(DYN_OK, dyn_distances(m, d, s.q.data(), out.data())) << dyn_last_error();
    return out;
  }
  dynDistance found(int pair, dynStatus status = DYN_OK) {
    dynDistance out{};
    out.struct_size = sizeof out;
    EXPECT_EQ(status, dyn_pair_distance(m, d, pair, &out)) << dyn_last_error();
    return out;
  }
};

TEST_F(Collision, DistancesAreThoseOfShapes) {
  ASSERT_GT(pairs, 100);
  const Numbers all = distances();
  ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, nullptr, nullptr, nullptr));
  for (int k = 0; k < pairs; ++k) {
    int shapes[2];
    dynPairReason reason;
    ASSERT_EQ(DYN_OK, dyn_model_pair(m, k, shapes, shapes + 1, &reason));
    EXPECT_LT(shapes[0], shapes[1]);
    ASSERT_EQ(DYN_PAIR_REASON_TESTED, reason);
    dynGeometry g[2];
    std::array<double, 12> X[2];
    for (int i = 0; i < 2; ++i) {
      dynShapeInfo info{};
      info.struct_size = sizeof info;
      ASSERT_EQ(DYN_OK, dyn_model_shape_info(m, shapes[i], &info));
      g[i] = geometry(info.type, info.size[0], info.size[1], info.size[2]);
      double F[12];
      ASSERT_EQ(DYN_OK, dyn_frame_placement(m, d, info.frame, F));
      for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 3; ++r) {
          double sum = c == 3 ? F[9 + r] : 0;
          for (int j = 0; j < 3; ++j) sum += F[3 * j + r] * info.placement[3 * c + j];
          X[i][std::size_t(3 * c + r)] = sum;
        }
    }
    const dynDistance alone = distance(g[0], X[0], g[1], X[1]);
    EXPECT_NEAR(alone.distance, all[std::size_t(k)], 1e-9);
    EXPECT_EQ(all[std::size_t(k)], found(k).distance);
  }
}

TEST_F(Collision, CollisionsAndMargin) {
  const Numbers all = distances();
  for (const double margin : {0., 0.05, 0.2, 10.}) {
    std::vector<int> expected, list(std::size_t(pairs), -1);
    for (int k = 0; k < pairs; ++k)
      if (all[std::size_t(k)] <= margin) expected.push_back(k);
    int count = -1;
    ASSERT_EQ(DYN_OK, dyn_collisions(m, d, nullptr, margin, list.data(), pairs, &count));
    EXPECT_EQ(int(expected.size()), count);
    list.resize(expected.size());
    EXPECT_EQ(expected, list);
    int one[2] = {-7, -7};
    ASSERT_EQ(DYN_OK, dyn_collisions(m, d, nullptr, margin, one, 1, &count));
    EXPECT_EQ(int(expected.size()), count);
    EXPECT_EQ(-7, one[1]);
    ASSERT_EQ(DYN_OK, dyn_collisions(m, d, nullptr, margin, nullptr, 0, &count));
  }
}

TEST_F(Collision, PairsAreSwitched) {
  const Numbers all = distances();
  ASSERT_EQ(DYN_OK, dyn_data_set_pair(m, d, 3, 0));
  found(2, DYN_ERROR_STALE);
  Numbers without = distances();
  EXPECT_EQ(inf, without[3]);
  without[3] = all[3];
  EXPECT_EQ(all, without);
  dynPairReason reason;
  ASSERT_EQ(DYN_OK, dyn_data_pair(m, d, 3, &reason));
  EXPECT_EQ(DYN_PAIR_REASON_OFF, reason);
  found(3, DYN_ERROR_ARGUMENT);
  EXPECT_TRUE(says({"pair 3 is not tested"}));
  ASSERT_EQ(DYN_OK, dyn_data_set_pair(m, d, -1, 0));
  for (const double x : distances()) EXPECT_EQ(inf, x);
  ASSERT_EQ(DYN_OK, dyn_data_set_pair(m, d, -1, 1));
  EXPECT_EQ(all, distances());
}

TEST_F(Collision, GradientsOfWhatIsTested) {
  distances();
  const std::size_t n = std::size_t(pairs) * std::size_t(m.nv());
  Numbers g(n, nan);
  ASSERT_EQ(DYN_OK, dyn_distance_gradients(m, d, g.data()));
  double sum = 0;
  for (const double x : g) sum += std::abs(x);
  EXPECT_TRUE(std::isfinite(sum) && sum > 1);
  for (int k = 0; k < 6; ++k)  // a robot that moves as a whole changes none of them
    for (int p = 0; p < pairs; ++p) EXPECT_NEAR(0, g[std::size_t(p + k * pairs)], 1e-12);
}

TEST_F(Collision, BadArguments) {
  int shape, count = -5, list[4] = {-5, -5, -5, -5};
  dynPairReason reason;
  for (const int bad : {-1, pairs, 1 << 30}) {
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_pair(m, bad, &shape, nullptr, nullptr));
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_pair(m, d, bad, &reason));
    if (bad != -1) {
      EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_pair(m, d, bad, 1));
    }
    EXPECT_TRUE(says({"pair " + std::to_string(bad)}) || bad == -1);
    found(bad, DYN_ERROR_ARGUMENT);
  }
  found(0, DYN_ERROR_STALE);
  EXPECT_TRUE(says({"dyn_distances"}));
  Numbers g(std::size_t(pairs) * std::size_t(m.nv()));
  EXPECT_EQ(DYN_ERROR_STALE, dyn_distance_gradients(m, d, g.data()));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_collisions(m, d, nullptr, -1, list, 4, &count));
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_collisions(m, d, nullptr, nan, list, 4, &count));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_collisions(m, d, nullptr, 0, list, -1, &count));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_collisions(m, d, nullptr, 0, nullptr, 4, &count));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_collisions(m, d, nullptr, 0, list, 4, nullptr));
  EXPECT_TRUE(count == -5 && list[0] == -5);
  Numbers far = s.q;
  far[0] = 1e50;
  EXPECT_EQ(DYN_ERROR_NUMERIC, dyn_distances(m, d, far.data(), nullptr));
  EXPECT_TRUE(says({"dyn_distances", "overflow"}));
}

TEST(Builder, ShapesThatCannotBe) {
  Builder b;
  b.joint(Spec("j", DYN_JOINT_TYPE_FREE_FLYER)).body("l", "j");
  dynShapeSpec s;
  auto refused = [&](dynStatus status, std::initializer_list<std::string> words) {
    EXPECT_EQ(status, dyn_builder_add_shape(b, &s));
    EXPECT_TRUE(says(words)) << dyn_last_error();
    dyn_shape_spec_init(&s);
    s.body = "l", s.type = DYN_SHAPE_TYPE_CYLINDER, s.size[0] = s.size[1] = 1;
  };
  dyn_shape_spec_init(&s), dyn_shape_spec_init(nullptr);
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_add_shape(b, nullptr));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_builder_add_shape(nullptr, &s));
  refused(DYN_ERROR_INVALID, {"shape", "size 0"});
  s.body = "nobody", refused(DYN_ERROR_NAME, {"'nobody'"});
  s.body = "j", refused(DYN_ERROR_NAME, {"'j'"});  // a joint, not a link
  s.struct_size = 8, refused(DYN_ERROR_SIZE, {"dyn_shape_spec_init"});
  s.size[1] = 0, refused(DYN_ERROR_INVALID, {"'l'", "size 0"});
  s.size[1] = -1, refused(DYN_ERROR_INVALID, {"'l'", "size -1"});
  s.size[1] = 1e300, refused(DYN_ERROR_INVALID, {"'l'", "size"});
  s.size[2] = nan, refused(DYN_ERROR_NONFINITE, {"'l'", "size"});
  s.placement[0] = 2, refused(DYN_ERROR_INVALID, {"'l'"});
  for (const int bad : {0, -1, 99}) {
    std::memcpy(&s.type, &bad, sizeof bad), refused(DYN_ERROR_ARGUMENT, {"type is " + std::to_string(bad)});
    std::memcpy(&s.role, &bad, sizeof bad), refused(DYN_ERROR_ARGUMENT, {"role is " + std::to_string(bad)});
  }
  EXPECT_EQ(0, dyn_model_nshapes(b.finish()));
  ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &s));
  EXPECT_EQ(1, dyn_model_nshapes(b.finish()));
}

TEST(Pairs, ARobotWithoutShapes) {
  Builder b;
  b.joint(Spec("j", DYN_JOINT_TYPE_FREE_FLYER)).body("l", "j");
  const Model m = b.finish();
  EXPECT_EQ(0, dyn_model_npairs(m));
  EXPECT_EQ(-1, dyn_model_npairs(nullptr));
  const Data d(m, DYN_PART_COLLISION);
  EXPECT_EQ(DYN_OK, dyn_distances(m, d, nullptr, nullptr));
  EXPECT_EQ(DYN_OK, dyn_distance_gradients(m, d, nullptr));
}

}  // namespace
}  // namespace dyn_test
