// Broad phase against all pairs of boxes, through insertions, motions and removals.
#include <gtest/gtest.h>

#include <memory>
#include <set>

#include "collision/scene.hpp"
#include "collision/broad/broad_phase.hpp"

namespace dyn_test {
namespace {

using collision::BroadPhase;
using shape::Bounds;
using Pairs = std::vector<std::pair<Index, Index>>;

struct Boxes {
  std::unique_ptr<void, void (*)(void*)> memory;
  BroadPhase tree;
  std::vector<Bounds> box;
  std::vector<bool> there;

  Boxes(Index capacity, std::ptrdiff_t pairs, double margin)
      : memory(std::aligned_alloc(64, BroadPhase::bytes(capacity, pairs)), std::free),
        tree(capacity, pairs, margin, memory.get()),
        box(std::size_t(capacity)),
        there(std::size_t(capacity)) {}
  Index insert(const Bounds& b) {
    const Index id = tree.insert(b);
    EXPECT_EQ(std::find(there.begin(), there.end(), false) - there.begin(), id);
    box[std::size_t(id)] = b, there[std::size_t(id)] = true;
    return id;
  }
  void update(Index id, const Bounds& b) { tree.update(id, b), box[std::size_t(id)] = b; }
  void remove(Index id) { tree.remove(id), there[std::size_t(id)] = false; }
  Pairs found() {
    Pairs out;
    EXPECT_TRUE(tree.pairs([&](Index a, Index b) { out.emplace_back(a, b); }));
    return out;
  }
  Pairs expected() const {
    Pairs out;
    for (std::size_t a = 0; a < box.size(); ++a)
      for (std::size_t b = a + 1; b < box.size(); ++b)
        if (there[a] && there[b] && BroadPhase::overlap(box[a], box[b])) out.emplace_back(Index(a), Index(b));
    return out;
  }
};

Bounds box_at(Chance& g, double room, double size) {
  const Vec c = Vec::make(g.uniform(-room, room), g.uniform(-room, room), g.uniform(-room, room));
  const Vec h = Vec::make(g.uniform(0, size), g.uniform(0, size), g.uniform(0, size));
  return {c - h, c + h};
}

TEST(BroadPhase, AllPairsThroughALife) {
  for (double margin : {0.0, 0.05})
    for (int seed = 0; seed < 6; ++seed) {
      Chance g{std::uint64_t(seed + 1)};
      const Index capacity = seed == 0 ? 7 : 400;
      Boxes b(capacity, 100000, margin);
      EXPECT_TRUE(b.found().empty());
      std::vector<Index> live;
      for (int step = 0; step < 60; ++step) {
        const int grow = g.pick(seed % 2 ? 40 : 4), shrink = g.pick(seed % 2 ? 30 : 3);
        for (int k = 0; k < grow && b.tree.count() < capacity; ++k) live.push_back(b.insert(box_at(g, 1, 0.15)));
        for (int k = 0; k < shrink && !live.empty(); ++k) {
          const std::size_t i = std::size_t(g.pick(int(live.size())));
          b.remove(live[i]), live.erase(live.begin() + std::ptrdiff_t(i));
        }
        // few boxes move far, or all a little
        const bool all = g.pick(2);
        for (Index id : live)
          if (all || g.pick(20) == 0) {
            const Bounds& old = b.box[std::size_t(id)];
            const Vec d = g.direction() * g.uniform(0, all ? 0.02 : 1);
            b.update(id, {old.lower + d, old.upper + d});
            if (g.pick(10) == 0) b.update(id, old);
          }
        if (g.pick(3) == 0) {  // a query in between, then more motion
          b.tree.query(box_at(g, 1, 0.3), [](Index) {});
          for (Index id : live)
            if (g.pick(10) == 0) b.update(id, box_at(g, 1, 0.15));
        }
        ASSERT_EQ(b.expected(), b.found()) << seed << " " << step;
        ASSERT_EQ(b.found(), b.found());
        // overlaps with a box and hits of a ray
        const Bounds q = box_at(g, 1, 0.3);
        std::set<Index> seen, wanted;
        b.tree.query(q, [&](Index id) { EXPECT_TRUE(seen.insert(id).second); });
        for (Index id : live)
          if (BroadPhase::overlap(q, b.box[std::size_t(id)])) wanted.insert(id);
        ASSERT_EQ(wanted, seen);
        seen.clear(), wanted.clear();
        const Vec o = g.direction() * 1.5, d = g.pick(4) ? g.direction() : shape::axis(g.pick(3)), e = d * g.uniform(0.5, 3);
        b.tree.ray(o, e, 1, [&](Index id) { EXPECT_TRUE(seen.insert(id).second); });
        for (Index id : live) {
          const Bounds& x = b.box[std::size_t(id)];
          const Vec h = (x.upper - x.lower) * 0.5, c = (x.upper + x.lower) * 0.5;
          if (std::min({h[0], h[1], h[2]}) <= 0) continue;
          if (shape::Box({Type::Box, 0, h, nullptr}).ray(o - c, e).t <= 1) wanted.insert(id);
        }
        ASSERT_EQ(wanted, seen);
      }
    }
}

// The same boxes move for long, first slightly, then across each other. One is infinite.
TEST(BroadPhase, AllMoveForLong) {
  for (double margin : {0.0, 0.02}) {
    Chance g{11};
    Boxes b(600, 200000, margin);
    const double inf = shape::infinity;
    b.insert({Vec::make(-inf, -inf, -inf), Vec::make(inf, inf, -0.9)});
    for (int k = 1; k < 600; ++k) b.insert(box_at(g, 1, 0.05));
    for (int step = 0; step < 120; ++step) {
      if (step == 50) b.remove(17), b.insert(box_at(g, 1, 0.05));
      const double most = step < 40 ? 1e-3 : step < 80 ? 0.1 : step == 100 ? 2 : 0.02;
      for (Index id = 1; id < 600; ++id) {
        const Vec d = g.direction() * g.uniform(0, most);
        b.update(id, {b.box[std::size_t(id)].lower + d, b.box[std::size_t(id)].upper + d});
      }
      ASSERT_EQ(b.expected(), b.found()) << step;
    }
  }
}

// All boxes drift at different speeds, so few leave their fat boxes at a time. After all fat boxes were renewed, boxes still in
// their own may meet others.
TEST(BroadPhase, AllDriftGently) {
  Chance g{5};
  Boxes b(220, 40000, 0.02);
  std::vector<Vec> speed;
  for (int k = 0; k < 220; ++k) b.insert(box_at(g, 0.7, 0.1)), speed.push_back(g.direction() * g.uniform(0, 4e-3));
  for (int step = 0; step < 400; ++step) {
    for (Index id = 0; id < 220; ++id) {
      const Vec d = speed[std::size_t(id)] * (step % 200 < 100 ? 1 : -1);
      b.update(id, {b.box[std::size_t(id)].lower + d, b.box[std::size_t(id)].upper + d});
    }
    ASSERT_EQ(b.expected(), b.found()) << step;
  }
}

TEST(BroadPhase, InfiniteBoxesAndFullRoom) {
  Chance g{3};
  Boxes b(300, 40000, 0.01);
  const double inf = shape::infinity;
  b.insert({Vec::make(-inf, -inf, -inf), Vec::make(inf, inf, 0)});
  for (int k = 1; k < 300; ++k) b.insert(box_at(g, 1, 0.1));
  EXPECT_EQ(-1, b.tree.insert(box_at(g, 1, 0.1)));
  EXPECT_EQ(b.expected(), b.found());
  // more candidates than the capacity are reported, and found once they are fewer
  Boxes tight(100, 50, 0);
  for (int k = 0; k < 100; ++k) tight.insert(box_at(g, 0.1, 1));
  EXPECT_FALSE(tight.tree.pairs([](Index, Index) {}));
  for (int k = 0; k < 100; ++k) tight.update(k, {Vec::make(k, 0, 0), Vec::make(k + 0.5, 1, 1)});
  EXPECT_TRUE(tight.found().empty());
  for (int k = 0; k < 100; ++k) tight.remove(k);
  EXPECT_TRUE(tight.found().empty());
}

// Rounding to single precision must hide no overlap: boxes that touch to the last bit, far from the origin.
TEST(BroadPhase, TouchingFarAway) {
  Boxes b(200, 1000, 0);
  double x = 1e6 + 1.0 / 3;
  for (int k = 0; k < 200; ++k) {
    const double next = x + 0.1;
    b.insert({Vec::make(x, -1, -1), Vec::make(next, 1, 1)});
    x = next;
  }
  EXPECT_EQ(199u, b.found().size());
}

// Boxes are closed: a ray in the plane of a face, along an edge or to a corner meets the box, and so does one that ends there.
TEST(BroadPhase, RaysInAFaceMeetTheBox) {
  Boxes b(8, 8, 0);
  b.insert({Vec::make(-1, -1, -1), Vec::make(1, 1, 1)});
  for (int i = 0; i < 3; ++i)
    for (const double u : {-1.0, 0.5, 1.0, 1.25})
      for (const double v : {-1.0, 0.5, 1.0, -1.25})
        for (const double side : {-1.0, 1.0}) {
          const int j = (i + 1) % 3, k = (i + 2) % 3;
          const Vec o = shape::axis(i) * (-2 * side) + shape::axis(j) * u + shape::axis(k) * v, d = shape::axis(i) * side;
          for (const double far : {0.75, 1.0, 4.0}) {
            int met = 0;
            b.tree.ray(o, d, far, [&](Index) { ++met; });
            EXPECT_EQ(int(std::abs(u) <= 1 && std::abs(v) <= 1 && far >= 1), met) << i << ' ' << u << ' ' << v << ' ' << far;
          }
        }
}

}  // namespace
}  // namespace dyn_test
