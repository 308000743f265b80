#include "engine.hpp"

namespace dyn_bench {
namespace {

struct Dyn : Engine {
  std::vector<Scene> scenes;
  const char* name() const override { return "libdyn"; }
  bool load(const Solid&, const Solid&) override { return true; }
  void place(const std::vector<Scene>& s) override { scenes = s; }
  void ask(double* d) override {
    for (const Scene& s : scenes) *d++ = query(s).distance;
  }
};

}  // namespace

std::unique_ptr<Engine> make_dyn() { return std::make_unique<Dyn>(); }

}  // namespace dyn_bench
