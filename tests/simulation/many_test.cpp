// Scenes with more shapes than the pair list holds: the broad phase finds the same contacts.
#include "simulation/scene.hpp"

#include <random>

namespace dyn_test::many_test {
namespace {


// Boxes, balls and capsules in a heap over a floor, a slope on a body of its own and a ramp, and optional boxes far away.
struct Heap {
  Scene scene;
  Numbers q;
  explicit Heap(int bodies, int far) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> u(-1, 1);
    scene.ground().shape("universe", DYN_SHAPE_TYPE_BOX, {0.6, 0.6, 0.1}, material(0.5));
    for (int k = 0; k < bodies; ++k) {
      const std::string name = "body" + std::to_string(k);
      if (k % 3 == 0) scene.box(name.c_str(), 1, {0.1, 0.12, 0.14}, material(0.5));
      else if (k % 3 == 1) scene.sphere(name.c_str(), 0.5, 0.06, material(0.4, 0.2));
      else
        scene.free(name.c_str(), 0.7, {2e-3, 2e-3, 1e-3})
            .shape(name.c_str(), DYN_SHAPE_TYPE_CAPSULE, {0.04, 0.1, 0}, material(0.6));
      q.insert(q.end(), {0.25 * u(random), 0.25 * u(random), 0.15 + 0.09 * k, 0, 0, 0, 1});
      double norm = 0;
      for (int i = 0; i < 4; ++i) {
        double& x = q[q.size() - 4 + std::size_t(i)];
        x += 0.3 * u(random), norm += x * x;
      }
      for (int i = 0; i < 4; ++i) q[q.size() - 4 + std::size_t(i)] /= std::sqrt(norm);
    }
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    s.body = "universe", s.type = DYN_SHAPE_TYPE_BOX;
    for (int k = 0; k < far; ++k) {
      for (int i = 0; i < 3; ++i) s.size[i] = 0.5;
      s.placement[9] = 20 + k % 50, s.placement[10] = k / 50, s.placement[11] = -5;
      EXPECT_EQ(DYN_OK, dyn_builder_add_shape(scene.builder(), &s)) << dyn_last_error();
    }
  }
};

void expect_same(const Simulation& a, const Simulation& b, int step) {
  for (int k = 0; k < dyn_model_nq(a.m); ++k) ASSERT_EQ(a.q[k], b.q[k]) << step << " " << k;
  for (int k = 0; k < dyn_model_nv(a.m); ++k) ASSERT_EQ(a.v[k], b.v[k]) << step << " " << k;
}

// 12 bodies use the pair list, 45 the broad phase. With 1,000 shapes far away no list exists.
TEST(ManyShapes, PairListAndBroadPhaseGiveTheSameBits) {
  for (const int bodies : {12, 45}) {
    Heap few(bodies, 0), many(bodies, 1000);
    Simulation a(few.scene.finish()), b(many.scene.finish());
    EXPECT_GT(dyn_model_npairs(a.m), 0);
    EXPECT_EQ(0, dyn_model_npairs(b.m));
    a.set(few.q), b.set(many.q);
    std::size_t met = 0;
    for (int k = 0; k < 400; ++k) {
      a.steps(1), b.steps(1);
      expect_same(a, b, k);
      const auto x = a.contacts(), y = b.contacts();
      ASSERT_EQ(x.size(), y.size());
      met += x.size();
      for (std::size_t i = 0; i < x.size(); ++i) {
        EXPECT_GE(x[i].contact.pair, 0);
        EXPECT_EQ(-1, y[i].contact.pair);
        ASSERT_EQ(x[i].contact.shape_a, y[i].contact.shape_a);
        ASSERT_EQ(x[i].contact.shape_b, y[i].contact.shape_b);
        ASSERT_EQ(x[i].contact.feature, y[i].contact.feature);
        for (int j = 0; j < 3; ++j) ASSERT_EQ(x[i].force_on_b[j], y[i].force_on_b[j]);
      }
    }
    EXPECT_GT(met, 400u);
  }
}

// Contacts of queries.
TEST(ManyShapes, QueriesMatchThePairList) {
  Heap few(30, 0), many(30, 1000);
  Simulation a(few.scene.finish()), b(many.scene.finish());
  dynData *da = nullptr, *db = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(a.m, DYN_PART_COLLISION, &da));
  ASSERT_EQ(DYN_OK, dyn_data_new(b.m, DYN_PART_COLLISION, &db));
  a.set(few.q), a.steps(300);
  for (const double margin : {0.0, 0.01, 0.2}) {
    std::vector<dynContact> x(4000), y(4000);
    int nx = 0, ny = 0;
    ASSERT_EQ(DYN_OK, dyn_contacts(a.m, da, a.q, margin, x.data(), 4000, &nx)) << dyn_last_error();
    ASSERT_EQ(DYN_OK, dyn_contacts(b.m, db, a.q, margin, y.data(), 4000, &ny)) << dyn_last_error();
    ASSERT_EQ(nx, ny);
    EXPECT_GT(nx, 0);
    for (int k = 0; k < nx; ++k) {
      const auto i = std::size_t(k);
      EXPECT_EQ(x[i].shape_a, y[i].shape_a);
      EXPECT_EQ(x[i].shape_b, y[i].shape_b);
      EXPECT_EQ(x[i].distance, y[i].distance);
    }
  }
  double distance = 0;
  int count = 0, pair = 0;
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_distances(b.m, db, nullptr, &distance));
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_collisions(b.m, db, nullptr, 0, &pair, 1, &count));
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_data_set_pair(b.m, db, -1, 0));
  dyn_data_free(da), dyn_data_free(db);
}

