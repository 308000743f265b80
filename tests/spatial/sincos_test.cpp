// The vectorised sweep of sines and cosines: within one unit in the last place of quadruple precision, for all arguments.
#include "base/sincos.hpp"

#include <algorithm>
#include <vector>

#include "common/eigen.hpp"
#include "common/quad.hpp"

namespace dyn_test {
namespace {

// |got - exact| in units in the last place of the exact value
double ulps(double got, Quad exact) {
  const double rounded = double(exact);
  const double unit = rounded == 0 || std::abs(rounded) < std::numeric_limits<double>::min()
                          ? std::numeric_limits<double>::denorm_min()
                          : std::ldexp(1.0, std::ilogb(rounded) - 52);
  const double error = double(abs(Quad(got) - exact) / Quad(unit));
  return error == error ? error : infinity;
}

struct Swept {
  std::vector<double> x, c, s;
  explicit Swept(std::vector<double> values) : x(std::move(values)) {
    const std::size_t n = x.size(), room = std::size_t(padded_sweep(Index(n)));
    x.resize(room, 0);
    c.resize(room), s.resize(room);
    sincos_sweep(x.data(), Index(n), c.data(), s.data());
    x.resize(n);
  }
  void expect_within_one_ulp() const {
    double worst = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double ec = ulps(c[i], cos(Quad(x[i]))), es = ulps(s[i], sin(Quad(x[i])));
      worst = std::max({worst, ec, es});
      ASSERT_LT(ec, 1.0) << "cos " << std::hexfloat << x[i];
      ASSERT_LT(es, 1.0) << "sin " << std::hexfloat << x[i];
    }
    testing::Test::RecordProperty("worst_ulps", std::to_string(worst));
  }
};

std::vector<double> make(int n, double (*one)(Dice&)) {
  Dice dice(11);
  std::vector<double> x(static_cast<std::size_t>(n));
  for (double& y : x) y = one(dice);
  return x;
}
double sign(Dice& dice) { return dice.chance(0.5) ? 1 : -1; }

TEST(Sincos, AnglesOfRobots) {
  Swept(make(400000, [](Dice& dice) { return dice.in(-10, 10); })).expect_within_one_ulp();
}
TEST(Sincos, NearMultiplesOfHalfPi) {
  Swept(make(300000, [](Dice& dice) {
    const int range = dice.chance(0.5) ? 100 : 660000;
    double x = double(double(dice.below(2 * range) - range) * (pi / 2));
    for (int k = dice.below(8); k > 0; --k) x = std::nextafter(x, infinity);
    for (int k = dice.below(8); k > 0; --k) x = std::nextafter(x, -infinity);
    return x;
  })).expect_within_one_ulp();
}
TEST(Sincos, EveryMagnitudeThatTheSweepReduces) {
  Swept(make(200000, [](Dice& dice) { return sign(dice) * std::exp2(dice.in(-1074, 21)); })).expect_within_one_ulp();
}
TEST(Sincos, LargeAnglesUpToTheBound) {
  Swept(make(60000, [](Dice& dice) { return sign(dice) * dice.in(1e3, 0x1.00001p20); })).expect_within_one_ulp();
}
TEST(Sincos, HugeAngles) {
  Swept(make(40000, [](Dice& dice) { return sign(dice) * std::pow(10.0, dice.in(5, 308)); })).expect_within_one_ulp();
}
TEST(Sincos, Edges) {
  const double max = std::numeric_limits<double>::max(), min = std::numeric_limits<double>::min(),
               denormal = std::numeric_limits<double>::denorm_min();
  std::vector<double> x = {0,   1,   pi,       pi / 2,      pi / 4, 3 * pi / 4, 1e22, 0x1p20, std::nextafter(0x1p20, infinity),
                           max, min, denormal, 5 * denormal};
  for (std::size_t i = 0, n = x.size(); i < n; ++i) x.push_back(-x[i]);
  Swept(x).expect_within_one_ulp();
  const Swept zero({0.0, -0.0});
  EXPECT_EQ(1, zero.c[0]);
  EXPECT_EQ(1, zero.c[1]);
  EXPECT_FALSE(std::signbit(zero.s[0]));
  EXPECT_TRUE(std::signbit(zero.s[1]));
  const Swept not_finite({infinity, -infinity, std::nan("")});
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(std::isnan(not_finite.s[std::size_t(i)]) && std::isnan(not_finite.c[std::size_t(i)]));
}
TEST(Sincos, TheDoubleClosestToAMultipleOfHalfPi) {
  // 6381956970095103 2^797 (Kahan). Beyond the sweep's range the answer is libm's, and glibc 2.36 is 8 units off here.
  const Swept kahan({6381956970095103.0 * 0x1p797});
  EXPECT_LT(ulps(kahan.c[0], cos(Quad(kahan.x[0]))), 16);
  EXPECT_LT(ulps(kahan.s[0], sin(Quad(kahan.x[0]))), 1);
}
TEST(Sincos, ExactlyOddAndEven) {
  const auto x = make(10000, [](Dice& dice) { return dice.in(-1e4, 1e4); });
  std::vector<double> minus;
  for (double y : x) minus.push_back(-y);
  const Swept a(x), b(minus);
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_EQ(a.c[i], b.c[i]) << x[i];
    ASSERT_EQ(a.s[i], -b.s[i]) << x[i];
  }
}
TEST(Sincos, ANumberDoesNotDependOnItsPlaceInTheSweep) {
  const auto x = make(37, [](Dice& dice) { return dice.chance(0.2) ? 1e7 * dice.uniform() : dice.in(-4, 4); });
  const Swept all(x);
  for (std::size_t n = 0; n <= x.size(); ++n) {
    const Swept part(std::vector<double>(x.end() - std::ptrdiff_t(n), x.end()));
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_EQ(all.c[x.size() - n + i], part.c[i]);
      EXPECT_EQ(all.s[x.size() - n + i], part.s[i]);
    }
  }
}

}  // namespace
}  // namespace dyn_test
