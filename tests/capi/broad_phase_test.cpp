// The broad phase through the C interface.
#include "capi/support.hpp"

namespace dyn_test {
namespace {

struct Phase {
  dynBroadPhase* b = nullptr;
  Phase(int capacity, std::int64_t pairs, double margin) {
    EXPECT_EQ(DYN_OK, dyn_broad_phase_new(capacity, pairs, margin, &b)) << dyn_last_error();
  }
  Phase(const Phase&) = delete;
  ~Phase() { dyn_broad_phase_free(b); }
  operator dynBroadPhase*() const { return b; }
  int insert(double x, double size = 1) {
    const double lower[3] = {x, 0, 0}, upper[3] = {x + size, 1, 1};
    int id = -1;
    EXPECT_EQ(DYN_OK, dyn_broad_phase_insert(b, lower, upper, &id)) << dyn_last_error();
    return id;
  }
  std::vector<int> pairs() {
    std::vector<int> out(200, -7);
    std::int64_t count = -1;
    EXPECT_EQ(DYN_OK, dyn_broad_phase_pairs(b, out.data(), 100, &count)) << dyn_last_error();
    out.resize(std::size_t(2 * count));
    return out;
  }
};

TEST(BroadPhase, InsertMoveRemove) {
  Phase p(4, 100, 0.1);
  EXPECT_TRUE(p.pairs().empty());
  EXPECT_EQ(0, p.insert(0));
  EXPECT_EQ(1, p.insert(5));
  EXPECT_EQ(2, p.insert(0.5));
  EXPECT_EQ((std::vector<int>{0, 2}), p.pairs());
  const double lower[3] = {1, 0, 0}, upper[3] = {2, 1, 1};
  ASSERT_EQ(DYN_OK, dyn_broad_phase_update(p, 1, lower, upper));
  EXPECT_EQ((std::vector<int>{0, 1, 0, 2, 1, 2}), p.pairs());
  ASSERT_EQ(DYN_OK, dyn_broad_phase_remove(p, 0));
  EXPECT_EQ((std::vector<int>{1, 2}), p.pairs());
  EXPECT_EQ(0, p.insert(1.5));
  EXPECT_EQ(3, p.insert(9));
  int ids[4], count = 0;
  ASSERT_EQ(DYN_OK, dyn_broad_phase_query(p, lower, upper, ids, 4, &count));
  EXPECT_EQ(3, count);
  EXPECT_TRUE(ids[0] == 0 && ids[1] == 1 && ids[2] == 2);
  const double origin[3] = {-1, 0.5, 0.5}, x[3] = {1, 0, 0};
  ASSERT_EQ(DYN_OK, dyn_broad_phase_ray(p, origin, x, 3, ids, 4, &count));
  EXPECT_EQ(3, count);
  ASSERT_EQ(DYN_OK, dyn_broad_phase_ray(p, origin, x, inf, ids, 1, &count));
  EXPECT_EQ(4, count);
}

TEST(BroadPhase, BadArguments) {
  dynBroadPhase* none = nullptr;
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_broad_phase_new(0, 10, 0, &none));
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_broad_phase_new(10, 0, 0, &none));
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_broad_phase_new(1 << 30, 10, 0, &none));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_broad_phase_new(10, 10, -1, &none));
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_broad_phase_new(10, 10, nan, &none));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_broad_phase_new(10, 10, 0, nullptr));
  EXPECT_EQ(nullptr, none);
  Phase p(2, 1, 0);
  p.insert(0);
  const double lower[3] = {0, 0, 0}, upper[3] = {1, 1, 1}, bad[3] = {0, nan, 0}, below[3] = {0, -1, 0}, zero[3] = {0, 0, 0};
  int id = -7, ids[2], count = -7;
  std::int64_t pairs = -7;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_broad_phase_insert(p, nullptr, upper, &id));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_broad_phase_insert(p, lower, upper, nullptr));
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_broad_phase_insert(p, lower, bad, &id));
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_broad_phase_insert(p, lower, below, &id));
  EXPECT_TRUE(says({"lower[1]", "upper[1]"}));
  for (int no : {-1, 1, 5}) {
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_broad_phase_update(p, no, lower, upper));
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_broad_phase_remove(p, no));
    EXPECT_TRUE(says({"no box " + std::to_string(no)}));
  }
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_broad_phase_pairs(p, nullptr, 1, &pairs));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_broad_phase_pairs(p, ids, -1, &pairs));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_broad_phase_query(p, lower, upper, nullptr, 2, &count));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_broad_phase_ray(p, lower, upper, -1, ids, 2, &count));
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_broad_phase_ray(p, bad, upper, 1, ids, 2, &count));
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_broad_phase_ray(p, zero, upper, nan, ids, 2, &count));
  EXPECT_TRUE(id == -7 && count == -7 && pairs == -7);
  p.insert(0);
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_broad_phase_insert(p, lower, upper, &id));
  EXPECT_TRUE(says({"capacity"}));
  // more overlaps than room
  Phase small(10, 2, 0);
  for (int k = 0; k < 3; ++k) small.insert(0);
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_broad_phase_pairs(small, nullptr, 0, &pairs));
  EXPECT_TRUE(says({"3 overlaps", "pair_capacity"}));
  ASSERT_EQ(DYN_OK, dyn_broad_phase_remove(small, 1));
  EXPECT_EQ((std::vector<int>{0, 2}), small.pairs());
}

TEST(BroadPhase, Handles) {
  dyn_broad_phase_free(nullptr);
  dynBroadPhase* freed = nullptr;
  ASSERT_EQ(DYN_OK, dyn_broad_phase_new(2, 2, 0, &freed));
  dyn_broad_phase_free(freed), dyn_broad_phase_free(freed);
  const double lower[3] = {}, upper[3] = {1, 1, 1};
  int id;
  std::int64_t count;
  for (dynBroadPhase* b : {static_cast<dynBroadPhase*>(nullptr), freed}) {
    EXPECT_EQ(DYN_ERROR_HANDLE, dyn_broad_phase_insert(b, lower, upper, &id));
    EXPECT_TRUE(says({"broad phase", b ? "freed" : "dyn_broad_phase_new"}));
    EXPECT_EQ(DYN_ERROR_HANDLE, dyn_broad_phase_update(b, 0, lower, upper));
    EXPECT_EQ(DYN_ERROR_HANDLE, dyn_broad_phase_remove(b, 0));
    EXPECT_EQ(DYN_ERROR_HANDLE, dyn_broad_phase_pairs(b, nullptr, 0, &count));
    EXPECT_EQ(DYN_ERROR_HANDLE, dyn_broad_phase_query(b, lower, upper, nullptr, 0, &id));
    EXPECT_EQ(DYN_ERROR_HANDLE, dyn_broad_phase_ray(b, lower, upper, 1, nullptr, 0, &id));
  }
}

}  // namespace
}  // namespace dyn_test
