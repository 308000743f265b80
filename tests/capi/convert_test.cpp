// States in other libraries' orders and frames: there and back, power, derivatives, the free joint against the frame queries,
// and what is refused.
#include <algorithm>

#include "capi/support.hpp"

namespace dyn_test {
namespace {

struct Layout : dynStateLayout {
  explicit Layout(dynConvention c, dynAngle angle = DYN_ANGLE_BY_CONVENTION) {
    dyn_state_layout_init(this);
    convention = c, continuous = angle;
  }
  Layout& order(const std::vector<const char*>& names) {
    joints = names.data(), joints_count = names.size();
    return *this;
  }
  Layout& at(const std::vector<std::int32_t>& q, const std::vector<std::int32_t>& v) {
    idx_q = q.data(), idx_v = v.data();
    return *this;
  }
};

struct Sizes {
  int nq = -1, nv = -1;
  Sizes(const dynModel* m, const Layout& l) { EXPECT_EQ(DYN_OK, dyn_state_layout_sizes(m, &l, &nq, &nv)) << dyn_last_error(); }
};

struct Peer {
  Numbers q, v, a, tau;
  explicit Peer(const Sizes& n, double x = 0) : q(std::size_t(n.nq), x), v(std::size_t(n.nv), x), a(v), tau(v) {}
};

Peer to_peer(const dynModel* m, const Layout& l, const State& s) {
  Peer y{Sizes(m, l)};
  EXPECT_EQ(DYN_OK, dyn_state_layout_convert(m, &l, DYN_DIRECTION_TO_PEER,
                                             with<dynStateInput>({0, s.q.data(), s.v.data(), s.a.data(), s.tau.data()}),
                                             with<dynStateOutput>({0, y.q.data(), y.v.data(), y.a.data(), y.tau.data()})))
      << dyn_last_error();
  return y;
}
State from_peer(const dynModel* m, const Layout& l, const Peer& y) {
  State s = {Numbers(std::size_t(dyn_model_nq(m))),
             Numbers(std::size_t(dyn_model_nv(m))),
             Numbers(std::size_t(dyn_model_nv(m))),
             Numbers(std::size_t(dyn_model_nv(m))),
             {}};
  EXPECT_EQ(DYN_OK, dyn_state_layout_convert(m, &l, DYN_DIRECTION_FROM_PEER,
                                             with<dynStateInput>({0, y.q.data(), y.v.data(), y.a.data(), y.tau.data()}),
                                             with<dynStateOutput>({0, s.q.data(), s.v.data(), s.a.data(), s.tau.data()})))
      << dyn_last_error();
  return s;
}

double distance(const Numbers& x, const Numbers& y) {
  EXPECT_EQ(x.size(), y.size());
  double worst = 0;
  for (std::size_t k = 0; k < x.size(); ++k) worst = std::max(worst, std::abs(x[k] - y[k]));
  return worst;
}
double dot(const Numbers& x, const Numbers& y) {
  double sum = 0;
  for (std::size_t k = 0; k < x.size(); ++k) sum += x[k] * y[k];
  return sum;
}

std::vector<Layout> layouts() {
  std::vector<Layout> all;
  for (dynConvention c : {DYN_CONVENTION_DYN, DYN_CONVENTION_PINOCCHIO, DYN_CONVENTION_MUJOCO, DYN_CONVENTION_DRAKE})
    for (dynAngle angle : {DYN_ANGLE_BY_CONVENTION, DYN_ANGLE_PLAIN, DYN_ANGLE_COS_SIN}) all.emplace_back(c, angle);
  return all;
}

TEST(Convert, ThereAndBack) {
  const Model m = all_types();
  for (const Layout& l : layouts())
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const State s = random_state(m, seed), back = from_peer(m, l, to_peer(m, l, s));
      double apart = -1;
      ASSERT_EQ(DYN_OK, dyn_configuration_distance(m, s.q.data(), back.q.data(), &apart));
      EXPECT_LT(apart, 1e-13) << l.convention << " " << l.continuous;
      EXPECT_LT(distance(s.v, back.v), 1e-13);
      EXPECT_LT(distance(s.a, back.a), 1e-13);
      EXPECT_LT(distance(s.tau, back.tau), 1e-13);
    }
}

TEST(Convert, SamePower) {
  const Model m = all_types();
  for (const Layout& l : layouts())
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const State s = random_state(m, seed);
      Peer y = to_peer(m, l, s);
      EXPECT_NEAR(dot(s.tau, s.v), dot(y.tau, y.v), 1e-12);
      Random g{seed};
      y.tau = g.numbers(int(y.tau.size()));  // on followers, too
      EXPECT_NEAR(dot(y.tau, y.v), dot(from_peer(m, l, y).tau, s.v), 1e-12);
    }
}

