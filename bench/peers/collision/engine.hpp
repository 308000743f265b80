// One collision engine among those compared: it is given two shapes, then poses in its own terms, then asked in batches.
#pragma once

#include <memory>
#include <vector>

#include "poses.hpp"

namespace dyn_bench {

struct Engine {
  virtual ~Engine() = default;
  virtual const char* name() const = 0;
  // false: it has no such shape
  virtual bool load(const Solid& a, const Solid& b) = 0;
  virtual void place(const std::vector<Scene>& scenes) = 0;
  // signed distances of all placed scenes: this is what is timed
  virtual void ask(double* distances) = 0;
  // least distance of the contact points of each scene without margin, infinite where there are none. Returns false if the engine
  // has no contact points.
  virtual bool contacts(double*) { return false; }
  // depths alone: what is apart is answered by infinity
  virtual bool depths_only() const { return false; }
};

std::unique_ptr<Engine> make_dyn();
std::unique_ptr<Engine> make_coal();
std::unique_ptr<Engine> make_mujoco();
std::unique_ptr<Engine> make_ccd();

}  // namespace dyn_bench
