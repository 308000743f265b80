// Work and precision of a scene: every integrator at every step or accuracy that the budget allows, and the contact solvers at
// every tolerance.
#pragma once

#include <algorithm>
#include <functional>

#include "run.hpp"

namespace cli::accuracy {

struct Point {
  Setting setting;
  Samples samples;
  Error error;
  double wall_s = 0, penetration = 0, residual = 0;
  long long evaluations = 0, steps = 0;
  std::string failure;  // why there is no error
  bool pareto = false;  // nothing else is both cheaper and nearer
};
std::string name_of(const Setting& s);  // "rk4 dt 0.001", "rk45 accuracy 1e-06"
std::string key_of(const Setting& s);   // with the solver

// What errors are measured from.
struct Reference {
  JointRun run;
  std::string kind;        // how it was made
  Error uncertainty;       // of itself
  std::string confidence;  // in words
  bool smooth = true;      // nothing jumped
  bool statistics = false;  // errors are those of the centre of mass, of energy and momentum, from means over perturbed starts
};
Error error_from(const Scene& scene, const Reference& reference, const Samples& samples);

// Seconds that are left, for all of it.
class Budget {
 public:
  explicit Budget(double seconds)
      : seconds_(seconds),
        end_(std::chrono::steady_clock::now() +
             std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds))) {}
  double share() const { return std::min(left(), seconds_ / 10); }  // of one run
  double left() const { return std::chrono::duration<double>(end_ - std::chrono::steady_clock::now()).count(); }

 private:
  double seconds_;
  std::chrono::steady_clock::time_point end_;
};

Reference make_reference(const Scene& scene, const Setting& contact, const Budget& budget);
// The user's: one configuration, at the end.
Reference given_reference(const Scene& scene, const Vector& q, const Vector& v);

// known: points of an earlier run by their keys; done: is told each new one.
using Known = std::function<const Point*(const std::string& key)>;
using Done = std::function<void(const Point&)>;
std::vector<Point> integrator_sweep(const Scene& scene, const Reference& reference, const Setting& contact, const Budget& budget,
                                    const Known& known, const Done& done);
// At one step; against the tightest of them.
// Settings between and beside those of the sweep that may be cheaper for errors that within() accepts: finer ladders, and in
// contact the solvers and their tolerances. They are appended. Returns the cheapest, timed again, or nullptr.
const Point* refine_cheapest(const Scene& scene, const Reference& reference, const Budget& budget,
                             const std::function<bool(const Error&)>& within, std::vector<Point>& points);
std::vector<Point> solver_sweep(const Scene& scene, double dt, const Budget& budget, const Known& known, const Done& done);

}  // namespace cli::accuracy