// The peer's a is the derivative of its v along q(t) = q (+) (v t + a t^2 / 2), to which v(t) = v + a t up to t^2.
TEST(Convert, AccelerationIsTheDerivativeOfVelocity) {
  const Model m = all_types();
  for (const Layout& l : layouts())
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const State s = random_state(m, seed);
      const Numbers a = to_peer(m, l, s).a;
      auto velocity = [&](double t) {
        State x = s;
        Numbers step(s.v.size());
        for (std::size_t k = 0; k < step.size(); ++k) step[k] = t * s.v[k] + t * t / 2 * s.a[k], x.v[k] += t * s.a[k];
        EXPECT_EQ(DYN_OK, dyn_integrate(m, s.q.data(), step.data(), x.q.data()));
        return to_peer(m, l, x).v;
      };
      auto difference = [&](double h) {
        Numbers d = velocity(h), e = velocity(-h);
        for (std::size_t k = 0; k < d.size(); ++k) d[k] = (d[k] - e[k]) / (2 * h);
        return d;
      };
      Numbers coarse = difference(2e-3), fine = difference(1e-3);
      for (std::size_t k = 0; k < fine.size(); ++k) fine[k] += (fine[k] - coarse[k]) / 3;
      EXPECT_LT(distance(a, fine), 1e-9) << l.convention << " seed " << seed;
    }
}

// A free flyer that starts somewhere, with an arm, and a frame on its body.
Model displaced() {
  Builder b("displaced");
  Spec base("base", DYN_JOINT_TYPE_FREE_FLYER, nullptr, {0.3, -0.1, 0.7});
  const double R[9] = {0, 1, 0, -1, 0, 0, 0, 0, 1};
  std::copy(R, R + 9, base.placement);
  b.joint(base).body("trunk", "base");
  b.joint(Spec("arm", DYN_JOINT_TYPE_CONTINUOUS, "base")).body("forearm", "arm");
  const double X[12] = {1, 0, 0, 0, 0.6, 0.8, 0, -0.8, 0.6, 0.2, 0.4, -0.5};
  EXPECT_EQ(DYN_OK, dyn_builder_add_frame(b, "camera", "base", X, DYN_FRAME_TYPE_SENSOR));
  return b.finish();
}

