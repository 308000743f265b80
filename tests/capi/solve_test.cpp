// Tests which factor dyn_cholesky_solve uses: that of the held q, or none.
#include "capi/calls.hpp"

namespace dyn_test {
namespace {

class Solve : public ::testing::TestWithParam<bool> {  // with mimic joints or without
 protected:
  const Model m = all_types(GetParam());
  const State s = random_state(m, 1), t = random_state(m, 2);
  Data d{m};

  Numbers solve() {
    Numbers x(s.v.size(), 0.5);
    EXPECT_EQ(DYN_OK, dyn_cholesky_solve(m, d, s.a.data(), 1, x.data())) << dyn_last_error();
    return x;
  }
  void expect_stale(const char* after) {
    Numbers x(s.v.size(), 0.5);
    EXPECT_EQ(DYN_ERROR_STALE, dyn_cholesky_solve(m, d, s.a.data(), 1, x.data())) << after;
    EXPECT_TRUE(says({"dyn_cholesky_solve", "the factor of M", "not computed for the current state", "call dyn_cholesky"}))
        << after;
    for (double e : x) EXPECT_EQ(0.5, e) << after;
  }
  void factorize(const Numbers& q) {
    ASSERT_EQ(DYN_OK, dyn_crba(m, d, q.data(), nullptr));
    ASSERT_EQ(DYN_OK, dyn_cholesky(m, d));
  }
  // M x - b, M of the held q
  double residual(const Numbers& x) {
    const Numbers M = field(m, d, "M");
    double worst = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      double sum = -s.a[i];
      for (std::size_t k = 0; k < x.size(); ++k) sum += M[i + x.size() * k] * x[k];
      worst = std::max(worst, std::abs(sum));
    }
    return worst;
  }
};

TEST_P(Solve, NeedsAFactorOfTheHeldQ) {
  expect_stale("nothing");
  ASSERT_EQ(DYN_OK, dyn_crba(m, d, s.q.data(), nullptr));
  expect_stale("dyn_crba alone");
  factorize(s.q);
  const Numbers x = solve();
  EXPECT_LT(residual(x), 1e-10);
  // the rest of the state, and the same q once more, change nothing
  ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, s.q.data(), t.v.data(), t.a.data(), t.tau.data()));
  ASSERT_EQ(DYN_OK, dyn_crba(m, d, nullptr, nullptr));
  EXPECT_TRUE(same_bits(x, solve()));
}

TEST_P(Solve, IsStaleOnceQHasChanged) {
  factorize(s.q);
  ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, t.q.data(), nullptr, nullptr, nullptr));
  expect_stale("dyn_data_set_state");
  ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, s.q.data(), nullptr, nullptr, nullptr));
  expect_stale("going there and back");
  for (const CallRow& row : call_rows) {
    if (!(row.uses & uses_q)) continue;
    factorize(s.q);
    Prepared p(row, m, t);
    p.x.mask = DYN_TERM_KINEMATICS;
    ASSERT_EQ(DYN_OK, p(m, d)) << row.name;
    Numbers y(s.v.size(), 0.5);  // a few make the factor of the new q on their way
    if (dyn_cholesky_solve(m, d, s.a.data(), 1, y.data()) != DYN_OK) {
      expect_stale(row.name);
      continue;
    }
    ASSERT_EQ(DYN_OK, dyn_crba(m, d, nullptr, nullptr)) << row.name;
    EXPECT_LT(residual(y), 1e-10) << row.name;
  }
  factorize(s.q);
  ASSERT_EQ(DYN_OK, take_step(m, d, DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3));
  expect_stale("dyn_step");
}

TEST_P(Solve, AfterAllTerms) {
  for (std::uint32_t mask : {DYN_TERM_CHOLESKY, DYN_TERM_MINV}) {
    ASSERT_EQ(DYN_OK, dyn_all_terms(m, d, mask, mask == DYN_TERM_CHOLESKY ? s.q.data() : t.q.data(), nullptr, nullptr));
    EXPECT_LT(residual(solve()), 1e-10);
  }
}

TEST_P(Solve, SeveralInPlace) {
  factorize(s.q);
  const Numbers x = solve();
  Numbers b;
  for (int k = 0; k < 3; ++k) b.insert(b.end(), s.a.begin(), s.a.end());
  ASSERT_EQ(DYN_OK, dyn_cholesky_solve(m, d, b.data(), 3, b.data()));
  for (std::size_t k = 0; k < b.size(); ++k) EXPECT_EQ(x[k % x.size()], b[k]);
  EXPECT_EQ(DYN_OK, dyn_cholesky_solve(m, d, b.data(), 0, b.data()));
}

INSTANTIATE_TEST_SUITE_P(Capi, Solve, testing::Bool(), [](const auto& p) { return p.param ? "WithMimic" : "WithoutMimic"; });

}  // namespace
}  // namespace dyn_test
