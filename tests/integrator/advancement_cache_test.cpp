// When a search that found nothing spares later ones.
#include "integrator/hinge.hpp"
#include "simulation/conservative_advancement.hpp"

namespace dyn_test {
namespace {

struct SearchedHinge : Hinge {
  // A search in a step that turns the hinge by an angle, and whether it is remembered.
  bool searched(double angle) {
    w.q(std::vector{0.0}).v(std::vector{angle});
    simulation::update_advancement_cache(*model, w.d, w.d.v, 1, shape::infinity);
    return w.d.step->advancement_cache.square > 0;
  }
  bool spared(double q, double angle) {
    w.q(std::vector{q}).v(std::vector{angle});
    return simulation::cache_excludes_contact(*model, w.d, 1);
  }
};

// The joint may turn three times as far, and what it turned and turns adds up to sqrt(2) times their squares' root at most.
TEST(AdvancementCache, LimitsBeyondReachNeedNoSearch) {
  SearchedHinge x;
  ASSERT_TRUE(x.searched(1e-3));
  EXPECT_TRUE(x.spared(0.7, 1e-3));
  EXPECT_FALSE(x.spared(0.72, 1e-3));
  EXPECT_TRUE(x.spared(0, 0.23));
  EXPECT_FALSE(x.spared(0, 0.24));
}

// It is remembered where it spares more than three steps: finding out costs as much.
TEST(AdvancementCache, IsKeptWhereItSparesSeveralSearches) {
  const double furthest = Hinge::gap / (3 * std::sqrt(2));
  EXPECT_TRUE(SearchedHinge().searched(furthest / 5));
  EXPECT_FALSE(SearchedHinge().searched(furthest / 3));
}

}  // namespace
}  // namespace dyn_test
