// Double against the same templates in quadruple precision: how far rounding takes each algorithm, and that the error of forward
// dynamics grows no faster than cond(M).
#include "algorithm/trees.hpp"
#include "algorithm/coriolis.hpp"
#include "algorithm/forward_dynamics.hpp"
#include "integrator/runge_kutta.hpp"

namespace dyn_test {
namespace {

Quads quads(const VectorXd& x) { return Quads(x.begin(), x.end()); }
VectorXd doubles(const Quads& x) { return matrix(x.data(), Eigen::Index(x.size())); }

struct Reference {
  const Case& c;
  Work<Quad> w;
  explicit Reference(const Case& c_) : c(c_), w(c_.m) { w.q(c_.x.q).v(c_.x.v).a(c_.x.a); }
  VectorXd rnea() {
    Quads tau(std::size_t(c.nv));
    inverse_dynamics<Quad>(c.m, w.d, w.d.v, w.d.a, nullptr, tau.data());
    return doubles(tau);
  }
  VectorXd aba(const VectorXd& tau) {
    Quads ddq(std::size_t(c.nv));
    EXPECT_EQ(0, (forward_dynamics<Quad>(c.m, w.d, w.d.v, quads(tau).data(), nullptr, ddq.data())));
    return doubles(ddq);
  }
};

TEST(Quadruple, InverseDynamicsInertiaAndCoriolis) {
  for_trees(
      [](Case& c) {
        if (c.nv > 60) return;  // nv^2 elements in software arithmetic
        Reference r(c);
        EXPECT_LE(gap(c.rnea(c.x.v, c.x.a), r.rnea()), tol * c.terms(c.x.a));
        crba(c.m, r.w.d);
        const MatrixXd M = matrix(r.w.d.M, c.nv, c.nv), got = c.M();
        // element by element, relative to what Cauchy and Schwarz allow it to be
        for (Index i = 0; i < c.nv; ++i)
          for (Index j = 0; j < c.nv; ++j)
            ASSERT_LE(std::abs(got(i, j) - M(i, j)), tol * std::sqrt(M(i, i) * M(j, j))) << i << ", " << j;
        coriolis_matrix(c.m, r.w.d), coriolis_matrix(c.m, c.w.d);
        const MatrixXd C = matrix(r.w.d.coriolis, c.nv, c.nv);
        EXPECT_LE(gap(matrix(c.w.d.coriolis, c.nv, c.nv), C), tol * (1 + largest(C)));
      },
      80);
}

TEST(Quadruple, ForwardDynamicsOfRandomTrees) {
  for_trees(
      [](Case& c) {
        Reference r(c);
        const VectorXd ddq = r.aba(c.x.tau);
        // cond in the scaling of M by its diagonal, which no triangular elimination feels
        const MatrixXd M = c.M();
        const VectorXd s = M.diagonal().cwiseSqrt().cwiseInverse();
        const VectorXd lambda =
            Eigen::SelfAdjointEigenSolver<MatrixXd>(s.asDiagonal() * M * s.asDiagonal(), Eigen::EigenvaluesOnly).eigenvalues();
        const double cond = lambda.maxCoeff() / lambda.minCoeff();
        const VectorXd error = (c.aba(c.x.tau) - ddq).cwiseQuotient(s), scaled = ddq.cwiseQuotient(s);
        const double force = largest((c.x.tau.cwiseAbs() + c.nle().cwiseAbs() + M.cwiseAbs() * ddq.cwiseAbs()).cwiseProduct(s));
        // with fused products at most 1.8e-16 of 1,500 trees; without, as in reproducible builds, 2.1e-16 of 60
        EXPECT_LE(largest(error), 3e-16 * cond * (largest(scaled) + force));
      },
      60);
}

// Chains of links whose masses fall or rise by a ratio: cond(M) from 1e3 to 1e13.
TEST(Quadruple, ForwardDynamicsOfBadlyConditionedChains) {
  double worst_cond = 0;
  for (int links : {4, 8, 12})
    for (double ratio : {0.3, 1.0, 3.0, 10.0}) {
      SCOPED_TRACE(testing::Message() << links << " links, mass ratio " << ratio);
      TreeOptions options;
      options.joints = links, options.types = {DYN_JOINT_TYPE_REVOLUTE},
      options.branch = options.mimic = options.massless = options.armature = 0;
      Tree tree = random_tree(std::uint64_t(links), options);
      double mass = 1;
      for (BodySpec& b : tree.bodies) b.inertia *= mass / b.mass, b.mass = mass, mass *= ratio;
      const ModelPtr model = tree.build();
      const State x(*model, 5);
      const Index n = model->n.nv;
      Work<double> w(*model);
      Work<Quad> q(*model);
      w.q(x.q).v(x.v), q.q(x.q).v(x.v);
      VectorXd ddq(n), nle(n);
      Quads exact(static_cast<std::size_t>(n));
      ASSERT_EQ(0, (forward_dynamics<double>(*model, w.d, x.v.data(), x.tau.data(), nullptr, ddq.data())));
      ASSERT_EQ(0, (forward_dynamics<Quad>(*model, q.d, q.d.v, quads(x.tau).data(), nullptr, exact.data())));
      inverse_dynamics<double>(*model, w.d, x.v.data(), w.d.zero, nullptr, nle.data());
      crba(*model, w.d);
      const MatrixXd M = matrix(w.d.M, n, n);
      const VectorXd lambda = Eigen::JacobiSVD<MatrixXd>(M).singularValues();
      const double cond = lambda.maxCoeff() / lambda.minCoeff();
      worst_cond = std::max(worst_cond, cond);
      const VectorXd reference = doubles(exact);
      const double relative = (ddq - reference).norm() / (reference.norm() + (x.tau - nle).norm() / lambda.maxCoeff());
      EXPECT_LE(relative, 1e-15 * cond) << "cond " << cond;
      // backward stable, whatever cond is: the residual
      VectorXd tau(n);
      inverse_dynamics<double>(*model, w.d, x.v.data(), ddq.data(), nullptr, tau.data());
      EXPECT_LE(gap(tau, x.tau), 1e-13 * ((M.cwiseAbs() * ddq.cwiseAbs()).maxCoeff() + largest(nle) + largest(x.tau)));
    }
  EXPECT_GT(worst_cond, 1e9) << "the chains are no longer hard";
}

TEST(Quadruple, StepsAgreeToRounding) {
  TreeOptions options;
  options.joints = 5;
  for_trees(
      [](Case& c) {
        if (c.M().diagonal().minCoeff() < 1e-3) return;  // tiny inertias make the short motion wild
        Work<Quad> q(c.m);
        q.q(c.x.q).v(c.x.v).tau(c.x.tau);
        ASSERT_EQ(0, integrator::explicit_step<integrator::Classical>(c.m, c.w.d, integrator::Stages<double>(c.m, c.w.d), 0.001));
        ASSERT_EQ(0, integrator::explicit_step<integrator::Classical>(c.m, q.d, integrator::Stages<Quad>(c.m, q.d), Quad(0.001)));
        EXPECT_LE(gap(matrix(c.w.d.q, c.m.n.nq), matrix(q.d.q, c.m.n.nq)), 1e-10);
      },
      20, options);
}

}  // namespace
}  // namespace dyn_test
