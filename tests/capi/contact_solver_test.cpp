// Tests the contact problem's calls: what a caller may get wrong is refused by name, with nothing written; handles; memory of the
// caller's.
#include <functional>

#include "capi/support.hpp"

namespace dyn_test {
namespace {

struct Problem {
  std::vector<double> G{2, 0, 1, 0, 2, 0, 1, 0, 2}, g{0.1, 0, -1}, friction{0.5}, row{0, 0, 0}, one{0}, lower, upper;
  std::int32_t rows[1] = {3};
  dynContactProblem p;
  dynContactOptions o;
  dynContactReport r{};
  double lambda[3] = {7, 7, 7}, velocity[3] = {7, 7, 7};

  Problem() {
    dyn_contact_problem_init(&p), dyn_contact_options_init(&o);
    p.contacts = 1, p.G = G.data(), p.g = g.data(), p.friction = friction.data(), p.contact_rows = rows;
    r.struct_size = sizeof r;
  }
  dynStatus operator()(dynContactSolver* s) { return dyn_contact_solver_solve(s, &p, &o, lambda, velocity, &r); }
};

class ContactSolve : public testing::Test {
 protected:
  dynContactSolver* s = nullptr;
  void SetUp() override { ASSERT_EQ(DYN_OK, dyn_contact_solver_new(3, &s)); }
  void TearDown() override { dyn_contact_solver_free(s); }

