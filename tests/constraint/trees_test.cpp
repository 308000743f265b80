// Constrained dynamics of random robots under random constraints, also dependent ones. Reference: a dense solution in extended
// precision. Derivatives against extrapolated differences.
#include "constraint/trees.hpp"

#include "algorithm/constrained/kkt_inverse.hpp"
#include "algorithm/constrained/project.hpp"

namespace dyn_test {
namespace {

using Extended = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using ExtendedVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

struct Solved {
  VectorXd ddq, lambda;
  dynConstraintResult result{};
};
Solved solve(Case& x, const VectorXd& q, const VectorXd& v, const VectorXd& tau) {
  Data<double>& d = x.w.d;
  x.w.q(q).v(v).tau(tau);
  Solved out;
  out.ddq.resize(x.nv);
  EXPECT_EQ(0, constrained_dynamics(x.m, d, d.v, d.tau_applied, static_cast<const double*>(nullptr), ProximalOptions{},
                                    out.ddq.data(), out.result));
  out.lambda = matrix(d.lambda, out.result.rows);
  return out;
}

// ddq and J^T lambda of the KKT system. lambda: least squares for contradictory rows, with rows scaled by their diagonal of G.
struct Dense {
  VectorXd ddq, push;
  Eigen::Index rank = 0;
  bool clear = true;  // no row is nearly dependent
};
Dense dense(Case& x, Index rows) {
  Data<double>& d = x.w.d;
  const MatrixXd M = x.M();
  const VectorXd h = x.nle();
  EXPECT_EQ(0, constraint_factor(x.m, d));
  evaluate_rows(x.m, d, d.expand(x.m, static_cast<const double*>(d.v), d.vx), static_cast<const double*>(nullptr));
  MatrixXd J(rows, x.nv);
  constraint_jacobian(x.m, d, J.data(), rows);
  ExtendedVector b(rows), scale(rows);
  for_each_constraint(x.m, d, [&](const ConstraintInstance<double>& s, Index) {
    for (Index r = 0; r < s.rows; ++r)
      b[s.first + r] = -(s.acceleration[r] + s.c.stiffness * s.error[r] + s.c.damping * s.rate[r]);
  });
  const Eigen::LDLT<Extended> factor(M.cast<long double>());
  const Extended Z = factor.solve(J.transpose().cast<long double>()), G = J.cast<long double>() * Z;
  const ExtendedVector free = factor.solve((x.x.tau - h).cast<long double>());
  const long double most = G.diagonal().maxCoeff();
  for (Index r = 0; r < rows; ++r) scale[r] = G(r, r) > 1e-24L * most ? 1 / std::sqrt(G(r, r)) : 0;
  const Extended S = scale.asDiagonal() * G * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Extended> e(0.5L * (S + S.transpose()));
  Dense out;
  ExtendedVector inverse = e.eigenvalues();
  for (auto& value : inverse) {
    const long double part = value / e.eigenvalues()[rows - 1];
    if (part > 1e-14L && part < 1e-7L) out.clear = false;
    out.rank += part > 1e-11L;
    value = part > 1e-11L ? 1 / value : 0;
  }
  const ExtendedVector asked = scale.asDiagonal() * (b - J.cast<long double>() * free);
  const ExtendedVector lambda =
      scale.asDiagonal() * (e.eigenvectors() * (inverse.asDiagonal() * (e.eigenvectors().transpose() * asked)));
  out.ddq = (free + Z * lambda).cast<double>(), out.push = (J.transpose().cast<long double>() * lambda).cast<double>();
  return out;
}

TEST(ConstrainedTrees, AgainstExtendedPrecision) {
  int checked = 0, deficient = 0;
  for_trees([&](Case& x) {
    Dice dice(std::uint64_t(x.nv) * 131 + 7);
    random_constraints(x, dice, 4, 0.4, true);
    const Solved found = solve(x, x.x.q, x.x.v, x.x.tau);
    const Index rows = found.result.rows;
    if (!rows) return;
    const Dense expected = dense(x, rows);
    if (!expected.clear) return;
    ++checked, deficient += expected.rank < rows;
    EXPECT_EQ(expected.rank, found.result.rank);
    EXPECT_LE(gap(expected.ddq, found.ddq), 1e-9 * (1 + largest(expected.ddq)));
    MatrixXd J(rows, x.nv);
    constraint_jacobian(x.m, x.w.d, J.data(), rows);
    EXPECT_LE(gap(expected.push, J.transpose() * found.lambda), 1e-9 * (1 + largest(expected.push)));
  });
  EXPECT_GT(checked, tree_count / 2);
  EXPECT_GT(deficient, 20);
}

// A point that is tied twice, to places 1e-4 m apart: the cost of a projection is the sum of squares of the rows that are kept.
TEST(ConstrainedTrees, RowsThatAreLeftOutCostNothing) {
  int checked = 0;
  for (int seed = 1; seed <= 40; ++seed) {
    TreeOptions options;
    options.joints = 3 + seed % 4, options.massless = 0;
    Case x(std::uint64_t(seed), options);
    Data<double>& d = x.w.d;
    dynConstraint c = default_constraint(DYN_CONSTRAINT_TYPE_CONNECT);
    c.first = x.m.n.frames - 1;
    char message[512];
    if (check_constraint(x.m, c, message, sizeof message) != DYN_OK) continue;
    for (Index slot = 0; slot < 2; ++slot) c.placement2[9] += 1e-4 * slot, set_constraint(x.m, d, slot, c);
    number_rows(x.m, d);
    x.w.q(x.x.q);
    ASSERT_EQ(0, project_rows(x.m, d, true));
    propagate_rows(x.m, d);
    checked += drop_redundant_rows(x.m, d, misalignment_tolerance) > 0;
    double kept = 0;
    for_each_constraint(x.m, d, [&](const ConstraintInstance<double>& s, Index) {
      for (Index r = 0; r < s.rows; ++r)
        if (!(s.dropped >> r & 1)) kept += s.error[r] * s.error[r];
    });
    DescentResult<double> found;
    ASSERT_EQ(0, levenberg_marquardt(x.m, d, 0, true, 0.0, 1e-14, 0.0, found));
    EXPECT_NEAR(kept, found.cost, 1e-14 * kept) << seed;
  }
  EXPECT_GT(checked, 20);
}

// Compares the derivatives of ddq and lambda with extrapolated central differences. Returns false where the rows are nearly
// dependent or contradict each other.
bool expect_derivatives(Case& x) {
  const Solved here = solve(x, x.x.q, x.x.v, x.x.tau);
  const Index rows = here.result.rows;
  if (!rows || here.result.rank < rows || here.result.condition > 1e4 || here.result.contradiction > 0) return false;
  Data<double>& d = x.w.d;
  dynConstraintResult result{};
  EXPECT_EQ(0, constrained_dynamics_derivatives(x.m, d, d.v, d.tau_applied, static_cast<const double*>(nullptr),
                                                ProximalOptions{}, result));
  const KktSystem<double> K = kkt_system(x.m, d, rows);
  const Eigen::Index all = x.nv + rows;
  auto take = [&](const double* from) { return MatrixXd(Eigen::Map<const MatrixXd>(from, K.ld, x.nv).topRows(all)); };
  const MatrixXd by_q = take(K.by_q), by_v = take(K.by_v), by_tau = take(K.inverse);
  auto differences = [&](auto&& moved) {
    MatrixXd out(all, x.nv);
    for (Index k = 0; k < x.nv; ++k) {
      auto slope = [&](double h) {
        auto at = [&](double t) {
          const Solved s = moved(VectorXd(VectorXd::Unit(x.nv, k) * t));
          VectorXd both(all);
          both << s.ddq, s.lambda;
          return both;
        };
        return VectorXd((at(h) - at(-h)) / (2 * h));
      };
      const double h = 2e-3;
      out.col(k) = (64 * slope(h / 4) - 20 * slope(h / 2) + slope(h)) / 45;
    }
    return out;
  };
  auto agree = [&](const MatrixXd& expected, const MatrixXd& got) {
    EXPECT_LE(gap(expected, got), 1e-7 * std::max(1.0, largest(expected)));
  };
  agree(differences([&](const VectorXd& e) {
    VectorXd q(x.m.n.nq);
    integrate(x.m, x.x.q.data(), e.data(), q.data());
    return solve(x, q, x.x.v, x.x.tau);
  }), by_q);
  agree(differences([&](const VectorXd& e) { return solve(x, x.x.q, x.x.v + e, x.x.tau); }), by_v);
  agree(differences([&](const VectorXd& e) { return solve(x, x.x.q, x.x.v, x.x.tau + e); }), by_tau);
  return true;
}

TEST(ConstrainedTrees, DerivativesAreThoseOfDifferences) {
  int checked = 0, mimics = 0;
  for (int seed = 1; seed <= 60 || (seed <= 600 && (checked <= 15 || mimics <= 3)); ++seed) {
    SCOPED_TRACE(testing::Message() << "tree " << seed);
    TreeOptions options;
    options.joints = 2 + seed % 9, options.mimic = 0.3, options.massless = 0;
    Case x(std::uint64_t(seed), options);
    Dice dice(std::uint64_t(seed) * 977);
    random_constraints(x, dice, 3, 0, false);
    if (expect_derivatives(x)) ++checked, mimics += x.m.has_mimic;
  }
  EXPECT_GT(checked, 15);
  EXPECT_GT(mimics, 3);
}

// A coupling by a polynomial of degree four, with gains: its third derivative counts, too.
TEST(ConstrainedTrees, DerivativesOfCouplings) {
  int checked = 0, mimics = 0;
  for (int seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "tree " << seed);
    TreeOptions options;
    options.joints = 3 + seed % 4, options.mimic = 0.3, options.massless = 0;
    options.types = {DYN_JOINT_TYPE_REVOLUTE, DYN_JOINT_TYPE_PRISMATIC};
    Case x(std::uint64_t(seed), options);
    Dice dice(std::uint64_t(seed) * 977);
    dynConstraint c = default_constraint(DYN_CONSTRAINT_TYPE_COUPLING);
    c.stiffness = 20, c.damping = 5;
    for (double& k : c.coefficients) k = dice.in(-0.5, 0.5);
    std::vector<Index> leaders;
    for (Index k = 1; k < x.m.n.joints; ++k)
      if (x.m.joints()[k].leader < 0) leaders.push_back(k);
    if (leaders.size() < 2) continue;
    c.first = int(leaders.front()), c.second = int(leaders.back());
    char message[512];
    if (check_constraint(x.m, c, message, sizeof message) != DYN_OK) continue;
    set_constraint(x.m, x.w.d, 0, c), number_rows(x.m, x.w.d);
    if (expect_derivatives(x)) ++checked, mimics += x.m.has_mimic;
  }
  EXPECT_GT(checked, 10);
  EXPECT_GT(mimics, 3);
}

}  // namespace
}  // namespace dyn_test
