// Analytic derivatives against central differences in quadruple precision (truncation 1e-16 of the third derivative).
#include "algorithm/rates.hpp"
#include "algorithm/aba_derivatives.hpp"

namespace dyn_test {
namespace {

TEST(Derivatives, OfInverseDynamics) {
  for_trees(
      [](Case& c) {
        Dice dice(7);
        const auto fext = dice.vector(6 * c.m.n.joints, 10);
        const Quads f(fext.begin(), fext.end());
        Work<Quad> w(c.m, DYN_PART_INVERSE);
        auto tau = [&](const Quads& q, const Quads& v, const Quads&) {
          Quads out(std::size_t(c.nv));
          w.q(q).v(v).a(c.x.a);
          inverse_dynamics<Quad>(c.m, w.d, w.d.v, w.d.a, f.data(), out.data());
          return out;
        };
        rnea_derivatives(c.m, c.w.d, c.w.d.v, c.w.d.a, fext.data());
        const MatrixXd dq = by_q(c, tau), dv = by_v(c, tau), M = matrix(c.w.d.M, c.nv, c.nv);
        const double scale = c.terms(c.x.a) + largest(dq);
        EXPECT_LE(gap(matrix(c.w.d.dtau_dq, c.nv, c.nv), dq), tol * scale);
        EXPECT_LE(gap(matrix(c.w.d.dtau_dv, c.nv, c.nv), dv), tol * (scale + largest(dv)));
        EXPECT_LE(gap(matrix(c.w.d.tau, c.nv), c.rnea(c.x.v, c.x.a, fext.data())), tol * scale);
        EXPECT_LE(gap(M, c.M()), tol * largest(M));
      },
      60, up_to(12));
}

TEST(Derivatives, OfForwardDynamics) {
  for_trees(
      [](Case& c) {
        Dice dice(8);
        const auto fext = dice.vector(6 * c.m.n.joints, 10);
        const Quads f(fext.begin(), fext.end()), tau(c.x.tau.begin(), c.x.tau.end());
        Work<Quad> w(c.m);
        auto ddq = [&](const Quads& q, const Quads& v, const Quads&) {
          Quads out(std::size_t(c.nv));
          w.q(q).v(v);
          EXPECT_EQ(0, forward_dynamics<Quad>(c.m, w.d, w.d.v, tau.data(), f.data(), out.data()));
          return out;
        };
        ASSERT_EQ(0, aba_derivatives(c.m, c.w.d, c.w.d.v, c.w.d.tau_applied, fext.data()));
        const MatrixXd dq = by_q(c, ddq), dv = by_v(c, ddq), Minv = matrix(c.w.d.Minv, c.nv, c.nv);
        const MatrixXd dtau_dq = matrix(c.w.d.dtau_dq, c.nv, c.nv), dtau_dv = matrix(c.w.d.dtau_dv, c.nv, c.nv), M = c.M();
        // rounding: of M^-1, and of the ddq at which dtau is taken
        const double grow = (Minv.cwiseAbs() * M.cwiseAbs()).maxCoeff();
        EXPECT_LE(gap(matrix(c.w.d.ddq_dq, c.nv, c.nv), dq), 1e-13 * grow * (Minv.cwiseAbs() * dtau_dq.cwiseAbs()).maxCoeff());
        EXPECT_LE(gap(matrix(c.w.d.ddq_dv, c.nv, c.nv), dv), 1e-13 * grow * (Minv.cwiseAbs() * dtau_dv.cwiseAbs()).maxCoeff());
        EXPECT_EQ(0, gap(Minv, Minv.transpose()));
        EXPECT_LE(gap(M * Minv, MatrixXd::Identity(c.nv, c.nv)), 1e-14 * grow);
      },
      60, up_to(10));
}

TEST(Derivatives, InverseOfInertiaOfLargeTrees) {
  for_trees([](Case& c) {
    ASSERT_EQ(0, minverse(c.m, c.w.d));
    const MatrixXd Minv = matrix(c.w.d.Minv, c.nv, c.nv), M = c.M();
    EXPECT_EQ(0, gap(Minv, Minv.transpose()));
    EXPECT_LE(gap(M * Minv, MatrixXd::Identity(c.nv, c.nv)), 1e-14 * (M.cwiseAbs() * Minv.cwiseAbs()).maxCoeff());
  });
}

}  // namespace
}  // namespace dyn_test
