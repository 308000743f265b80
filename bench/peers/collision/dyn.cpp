#include "collision/manifold.hpp"
#include "engine.hpp"

namespace dyn_bench {
namespace {

struct Dyn : Engine {
  Solid a, b;
  std::vector<std::pair<Pose, Pose>> poses;
  const char* name() const override { return "libdyn"; }
  bool load(const Solid& x, const Solid& y) override { return a = x, b = y, true; }
  void place(const std::vector<Scene>& scenes) override {
    poses.clear();
    for (const Scene& s : scenes) poses.emplace_back(s.A, s.B);
  }
  void ask(double* d) override {
    for (const auto& X : poses) *d++ = collision::distance(a.shape, X.first, b.shape, X.second, workspace()).distance;
  }
  bool contacts(double* d) override {
    collision::Manifold m;
    for (const auto& X : poses) {
      collision::contacts(a.shape, X.first, b.shape, X.second, 0, workspace(), m);
      double least = shape::infinity;
      for (int i = 0; i < m.count; ++i) least = std::min(least, m.points[i].distance);
      *d++ = least;
    }
    return true;
  }
};

}  // namespace

std::unique_ptr<Engine> make_dyn() { return std::make_unique<Dyn>(); }

}  // namespace dyn_bench
