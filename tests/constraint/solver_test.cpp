// Solvers for rows: semidefinite G of any rank and scale, contradictory rows, bounds.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "common/eigen.hpp"
#include "algorithm/constrained/bounded.hpp"

namespace dyn {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

struct Problem {
  Index n;
  std::ptrdiff_t ld;
  std::vector<double> G, factor, scaled, range, vectors, part;
  std::vector<Index> state, free;

  explicit Problem(const Matrix& A)
      : n(Index(A.rows())),
        ld(padded_rows(n)),
        G(std::size_t(ld * ld)),
        factor(G),
        scaled(G),
        range(G),
        vectors(std::size_t(12 * ld)),
        part(G),
        state(std::size_t(ld)),
        free(state) {
    for (Index c = 0; c < n; ++c)
      for (Index r = 0; r < n; ++r) G[std::size_t(ld * c + r)] = A(r, c);
  }
  RowWork<double> work() { return {factor.data(), scaled.data(), range.data(), vectors.data(), ld}; }
  Vector solve(const Vector& b, ProximalResult<double>& result, const ProximalOptions& options = {}) {
    Vector lambda(n);
    solve_equalities(work(), G.data(), ld, n, b.data(), options, lambda.data(), result);
    return lambda;
  }
};

Matrix random_matrix(int rows, int cols, int seed) {
  std::mt19937 g(static_cast<unsigned>(seed));
  std::normal_distribution<double> normal;
  return Matrix::NullaryExpr(rows, cols, [&] { return normal(g); });
}

TEST(Proximal, FullRank) {
  for (int n = 1; n <= 40; ++n) {
    const Matrix J = random_matrix(n, n + 5, n);
    Problem p(J * J.transpose());
    const Vector x = random_matrix(n, 1, 100 + n);
    ProximalResult<double> result;
    const Vector lambda = p.solve(J * (J.transpose() * x), result);
    EXPECT_EQ(DYN_CONSTRAINT_REASON_CONVERGED, result.reason);
    EXPECT_EQ(n, result.rank);
    EXPECT_LE((J.transpose() * (lambda - x)).norm(), 1e-9 * x.norm());
  }
}

// Dependent rows in units of any size: rank, and the motion due to lambda.
TEST(Proximal, DependentRowsOfAnyScale) {
  for (int n = 2; n <= 24; ++n)
    for (int rank = 1; rank < n; rank += 3)
      for (double units : {1e-6, 1.0, 1e6}) {
        Matrix J = random_matrix(n, rank, n) * random_matrix(rank, rank + 4, rank);
        for (int i = 0; i < n; i += 2) J.row(i) *= units;
        Problem p(J * J.transpose());
        const Vector motion = random_matrix(rank + 4, 1, n + rank);
        ProximalResult<double> result;
        const Vector lambda = p.solve(J * motion, result);
        EXPECT_EQ(DYN_CONSTRAINT_REASON_CONVERGED, result.reason) << n << " " << rank << " " << units;
        EXPECT_EQ(rank, result.rank);
        const Eigen::JacobiSVD<Matrix> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
        const Matrix V = svd.matrixV().leftCols(rank);
        EXPECT_LE((J.transpose() * lambda - V * (V.transpose() * motion)).norm(), 1e-7 * motion.norm())
            << n << " " << rank << " " << units;
      }
}

TEST(Proximal, ContradictionIsTheLeastSquares) {
  Matrix J(3, 2);
  J << 1, 0, 1, 0, 0, 1;
  Problem p(J * J.transpose());
  ProximalResult<double> result;
  const Vector lambda = p.solve(Vector{{1.0, 2.0, 3.0}}, result);
  EXPECT_EQ(DYN_CONSTRAINT_REASON_CONTRADICTORY, result.reason);
  EXPECT_NEAR(0.5, result.contradiction, 1e-12);
  EXPECT_LE((J.transpose() * lambda - Eigen::Vector2d(1.5, 3)).norm(), 1e-9);
  EXPECT_NEAR(lambda[0], lambda[1], 1e-6);  // equal rows share it up to rounding over regularisation, 1e-16 / 1e-9
}

TEST(Proximal, TwelveDecadesOfRegularisation) {
  const Matrix J = random_matrix(12, 4, 1) * random_matrix(4, 9, 2);
  const Vector motion = random_matrix(9, 1, 3);
  for (int k = -16; k <= 2; ++k) {
    Problem p(J * J.transpose());
    ProximalResult<double> result;
    EXPECT_TRUE(p.solve(J * motion, result, {100, std::pow(10.0, k), 1e-12}).allFinite()) << k;
  }
}

TEST(Proximal, NothingToSolve) {
  Problem p(Matrix::Zero(4, 4));
  ProximalResult<double> result;
  EXPECT_EQ(0, p.solve(Vector::Zero(4), result).norm());
  EXPECT_EQ(0, result.rank);
  EXPECT_EQ(DYN_CONSTRAINT_REASON_CONVERGED, result.reason);
  EXPECT_EQ(0, p.solve(Vector::Ones(4), result).norm());
  EXPECT_EQ(DYN_CONSTRAINT_REASON_CONTRADICTORY, result.reason);
  EXPECT_EQ(1, result.contradiction);
}

// Complementarity of every row, in problems with bounds of all kinds.
TEST(Bounded, Complementarity) {
  for (int seed = 0; seed < 300; ++seed) {
    const int n = 1 + seed % 20;
    const Matrix J = random_matrix(n, n + 2, seed), G = J * J.transpose();
    const Vector b = 3 * random_matrix(n, 1, seed + 1000);
    std::vector<double> lower(std::size_t(n), -HUGE_VAL), upper(std::size_t(n), HUGE_VAL);
    for (int i = 0; i < n; ++i)
      switch ((seed + i) % 5) {
        case 0: lower[std::size_t(i)] = 0; break;
        case 1: upper[std::size_t(i)] = 0; break;
        case 2: lower[std::size_t(i)] = -0.5, upper[std::size_t(i)] = 0.5; break;
        case 3: lower[std::size_t(i)] = upper[std::size_t(i)] = 0; break;
        default: break;
      }
    Problem p(G);
    Vector lambda(n);
    ProximalResult<double> result;
    solve_bounded(p.work(), p.G.data(), p.ld, p.n, b.data(),
                  Bounds<double>{lower.data(), upper.data(), p.state.data(), p.free.data(), p.part.data()}, {}, lambda.data(),
                  result);
    EXPECT_EQ(DYN_CONSTRAINT_REASON_CONVERGED, result.reason) << seed;
    const Vector w = G * lambda - b;
    for (int i = 0; i < n; ++i) {
      const double low = lower[std::size_t(i)], high = upper[std::size_t(i)], tolerance = 1e-8 * (1 + b.norm());
      EXPECT_TRUE(lambda[i] >= low - 1e-12 && lambda[i] <= high + 1e-12) << seed;
      if (low == high) continue;
      if (lambda[i] > low + 1e-9) { EXPECT_LE(w[i], tolerance) << seed << " " << i; }
      if (lambda[i] < high - 1e-9) { EXPECT_GE(w[i], -tolerance) << seed << " " << i; }
    }
  }
}

}  // namespace
}  // namespace dyn
