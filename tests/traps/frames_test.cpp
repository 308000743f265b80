// Common mistakes with references, accelerations, parent frames, the order of six-vectors, and where forces act.
#include "traps/traps.hpp"

namespace dyn_test {
namespace {

// Velocity and Jacobian agree in every reference, and references convert as their definitions say.
TEST(Traps, VelocitiesAndJacobiansAgreeInEveryReference) {
  for (const Model& m : models()) {
    const State s = random_state(m, 11);
    Data d(m);
    compute_all(m, d, s);
    const std::size_t n = std::size_t(m.nv());
    for (int f = 0; f < m.nframes(); ++f) {
      const Numbers X = placement(m, d, f);
      const Numbers L = frame6(dyn_frame_velocity, m, d, f, DYN_REFERENCE_LOCAL),
                    A = frame6(dyn_frame_velocity, m, d, f, DYN_REFERENCE_LOCAL_WORLD_ALIGNED),
                    W = frame6(dyn_frame_velocity, m, d, f, DYN_REFERENCE_WORLD);
      auto turn = [&](const double* x) {
        Numbers y(3, 0.0);
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j) y[i] += X[i + 3 * j] * x[j];
        return y;
      };
      const Numbers linear = turn(L.data()), angular = turn(L.data() + 3), moved = cross(X.data() + 9, A.data() + 3);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(A[k], linear[k], 1e-10);
        EXPECT_NEAR(A[3 + k], angular[k], 1e-10);
        EXPECT_NEAR(W[k], A[k] + moved[k], 1e-10);
        EXPECT_EQ(W[3 + k], A[3 + k]);
      }
      for (dynReference r : {DYN_REFERENCE_LOCAL, DYN_REFERENCE_WORLD, DYN_REFERENCE_LOCAL_WORLD_ALIGNED}) {
        Numbers J(6 * n), Jv(6, 0.0);
        ASSERT_EQ(DYN_OK, dyn_frame_jacobian(m, d, f, r, J.data()));
        for (std::size_t c = 0; c < n; ++c)
          for (std::size_t i = 0; i < 6; ++i) Jv[i] += J[i + 6 * c] * s.v[c];
        expect_near(frame6(dyn_frame_velocity, m, d, f, r), Jv, 1e-11, "J v");
      }
    }
  }
}

TEST(Traps, UnknownReferenceIsRefused) {
  const Model m = chain(2);
  Data d(m);
  ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, nullptr, nullptr, nullptr));
  double J[12];
  const int none = 3;
  dynReference r;
  std::memcpy(&r, &none, sizeof r);
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_frame_jacobian(m, d, 1, r, J));
  EXPECT_TRUE(says({"dyn_frame_jacobian", "reference is 3", "_LOCAL_WORLD_ALIGNED"}));
}

// Two functions with two names. The classical acceleration is the second derivative of the position.
TEST(Traps, SpatialAndClassicalAccelerationHaveTwoNames) {
  for (const Model& m : models()) {
    const State s = random_state(m, 12);
    Data d(m), e(m);
    compute_all(m, d, s);
    // q(t) with v(0) = v and dv/dt = a, on the manifold
    auto position = [&](double t, int f) {
      Numbers step(s.v), q(s.q.size()), half(s.q.size());
      const int parts = 64;  // midpoint steps, because v changes along the path
      q = s.q;
      for (int k = 0; k < parts; ++k) {
        const double h = t / parts, at = (k + 0.5) * h;
        for (std::size_t i = 0; i < step.size(); ++i) step[i] = h * (s.v[i] + at * s.a[i]);
        EXPECT_EQ(DYN_OK, dyn_integrate(m, q.data(), step.data(), q.data()));
      }
      EXPECT_EQ(DYN_OK, dyn_forward_kinematics(m, e, q.data(), nullptr, nullptr));
      return placement(m, e, f);
    };
    for (int f : {1, m.nframes() / 2, m.nframes() - 1}) {
      const Numbers classical = frame6(dyn_frame_classical_acceleration, m, d, f, DYN_REFERENCE_LOCAL_WORLD_ALIGNED),
                    spatial = frame6(dyn_frame_acceleration, m, d, f, DYN_REFERENCE_LOCAL_WORLD_ALIGNED),
                    V = frame6(dyn_frame_velocity, m, d, f, DYN_REFERENCE_LOCAL_WORLD_ALIGNED);
      const double h = 2e-3;
      const Numbers before = position(-h, f), now = position(0, f), after = position(h, f);
      const Numbers turn = cross(V.data() + 3, V.data());
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR((after[9 + k] - 2 * now[9 + k] + before[9 + k]) / (h * h), classical[k], 2e-3 * (1 + largest(classical)))
            << dyn_model_frame_name(m, f);
        EXPECT_NEAR(spatial[k] + turn[k], classical[k], 1e-10 * (1 + largest(classical)));
        EXPECT_EQ(spatial[3 + k], classical[3 + k]);
      }
    }
  }
}

