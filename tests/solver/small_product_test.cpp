// Products of small matrices, and the rank of such a matrix.
#include "solver/small_product.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "solver/complete_pivoting.hpp"

namespace dyn::solver {
namespace {

struct Matrix {
  Index rows, columns;
  std::vector<double> x = std::vector<double>(std::size_t(rows * columns));
  double& operator()(Index i, Index j) { return x[std::size_t(columns * i + j)]; }
  double operator()(Index i, Index j) const { return x[std::size_t(columns * i + j)]; }
};

// A share of the entries is zero.
Matrix random(Index rows, Index columns, std::mt19937& gen, double zeros = 0) {
  Matrix a{rows, columns};
  std::uniform_real_distribution<double> number(-1, 1), chance(0, 1);
  for (double& x : a.x) x = chance(gen) < zeros ? 0 : number(gen);
  return a;
}
Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{a.rows, b.columns};
  for (Index i = 0; i < a.rows; ++i)
    for (Index l = 0; l < a.columns; ++l)
      for (Index j = 0; j < b.columns; ++j) c(i, j) += a(i, l) * b(l, j);
  return c;
}

// Of all sizes around blocks of rows and of lanes, and of more columns than a list of factors holds; what lies between rows stays.
TEST(SmallProduct, IsThatOfMatrices) {
  std::mt19937 gen(1);
  for (const Index rows : {1, 3, 4, 9})
    for (const Index count : {1, 5, 64, 130})
      for (const Index n : {1, 3, 4, 7, 8, 16, 37}) {
        const Matrix a = random(rows, count, gen, 0.7), b = random(count, n + 2, gen), before = random(rows, n + 3, gen);
        const Matrix more = product(a, b);
        Matrix across{count, rows}, direct = before, transposed = before;
        for (Index i = 0; i < rows; ++i)
          for (Index l = 0; l < count; ++l) across(l, i) = a(i, l);
        add_product(direct.x.data(), n + 3, rows, {a.x.data(), count, 1}, b.x.data(), n + 2, count, n);
        add_product(transposed.x.data(), n + 3, rows, {across.x.data(), 1, rows}, b.x.data(), n + 2, count, n);
        EXPECT_EQ(transposed.x, direct.x);
        for (Index i = 0; i < rows; ++i)
          for (Index j = 0; j < n + 3; ++j)
            EXPECT_NEAR(direct(i, j), before(i, j) + (j < n ? more(i, j) : 0), j < n ? 1e-14 * double(count + 1) : 0)
                << rows << " x " << count << " x " << n;
      }
}

TEST(SmallProduct, LargestEntry) {
  for (std::size_t n = 0; n < 30; ++n) {
    std::vector<double> x(n, -0.5);
    EXPECT_EQ(largest_of(x.data(), std::ptrdiff_t(n)), n > 0 ? 0.5 : 0);
    for (double& at : x) {
      at = -2;
      EXPECT_EQ(largest_of(x.data(), std::ptrdiff_t(n)), 2);
      at = 0.25;
    }
  }
}

// Rank, solutions, what no solution meets, and null vectors.
TEST(RankedLu, OfASingularMatrix) {
  std::mt19937 gen(2);
  constexpr Index n = 11, rank = 6, columns = 9;
  const Matrix a = product(random(n, rank, gen), random(rank, n, gen)), wanted = product(a, random(n, columns, gen));
  Matrix f = a, b = wanted, x{n, columns};
  Index rows[n], unknowns[n];
  RankedLu lu{f.x.data(), n, rows, unknowns};
  lu.factor(1e-12);
  ASSERT_EQ(lu.rank, rank);
  lu.solve(b.x.data(), columns, x.x.data());
  const Matrix reached = product(a, x);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < columns; ++j) EXPECT_NEAR(reached(i, j), wanted(i, j), 1e-13);
  EXPECT_LT(largest_of(b.x.data() + columns * rank, columns * (n - rank)), 1e-13);
  for (Index k = rank; k < n; ++k) {
    Matrix open{n, 1};
    lu.null_vector(k, open.x.data());
    EXPECT_EQ(open(unknowns[k], 0), 1);
    EXPECT_LT(largest_of(product(a, open).x.data(), n), 1e-13 * largest_of(open.x.data(), n));
  }
}

}  // namespace
}  // namespace dyn::solver