TEST(Convert, FreeJointIsTheFramesMotion) {
  const Model m = displaced();
  Data d(m);
  for (const char* child : {"base", "camera"})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const State s = random_state(m, seed);
      const int frame = dyn_model_frame_id(m, child);
      double X[12], local[6], aligned[6], a_aligned[6];
      ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, s.q.data(), s.v.data(), s.a.data()));
      ASSERT_EQ(DYN_OK, dyn_frame_placement(m, d, frame, X));
      ASSERT_EQ(DYN_OK, dyn_frame_velocity(m, d, frame, DYN_REFERENCE_LOCAL, local));
      ASSERT_EQ(DYN_OK, dyn_frame_velocity(m, d, frame, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, aligned));
      ASSERT_EQ(DYN_OK, dyn_frame_classical_acceleration(m, d, frame, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, a_aligned));
      Peer y[3] = {Peer(Sizes(m, Layout(DYN_CONVENTION_MUJOCO))), Peer(Sizes(m, Layout(DYN_CONVENTION_MUJOCO))),
                   Peer(Sizes(m, Layout(DYN_CONVENTION_MUJOCO)))};
      int k = 0;
      for (dynConvention c : {DYN_CONVENTION_MUJOCO, DYN_CONVENTION_DRAKE, DYN_CONVENTION_ROS}) {
        Layout l(c);
        l.child_frame = child;
        y[k++] = to_peer(m, l, s);
        double apart = -1;
        const State back = from_peer(m, l, y[k - 1]);
        ASSERT_EQ(DYN_OK, dyn_configuration_distance(m, s.q.data(), back.q.data(), &apart));
        EXPECT_LT(apart, 1e-13);
        EXPECT_LT(distance(s.v, back.v), 1e-13);
        EXPECT_LT(distance(s.a, back.a), 1e-13);
        EXPECT_LT(distance(s.tau, back.tau), 1e-13);
        EXPECT_NEAR(dot(s.tau, s.v), dot(y[k - 1].tau, y[k - 1].v), 1e-13);
      }
      const Peer &mujoco = y[0], &drake = y[1], &ros = y[2];
      auto near = [&](const double* x, const double* expected, int n) {
        for (int i = 0; i < n; ++i) EXPECT_NEAR(x[i], expected[i], 1e-13) << child << " " << i;
      };
      auto turned = [&](const double* wxyz) {  // the columns of the rotation
        const double w = wxyz[0], x = wxyz[1], z = wxyz[3], y2 = wxyz[2], n = w * w + x * x + y2 * y2 + z * z;
        const double R[9] = {(w * w + x * x - y2 * y2 - z * z) / n, 2 * (x * y2 + w * z) / n, 2 * (x * z - w * y2) / n,
                             2 * (x * y2 - w * z) / n, (w * w - x * x + y2 * y2 - z * z) / n, 2 * (y2 * z + w * x) / n,
                             2 * (x * z + w * y2) / n, 2 * (y2 * z - w * x) / n, (w * w - x * x - y2 * y2 + z * z) / n};
        near(R, X, 9);
      };
      near(mujoco.q.data(), X + 9, 3), turned(mujoco.q.data() + 3);
      near(mujoco.v.data(), aligned, 3), near(mujoco.v.data() + 3, local + 3, 3);
      near(mujoco.a.data(), a_aligned, 3);
      near(drake.q.data() + 4, X + 9, 3), turned(drake.q.data());
      near(drake.v.data() + 3, aligned, 3), near(drake.v.data(), aligned + 3, 3);
      near(drake.a.data() + 3, a_aligned, 3), near(drake.a.data(), a_aligned + 3, 3);
      const double ros_wxyz[4] = {ros.q[6], ros.q[3], ros.q[4], ros.q[5]};
      near(ros.q.data(), X + 9, 3), turned(ros_wxyz);
      near(ros.v.data(), local, 6);
    }
}

TEST(Convert, OrderAndPlaces) {
  const Model m = displaced();
  const State s = random_state(m, 3);
  const std::vector<const char*> names = {"arm", "base"};
  const std::vector<std::int32_t> q = {1, 4}, v = {0, 2};
  Layout l(DYN_CONVENTION_PINOCCHIO);
  l.order(names).at(q, v);
  l.nq = 13, l.nv = 10;
  Peer y(Sizes(m, l), 77);
  ASSERT_EQ(13u, y.q.size());
  ASSERT_EQ(DYN_OK, dyn_state_layout_convert(m, &l, DYN_DIRECTION_TO_PEER,
                                             with<dynStateInput>({0, s.q.data(), s.v.data(), nullptr, nullptr}),
                                             with<dynStateOutput>({0, y.q.data(), y.v.data(), nullptr, nullptr})));
  EXPECT_EQ((Numbers{77, std::cos(s.q[7]), std::sin(s.q[7]), 77, s.q[0], s.q[1], s.q[2], s.q[3], s.q[4], s.q[5], s.q[6], 77, 77}),
            y.q);
  EXPECT_EQ((Numbers{s.v[6], 77, s.v[0], s.v[1], s.v[2], s.v[3], s.v[4], s.v[5], 77, 77}), y.v);
  EXPECT_EQ(77, y.a[0]);
}

