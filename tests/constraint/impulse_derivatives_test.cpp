// Derivatives of impulses against extrapolated differences: random robots of all joint types, random constraints with
// restitution.
#include "constraint/trees.hpp"

#include "algorithm/constrained/kkt_inverse.hpp"

namespace dyn_test {
namespace {

// v_plus and lambda
VectorXd impulse(Case& x, const VectorXd& q, const VectorXd& v, dynConstraintResult& result) {
  Data<double>& d = x.w.d;
  x.w.q(q).v(v);
  EXPECT_EQ(0, constraint_impulse(x.m, d, d.v, ProximalOptions{}, d.constraint_ddq, result));
  VectorXd both(x.nv + result.rows);
  for (Index k = 0; k < x.nv; ++k) both[k] = d.constraint_ddq[k];
  for (Index k = 0; k < result.rows; ++k) both[x.nv + k] = d.lambda[k];
  return both;
}

// along e_k t, for t around 0
template <class F>
MatrixXd differences(Index nv, Eigen::Index rows, F&& f) {
  MatrixXd out(rows, nv);
  for (Index k = 0; k < nv; ++k) {
    auto slope = [&](double h) {
      const VectorXd step = VectorXd::Unit(nv, k) * h;
      return VectorXd((f(step) - f(VectorXd(-step))) / (2 * h));
    };
    const double h = 2e-3;
    out.col(k) = (64 * slope(h / 4) - 20 * slope(h / 2) + slope(h)) / 45;
  }
  return out;
}

TEST(ConstrainedTrees, ImpulseDerivativesAreThoseOfDifferences) {
  int checked = 0, mimics = 0;
  for (int seed = 1; seed <= 60 || (seed <= 600 && (checked <= 15 || mimics <= 3)); ++seed) {
    SCOPED_TRACE(testing::Message() << "tree " << seed);
    TreeOptions options;
    options.joints = 2 + seed % 9, options.mimic = 0.3, options.massless = 0;
    Case x(std::uint64_t(seed), options);
    Dice dice(std::uint64_t(seed) * 977);
    random_constraints(x, dice, 3, 0, false);
    for_each_constraint(x.m, x.w.d, [&](ConstraintInstance<double>& s, Index) { s.c.restitution = dice.in(0, 1); });
    dynConstraintResult result{};
    impulse(x, x.x.q, x.x.v, result);
    const Index rows = result.rows;
    if (!rows || result.rank < rows || result.condition > 1e4) continue;
    ++checked, mimics += x.m.has_mimic;
    Data<double>& d = x.w.d;
    ASSERT_EQ(0, constraint_impulse_derivatives(x.m, d, d.v, ProximalOptions{}, result));
    const KktSystem<double> K = kkt_system(x.m, d, rows);
    const Eigen::Index all = x.nv + rows;
    const MatrixXd by_q = Eigen::Map<const MatrixXd>(K.by_q, K.ld, x.nv).topRows(all),
                   by_v = Eigen::Map<const MatrixXd>(K.by_v, K.ld, x.nv).topRows(all);
    auto agree = [&](const MatrixXd& expected, const MatrixXd& got) {
      EXPECT_LE(gap(expected, got), 1e-7 * std::max(1.0, largest(expected)));
    };
    agree(differences(x.nv, all, [&](const VectorXd& e) {
      VectorXd q(x.m.n.nq);
      integrate(x.m, x.x.q.data(), e.data(), q.data());
      return impulse(x, q, x.x.v, result);
    }), by_q);
    agree(differences(x.nv, all, [&](const VectorXd& e) { return impulse(x, x.x.q, x.x.v + e, result); }), by_v);
  }
  EXPECT_GT(checked, 15);
  EXPECT_GT(mimics, 3);
}

}  // namespace
}  // namespace dyn_test