  void refused(dynStatus status, const std::vector<std::string>& fragments, const std::function<void(Problem&)>& spoil) {
    Problem x;
    spoil(x);
    const dynContactReport before = x.r;
    EXPECT_EQ(status, x(s)) << dyn_last_error();
    EXPECT_TRUE(says(fragments)) << dyn_last_error();
    for (int i = 0; i < 3; ++i) {
      EXPECT_TRUE(x.lambda[i] == 7 || x.lambda[i] != x.lambda[i]);
      EXPECT_EQ(7, x.velocity[i]);
    }
    EXPECT_EQ(0, std::memcmp(&before, &x.r, sizeof before));
  }
};

// A solver that has solved another problem gives the bits of a new one: from guesses so large, too, that round-off hides the speeds.
TEST_F(ContactSolve, EarlierProblemsLeaveNothingBehind) {
  for (const int type : {DYN_CONTACT_SOLVER_TYPE_PGS, DYN_CONTACT_SOLVER_TYPE_ADMM, DYN_CONTACT_SOLVER_TYPE_NEWTON})
    for (const double guess : {0.0, 0.3, 1e6, 1e14, 1e20})
      for (const int iterations : {6, 60}) {
        const auto solve = [&](dynContactSolver* by, double speed) {
          Problem x;
          x.o.solver = static_cast<dynContactSolverType>(type), x.o.warm_start = 1, x.o.max_iterations = iterations;
          x.g = {0.3, 0.2, speed};
          x.lambda[0] = 0.1 * guess, x.lambda[1] = 0, x.lambda[2] = guess;
          const double status = x(by);  // after few iterations from a large guess the result is beyond double precision
          return std::vector<double>{x.lambda[0], x.lambda[1], x.lambda[2], x.velocity[0], x.velocity[1], x.velocity[2], status};
        };
        dynContactSolver* fresh = nullptr;
        ASSERT_EQ(DYN_OK, dyn_contact_solver_new(3, &fresh));
        const std::vector<double> alone = solve(fresh, -1);
        dyn_contact_solver_free(fresh);
        EXPECT_EQ(DYN_OK, solve(s, 2).back());
        solve(s, -50);
        EXPECT_TRUE(same_bits(alone, solve(s, -1))) << type << " from " << guess << " in " << iterations;
      }
}

TEST_F(ContactSolve, RefusesWhatIsWrong) {
  const double bad[] = {nan, HUGE_VAL, -HUGE_VAL};
  for (const double b : bad) {
    refused(DYN_ERROR_NONFINITE, {"dyn_contact_solver_solve", "G(2, 1)"}, [&](Problem& x) { x.G[5] = b; });
    refused(DYN_ERROR_NONFINITE, {"g[1]"}, [&](Problem& x) { x.g[1] = b; });
    refused(DYN_ERROR_NONFINITE, {"friction[0]"}, [&](Problem& x) { x.friction[0] = b; });
    refused(DYN_ERROR_NONFINITE, {"compliance[2]"}, [&](Problem& x) { x.row[2] = b, x.p.compliance = x.row.data(); });
    refused(DYN_ERROR_NONFINITE, {"bias[2]"}, [&](Problem& x) { x.row[2] = b, x.p.bias = x.row.data(); });
    refused(DYN_ERROR_NONFINITE, {"v_minus[0]"}, [&](Problem& x) { x.row[0] = b, x.p.v_minus = x.row.data(); });
    refused(DYN_ERROR_NONFINITE, {"torsion[0]"}, [&](Problem& x) { x.one[0] = b, x.p.torsion = x.one.data(); });
    refused(DYN_ERROR_NONFINITE, {"rolling[0]"}, [&](Problem& x) { x.one[0] = b, x.p.rolling = x.one.data(); });
    refused(DYN_ERROR_NONFINITE, {"restitution[0]"}, [&](Problem& x) { x.one[0] = b, x.p.restitution = x.one.data(); });
  }
  refused(DYN_ERROR_NONFINITE, {"lambda[0]", "NaN"}, [&](Problem& x) { x.o.warm_start = 1, x.lambda[0] = nan; });
  refused(DYN_ERROR_ARGUMENT, {"friction[0] is -0.5"}, [](Problem& x) { x.friction[0] = -0.5; });
  refused(DYN_ERROR_ARGUMENT, {"restitution[0] is 1.5", "0 to 1"},
          [](Problem& x) { x.one[0] = 1.5, x.p.restitution = x.one.data(); });
  refused(DYN_ERROR_ARGUMENT, {"compliance[1] is -1"}, [](Problem& x) { x.row[1] = -1, x.p.compliance = x.row.data(); });
  refused(DYN_ERROR_INVALID, {"G(1, 1)", "negative diagonal"}, [](Problem& x) { x.G[4] = -2; });
  refused(DYN_ERROR_INVALID, {"G(0, 2)", "symmetric"}, [](Problem& x) { x.G[6] = 1.1; });
  refused(DYN_ERROR_INVALID, {"G(0, 2)", "positive semi-definite"}, [](Problem& x) { x.G[6] = x.G[2] = 3; });
  refused(DYN_ERROR_INVALID, {"positive semi-definite"}, [](Problem& x) { x.G[0] = 0; });
  refused(DYN_ERROR_ARGUMENT, {"contact_rows[0] is 2"}, [](Problem& x) { x.rows[0] = 2; });
  refused(DYN_ERROR_LIMIT, {"6 rows", "room for 3"}, [](Problem& x) { x.rows[0] = 6; });
  refused(DYN_ERROR_LIMIT, {"contacts is 1000000000"}, [](Problem& x) { x.p.contacts = 1000000000; });
  refused(DYN_ERROR_ARGUMENT, {"boxes is -1"}, [](Problem& x) { x.p.boxes = -1; });
  refused(DYN_ERROR_SIZE, {"G_stride is 2"}, [](Problem& x) { x.p.G_stride = 2; });
  refused(DYN_ERROR_SIZE, {"dynContactProblem"}, [](Problem& x) { x.p.struct_size = 4; });
  refused(DYN_ERROR_SIZE, {"dynContactOptions"}, [](Problem& x) { x.o.struct_size = 4; });
  refused(DYN_ERROR_SIZE, {"dynContactReport"}, [](Problem& x) { x.r.struct_size = 4; });
  refused(DYN_ERROR_ARGUMENT, {"G is NULL"}, [](Problem& x) { x.p.G = nullptr; });
  refused(DYN_ERROR_ARGUMENT, {"g is NULL"}, [](Problem& x) { x.p.g = nullptr; });
  refused(DYN_ERROR_ARGUMENT, {"solver is 7"}, [](Problem& x) { x.o.solver = static_cast<dynContactSolverType>(7); });
  refused(DYN_ERROR_ARGUMENT, {"max_iterations is -1"}, [](Problem& x) { x.o.max_iterations = -1; });
  refused(DYN_ERROR_ARGUMENT, {"relaxation is 2"}, [](Problem& x) { x.o.relaxation = 2; });
  refused(DYN_ERROR_NONFINITE, {"tolerance is nan"}, [](Problem& x) { x.o.tolerance = nan; });
  refused(DYN_ERROR_ARGUMENT, {"time_budget is -1"}, [](Problem& x) { x.o.time_budget = -1; });
  for (const auto& [lower, upper, status] : {std::tuple(1.0, 0.0, DYN_ERROR_ARGUMENT), std::tuple(nan, 0.0, DYN_ERROR_NONFINITE),
                                             std::tuple(HUGE_VAL, HUGE_VAL, DYN_ERROR_ARGUMENT)})
    refused(status, {"lower[0]"}, [&, l = lower, u = upper](Problem& x) {
      x.p.contacts = 0, x.p.boxes = 3, x.lower = {l, 0, 0}, x.upper = {u, 1, 1}, x.p.lower = x.lower.data(),
      x.p.upper = x.upper.data();
    });
  Problem x;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_solver_solve(s, nullptr, nullptr, x.lambda, nullptr, &x.r));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_solver_solve(s, &x.p, nullptr, nullptr, nullptr, &x.r));
  EXPECT_TRUE(says({"lambda is NULL"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_solver_solve(s, &x.p, nullptr, x.lambda, nullptr, nullptr));
  EXPECT_EQ(DYN_OK, dyn_contact_solver_solve(s, &x.p, nullptr, x.lambda, nullptr, &x.r));
  EXPECT_EQ(DYN_CONTACT_STATUS_CONVERGED, x.r.status);
}

// Numbers as large and as small as they come: an answer, or an error, and nothing that is not finite.
TEST_F(ContactSolve, Extremes) {
  for (const double G : {1e-300, 1e-150, 1.0, 1e150, 1e300})
    for (const double g : {0.0, 1e-300, 1e-150, 1.0, 1e150, 1e300})
      for (const double mu : {0.0, 1e-300, 1e-8, 1.0, 1e8, 1e300})
        for (const int type : {0, 1, 2}) {
          Problem x;
          for (double& e : x.G) e *= G;
          for (double& e : x.g) e *= g;
          x.friction[0] = mu, x.o.solver = static_cast<dynContactSolverType>(type);
          const dynStatus status = x(s);
          EXPECT_TRUE(status == DYN_OK || status == DYN_ERROR_NUMERIC) << dyn_last_error();
          for (int i = 0; i < 3; ++i) EXPECT_TRUE(std::isfinite(x.lambda[i]) && std::isfinite(x.velocity[i]));
          if (status != DYN_OK) {
            EXPECT_EQ(7, x.lambda[0]);
          }
        }
}

TEST(ContactSolver, Handles) {
  dynContactSolver* s = nullptr;
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_contact_solver_new(0, &s));
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_contact_solver_new(-3, &s));
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_contact_solver_new(1 << 30, &s));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_solver_new(3, nullptr));
  EXPECT_EQ(0u, dyn_contact_solver_size(0));
  EXPECT_EQ(nullptr, s);
  dyn_contact_solver_free(nullptr);
  Problem x;
  EXPECT_EQ(DYN_ERROR_HANDLE, x(nullptr));
  alignas(64) unsigned char noise[128] = {};
  EXPECT_EQ(DYN_ERROR_HANDLE, x(reinterpret_cast<dynContactSolver*>(noise)));
  ASSERT_EQ(DYN_OK, dyn_contact_solver_new(3, &s));
  dyn_contact_solver_free(s);
  EXPECT_EQ(DYN_ERROR_HANDLE, x(s));
  EXPECT_TRUE(says({"contact solver", "freed"}));
  EXPECT_EQ(7, x.lambda[0]);

  const std::size_t size = dyn_contact_solver_size(3);
  std::vector<double> block(size / 8 + 16, 1.5);
  const std::size_t shift = (64 - reinterpret_cast<std::uintptr_t>(block.data()) % 64) % 64;
  char* const memory = reinterpret_cast<char*>(block.data()) + shift;
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_contact_solver_init(3, memory, size - 1, &s));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_solver_init(3, memory + 8, size, &s));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_solver_init(3, nullptr, size, &s));
  ASSERT_EQ(DYN_OK, dyn_contact_solver_init(3, memory, size, &s));
  EXPECT_EQ(DYN_OK, x(s));
  for (std::size_t k = (shift + size) / 8; k < block.size(); ++k) EXPECT_EQ(1.5, block[k]);
  dyn_contact_solver_free(s);
  EXPECT_EQ(DYN_ERROR_HANDLE, x(s));
}

