// The broad phase beside Coal's tree and sweep, and sort-and-sweep of our own: moving all boxes and finding all pairs, ms.
//   usage: broad_bench [boxes]
// Build: c++ -O3 -march=native -std=c++20 -Wno-psabi -I include -I capi -isystem <eigen> -isystem <coal>/include
// bench/collision/broad_bench.cpp
//        src/collision/broad_phase.cpp -L <coal>/lib -lcoal -Wl,-rpath,<coal>/lib    (the package `coal` of PyPI has both in
//        cmeel.prefix)
#include <coal/broadphase/broadphase_SSaP.h>
#include <coal/broadphase/broadphase_dynamic_AABB_tree.h>
#include <coal/broadphase/broadphase_dynamic_AABB_tree_array.h>
#include <coal/shape/geometric_shapes.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "collision/broad/broad_phase.hpp"

namespace {

using namespace dyn;
using collision::BroadPhase;
using shape::Bounds;
using shape::Vec;

constexpr int steps = 30;

struct Scene {
  double size;     // half
  double motion;   // of the centre in a step, at most; of 1: anywhere
  bool flat;       // spread over a floor, in a layer three boxes high
};

std::vector<std::vector<Vec>> path(const Scene& s, int n) {
  std::mt19937_64 g(1);
  std::uniform_real_distribution<double> u(0, 1);
  auto anywhere = [&] { return Vec::make(u(g), u(g), s.flat ? u(g) * 6 * s.size : u(g)); };
  std::vector<std::vector<Vec>> out(steps + 1, std::vector<Vec>(std::size_t(n)));
  for (Vec& p : out[0]) p = anywhere();
  for (int k = 1; k <= steps; ++k)
    for (int i = 0; i < n; ++i) {
      auto step = [&] { return (2 * u(g) - 1) * s.motion; };
      out[std::size_t(k)][std::size_t(i)] =
          s.motion == 1 ? anywhere() : out[std::size_t(k) - 1][std::size_t(i)] + Vec::make(step(), step(), step());
    }
  return out;
}

// median time of a step after the first, and the pairs of the last
template <class F>
void run(const char* name, const std::vector<std::vector<Vec>>& path, F&& step) {
  std::vector<double> t;
  std::size_t pairs = 0;
  for (const auto& p : path) {
    const auto start = std::chrono::steady_clock::now();
    pairs = step(p);
    t.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() * 1e3);
  }
  std::sort(t.begin() + 1, t.end());
  std::printf("  %-28s %8.3f %8.3f   %zu pairs\n", name, t[t.size() / 2], t.back(), pairs);
}

struct Counter : coal::CollisionCallBackBase {
  std::vector<std::pair<coal::CollisionObject*, coal::CollisionObject*>> found;  // as ours writes them
  bool collide(coal::CollisionObject* a, coal::CollisionObject* b) override { return found.emplace_back(a, b), false; }
};

template <class Manager>
void coal_run(const char* name, const std::vector<std::vector<Vec>>& path, double h) {
  auto shape = std::make_shared<coal::Box>(2 * h, 2 * h, 2 * h);
  std::vector<std::unique_ptr<coal::CollisionObject>> objects;
  Manager manager;
  Counter counter;
  run(name, path, [&](const std::vector<Vec>& p) {
    const bool first = objects.empty();
    if (first)
      for (std::size_t i = 0; i < p.size(); ++i) objects.push_back(std::make_unique<coal::CollisionObject>(shape));
    for (std::size_t i = 0; i < p.size(); ++i) {
      // the box alone: what turning it costs is not the broad phase's
      coal::AABB& box = objects[i]->getAABB();
      box.min_ = coal::Vec3s(p[i][0] - h, p[i][1] - h, p[i][2] - h),
      box.max_ = coal::Vec3s(p[i][0] + h, p[i][1] + h, p[i][2] + h);
    }
    if (first) {
      std::vector<coal::CollisionObject*> all;
      for (auto& o : objects) all.push_back(o.get());
      manager.registerObjects(all), manager.setup();
    } else {
      manager.update();
    }
    counter.found.clear();
    manager.collide(&counter);
    return counter.found.size();
  });
}

