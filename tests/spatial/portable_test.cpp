// Elementary functions of our own: their errors against quadruple precision, what they do at the ends, and that they have the
// same bits everywhere.
#include "base/portable.hpp"

#include <algorithm>
#include <cstring>

#include "common/eigen.hpp"
#include "common/quad.hpp"

namespace dyn_test::portable_test {
namespace {

using namespace dyn;

double ulps(double got, Quad exact) {
  const double rounded = double(exact);
  if (rounded == got) return 0;
  const double unit = std::abs(rounded) < std::numeric_limits<double>::min() ? std::numeric_limits<double>::denorm_min()
                                                                             : std::ldexp(1.0, std::ilogb(rounded) - 52);
  return double(abs(Quad(got) - exact) / Quad(unit));
}

// f within so many units in the last place of the exact function, for numbers that one(dice) draws.
template <class F, class Exact, class One>
void expect_within(double most, const char* name, F f, Exact exact, One one) {
  Dice dice(5);
  for (int k = 0; k < 20000; ++k) {
    const double x = one(dice), error = ulps(f(x), exact(Quad(x)));
    ASSERT_LT(error, most) << name << " of " << std::hexfloat << x;
  }
}
double wide(Dice& dice) { return (dice.chance(0.5) ? 1 : -1) * std::exp(dice.in(-20, 700)); }

TEST(Portable, Errors) {
  const auto about_ten = [](Dice& dice) { return dice.in(-10, 10); };
  expect_within(1, "sin", [](double x) { return portable::sin(x); }, [](Quad x) { return sin(x); }, about_ten);
  expect_within(1, "cos", [](double x) { return portable::cos(x); }, [](Quad x) { return cos(x); }, about_ten);
  expect_within(2.5, "tan", [](double x) { return portable::tan(x); }, [](Quad x) { return tan(x); }, about_ten);
  expect_within(1, "sin", [](double x) { return portable::sin(x); }, [](Quad x) { return sin(x); }, wide);
  expect_within(1, "cos", [](double x) { return portable::cos(x); }, [](Quad x) { return cos(x); }, wide);
  expect_within(
      1, "exp", [](double x) { return portable::exp(x); }, [](Quad x) { return exp(x); },
      [](Dice& dice) { return dice.in(-700, 709); });
  expect_within(
      1.5, "tanh", [](double x) { return portable::tanh(x); }, [](Quad x) { return tanh(x); },
      [](Dice& dice) { return dice.in(-3, 3); });
  Dice dice(6);
  for (int k = 0; k < 20000; ++k) {
    const double y = wide(dice) * 1e-100, x = y * dice.in(-3, 3);
    ASSERT_LT(ulps(portable::atan2(y, x), atan2(Quad(y), Quad(x))), 1.7) << y << " " << x;
    ASSERT_LT(ulps(portable::hypot(y, x), sqrt(Quad(y) * Quad(y) + Quad(x) * Quad(x))), 1.7) << y << " " << x;
    // exp(log p) is p: what is left of log's error
    const double p = std::exp(dice.in(-600, 600)), l = portable::log(p);
    ASSERT_LT(std::abs(double(exp(Quad(l)) / Quad(p) - Quad(1))), 1.2e-16 * std::max(1.0, 2 * std::abs(l))) << p;
    ASSERT_NEAR(portable::pow(p, 0.01) / std::pow(p, 0.01), 1, 1e-14) << p;
  }
}

TEST(Portable, Ends) {
  EXPECT_TRUE(std::isnan(portable::sin(infinity)) && std::isnan(portable::cos(-infinity)) && std::isnan(portable::tan(NAN)));
  EXPECT_TRUE(std::isnan(portable::log(-1)) && std::isnan(portable::exp(NAN)) && std::isnan(portable::atan2(NAN, 1)));
  EXPECT_TRUE(std::isnan(portable::tanh(NAN)) && std::isnan(portable::hypot(NAN, 1)));
  EXPECT_EQ(-infinity, portable::log(0));
  EXPECT_EQ(infinity, portable::log(infinity));
  EXPECT_EQ(infinity, portable::exp(infinity));
  EXPECT_EQ(0, portable::exp(-infinity));
  EXPECT_EQ(1, portable::exp(0));
  EXPECT_EQ(1, portable::tanh(infinity));
  EXPECT_EQ(-1, portable::tanh(-400));
  EXPECT_EQ(1, portable::pow(7, 0));
  EXPECT_EQ(infinity, portable::hypot(NAN, -infinity));
  EXPECT_EQ(0, portable::hypot(0, 0));
  for (const double y : {0.0, -0.0, 1.0, -1.0, infinity, -infinity})
    for (const double x : {0.0, -0.0, 1.0, -1.0, infinity, -infinity}) {
      EXPECT_EQ(std::atan2(y, x), portable::atan2(y, x)) << y << " " << x;
      EXPECT_EQ(std::signbit(std::atan2(y, x)), std::signbit(portable::atan2(y, x))) << y << " " << x;
    }
}

// FNV-1a of many results, recorded on x86-64: it is that of every other machine.
TEST(Portable, SameBitsEverywhere) {
  std::uint64_t hash = 0xcbf29ce484222325u, state = 1;
  const auto add = [&](double x) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, 8);
    hash = (hash ^ bits) * 0x100000001b3u;
  };
  for (int k = 0; k < 100000; ++k) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const double u = double(std::int64_t(state) >> 11) * 0x1p-52, x = 20 * u, far = u * std::ldexp(1.0, int(state >> 58) * 16);
    add(portable::sin(x)), add(portable::cos(x)), add(portable::tan(x)), add(portable::sin(far)), add(portable::cos(far));
    add(portable::exp(x)), add(portable::log(std::abs(far) + 1e-300)), add(portable::tanh(u)), add(portable::tanh(x));
    add(portable::atan2(u, x - 3)), add(portable::hypot(u, x, 1)), add(portable::pow(std::abs(x) + 0.1, u));
  }
  EXPECT_EQ(12236236533773295905u, hash);
}

}  // namespace
}  // namespace dyn_test::portable_test
