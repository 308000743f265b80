// Tests that scenes end at the same bits: in any number of threads at once, begun again, and gone on with from a saved state.
#include <gtest/gtest.h>

#include <thread>

#include "soak/simulation.hpp"

namespace dyn_test {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr long steps = 150;
#else
constexpr long steps = 1500;
#endif

std::uint64_t play(soak::Simulation& x, long until) {
  while (x.steps < until) soak::check(x.step());
  return x.hash();
}

class Determinism : public testing::TestWithParam<soak::Scene> {};

TEST_P(Determinism, BegunAgain) {
  soak::Simulation first(GetParam()), second(GetParam());
  const std::uint64_t hash = play(first, steps);
  EXPECT_EQ(hash, play(second, steps));
  soak::Simulation other(GetParam());
  other.dice.state = 2;
  EXPECT_NE(hash, play(other, steps));  // the hash sees the motion
}

TEST_P(Determinism, SavedAndRestored) {
  soak::Simulation x(GetParam());
  play(x, steps / 3);
  const soak::Simulation::Snapshot at = x.save();
  const std::uint64_t hash = play(x, steps);
  x.restore(at);
  EXPECT_EQ(hash, play(x, steps));
  // in the middle of what another run left behind
  x.dice.state = 77;
  play(x, steps + 200);
  x.restore(at);
  EXPECT_EQ(hash, play(x, steps));
}

TEST_P(Determinism, OneToFourThreads) {
  soak::Simulation alone(GetParam());
  const std::uint64_t hash = play(alone, steps);
  for (int threads = 1; threads <= 4; ++threads) {
    std::vector<std::uint64_t> found(std::size_t(threads), 0);
    std::vector<std::thread> all;
    for (std::uint64_t& f : found)
      all.emplace_back([&f] {
        soak::Simulation x(GetParam());
        f = play(x, steps);
      });
    for (std::thread& t : all) t.join();
    for (const std::uint64_t f : found) EXPECT_EQ(hash, f) << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Determinism, testing::ValuesIn(soak::scenes), [](const auto& info) {
  std::string name;
  for (const char* c = info.param.name; *c; ++c)
    if ((*c >= 'a' && *c <= 'z') || (*c >= '0' && *c <= '9')) name += *c;
  return name;
});

}  // namespace
}  // namespace dyn_test