TEST(ContactSolver, ResidualsOfAGuess) {
  dynContactSolver* s = nullptr;
  ASSERT_EQ(DYN_OK, dyn_contact_solver_new(6, &s));
  Problem x;
  const double outside[3] = {1, 0, 1}, bad[3] = {0, nan, 0};
  ASSERT_EQ(DYN_OK, dyn_contact_solver_residuals(s, &x.p, outside, &x.r));
  EXPECT_NEAR(0.5 / std::sqrt(1.25), x.r.primal, 1e-15);  // distance to the cone of slope 1/2
  EXPECT_GT(x.r.residual, 0.1);
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_contact_solver_residuals(s, &x.p, bad, &x.r));
  const double vast[] = {1e300, 1e300, 1e300};
  EXPECT_EQ(DYN_ERROR_NUMERIC, dyn_contact_solver_residuals(s, &x.p, vast, &x.r));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_solver_residuals(s, &x.p, nullptr, &x.r));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_solver_residuals(s, nullptr, outside, &x.r));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_contact_solver_residuals(nullptr, &x.p, outside, &x.r));
  dyn_contact_solver_free(s);
}

TEST(FrictionConeQp, Refuses) {
  Problem x;
  dynQp q{};
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_contact_problem_qp(&x.p, 8, 1, &q));
  q.struct_size = sizeof q;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_problem_qp(nullptr, 8, 1, &q));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_problem_qp(&x.p, 8, 1, nullptr));
  for (const int facets : {-1, 1, 2, 2000}) EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_problem_qp(&x.p, facets, 1, &q));
  ASSERT_EQ(DYN_OK, dyn_contact_problem_qp(&x.p, 8, 1, &q));
  EXPECT_EQ(3, q.n);
  EXPECT_EQ(9, q.m);
  double upper[9];
  q.upper = upper, q.m = 8;
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_contact_problem_qp(&x.p, 8, 1, &q));
  EXPECT_TRUE(says({"m is 8, needs 9"}));
  q.m = 9, q.A = upper;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_problem_qp(&x.p, 8, 1, &q));
  q.A = nullptr;
  EXPECT_EQ(DYN_OK, dyn_contact_problem_qp(&x.p, 8, 1, &q));
  EXPECT_EQ(HUGE_VAL, upper[0]);
  EXPECT_EQ(0, upper[8]);
  x.g[0] = nan;
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_contact_problem_qp(&x.p, 8, 1, &q));
}

TEST(ContactCompliance, Refuses) {
  double R = 7, b = 7;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_compliance(0, 0, 1e-3, 0, &R, &b));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_compliance(-1, 0, 1e-3, 0, &R, &b));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_compliance(1, 0, 0, 0, &R, &b));
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_contact_compliance(nan, 0, 1e-3, 0, &R, &b));
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_contact_compliance(1, 0, 1e-3, HUGE_VAL, &R, &b));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_compliance(1, 0, 1e-3, 0, nullptr, &b));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_stiffness_hertz(0, 1, 1, &R, &b));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_stiffness_hertz(1, 1, -1, &R, &b));
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_contact_stiffness_hertz(1, nan, 1, &R, &b));
  EXPECT_EQ(DYN_ERROR_NUMERIC, dyn_contact_stiffness_hertz(1e200, 1, 1, &R, &b));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_stiffness_hertz(1, 1, 1, &R, nullptr));
  EXPECT_EQ(7, R);
  EXPECT_EQ(7, b);
}

}  // namespace
}  // namespace dyn_test