TEST(Convert, Followers) {
  const Model m = all_types();
  const Layout without(DYN_CONVENTION_PINOCCHIO), with(DYN_CONVENTION_MUJOCO);
  EXPECT_EQ(m.nv(), Sizes(m, without).nv);
  EXPECT_EQ(m.nv() + 2, Sizes(m, with).nv);
  const State s = random_state(m, 5);
  const Peer y = to_peer(m, with, s);
  dynJointInfo hinge{}, follower{};
  hinge.struct_size = follower.struct_size = sizeof hinge;
  ASSERT_EQ(DYN_OK, dyn_model_joint_info(m, dyn_model_joint_id(m, "hinge"), &hinge));
  // depth first: the composite's limb is the last but for what its dial carries
  const std::size_t q = y.q.size() - 1, v = y.v.size() - 1;
  EXPECT_NEAR(-0.3 * s.q[std::size_t(hinge.idx_q)] + 0.1, y.q[q], 1e-15);
  EXPECT_NEAR(-0.3 * s.v[std::size_t(hinge.idx_v)], y.v[v], 1e-15);
  EXPECT_NEAR(-0.3 * s.a[std::size_t(hinge.idx_v)], y.a[v], 1e-15);
  EXPECT_EQ(0, y.tau[v]);
}

struct Refusal {
  const char* what;
  dynStatus status;
  std::vector<std::string> says;
};

class ConvertRefused : public ::testing::Test {
 protected:
  const Model m = all_types();
  const State s = random_state(m, 1);
  Layout l{DYN_CONVENTION_MUJOCO};
  Peer y{Sizes(m, l), 1.5};
  void refuse(const Refusal& r, dynDirection direction = DYN_DIRECTION_TO_PEER) {
    refuse(r, direction, direction == DYN_DIRECTION_TO_PEER ? s.q.data() : y.q.data());
  }
  void refuse(const Refusal& r, dynDirection direction, const double* q) {
    Numbers out(100, -3.0), before = out;
    EXPECT_EQ(r.status,
              dyn_state_layout_convert(
                  m, &l, direction,
                  with<dynStateInput>({0, q, direction == DYN_DIRECTION_TO_PEER ? s.v.data() : y.v.data(), nullptr, nullptr}),
                  with<dynStateOutput>({0, out.data(), out.data() + 50, nullptr, nullptr})))
        << r.what;
    EXPECT_TRUE(dyn_test::says(r.says)) << r.what;
    EXPECT_EQ(before, out) << r.what;
  }
};

