// A number that goes into a lane comes out of the same lane.
#include "base/simd_memory.hpp"
#include "base/transpose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace dyn {
namespace {

TEST(Simd, GathersAndScatters) {
  std::vector<double> x(60);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = double(i);
  const Index at[] = {0, 7, 53, 30};
  Double4 seven[7], six[6];
  gather<7>(x.data(), at, seven), gather<6>(x.data(), at, six);
  for (int l = 0; l < Double4::lanes; ++l) {
    for (int k = 0; k < 7; ++k) EXPECT_EQ(at[l] + k, seven[k][l]);
    for (int k = 0; k < 6; ++k) EXPECT_EQ(at[l] + k, six[k][l]);
  }
  int lanes = 0;
  for_each_lane(seven[3], seven[4], seven[5], seven[6], [&](int l, const auto& four) {
    for (int k = 0; k < 4; ++k) EXPECT_EQ(at[l] + 3 + k, four[k]);
    ++lanes;
  });
  EXPECT_EQ(Double4::lanes, lanes);
}

TEST(Simd, Masks) {
  for (int l = 0; l < Double4::lanes; ++l) {
    Double4 a(1.0);
    a.set(l, 3);
    EXPECT_EQ(1u << l, bits_of(a > 2.0));
    EXPECT_TRUE(any(a > 2.0));
    EXPECT_EQ(7, select(a > 2.0, Double4(7.0), a)[l]);
    EXPECT_EQ(3, max(a, 2.0)[l]);
    EXPECT_EQ(2, min(a, 2.0)[l]);
  }
  EXPECT_FALSE(any(Double4(1.0) > 2.0));
  EXPECT_EQ(3, sqrt(Double4(9.0))[2]);
}

// One vector, several registers, and plain numbers of a type without vectors.
template <class S>
class Storage : public testing::Test {};
using Storages = testing::Types<Simd<double, 4>, Simd<double, 8>, Simd<double, 16>, Simd<float, 8>, Simd<std::int64_t, 8>,
                                Simd<long double, 4>>;
TYPED_TEST_SUITE(Storage, Storages);

TYPED_TEST(Storage, EachLaneByItself) {
  using S = TypeParam;
  using T = std::remove_cvref_t<decltype(S::zero()[0])>;
  T a[S::lanes], b[S::lanes], c[S::lanes];
  for (int k = 0; k < S::lanes; ++k) a[k] = T(3 * k - 7), b[k] = T(10 - k);
  const S x = S::load(a), y = S::load(b);
  (x * y - T(2) * x + T(1)).store(c);
  const unsigned less = bits_of(x < y), equal = bits_of(x == y);
  for (int k = 0; k < S::lanes; ++k) {
    EXPECT_EQ(a[k] * b[k] - 2 * a[k] + 1, c[k]);
    EXPECT_EQ(a[k] < b[k], bool(less >> k & 1u));
    EXPECT_EQ(a[k] == b[k], bool(equal >> k & 1u));
    EXPECT_EQ(std::min(a[k], b[k]), min(x, y)[k]);
    EXPECT_EQ(std::max(a[k], b[k]), max(x, y)[k]);
    EXPECT_EQ(a[k] > b[k] ? a[k] : T(5), select(x > y, x, T(5))[k]);
    EXPECT_EQ(-a[k], (-x)[k]);
    S z = x;
    z.set(k, T(99));
    for (int l = 0; l < S::lanes; ++l) EXPECT_EQ(l == k ? T(99) : a[l], z[l]);
  }
  T total = 0;
  for (T u : a) total += u;
  EXPECT_EQ(total, sum(x));
  EXPECT_TRUE(all(x == x));
  EXPECT_FALSE(any(x != x));
}

TEST(Simd, SizesAndRoots) {
  const double a[] = {-4, 0, -0.0, 9, 16, -25, 36, 49};
  const auto x = Simd<double, 8>::load(a), size = abs(x), root = sqrt(size);
  for (int k = 0; k < 8; ++k) {
    EXPECT_EQ(std::abs(a[k]), size[k]);
    EXPECT_FALSE(std::signbit(size[k]));
    EXPECT_EQ(std::sqrt(std::abs(a[k])), root[k]);
  }
}

TEST(Simd, LanesInAnotherOrder) {
  const double a[] = {0, 1, 2, 3, 4, 5, 6, 7};
  const auto eight = Simd<double, 8>::load(a);
  const Double4 low = slice4<0>(eight), high = slice4<4>(eight), mixed = shuffle<7, 0, 4, 3>(low, high);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(k, low[k]);
    EXPECT_EQ(4 + k, high[k]);
    EXPECT_EQ(2, broadcast<2>(low)[k]);
    EXPECT_EQ(k < 1 ? k : 4 + k, blend<1>(low, high)[k]);
    EXPECT_EQ((std::array{7, 0, 4, 3})[std::size_t(k)], mixed[k]);
  }
}

template <int count>
void first_lanes() {
  const double a[] = {1, 2, 3, 4};
  for (const Double4& x : {load_partial(a, count), load_partial<count>(a)}) {
    for (int k = 0; k < 4; ++k) EXPECT_EQ(k < count ? a[k] : 0, x[k]) << count;
    double b[] = {9, 9, 9, 9}, c[] = {9, 9, 9, 9};
    store_partial(x, b, count), store_partial<count>(x, c);
    for (int k = 0; k < 4; ++k) {
      EXPECT_EQ(k < count ? a[k] : 9, b[k]) << count;
      EXPECT_EQ(b[k], c[k]) << count;
    }
  }
}
TEST(Simd, FirstLanesAlone) { first_lanes<1>(), first_lanes<2>(), first_lanes<3>(), first_lanes<4>(); }

TEST(Simd, TransposesMatrices) {
  constexpr int rows = 7, columns = 10;
  std::vector<double> a(rows * columns), b(a.size()), square(400);
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = double(i);
  transpose(a.data(), rows, rows, columns, -2.0, b.data(), columns);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) EXPECT_EQ(-2 * a[std::size_t(r + rows * c)], b[std::size_t(c + columns * r)]);
  for (std::size_t i = 0; i < square.size(); ++i) square[i] = double(i);
  const std::vector<double> before = square;
  mirror_upper(square.data(), 20);
  for (std::size_t i = 0; i < 20; ++i)
    for (std::size_t j = 0; j < 20; ++j) EXPECT_EQ(before[std::min(i, j) + 20 * std::max(i, j)], square[i + 20 * j]);
}

}  // namespace
}  // namespace dyn