// Sort along x, then each box against those that begin before it ends, eight at once.
struct Sweep {
  std::vector<int> order;
  std::vector<float> lo[3], hi[3];
  std::vector<std::uint64_t> found;
  explicit Sweep(std::size_t n) : order(n) {
    std::iota(order.begin(), order.end(), 0);
    for (int i = 0; i < 3; ++i) lo[i].assign(n + 8, 1e30f), hi[i].assign(n + 8, -1e30f);
  }
  std::size_t step(const std::vector<Vec>& p, double h) {
    // nearly sorted from the last step: insertion, unless it takes too long
    std::size_t moves = 0;
    auto less = [&](int a, int b) { return p[std::size_t(a)][0] < p[std::size_t(b)][0]; };
    for (std::size_t k = 1; k < order.size(); ++k) {
      const int x = order[k];
      std::size_t j = k;
      for (; j > 0 && less(x, order[j - 1]); --j, ++moves) order[j] = order[j - 1];
      order[j] = x;
      if (moves > 20 * order.size()) {
        std::sort(order.begin(), order.end(), less);
        break;
      }
    }
    const std::size_t n = order.size();
    for (std::size_t k = 0; k < n; ++k)
      for (int i = 0; i < 3; ++i)
        lo[i][k] = float(p[std::size_t(order[k])][i] - h), hi[i][k] = float(p[std::size_t(order[k])][i] + h);
    found.clear();
    using namespace collision;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = a + 1; b < n && lo[0][b] <= hi[0][a]; b += 8) {
        Floats l[3], u[3];
        for (int i = 0; i < 3; ++i) l[i] = Floats::load(&lo[i][b]), u[i] = Floats::load(&hi[i][b]);
        for_each_bit(
            bits_of((l[0] <= hi[0][a]) & (l[1] <= hi[1][a]) & (u[1] >= lo[1][a]) & (l[2] <= hi[2][a]) & (u[2] >= lo[2][a])),
            [&](Index k) { found.push_back(id_pair(order[a], order[b + std::size_t(k)])); });
      }
    std::sort(found.begin(), found.end());
    return found.size();
  }
};

}  // namespace

int main(int argc, char** argv) {
  const int n = argc > 1 ? std::atoi(argv[1]) : 10000;
  const double third = 1.0 / 3;
  struct {
    const char* name;
    Scene scene;
  } rows[] = {{"0.1 % of pairs", {std::pow(1e-3, third) / 4, 0, false}},
              {"1 % of pairs", {std::pow(1e-2, third) / 4, 0, false}},
              {"six neighbours each", {std::pow(6.0 / n, third) / 4, 0, false}},
              {"six neighbours, on a floor", {std::sqrt(6.0 / n) / 6, 0, true}}};
  for (auto& row : rows)
    for (const auto& [motion, share] : {std::pair{"settled: motions of 0.001 of the size", 1e-3},
                                        std::pair{"moving: 0.05 of the size", 0.05}, std::pair{"anywhere in each step", 0.0}}) {
      Scene s = row.scene;
      s.motion = share == 0 ? 1 : 2 * s.size * share;
      std::printf("%d boxes, %s, %s: median, largest ms of a step\n", n, row.name, motion);
      const auto p = path(s, n);
      const Vec h = Vec::make(s.size, s.size, s.size);
      const std::ptrdiff_t room = 100 * std::ptrdiff_t(n) + 20000;
      for (const double margin : {0.0, 0.05}) {
        const std::unique_ptr<void, void (*)(void*)> memory(std::aligned_alloc(64, BroadPhase::bytes(n, room)), std::free);
        BroadPhase b(n, room, margin * 2 * s.size, memory.get());
        std::vector<std::pair<Index, Index>> found(static_cast<std::size_t>(room));
        run(margin == 0 ? "dyn, margin 0" : "dyn, margin 0.05 of the size", p, [&](const std::vector<Vec>& x) {
          for (Index i = 0; i < n; ++i) {
            const Bounds box = {x[std::size_t(i)] - h, x[std::size_t(i)] + h};
            if (b.has(i))
              b.update(i, box);
            else
              b.insert(box);
          }
          std::size_t count = 0;
          if (!b.pairs([&](Index i, Index j) { found[count++] = {i, j}; })) std::puts("  no room");
          return count;
        });
      }
      Sweep sweep(static_cast<std::size_t>(n));
      run("sort and sweep", p, [&](const std::vector<Vec>& x) { return sweep.step(x, s.size); });
      coal_run<coal::DynamicAABBTreeCollisionManager>("Coal, DynamicAABBTree", p, s.size);
      coal_run<coal::DynamicAABBTreeArrayCollisionManager>("Coal, DynamicAABBTreeArray", p, s.size);
      coal_run<coal::SSaPCollisionManager>("Coal, SSaP", p, s.size);
    }
}
