// Inverse and forward dynamics, the joint-space inertia and its factor: what must hold between them.
#include "algorithm/trees.hpp"
#include "algorithm/cholesky.hpp"
#include "host.hpp"

namespace dyn_test {
namespace {

TEST(Dynamics, InverseOfForwardIsTheIdentity) {
  for_trees([](Case& c) {
    const VectorXd ddq = c.aba(c.x.tau);
    EXPECT_LE(gap(c.rnea(c.x.v, ddq), c.x.tau), tol * (c.terms(ddq) + largest(c.x.tau)));
  });
}

TEST(Dynamics, ForwardOfInverseIsTheIdentity) {
  TreeOptions small;
  small.joints = 12;  // the error grows with cond(M), which is computed here
  for_trees(
      [](Case& c) {
        const VectorXd tau = c.rnea(c.x.v, c.x.a),
                       eigenvalues = Eigen::SelfAdjointEigenSolver<MatrixXd>(c.M(), Eigen::EigenvaluesOnly).eigenvalues();
        const double cond = eigenvalues.maxCoeff() / eigenvalues.minCoeff();
        EXPECT_LE(gap(c.aba(tau), c.x.a), 1e-15 * cond * c.terms(c.x.a) / eigenvalues.maxCoeff() + tol);
      },
      tree_count, small);
}

TEST(Dynamics, InertiaTimesAccelerationPlusNonlinearEffects) {
  for_trees([](Case& c) { EXPECT_LE(gap(c.M() * c.x.a + c.nle(), c.rnea(c.x.v, c.x.a)), tol * c.terms(c.x.a)); });
}

TEST(Dynamics, InertiaIsFullSymmetricAndPositive) {
  for_trees([](Case& c) {
    c.M();  // what was there before must not show; entries of unrelated joints are zero from the start
    for (std::ptrdiff_t k = 0; k < std::ptrdiff_t(c.nv) * c.nv; ++k)
      if (c.w.d.M[k] != 0) c.w.d.M[k] = 777;
    c.w.d.invalidate(Stage::Mass);
    const MatrixXd M = c.M();
    EXPECT_EQ(0, gap(M, M.transpose())) << "to the last bit";
    EXPECT_EQ(Eigen::Success, Eigen::LLT<MatrixXd>(M).info());
    // column by column, M = rnea(a = e_k) - nle at v = 0
    const VectorXd none = VectorXd::Zero(c.nv), g = c.gravity();
    for (Index k = 0; k < c.nv; k += 1 + c.nv / 5)
      EXPECT_LE(gap(c.rnea(none, VectorXd::Unit(c.nv, k)) - g, M.col(k)), tol * (largest(M) + largest(g)));
  });
}

TEST(Dynamics, FactorReproducesTheInertia) {
  for_trees([](Case& c) {
    const MatrixXd M = c.M();
    ASSERT_EQ(0, factorize(c.m, c.w.d));
    MatrixXd L = MatrixXd::Identity(c.nv, c.nv);
    VectorXd D(c.nv);
    for (Index i = 0; i < c.nv; ++i) {
      D[i] = 1 / c.w.d.D[i];
      EXPECT_GT(D[i], 0);
      for (Index j = c.m.dof_parent()[i]; j >= 0; j = c.m.dof_parent()[j])
        L(i, j) = factor_row(c.m, c.w.d, i)[c.m.dof_depth()[j]] * c.w.d.D[i];
    }
    EXPECT_LE(gap(L.transpose() * D.asDiagonal() * L, M), tol * largest(M));
    // M x = b: the residual is small whatever cond(M) is
    VectorXd x = c.x.tau;
    solve(c.m, c.w.d, x.data(), x.data(), x.data());
    EXPECT_LE(gap(M * x, c.x.tau), tol * ((M.cwiseAbs() * x.cwiseAbs()).maxCoeff() + largest(c.x.tau)));
  });
}

TEST(Dynamics, InverseOfTheInertia) {
  for_trees(
      [](Case& c) {
        const MatrixXd M = c.M();
        ASSERT_EQ(0, factorize(c.m, c.w.d));
        invert(c.m, c.w.d);
        const MatrixXd Minv = matrix(c.w.d.Minv, c.nv, c.nv);
        EXPECT_EQ(0, gap(Minv, Minv.transpose()));
        EXPECT_LE(gap(M * Minv, MatrixXd::Identity(c.nv, c.nv)), 1e-14 * (M.cwiseAbs() * Minv.cwiseAbs()).maxCoeff());
        // and ABA agrees: ddq = Minv (tau - nle)
        const VectorXd ddq = c.aba(c.x.tau), force = c.x.tau - c.nle();
        EXPECT_LE(gap(Minv * force, ddq),
                  1e-14 * (Minv.cwiseAbs() * (M.cwiseAbs() * ddq.cwiseAbs() + force.cwiseAbs())).maxCoeff());
      },
      100);
}

TEST(Dynamics, ExternalForcesAreJacobianTransposedTimesForce) {
  for_trees([](Case& c) {
    Dice dice(3);
    const MatrixXd f = Eigen::Map<MatrixXd>(dice.vector(6 * c.m.n.joints, 10).data(), 6, c.m.n.joints);
    forward_kinematics<0>(c.m, c.w.d);
    VectorXd expected = VectorXd::Zero(c.nv);
    double scale = 0;
    MatrixXd J(6, c.nv);
    for (Index j = 1; j < c.m.n.joints; ++j) {
      frame_jacobian(c.m, c.w.d, joint_frame(c.m, j), DYN_REFERENCE_LOCAL, J.data());
      expected += J.transpose() * f.col(j);
      scale += largest(J.transpose() * f.col(j));
    }
    EXPECT_LE(gap(c.rnea(c.x.v, c.x.a) - c.rnea(c.x.v, c.x.a, f.data()), expected), tol * (scale + c.terms(c.x.a)));
    const VectorXd ddq = c.aba(c.x.tau, f.data());
    EXPECT_LE(gap(c.rnea(c.x.v, ddq, f.data()), c.x.tau), tol * (c.terms(ddq) + scale + largest(c.x.tau)));
  });
}

TEST(Dynamics, AtRestInverseDynamicsIsGravityBitForBit) {
  for (std::uint64_t seed = 1; seed <= tree_count; ++seed) {
    ModelPtr model = random_tree(seed).build();
    const Index nv = model->n.nv;
    const State x(*model, seed);
    const VectorXd elsewhere = State(*model, 77).q;
    dynModel* m = nullptr;
    ASSERT_EQ(DYN_OK, capi::make_handle(std::move(model), &m));
    dynData* d = nullptr;
    ASSERT_EQ(DYN_OK, dyn_data_new(m, DYN_PART_INVERSE, &d));
    const VectorXd zero = VectorXd::Zero(nv);
    VectorXd tau(nv), g(nv), nle(nv), held(nv);
    EXPECT_EQ(DYN_OK, dyn_rnea(m, d, x.q.data(), zero.data(), zero.data(), nullptr, tau.data()));
    EXPECT_EQ(DYN_OK, dyn_gravity_torque(m, d, x.q.data(), g.data()));
    EXPECT_EQ(DYN_OK, dyn_nle(m, d, x.q.data(), zero.data(), nle.data()));
    EXPECT_EQ(DYN_OK, dyn_static_torque(m, d, x.q.data(), nullptr, held.data()));
    for (const VectorXd* other : {&g, &nle, &held})
      EXPECT_EQ(0, std::memcmp(tau.data(), other->data(), sizeof(double) * std::size_t(nv))) << seed;
    // also after the data was elsewhere, moving
    EXPECT_EQ(DYN_OK, dyn_rnea(m, d, elsewhere.data(), x.v.data(), x.a.data(), nullptr, nullptr));
    EXPECT_EQ(DYN_OK, dyn_gravity_torque(m, d, x.q.data(), g.data()));
    EXPECT_EQ(0, std::memcmp(tau.data(), g.data(), sizeof(double) * std::size_t(nv))) << seed;
    dyn_data_free(d);
    dyn_model_free(m);
    if (HasFailure()) return;
  }
}

TEST(Dynamics, ResultsDoNotDependOnWhatDataHeldBefore) {
  for_trees(
      [](Case& c) {
        const VectorXd tau = c.rnea(c.x.v, c.x.a), ddq = c.aba(c.x.tau);
        const MatrixXd M = c.M();
        const State other(c.m, 999);
        c.w.q(other.q).v(other.v).a(other.a);
        c.rnea(other.v, other.a), c.aba(other.tau), c.M();
        forward_kinematics<2>(c.m, c.w.d);
        c.w.q(c.x.q).v(c.x.v).a(c.x.a);
        EXPECT_EQ(0, gap(c.aba(c.x.tau), ddq));
        EXPECT_EQ(0, gap(c.M(), M));
        EXPECT_EQ(0, gap(c.rnea(c.x.v, c.x.a), tau));
      },
      50);
}

}  // namespace
}  // namespace dyn_test
