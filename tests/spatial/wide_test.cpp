// Four numbers as one: what goes in comes out of its lane.
#include "base/wide.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace dyn {
namespace {

TEST(Wide, GathersAndScatters) {
  std::vector<double> x(60);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = double(i);
  const Index at[] = {0, 7, 53, 30};
  Wide seven[7], six[6];
  gather<7>(x.data(), at, seven), gather<6>(x.data(), at, six);
  for (int l = 0; l < Wide::lanes; ++l) {
    for (int k = 0; k < 7; ++k) EXPECT_EQ(at[l] + k, seven[k][l]);
    for (int k = 0; k < 6; ++k) EXPECT_EQ(at[l] + k, six[k][l]);
  }
  int lanes = 0;
  for_each_lane(seven[3], seven[4], seven[5], seven[6], [&](int l, const auto& four) {
    for (int k = 0; k < 4; ++k) EXPECT_EQ(at[l] + 3 + k, four[k]);
    ++lanes;
  });
  EXPECT_EQ(Wide::lanes, lanes);
}

TEST(Wide, Masks) {
  for (int l = 0; l < Wide::lanes; ++l) {
    Wide a(1.0);
    a.x[l] = 3;
    EXPECT_EQ(1u << l, bits_of(a > 2.0));
    EXPECT_TRUE(any(a > 2.0));
    EXPECT_EQ(7, select(a > 2.0, Wide(7.0), a)[l]);
    EXPECT_EQ(3, max(a, 2.0)[l]);
    EXPECT_EQ(2, min(a, 2.0)[l]);
  }
  EXPECT_FALSE(any(Wide(1.0) > 2.0));
  EXPECT_EQ(3, sqrt(Wide(9.0))[2]);
}

}  // namespace
}  // namespace dyn
