// The reference of tests where nothing is wider than double (common/twice.hpp), itself against quadruple precision where that is
// there.
#include "common/twice.hpp"

#include <algorithm>

#include "common/eigen.hpp"
#include "common/quad.hpp"

#if defined(__SIZEOF_FLOAT128__)
namespace dyn_test {
namespace {

Quad quad(Twice x) { return Quad(x.high) + Quad(x.low); }

// A number of 106 bits, of up to most.
Twice draw(Dice& dice, double most) {
  const double high = dice.in(-most, most);
  return Twice(high) + Twice(high * 0x1p-54 * dice.in(-1, 1));
}

TEST(Twice, AgainstQuadruplePrecision) {
  Dice dice(3);
  const auto expect = [](const char* what, Twice got, Quad exact, double size) {  // size: of what was rounded
    EXPECT_LE(double(abs(quad(got) - exact)), 0x1p-98 * std::max(size, std::abs(double(exact)))) << what;
  };
  for (int k = 0; k < 20000; ++k) {
    const Twice a = draw(dice, dice.chance(0.5) ? 1 : 100), b = draw(dice, 3), root = a < Twice(0) ? -a : a,
                turn = Twice(3) + draw(dice, 0.1);
    const Quad x = quad(a), y = quad(b);
    expect("+", a + b, x + y, 0), expect("-", a - b, x - y, 0), expect("*", a * b, x * y, 0), expect("/", a / b, x / y, 0);
    expect("sqrt", twice_sqrt(root), sqrt(quad(root)), 0);
    expect("exp", twice_exp(a), exp(x), 0), expect("tanh", twice_tanh(a), tanh(x), 0);
    expect("sin", twice_sin(a), sin(x), 1), expect("cos", twice_cos(a), cos(x), 1);
    expect("tan", twice_tan(a), tan(x), 1 + double(tan(x) * tan(x)));
    expect("atan2", twice_atan2(a, b), atan2(x, y), 0),
        expect("remainder", twice_remainder(a, turn), remainder(x, quad(turn)), 100);
    EXPECT_EQ(x < y, a < b);
    EXPECT_EQ(x >= y, a >= b);
  }
}

}  // namespace
}  // namespace dyn_test
#endif
