// One run of a scene: where it is at samples, and what that took.
#pragma once

#include <string>
#include <vector>

#include "../stepping.hpp"

namespace cli::accuracy {

inline constexpr int samples = 10;  // moments that are compared, equally far apart

struct Setting {
  Integrator integrator;
  double dt = 0;        // steps of this
  double accuracy = 0;  // or steps that their own error chooses
  dynContactSolverType solver = DYN_CONTACT_ADMM;
  double tolerance = 1e-9;
  int parts = 1;  // calls in which a sample is reached
};

struct Sample {
  Vector q, places;  // of all frames, 12 numbers each
  double energy = 0, momentum[3] = {};
};

inline constexpr const char* too_long = "it took longer than its share of the budget";

struct Run {
  std::vector<Sample> samples;
  double wall_s = 0;  // of the steps alone
  long long evaluations = 0, steps = 0;
  double penetration = 0, residual = 0;
  int rows = 0;       // most that acted in a step: contacts, limits, constraints that are solved in it
  std::string error;  // why it ended early
};

// What is simulated.
struct Scene {
  const Robot& robot;
  State start;
  std::uint32_t effects;
  double duration;
};

Run run(const Scene& scene, const Setting& setting);
// In a process of its own, which is ended after most_s seconds: the error then says so.
Run run_within(const Scene& scene, const Setting& setting, double most_s);

// Between two runs, the largest over all samples.
struct Error {
  double m = 0, rad = 0;  // of any frame's place
  double energy = 0;      // J
  double momentum = 0;    // kg m/s
};
Error error_between(const Robot& robot, const Run& a, const Run& b);

}  // namespace cli::accuracy
