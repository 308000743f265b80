// One contact in a sweep: its block is solved exactly, whatever its scales, from nothing and from the last solution.
#include <gtest/gtest.h>

#include <random>

#include "solver/interior_point.hpp"
#include "solver/local_cone.hpp"
#include "solver/point_contact.hpp"

namespace dyn::solver {
namespace {

struct Random {
  std::mt19937 generator{7};
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator); }
  double normal() { return std::normal_distribution<double>()(generator); }
  double power(double low, double high) { return std::pow(10, uniform(low, high)); }
};

// G of one contact of n rows, the normal first, positive definite.
struct OwnBlock {
  Index n;
  double mu;
  double entries[6 * 8] = {}, b[6];
  OwnBlock(Index rows, Random& draw, double spread = 2) : n(rows), mu(draw.power(-2, 0.5)) {
    double factor[6][6], scale[6];
    for (auto& row : factor)
      for (double& x : row) x = draw.normal();
    for (double& x : scale) x = draw.power(-spread / 2, spread / 2);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) {
        double sum = i == j;
        for (Index k = 0; k < n; ++k) sum += factor[i][k] * factor[j][k];
        entries[i + 8 * j] = scale[i] * scale[j] * sum;
      }
    for (Index i = 0; i < n; ++i) b[i] = scale[i] * draw.normal();
    b[0] = -std::fabs(b[0]);
  }
  double at(Index i, Index j) const { return entries[i + 8 * j]; }
  LocalCone cone() const {
    LocalCone l;
    l.set(entries, 8, n);
    return l;
  }
  // By how much y misses the law, relative: sticking contacts do not move, sliding ones along -y_t.
  double error(const double* y) const {
    double c[6], size = 0, worst = 0, ct = 0, yt = 0, product = 0;
    for (Index i = 0; i < n; ++i) {
      c[i] = b[i];
      double terms = std::fabs(b[i]);
      for (Index j = 0; j < n; ++j) c[i] += at(i, j) * y[j], terms += std::fabs(at(i, j) * y[j]);
      size = std::max(size, terms);
    }
    for (Index i = 1; i < n; ++i) ct += c[i] * c[i], yt += y[i] * y[i], product += c[i] * y[i];
    ct = std::sqrt(ct), yt = std::sqrt(yt);
    worst = std::fabs(c[0]) / size;
    const double inside = 1 - yt / (mu * y[0]);                                                   // of the cone, as a share
    if (inside < 1e-3) return std::max({worst, (product / yt + ct) / size, inside * ct / size});  // slides
    return std::max(worst, ct / size);
  }
};

// Impulses along one direction of the cone move nothing, and rounding leaves a velocity along it.
TEST(ContactBlock, ImpulsesThatMoveNothingStaySmall) {
  Random draw;
  for (int k = 0; k < 500; ++k) {
    OwnBlock x(3, draw);
    x.mu = 1;
    const double turn = draw.uniform(0, 6.3), lean = draw.uniform(0, 0.9),
                 still[3] = {1, lean * std::cos(turn), lean * std::sin(turn)};
    double moved[3][2], asked[2], size = 0;
    for (double& y : asked) y = draw.normal();
    for (int j = 0; j < 2; ++j) {
      double along = 0;
      for (auto& row : moved) row[j] = draw.normal();
      for (int i = 0; i < 3; ++i) along += moved[i][j] * still[i] / (1 + lean * lean);
      for (int i = 0; i < 3; ++i) moved[i][j] -= along * still[i];
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) x.entries[i + 8 * j] = moved[i][0] * moved[j][0] + moved[i][1] * moved[j][1];
      x.b[i] = moved[i][0] * asked[0] + moved[i][1] * asked[1], size = std::max(size, std::fabs(x.b[i]));
    }
    for (int i = 0; i < 3; ++i) x.b[i] += 1e-14 * size * draw.normal();
    LocalCone l = x.cone();
    double y[3];
    l.solve(x.mu, x.b, y);
    EXPECT_LE(std::hypot(y[0], y[1], y[2]), 1e6) << k;
  }
}

// S = Q E Q' of the tangential block without the normal.
TEST(ContactBlock, EigenvectorsAreExact) {
  Random draw;
  for (int k = 0; k < 500; ++k) {
    const OwnBlock x(6, draw);
    LocalCone l = x.cone();
    l.find_eigenvectors(x.mu);
    double size = 0, worst = 0, turned = 0;
    for (Index i = 0; i < 5; ++i)
      for (Index j = 0; j < 5; ++j) {
        const double S = x.at(1 + i, 1 + j) - x.at(1 + i, 0) * x.at(1 + j, 0) / x.at(0, 0);
        double sum = -S, product = -(i == j);
        for (Index e = 0; e < 5; ++e) sum += l.q[i][e] * l.e[e] * l.q[j][e], product += l.q[e][i] * l.q[e][j];
        size = std::max(size, std::fabs(S)), worst = std::max(worst, std::fabs(sum));
        turned = std::max(turned, std::fabs(product));
      }
    EXPECT_LT(worst, 6e-15 * size);
    EXPECT_LT(turned, 6e-15);
  }
}

// A direction that moves by rounding alone has no stiffness.
TEST(ContactBlock, RoundingIsNoStiffness) {
  for (const double least : {3e-15, 3e-14}) {
    Random draw;
    OwnBlock x(3, draw);
    std::fill_n(x.entries, 24, 0.0);
    x.entries[0] = x.entries[9] = 1, x.entries[18] = least;
    LocalCone l = x.cone();
    l.find_eigenvectors(x.mu);
    EXPECT_EQ(least > 1e-14 ? least : 0, std::min(l.e[0], l.e[1]));
  }
}

