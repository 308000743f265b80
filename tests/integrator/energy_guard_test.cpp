// When a gain of energy is no rounding.
#include "integrator/hinge.hpp"
#include "simulation/energy_guard.hpp"

namespace dyn_test {
namespace {

// Impulses of rows at rest are rounding, and their work has any sign: what they move by less than 1e-9 rad is no gain.
TEST(EnergyGuard, RowsAtRestGainNothing) {
  Hinge x;
  const auto moves = [&](double angle) {
    x.w.q(std::vector{0.0}).v(std::vector{angle});
    return simulation::moves(*x.model, x.w.d, 1);
  };
  EXPECT_FALSE(moves(0) || moves(1e-34) || moves(-1e-10));
  EXPECT_TRUE(moves(-1e-8) && moves(NAN));
}

}  // namespace
}  // namespace dyn_test
