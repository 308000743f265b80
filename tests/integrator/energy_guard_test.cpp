// Which steps have their energy looked at.
#include "integrator/hinge.hpp"
#include "simulation/energy_guard.hpp"

namespace dyn_test {
namespace {

// Impulses of rows at rest are rounding, and their work has any sign: what they move by less than 1e-9 rad is no gain.
TEST(EnergyGuard, RowsAtRestGainNothing) {
  Hinge x;
  const auto looked_at = [&](double angle, bool by_rows) {
    x.w.q(std::vector{0.0}).v(std::vector{angle});
    x.w.d.step->rows_add_energy = by_rows;
    return simulation::may_gain_energy(*x.model, x.w.d, 1);
  };
  EXPECT_FALSE(looked_at(0, true));
  EXPECT_FALSE(looked_at(1e-34, true));
  EXPECT_FALSE(looked_at(-1e-10, true));
  EXPECT_TRUE(looked_at(-1e-8, true));
  EXPECT_FALSE(looked_at(0.05, false));
  EXPECT_TRUE(looked_at(0.2, false));
  EXPECT_TRUE(looked_at(NAN, true) && looked_at(NAN, false));
}

}  // namespace
}  // namespace dyn_test
