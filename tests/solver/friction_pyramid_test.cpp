// The linear friction pyramids of dyn_contact_problem_qp, beside the cone that they stand for.
#include "solver/scenes.hpp"

namespace dyn_test {
namespace {

struct Range {
  double least, most;
};

// Tangential impulses in all directions that the pyramid allows at a unit normal impulse.
Range allowed(int facets, int inscribed, double mu) {
  Scene s;
  s.g = {0, 0, 0}, s.friction = {mu};
  dynQp qp;
  dyn_qp_init(&qp);
  EXPECT_EQ(DYN_OK, dyn_contact_problem_qp(s.get(), facets, inscribed, &qp)) << dyn_last_error();
  std::vector<std::int32_t> columns(4), rows(std::size_t(qp.A_nonzeros));
  Vector A(rows.size()), upper(std::size_t(qp.m));
  qp.A_columns = columns.data(), qp.A_rows = rows.data(), qp.A = A.data(), qp.upper = upper.data();
  EXPECT_EQ(DYN_OK, dyn_contact_problem_qp(s.get(), facets, inscribed, &qp)) << dyn_last_error();
  Range found{HUGE_VAL, 0};
  for (int k = 0; k < 5040; ++k) {
    const double angle = 2 * pi * k / 5040, along[3] = {std::cos(angle), std::sin(angle), 0};
    Vector tangential(upper.size()), normal(upper.size());
    for (std::size_t j = 0; j < 3; ++j)
      for (std::int32_t n = columns[j]; n < columns[j + 1]; ++n)
        (j < 2 ? tangential : normal)[std::size_t(rows[std::size_t(n)])] += (j < 2 ? along[j] : 1) * A[std::size_t(n)];
    double most = HUGE_VAL;
    for (std::size_t i = 0; i < upper.size(); ++i)
      if (tangential[i] > 0) most = std::min(most, (upper[i] - normal[i]) / tangential[i]);
    found.least = std::min(found.least, most), found.most = std::max(found.most, most);
  }
  return found;
}

// A regular polygon of so many sides: around the circle of radius mu, or in it.
TEST(FrictionPyramid, IsARegularPolygonAroundTheConeOrInIt) {
  const double mu = 0.7;
  for (const int facets : {3, 4, 5, 8, 12}) {
    const double share = std::cos(pi / facets);
    const Range around = allowed(facets, 0, mu), in = allowed(facets, 1, mu);
    EXPECT_NEAR(mu, around.least, 1e-14) << facets;
    EXPECT_NEAR(mu / share, around.most, 1e-14) << facets;
    EXPECT_NEAR(mu * share, in.least, 1e-14) << facets;
    EXPECT_NEAR(mu, in.most, 1e-14) << facets;
  }
}

// H is G with the compliance on its diagonal. Zeros of G are left out, but the diagonal is there.
TEST(FrictionPyramid, QuadraticTermIsTheMatrixAndItsCompliance) {
  Scene s;
  s.G = {0, 0, 0, 0, 1, -0.25, 0, -0.25, 3}, s.g = {0, 0, 0}, s.friction = {0.5}, s.compliance = {0, 0.1, 0.2};
  dynQp qp;
  dyn_qp_init(&qp);
  ASSERT_EQ(DYN_OK, dyn_contact_problem_qp(s.get(), 4, 0, &qp)) << dyn_last_error();
  ASSERT_EQ(5, qp.H_nonzeros);
  std::vector<std::int32_t> columns(4), rows(5);
  Vector H(5), full(9);
  qp.H_columns = columns.data(), qp.H_rows = rows.data(), qp.H = H.data();
  ASSERT_EQ(DYN_OK, dyn_contact_problem_qp(s.get(), 4, 0, &qp)) << dyn_last_error();
  for (std::size_t j = 0; j < 3; ++j)
    for (auto n = std::size_t(columns[j]); n < std::size_t(columns[j + 1]); ++n) full[std::size_t(rows[n]) + 3 * j] = H[n];
  EXPECT_EQ((Vector{0, 0, 0, 0, 1.1, -0.25, 0, -0.25, 3.2}), full);
}

}  // namespace
}  // namespace dyn_test