TEST(ContactBlock, LawIsMetToRounding) {
  Random draw;
  for (const auto& [rows, tolerance] : {std::pair(2, 1e-12), {3, 1e-12}, {4, 1e-10}, {6, 1e-10}}) {
    double worst = 0;
    for (int k = 0; k < 500; ++k) {
      const OwnBlock x(rows, draw, 6);
      LocalCone l = x.cone();
      double y[6];
      l.solve(x.mu, x.b, y);
      worst = std::max(worst, x.error(y));
    }
    EXPECT_LT(worst, tolerance) << rows;
  }
}

// The next sweep starts from the last resistance: a small change takes Newton steps from there, a large one a new search.
TEST(ContactBlock, LastSolutionIsAStart) {
  Random draw;
  for (const auto& [change, tolerance] : {std::pair(1e-4, 1e-7), {1e-2, 1e-6}, {0.1, 1e-6}, {3.0, 1e-5}}) {
    double worst = 0;
    for (int k = 0; k < 500; ++k) {
      OwnBlock x(3, draw, 4);
      LocalCone l = x.cone();
      double y[6];
      l.solve(x.mu, x.b, y);
      for (Index i = 0; i < 3; ++i) x.b[i] *= 1 + change * draw.uniform(0, 1);
      l.solve(x.mu, x.b, y);
      worst = std::max(worst, x.error(y));
    }
    EXPECT_LT(worst, tolerance) << change;
  }
}

TEST(PointContact, LawIsMetToItsTolerance) {
  Random draw;
  for (const double spread : {2.0, 4.0}) {
    double worst = 0, again = 0;
    for (int k = 0; k < 500; ++k) {
      OwnBlock x(3, draw, spread);
      PointContact point;
      ASSERT_TRUE(point.set(x.entries, 8));
      double y[3];
      point.solve(x.mu, x.b, y);
      worst = std::max(worst, x.error(y));
      for (double& b : x.b) b *= 1 + draw.uniform(0, 0.3);
      point.solve(x.mu, x.b, y);
      again = std::max(again, x.error(y));
    }
    EXPECT_LT(worst, 3e-9) << spread;
    EXPECT_LT(again, 3e-9) << spread;
  }
}

// Its inverse has half the digits: blocks that are nearer to singular take the eigenvectors.
TEST(PointContact, NearlySingularBlocksAreRefused) {
  for (const double share : {3e-11, 3e-10}) {
    const double block[9] = {1, 0, 0, 0, 1, std::sqrt(1 - share), 0, std::sqrt(1 - share), 1};
    PointContact point;
    EXPECT_EQ(share > 1e-10, point.set(block, 3)) << share;
  }
}

// Bounded rows that nothing couples: c = G y + g.
struct Uncoupled {
  static constexpr bool inverse_laws = false;
  static constexpr double compliance = 0, edge = 0;
  static constexpr Index n = 6;
  double G[n], g[n];
  Block blocks[n] = {};
  LawMatrix laws[n];

  template <class F>
  void for_each(F&& f) const {
    for (Index k = 0; k < n; ++k) f(blocks[k], k);
  }
  LawMatrix& law(Index k) { return laws[k]; }
  double correction(Index) const { return 0; }
  bool factorize(bool) const { return true; }
  void solve(const double* r, double* dy, double* dc) const {
    for (Index k = 0; k < n; ++k) dy[k] = laws[k][0][0] * r[k] / (1 + laws[k][0][0] * G[k]), dc[k] = G[k] * dy[k];
  }
};

// Boxes follow z_l (y - l) = sigma, z_u (u - y) = sigma, z_l - z_u = c. The last equation is linear: Newton's step of length t
// leaves 1 - t of its error, in all rows alike.
TEST(InteriorPoint, StepsReduceTheErrorOfAllBoxesAlike) {
  Random draw;
  for (int round = 0; round < 20; ++round) {
    constexpr Index n = Uncoupled::n;
    Uncoupled problem;
    for (Index k = 0; k < n; ++k) {
      problem.G[k] = draw.power(-1, 1), problem.g[k] = draw.normal();
      Block& s = problem.blocks[k];
      s.rows = 1, s.first = k, s.lower = k % 3 == 1 ? -HUGE_VAL : -draw.uniform(0, 1), s.upper = k % 3 == 0 ? HUGE_VAL : 1;
    }
    double y[n] = {}, c[n], dy[n], dc[n], rhs[n], U[n], upper[n], dU[n], dupper[n], before[n];
    InteriorPoint<Uncoupled> path{problem, n, y, c, dy, dc, rhs, U, upper, dU, dupper};
    const auto set_velocity = [&] {
      for (Index k = 0; k < n; ++k) c[k] = problem.G[k] * y[k] + problem.g[k];
    };
    set_velocity(), path.start_inside(1, 1), set_velocity();
    const auto error = [&](Index k) { return U[k] - upper[k] - c[k]; };
    for (int step = 0; step < 4; ++step) {
      Index worst = 0;
      for (Index k = 0; k < n; ++k) {
        before[k] = error(k);
        if (std::abs(before[k]) > std::abs(before[worst])) worst = k;
      }
      ASSERT_TRUE(path.step());
      const double left = std::abs(before[worst]) > 1e-12 ? error(worst) / before[worst] : 0;  // nothing after a whole step
      EXPECT_TRUE(left > -1e-9 && left < 1) << left;
      for (Index k = 0; k < n; ++k) EXPECT_NEAR(left * before[k], error(k), 1e-12) << round << " " << step;
    }
  }
}

}  // namespace
}  // namespace dyn::solver
