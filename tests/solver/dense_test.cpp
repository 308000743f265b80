// Dense algebra of the solvers, for all sizes relative to groups of eight rows and panels of columns.
#include "solver/dense.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "count.hpp"

namespace dyn::solver {
namespace {

constexpr Index sizes = 70;

// n x n, aligned as a workspace is; rows beyond n hold values that must not be used.
struct Square {
  explicit Square(Index n) : ld(padded(n)), numbers(std::size_t(ld) * n + lanes, 1e100) {
    const auto address = reinterpret_cast<std::uintptr_t>(numbers.data());
    A = {numbers.data() + (64 - address % 64) % 64 / sizeof(double), ld};
  }
  Index ld;
  std::vector<double> numbers;
  Matrix A;
};

struct Draw {
  std::mt19937 generator{1};
  std::normal_distribution<double> normal;
  double operator()() { return normal(generator); }
};

double largest(const std::vector<double>& x) {
  double most = 0;
  for (const double v : x) most = std::max(most, std::fabs(v));
  return most;
}

TEST(Dense, LuSolves) {
  Draw draw;
  for (Index n = 1; n <= sizes; ++n) {
    Square s(n);
    std::vector<double> A(std::size_t(n) * n), x(n), b(n);
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) A[i + n * j] = s.A(i, j) = draw();
    for (double& v : b) v = draw();
    x = b;
    std::vector<Index> pivots(n);
    ASSERT_TRUE(lu(s.A, n, pivots.data())) << n;
    for (Index j = 0; j < n; ++j)
      for (Index i = j + 1; i < n; ++i)
        EXPECT_LE(std::fabs(s.A(i, j)), 1) << "a pivot that is not the largest of its column: " << n;
    lu_solve(s.A, n, pivots.data(), x.data());
    std::vector<double> left = b;
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) left[i] -= A[i + n * j] * x[j];
    EXPECT_LE(largest(left), 1e-14 * n * largest(A) * std::max(1.0, largest(x))) << n;  // backward stable
  }
}

// Panels of columns are cheaper for large matrices, single columns for small ones and for the last ones of all.
TEST(Dense, LuTakesTheCheaperOrderOfColumns) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(NDEBUG) || !defined(__x86_64__)
  GTEST_SKIP() << "builds for debugging and sanitizers have instructions of their own";
#endif
  for (const Index n : {9, 36}) {
    Square s(n);
    std::vector<Index> pivots(n);
    const auto count = [&](bool (*method)(const Matrix&, Index, Index*)) {
      Draw draw;
      for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i) s.A(i, j) = draw();
      return bench::instructions([&] { method(s.A, n, pivots.data()); });
    };
    const auto by_panels = [](const Matrix& A, Index n, Index* pivots) {
      Index j = 0;
      for (; n - j >= 4; j += 4) eliminate<4>(A, n, j, pivots);
      for (; j < n; ++j) eliminate<1>(A, n, j, pivots);
      return true;
    };
    const auto by_columns = [](const Matrix& A, Index n, Index* pivots) {
      for (Index j = 0; j < n; ++j) eliminate<1>(A, n, j, pivots);
      return true;
    };
    const long own = count(lu), panels = count(by_panels), columns = count(by_columns);
    if (own < 0) GTEST_SKIP() << "this system does not let a process trace its child";
    EXPECT_LE(double(own), 1.08 * double(std::min(panels, columns))) << n << ": " << panels << " " << columns;
  }
}

TEST(Dense, LuRefusesSingularMatrices) {
  for (const Index n : {1, 3, 17, 40}) {
    Square s(n);
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) s.A(i, j) = i == n - 1 ? 0 : 1.0 / (1 + i + j);  // its last row is zero
    std::vector<Index> pivots(n);
    EXPECT_FALSE(lu(s.A, n, pivots.data())) << n;
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) s.A(i, j) = i == j ? 1 : 0;
    s.A(n / 2, 0) = NAN;
    EXPECT_FALSE(lu(s.A, n, pivots.data())) << n;
  }
}

TEST(Dense, CholeskySolves) {
  Draw draw;
  for (Index n = 1; n <= sizes; ++n) {
    Square s(n);
    std::vector<double> R(std::size_t(n) * n), A(R.size()), x(n), b(n);
    for (double& v : R) v = draw();
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) {
        double sum = i == j;
        for (Index k = 0; k < n; ++k) sum += R[k + n * i] * R[k + n * j];
        A[i + n * j] = s.A(i, j) = sum;
      }
    for (double& v : b) v = draw();
    x = b;
    ASSERT_TRUE(cholesky(s.A, n)) << n;
    cholesky_solve(s.A, n, x.data());
    std::vector<double> left = b;
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) left[i] -= A[i + n * j] * x[j];
    EXPECT_LE(largest(left), 1e-14 * n * largest(A) * std::max(1.0, largest(x))) << n;
    s.A(n - 1, n - 1) = -1;
    EXPECT_FALSE(cholesky(s.A, n)) << n;
  }
}

TEST(Dense, TimesSkipsColumnsOfZeros) {
  Draw draw;
  for (Index n = 1; n <= sizes; ++n) {
    Square s(n);
    std::vector<double> x(padded(n)), b(padded(n)), y(padded(n));
    for (Index i = 0; i < n; ++i) x[i] = i % 3 == 1 ? 0 : draw(), b[i] = draw();
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) s.A(i, j) = x[j] == 0 ? NAN : draw();  // columns that are skipped
    for (const double* with : {static_cast<const double*>(nullptr), static_cast<const double*>(b.data())}) {
      times(s.A, x.data(), with, y.data(), n);
      for (Index i = 0; i < n; ++i) {
        double sum = with ? b[i] : 0, size = std::fabs(sum);
        for (Index j = 0; j < n; ++j)
          if (x[j] != 0) sum += s.A(i, j) * x[j], size += std::fabs(s.A(i, j) * x[j]);
        EXPECT_NEAR(y[i], sum, 1e-15 * n * size) << n;
      }
    }
  }
}

}  // namespace
}  // namespace dyn::solver