// Masks, requested pairs with a material, disabled and overlapping ones.
TEST(ManyShapes, FiltersMatchThePairList) {
  Heap heap(0, 1000);
  dynBuilder* b = heap.scene.builder();
  const auto ball = [&](const char* body, std::uint32_t contype, std::uint32_t conaffinity) {
    heap.scene.free(body, 1, {0.1, 0.1, 0.1});
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    s.body = body, s.name = body, s.type = DYN_SHAPE_TYPE_SPHERE, s.size[0] = 0.05, s.contype = contype,
    s.conaffinity = conaffinity;
    ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &s)) << dyn_last_error();
  };
  ball("meets", 1, 1), ball("passes", 2, 2), ball("wanted", 2, 2);
  dynShapeSpec s;
  dyn_shape_spec_init(&s);
  s.body = "universe", s.name = "table", s.type = DYN_SHAPE_TYPE_BOX, s.placement[9] = -5;
  s.size[0] = s.size[1] = 3, s.size[2] = 0.2;
  ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &s)) << dyn_last_error();
  const dynMaterial own = material(0.25);
  ASSERT_EQ(DYN_OK, dyn_builder_add_pair(b, "wanted", "table", &own)) << dyn_last_error();
  Simulation run(heap.scene.finish());
  ASSERT_EQ(1, dyn_model_npairs(run.m));
  run.place({{-5, 0, 0.15}, {-5.3, 0, 0.15}, {-5.6, 0, 0.15}});
  run.set({}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.2, 0, 0, 0, 0, 0});
  run.steps(100);
  EXPECT_NEAR(0.15, run.q[2], 1e-9);
  EXPECT_NEAR(0.15 - 0.5 * g * 0.01, run.q[9], 1e-3);
  EXPECT_NEAR(0.15, run.q[16], 1e-9);
  ASSERT_EQ(2u, run.contacts().size());
  for (const dynContactForce& f : run.contacts())
    EXPECT_EQ(f.contact.pair, f.contact.shape_a == run.contacts()[0].contact.shape_a ? -1 : 0);
  // disabled pairs, and groups at run time
  ASSERT_EQ(DYN_OK, dyn_data_set_pair(run.m, run.d, 0, 0));
  run.steps(1);
  EXPECT_EQ(1u, run.contacts().size());
  ASSERT_EQ(DYN_OK, dyn_data_set_shape_masks(run.m, run.d, run.contacts()[0].contact.shape_a, 4, 4));
  run.steps(1);
  EXPECT_EQ(0u, run.contacts().size());
}

// Shapes that overlap in the neutral configuration are parts of one mechanism and not tested, as with a pair list.
TEST(ManyShapes, InitialOverlapsAreNotTested) {
  for (const int far : {0, 1000}) {
    Heap heap(0, far);
    dynBuilder* b = heap.scene.builder();
    const double I[9] = {1e-3, 0, 0, 0, 1e-3, 0, 0, 0, 1e-3}, com[3] = {};
    std::string last = "universe";
    for (int k = 0; k < 3; ++k) {
      const std::string joint = "j" + std::to_string(k), link = "l" + std::to_string(k);
      Spec spec(joint.c_str(), DYN_JOINT_TYPE_REVOLUTE);
      if (k) spec.parent = last.c_str();
      spec.placement[9] = k ? 0 : -5, spec.placement[11] = 0.04;
      ASSERT_EQ(DYN_OK, dyn_builder_add_joint(b, &spec)) << dyn_last_error();
      ASSERT_EQ(DYN_OK, dyn_builder_add_body(b, link.c_str(), joint.c_str(), nullptr, 1, com, I)) << dyn_last_error();
      heap.scene.shape(link.c_str(), DYN_SHAPE_TYPE_SPHERE, {0.1, 0, 0}, material(0.5));
      last = joint;
    }
    Simulation run(heap.scene.finish());
    if (far) {
      // the first and the last link, and the first and the second one with the ground
      EXPECT_EQ(3, dyn_model_npairs(run.m));
      for (int k = 0; k < dyn_model_npairs(run.m); ++k) {
        dynPairReason reason;
        ASSERT_EQ(DYN_OK, dyn_model_pair(run.m, k, nullptr, nullptr, &reason));
        EXPECT_EQ(DYN_PAIR_REASON_OVERLAPS, reason) << k;
      }
    }
    run.steps(10);
    EXPECT_TRUE(run.contacts().empty());
  }
}