TEST_F(ConvertRefused, Layouts) {
  const Layout good = l;
  std::vector<const char*> names = {"hinge", "hinge"};
  l.order(names);
  refuse({"twice", DYN_ERROR_NAME, {"'hinge'", "twice"}});
  names = {"hinge"};
  l.order(names);
  refuse({"missing", DYN_ERROR_NAME, {"leave out 'free'"}});
  names = {"hinje"};
  l.order(names);
  refuse({"unknown", DYN_ERROR_NAME, {"'hinje'", "hinge"}});
  names = {"universe"};
  l.order(names);
  refuse({"universe", DYN_ERROR_NAME, {"universe"}});
  names = {nullptr};
  l.order(names);
  refuse({"NULL name", DYN_ERROR_ARGUMENT, {"joints[0] is NULL"}});
  l = good;
  l.struct_size = 4;
  refuse({"size", DYN_ERROR_SIZE, {"struct_size"}});
  l = good;
  l.nq = 5;
  refuse({"too small", DYN_ERROR_SIZE, {"'free'", "nq is 5"}});
  l = good;
  l.child_frame = "b1";
  refuse({"child", DYN_ERROR_ARGUMENT, {"'b1'", "'hinge'", "no free flyer"}});
  l.child_frame = "nothing";
  refuse({"child", DYN_ERROR_NAME, {"'nothing'"}});
  l = Layout(DYN_CONVENTION_ROS);
  refuse({"several coordinates", DYN_ERROR_UNSUPPORTED, {"'tube'", "JointState"}});
  l = good;
  const std::int32_t zeros[64] = {};
  l.idx_q = zeros;
  refuse({"one index", DYN_ERROR_ARGUMENT, {"idx_v is NULL"}});
  l.idx_v = zeros;
  refuse({"no names", DYN_ERROR_ARGUMENT, {"name the joints"}});
  std::vector<const char*> all;
  for (int j = 1; j < m.njoints(); ++j) all.push_back(dyn_model_joint_name(m, j));
  l.order(all);
  refuse({"overlap", DYN_ERROR_ARGUMENT, {"'free' and 'hinge' both have q[0]"}});
  const std::vector<std::int32_t> negative(all.size(), -1);
  l.at(negative, negative);
  refuse({"negative", DYN_ERROR_ARGUMENT, {"'free'", "negative"}});
  for (int bad : {-1, 5, 99}) {
    l = good;
    std::memcpy(&l.convention, &bad, sizeof bad);
    refuse({"convention", DYN_ERROR_ARGUMENT, {"convention"}});
  }
  EXPECT_EQ(DYN_ERROR_ARGUMENT,
            dyn_state_layout_convert(m, nullptr, DYN_DIRECTION_TO_PEER,
                                     with<dynStateInput>({0, s.q.data(), nullptr, nullptr, nullptr}), nullptr));
}

TEST_F(ConvertRefused, Arrays) {
  refuse({"no q", DYN_ERROR_ARGUMENT, {"q is NULL"}}, DYN_DIRECTION_TO_PEER, nullptr);
  Numbers q = s.q;
  q[2] = nan;
  refuse({"NaN", DYN_ERROR_NONFINITE, {"q[2] is NaN"}}, DYN_DIRECTION_TO_PEER, q.data());
  q = s.q, q[0] = 1e301;
  refuse({"overflow", DYN_ERROR_NUMERIC, {"'free'", "overflows"}}, DYN_DIRECTION_TO_PEER, q.data());
  q = s.q, std::fill(q.begin() + 3, q.begin() + 7, 0.0);
  refuse({"zero", DYN_ERROR_QUATERNION, {"'free'", "zero"}}, DYN_DIRECTION_TO_PEER, q.data());
  y = to_peer(m, l, s);
  std::fill(y.q.begin() + 3, y.q.begin() + 7, 0.0);
  refuse({"zero", DYN_ERROR_QUATERNION, {"'free'", "zero"}}, DYN_DIRECTION_FROM_PEER);
  y = to_peer(m, l, s);
  y.q[7] = inf;
  refuse({"infinite", DYN_ERROR_NONFINITE, {"q[7]", "'hinge'", "infinite"}}, DYN_DIRECTION_FROM_PEER);
  double out[100];
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_state_layout_convert(m, &l, DYN_DIRECTION_TO_PEER,
                                                         with<dynStateInput>({0, s.q.data(), nullptr, s.a.data(), nullptr}),
                                                         with<dynStateOutput>({0, nullptr, nullptr, out, nullptr})));
  EXPECT_TRUE(says({"a is given without v"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_state_layout_convert(m, &l, DYN_DIRECTION_TO_PEER,
                                                         with<dynStateInput>({0, s.q.data(), nullptr, nullptr, nullptr}),
                                                         with<dynStateOutput>({0, nullptr, nullptr, nullptr, out})));
  EXPECT_TRUE(says({"tau", "output", "without tau"}));
}

}  // namespace
}  // namespace dyn_test