// The frame a frame was attached to does not matter, only its joint and its placement.
TEST(Traps, ParentFrameMakesNoDifference) {
  double there[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.1, 0.2, 0.3}, rest[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.4, 0.1, 0.2}, whole[12];
  std::copy(there, there + 12, whole);
  for (int k = 9; k < 12; ++k) whole[k] += rest[k];
  const double com[3] = {};
  Builder b;
  b.joint(Spec("j", DYN_JOINT_TYPE_REVOLUTE));
  ASSERT_EQ(DYN_OK, dyn_builder_add_body(b, "l", "j", there, 1, com, some_inertia));
  ASSERT_EQ(DYN_OK, dyn_builder_add_frame(b, "of joint", "j", whole, DYN_FRAME_TYPE_OP_FRAME));
  ASSERT_EQ(DYN_OK, dyn_builder_add_frame(b, "of link", "l", rest, DYN_FRAME_TYPE_OP_FRAME));
  const Model m = b.finish();
  const State s = random_state(m, 13);
  Data d(m);
  compute_all(m, d, s);
  const int one = dyn_model_frame_id(m, "of joint"), two = dyn_model_frame_id(m, "of link");
  EXPECT_EQ(frame_info(m, one).joint, frame_info(m, two).joint);
  expect_near(placement(m, d, one), placement(m, d, two), 1e-15, "placement");
  for (dynReference r : {DYN_REFERENCE_LOCAL, DYN_REFERENCE_WORLD, DYN_REFERENCE_LOCAL_WORLD_ALIGNED}) {
    expect_near(frame6(dyn_frame_velocity, m, d, one, r), frame6(dyn_frame_velocity, m, d, two, r), 1e-15, "velocity");
    expect_near(frame6(dyn_frame_acceleration, m, d, one, r), frame6(dyn_frame_acceleration, m, d, two, r), 1e-15,
                "acceleration");
  }
}

// Six-vectors are [linear; angular] everywhere.
TEST(Traps, SixVectorsAreLinearThenAngular) {
  Builder b;
  b.joint(Spec("rail", DYN_JOINT_TYPE_PRISMATIC).about(1, 0, 0)).body("car", "rail", 2, {0, 0, 0});
  b.joint(Spec("pivot", DYN_JOINT_TYPE_REVOLUTE, "rail")).body("arm", "pivot", 1, {0, 0, 0});
  b.joint(Spec("free", DYN_JOINT_TYPE_FREE_FLYER)).body("ball", "free", 3, {0, 0, 0});
  const Model m = b.finish();
  Data d(m);
  State s = random_state(m, 20);
  s.v = {5, 7, 1, 2, 3, 4, 5, 6};
  std::fill(s.q.begin(), s.q.end(), 0.0);
  s.q.back() = 1;
  compute_all(m, d, s);
  expect_near({5, 0, 0, 0, 0, 0}, frame6(dyn_frame_velocity, m, d, dyn_model_frame_id(m, "rail"), DYN_REFERENCE_LOCAL), 1e-15,
              "rail");
  expect_near({5, 0, 0, 0, 0, 7}, frame6(dyn_frame_velocity, m, d, dyn_model_frame_id(m, "pivot"), DYN_REFERENCE_LOCAL), 1e-15,
              "pivot");
  expect_near({1, 2, 3, 4, 5, 6}, frame6(dyn_frame_velocity, m, d, dyn_model_frame_id(m, "free"), DYN_REFERENCE_LOCAL), 1e-15,
              "free");
  const Numbers J = field(m, d, "J");
  expect_near({1, 0, 0, 0, 0, 0}, Numbers(J.begin(), J.begin() + 6), 1e-15, "column of rail");
  expect_near({0, 0, 0, 0, 0, 1}, Numbers(J.begin() + 6, J.begin() + 12), 1e-15, "column of pivot");
  // forces too: the first three numbers push
  Numbers fext(24, 0.0), none(8, 0.0), push(8), rest(8);
  fext[6 * 3 + 0] = 10;
  ASSERT_EQ(DYN_OK, dyn_static_torque(m, d, nullptr, nullptr, rest.data()));
  ASSERT_EQ(DYN_OK, dyn_static_torque(m, d, nullptr, fext.data(), push.data()));
  for (std::size_t k = 0; k < 8; ++k) EXPECT_NEAR(k == 2 ? -10 : 0, push[k] - rest[k], 1e-12) << k;
}

// An external force acts at the joint frame's origin, in its axes: tau - J^T f with the joint frame's own Jacobian.
TEST(Traps, ExternalForceActsAtTheJointFramesOrigin) {
  for (const Model& m : models()) {
    const State s = random_state(m, 21);
    Data d(m);
    compute_all(m, d, s);
    const std::size_t n = std::size_t(m.nv());
    Numbers with(n), without(n), J(6 * n);
    ASSERT_EQ(DYN_OK, dyn_rnea(m, d, nullptr, nullptr, nullptr, nullptr, without.data()));
    for (int j = 1; j < m.njoints(); ++j) {
      Numbers fext(s.fext.size(), 0.0);
      std::copy_n(s.fext.begin() + 6 * j, 6, fext.begin() + 6 * j);
      ASSERT_EQ(DYN_OK, dyn_rnea(m, d, nullptr, nullptr, nullptr, fext.data(), with.data()));
      ASSERT_EQ(DYN_OK,
                dyn_frame_jacobian(m, d, dyn_model_frame_id(m, dyn_model_joint_name(m, j)), DYN_REFERENCE_LOCAL, J.data()));
      for (std::size_t c = 0; c < n; ++c) {
        double power = 0;
        for (std::size_t k = 0; k < 6; ++k) power += J[k + 6 * c] * fext[std::size_t(6 * j) + k];
        EXPECT_NEAR(without[c] - power, with[c], 1e-10 * (1 + largest(without))) << dyn_model_joint_name(m, j);
      }
    }
  }
}

}  // namespace
}  // namespace dyn_test
