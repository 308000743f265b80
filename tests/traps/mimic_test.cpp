// Mimic joints in every algorithm.
#include "traps/traps.hpp"

namespace dyn_test {
namespace {

// The same mechanism with and without mimic relations.
Model geared(bool bound) {
  Builder b;
  const std::array<double, 3> at = {0.2, 0.1, -0.1};
  b.joint(Spec("base", DYN_JOINT_TYPE_FREE_FLYER)).body("trunk", "base", 3);
  b.joint(Spec("lead", DYN_JOINT_TYPE_REVOLUTE, "base", at).about(0, 1, 0)).body("b1", "lead");
  auto follow = [&](const char* name, dynJointType type, const char* parent, const char* leader, double ratio, double offset,
                    double x) {
    Spec s(name, type, parent, at);
    s.about(x, 1, 0.5);
    if (bound) s.mimic = leader, s.mimic_ratio = ratio, s.mimic_offset = offset;
    b.joint(s).body((std::string("b ") + name).c_str(), name);
  };
  follow("inner", DYN_JOINT_TYPE_REVOLUTE, "lead", "lead", -1.5, 0.2, 1);
  b.joint(Spec("ball", DYN_JOINT_TYPE_SPHERICAL, "inner", at)).body("b2", "ball");
  follow("tip", DYN_JOINT_TYPE_PRISMATIC, "ball", "inner", 0.4, -0.1, 0);
  follow("aside", DYN_JOINT_TYPE_REVOLUTE, "base", "late", 2, 0, -1);  // its leader comes later in the file
  b.joint(Spec("late", DYN_JOINT_TYPE_PRISMATIC, "base", at)).body("b3", "late");
  follow("screw", DYN_JOINT_TYPE_CONTINUOUS, "late", "late", 3, 0.3, 2);
  return b.finish();
}

// Every algorithm agrees with the reduction q_x = G q + offset, v_x = G v.
TEST(Traps, MimicHoldsInEveryAlgorithm) {
  const Model m = geared(true), full = geared(false);
  const std::size_t n = std::size_t(m.nv()), N = std::size_t(full.nv());
  ASSERT_EQ(n + 4, N);
  Numbers G(N * n, 0.0);
  for (int j = 1; j < full.njoints(); ++j) {
    const dynJointInfo f = joint_info(full, j), r = joint_info(m, j);
    ASSERT_STREQ(f.name, r.name);
    EXPECT_EQ(r.mimic_leader < 0 ? f.nv : 0, r.nv) << f.name;
    for (int k = 0; k < f.nv; ++k)
      G[std::size_t(f.idx_v + k) + N * std::size_t(r.idx_v + k)] = r.mimic_leader < 0 ? 1 : r.mimic_ratio;
  }
  auto expand = [&](const Numbers& x) {
    Numbers y(N, 0.0);
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t k = 0; k < n; ++k) y[i] += G[i + N * k] * x[k];
    return y;
  };
  auto reduce = [&](const Numbers& y, std::size_t rows = 1) {  // columns of a rows x N matrix
    Numbers x(rows * n, 0.0);
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t i = 0; i < N; ++i)
        for (std::size_t r = 0; r < rows; ++r) x[r + rows * k] += G[i + N * k] * y[r + rows * i];
    return x;
  };
  auto transpose = [](const Numbers& A, std::size_t rows) {
    Numbers B(A.size());
    const std::size_t cols = A.size() / rows;
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j < cols; ++j) B[j + cols * i] = A[i + rows * j];
    return B;
  };
  auto both_sides = [&](const Numbers& A) { return transpose(reduce(transpose(reduce(A, N), N), n), n); };

  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const State s = random_state(m, seed);
    State x;
    x.q.assign(std::size_t(full.nq()), 0.0);
    for (int j = 1; j < full.njoints(); ++j) {
      const dynJointInfo f = joint_info(full, j), r = joint_info(m, j);
      for (int k = 0; k < f.nq; ++k)
        x.q[std::size_t(f.idx_q + k)] =
            r.mimic_leader < 0 ? s.q[std::size_t(r.idx_q + k)] : r.mimic_ratio * s.q[std::size_t(r.idx_q)] + r.mimic_offset;
    }
    x.v = expand(s.v), x.a = expand(s.a), x.tau.assign(N, 0.0), x.fext = s.fext;
    Data d(m), e(full);
    compute_all(m, d, s), compute_all(full, e, x);
    for (const char* name : {"tau", "nle", "g", "static_torque"})
      expect_near(reduce(field(full, e, name)), field(m, d, name), 1e-12, name);
    for (const char* name : {"placements", "com", "vcom", "acom", "kinetic", "potential", "mechanical"})
      expect_near(field(full, e, name), field(m, d, name), 1e-12, name);
    for (const char* name : {"J", "dJ"}) expect_near(reduce(field(full, e, name), 6), field(m, d, name), 1e-12, name);
    expect_near(reduce(field(full, e, "Jcom"), 3), field(m, d, "Jcom"), 1e-12, "Jcom");
    for (const char* name : {"M", "coriolis"}) expect_near(both_sides(field(full, e, name)), field(m, d, name), 1e-12, name);
    // M Minv = 1, and forward dynamics with it
    const Numbers M = field(m, d, "M"), Minv = field(m, d, "Minv"), ddq = field(m, d, "ddq");
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        double sum = 0;
        for (std::size_t k = 0; k < n; ++k) sum += M[i + n * k] * Minv[k + n * j];
        EXPECT_NEAR(i == j, sum, 1e-9);
      }
    Numbers back(n);
    ASSERT_EQ(DYN_OK, dyn_rnea(m, d, nullptr, nullptr, ddq.data(), s.fext.data(), back.data()));
    expect_near(s.tau, back, 1e-9, "rnea of aba");
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, s.q.data(), s.v.data(), s.a.data()));
    ASSERT_EQ(DYN_OK, dyn_com(m, d, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr));
    for (int f = 0; f < m.nframes(); ++f)
      for (dynReference r : {DYN_REFERENCE_LOCAL, DYN_REFERENCE_WORLD, DYN_REFERENCE_LOCAL_WORLD_ALIGNED}) {
        for (auto call : {dyn_frame_velocity, dyn_frame_acceleration, dyn_frame_classical_acceleration})
          expect_near(frame6(call, full, e, f, r), frame6(call, m, d, f, r), 1e-12, "frame");
        Numbers J(6 * n), F(6 * N);
        for (auto call : {dyn_frame_jacobian, dyn_frame_jacobian_time_variation}) {
          ASSERT_EQ(DYN_OK, call(m, d, f, r, J.data()));
          ASSERT_EQ(DYN_OK, call(full, e, f, r, F.data()));
          expect_near(reduce(F, 6), J, 1e-12, "frame Jacobian");
        }
      }
    for (int j = 1; j < m.njoints(); ++j) {
      Numbers c(3), C(3), J(3 * n), F(3 * N);
      ASSERT_EQ(DYN_OK, dyn_subtree_com(m, d, j, c.data(), nullptr));
      ASSERT_EQ(DYN_OK, dyn_subtree_com(full, e, j, C.data(), nullptr));
      expect_near(C, c, 1e-12, "subtree");
      ASSERT_EQ(DYN_OK, dyn_subtree_jcom(m, d, j, J.data()));
      ASSERT_EQ(DYN_OK, dyn_subtree_jcom(full, e, j, F.data()));
      expect_near(reduce(F, 3), J, 1e-12, "subtree Jacobian");
    }
    // a step keeps the gears meshed: the full model with the reduced accelerations moves alike
    Numbers moved(s.q.size()), hv(s.v);
    for (std::size_t k = 0; k < n; ++k) hv[k] = 1e-3 * (s.v[k] + 1e-3 * ddq[k]);
    ASSERT_EQ(DYN_OK, dyn_integrate(m, s.q.data(), hv.data(), moved.data()));
    Data step(m);
    ASSERT_EQ(DYN_OK, dyn_aba(m, step, s.q.data(), s.v.data(), s.tau.data(), nullptr, nullptr));
    const Numbers free_ddq = field(m, step, "ddq");
    ASSERT_EQ(DYN_OK, take_step(m, step, DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3));
    for (int j = 1; j < m.njoints(); ++j) {
      dynJointInfo info{};
      info.struct_size = sizeof info;
      ASSERT_EQ(DYN_OK, dyn_model_joint_info(m, j, &info));
      if (info.type == DYN_JOINT_TYPE_FREE_FLYER || info.mimic_leader >= 0) continue;  // free flyers are stepped in fixed axes
      for (int k = info.idx_v; k < info.idx_v + info.nv; ++k)
        EXPECT_NEAR(s.v[std::size_t(k)] + 1e-3 * free_ddq[std::size_t(k)], field(m, step, "v")[std::size_t(k)], 1e-12);
    }
  }
}

}  // namespace
}  // namespace dyn_test
