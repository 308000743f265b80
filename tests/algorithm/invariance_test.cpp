// What must not change the answer: where the robot stands, the units it is described in, the norm of its quaternions.
#include "algorithm/trees.hpp"

namespace dyn_test {
namespace {

TEST(Invariance, AKilometreFromTheOrigin) {
  for_trees([](Case& c) {
    Tree far = c.tree;
    for (JointSpec& s : far.joints)
      if (s.parent.name.empty()) s.placement[9] += 1000, s.placement[10] -= 2000, s.placement[11] += 500;
    const ModelPtr model = far.build();
    Work<double> w(*model);
    w.q(c.x.q).v(c.x.v);
    VectorXd tau(c.nv), ddq(c.nv);
    inverse_dynamics<double>(*model, w.d, c.x.v.data(), c.x.a.data(), nullptr, tau.data());
    EXPECT_LE(gap(tau, c.rnea(c.x.v, c.x.a)), tol * c.terms(c.x.a));
    const MatrixXd M = c.M();
    crba(*model, w.d);
    EXPECT_LE(gap(matrix(w.d.M, c.nv, c.nv), M), tol * largest(M));
    ASSERT_EQ(0, (forward_dynamics<double>(*model, w.d, c.x.v.data(), c.x.tau.data(), nullptr, ddq.data())));
    inverse_dynamics<double>(*model, w.d, c.x.v.data(), ddq.data(), nullptr, tau.data());
    EXPECT_LE(gap(tau, c.x.tau), tol * (c.terms(ddq) + largest(c.x.tau)));
    coriolis_matrix(*model, w.d), coriolis_matrix(c.m, c.w.d);
    const MatrixXd C = matrix(c.w.d.coriolis, c.nv, c.nv);
    EXPECT_LE(gap(matrix(w.d.coriolis, c.nv, c.nv), C), tol * (1 + largest(C)));
    kinetic_energy(*model, w.d), kinetic_energy(c.m, c.w.d);
    EXPECT_LE(std::abs(w.d.kinetic[0] - c.w.d.kinetic[0]), tol * (1 + c.w.d.kinetic[0]));
  });
}

// Ten kilometres away positions are rounded to 1e-12 m; nothing that belongs to the robot itself may feel it.
TEST(Invariance, CentroidalQuantitiesFarFromTheOrigin) {
  for_trees(
      [](Case& c) {
        Tree here = c.tree;
        for (JointSpec& s : here.joints)  // one tree: the distance of two would be rounded, too
          if (s.parent.name.empty()) s.parent.name = "base";
        JointSpec base;
        base.name = "base", base.type = DYN_JOINT_TYPE_SPHERICAL;
        here.joints.insert(here.joints.begin(), base);
        Dice dice(1);
        here.bodies.push_back(random_body(dice, "trunk", "base"));
        Tree far = here;
        for (std::size_t k = 9; k < 12; ++k) far.joints[0].placement[k] += 1e4;
        const ModelPtr models[] = {here.build(), far.build()};
        const State x(*models[0], 3);
        const Index nv = models[0]->n.nv;
        MatrixXd Ag[2], dAg[2], Ig[2], dhdot_dq[2];
        for (int k : {0, 1}) {
          Work<double> w(*models[k]);
          w.q(x.q).v(x.v).a(x.a);
          centroidal_map<true>(*models[k], w.d), centroidal_derivatives(*models[k], w.d);
          Ag[k] = matrix(w.d.Ag, 6, nv), dAg[k] = matrix(w.d.dAg, 6, nv), Ig[k] = matrix(w.d.Ig, 6, 6);
          dhdot_dq[k] = matrix(w.d.dhdot_dq, 6, nv);
        }
        EXPECT_LE(gap(Ag[0], Ag[1]), tol * largest(Ag[0]));
        EXPECT_LE(gap(dAg[0], dAg[1]), tol * largest(dAg[0]));
        EXPECT_LE(gap(Ig[0], Ig[1]), tol * largest(Ig[0]));
        EXPECT_LE(gap(dhdot_dq[0], dhdot_dq[1]), tol * largest(dhdot_dq[0]));
      },
      60);
}

TEST(Invariance, UnitsOfLengthAndMass) {
  for (const auto& [L, K] : std::vector<std::pair<double, double>>{{1e6, 1e9}, {1e-3, 1e3}, {1e-6, 1e-9}})
    for_trees(
        [&, L = L, K = K](Case& c) {
          const ModelPtr model = c.tree.scaled(L, K).build();
          // 1 where a coordinate is a length
          VectorXd lq = VectorXd::Ones(c.m.n.nq), lv = VectorXd::Ones(c.nv);
          for (Index j = 1; j < c.m.n.joints; ++j) {
            const JointRecord& r = c.m.joints()[j];
            const auto q = lengths(c.tree.joint(c.m.string(r.name)), true), v = lengths(c.tree.joint(c.m.string(r.name)), false);
            for (Index k = 0; k < r.nq; ++k) lq[r.idx_q + k] = q[std::size_t(k)] ? L : 1;
            for (Index k = 0; k < r.nv; ++k) lv[r.idx_v + k] = v[std::size_t(k)] ? L : 1;
          }
          const VectorXd unit = K * L * L * lv.cwiseInverse();  // of a generalised force
          const VectorXd q = c.x.q.cwiseProduct(lq), v = c.x.v.cwiseProduct(lv), a = c.x.a.cwiseProduct(lv),
                         tau = c.x.tau.cwiseProduct(unit);
          Work<double> w(*model);
          w.q(q).v(v);
          VectorXd got(c.nv), ddq(c.nv);
          inverse_dynamics<double>(*model, w.d, v.data(), a.data(), nullptr, got.data());
          EXPECT_LE(gap(got.cwiseQuotient(unit), c.rnea(c.x.v, c.x.a)), tol * c.terms(c.x.a));
          crba(*model, w.d);
          const MatrixXd M = c.M();
          EXPECT_LE(gap(unit.cwiseInverse().asDiagonal() * matrix(w.d.M, c.nv, c.nv) * lv.asDiagonal(), M), tol * largest(M));
          // forward dynamics: by its residual, which cond(M) leaves alone
          ASSERT_EQ(0, (forward_dynamics<double>(*model, w.d, v.data(), tau.data(), nullptr, ddq.data())));
          const VectorXd back = ddq.cwiseQuotient(lv);
          EXPECT_LE(gap(c.rnea(c.x.v, back), c.x.tau), tol * (c.terms(back) + largest(c.x.tau)));
        },
        60);
}

TEST(Invariance, TheNormOfQuaternionsAndCosSinPairs) {
  for_trees([](Case& c) {
    const VectorXd tau = c.rnea(c.x.v, c.x.a);
    const MatrixXd M = c.M();
    const double scale = c.terms(c.x.a);
    for (double factor : {1e-150, 0.3, -2.0, 1e150}) {
      VectorXd q = c.x.q;
      for (Index j = 1; j < c.m.n.joints; ++j) {
        const JointRecord& r = c.m.joints()[j];
        if (r.type == DYN_JOINT_TYPE_SPHERICAL) q.segment(r.idx_q, 4) *= factor;
        if (r.type == DYN_JOINT_TYPE_FREE_FLYER) q.segment(r.idx_q + 3, 4) *= factor;
        if (r.type == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED) q.segment(r.idx_q, 2) *= std::abs(factor);  // -q is half a turn here
      }
      c.w.q(q);
      EXPECT_LE(gap(c.rnea(c.x.v, c.x.a), tau), tol * scale);
      EXPECT_LE(gap(c.M(), M), tol * largest(M));
      const VectorXd ddq = c.aba(c.x.tau);
      EXPECT_LE(gap(c.rnea(c.x.v, ddq), c.x.tau), tol * (c.terms(ddq) + largest(c.x.tau)));
    }
  });
}

TEST(Invariance, TurningTheWorldWithItsGravity) {
  // a robot held by a turned base under equally turned gravity
  for_trees(
      [](Case& c) {
        const M4 X = Dice(4).pose();
        Tree turned = c.tree;
        for (JointSpec& s : turned.joints)
          if (s.parent.name.empty()) s.placement = placement(X * eigen(s.placement.data()));
        turned.gravity = X.topLeftCorner<3, 3>() * c.tree.gravity;
        const ModelPtr model = turned.build();
        Work<double> w(*model);
        w.q(c.x.q);
        VectorXd tau(c.nv);
        inverse_dynamics<double>(*model, w.d, c.x.v.data(), c.x.a.data(), nullptr, tau.data());
        EXPECT_LE(gap(tau, c.rnea(c.x.v, c.x.a)), tol * c.terms(c.x.a));
      },
      50);
}

}  // namespace
}  // namespace dyn_test