// A heap of 1,500 balls falls onto the floor: in every step the floor's impulse is the change of momentum; nothing passes
// through.
TEST(ManyShapes, FallingBallsKeepMomentum) {
  constexpr int n = 1500;
  constexpr double r = 0.05, m = 0.5, h = 2e-3;
  Scene scene;
  scene.ground();
  Numbers q;
  for (int k = 0; k < n; ++k) {
    scene.sphere(("b" + std::to_string(k)).c_str(), m, r, material(0.5));
    const int x = k % 15, y = k / 15 % 10, z = k / 150;
    q.insert(q.end(), {0.11 * x + 0.01 * (z % 3), 0.11 * y + 0.013 * (z % 2), r + 0.03 + 0.13 * z, 0, 0, 0, 1});
  }
  Simulation run(scene.finish(), h);
  EXPECT_EQ(0, dyn_model_npairs(run.m));
  run.set(q);
  const auto momentum = [&] {
    double sum = 0;
    for (int k = 0; k < n; ++k) sum += m * run.velocity(k)[2];
    return sum;
  };
  double before = 0;
  for (int k = 0; k < 150; ++k) {
    run.steps(1);
    double floor = 0, now = momentum();
    for (const dynContactForce& f : run.contacts())
      if (f.contact.shape_a == 0) floor += f.force_on_b[2];
    ASSERT_NEAR((floor - n * m * g) * h, now - before, 1e-9 * n * m * g) << k;
    before = now;
  }
  EXPECT_EQ(0, run.report().dropped);
  EXPECT_GT(run.report().contacts, 1000);
  const auto contacts = run.contacts();
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    EXPECT_GT(contacts[k].contact.distance, -2e-3) << k;
    if (k > 0) {
      EXPECT_LT(std::pair(contacts[k - 1].contact.shape_a, contacts[k - 1].contact.shape_b),
                std::pair(contacts[k].contact.shape_a, contacts[k].contact.shape_b));
    }
  }
}

// A floor of squares whose planes are on a fixed body, and one on a moving body.
TEST(ManyShapes, MovingHalfSpaceCollides) {
  Heap few(0, 0), many(0, 1000);
  std::vector<Numbers> ends;
  for (Heap* heap : {&few, &many}) {
    heap->scene.free("plane", 5, {1, 1, 1})
        .shape("plane", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.5))
        .sphere("ball", 1, 0.05, material(0.5));
    Simulation run(heap->scene.finish());
    // upside down: it falls onto the ball, which lies on the floor's box
    run.set({0, 0, 0.5, 1, 0, 0, 0, 0, 0, 0.1, 0, 0, 0, 1});
    run.steps(400);
    EXPECT_NEAR(0.15, run.q[2], 2e-6);
    ends.emplace_back(run.q, run.q + 14);
  }
  EXPECT_EQ(ends[0], ends[1]);
}

// A half-space on a moving body finds shapes that sleep: it falls upside down onto a ball that slept while it was far above.
TEST(ManyShapes, MovingHalfSpaceFindsSleepers) {
  Heap heap(0, 1000);
  heap.scene.free("plane", 5, {1, 1, 1})
      .shape("plane", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.5))
      .sphere("ball", 1, 0.05, material(0.5));
  Simulation run(heap.scene.finish());
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_DEFAULT | DYN_EFFECT_SLEEPING));
  run.options.sleep_time = 0.05;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
  run.set({0, 0, 0.5, 1, 0, 0, 0, 0, 0, 0.1, 0, 0, 0, 1});
  int slept = 0;
  double lowest = 1;
  for (int k = 0; k < 400; ++k) {
    run.steps(1);
    lowest = std::min(lowest, run.q[2]);
    if (run.q[2] > 0.2) slept = std::max(slept, run.report().sleeping);
  }
  EXPECT_EQ(1, slept);
  EXPECT_NEAR(0.15, run.q[2], 2e-6);
  EXPECT_GT(lowest, 0.149);
}

}  // namespace
}  // namespace dyn_test::many_test
