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
  dynContactSolverType solver = DYN_CONTACT_SOLVER_TYPE_ADMM;
  double tolerance = 1e-9;
  int parts = 1;  // calls in which a sample is reached
};

struct Sample {
  Vector q, places;  // of all frames, 12 numbers each
  double energy = 0, momentum[3] = {}, com[3] = {};
};
using Samples = std::vector<Sample>;
// Without places, which q says. Numbers that are not finite are null there.
json json_of(const Samples& samples);
Samples samples_of(const Robot& robot, const json& x);

inline constexpr const char* too_long = "it took longer than its share of the budget";

struct JointRun {
  Samples samples;
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

JointRun run(const Scene& scene, const Setting& setting);
// In a process of its own, which is ended after most_s seconds: the error then says so.
JointRun run_within(const Scene& scene, const Setting& setting, double most_s);

// The largest between the samples of two runs.
struct Error {
  double m = 0, rad = 0;  // of any frame's place
  double energy = 0;      // J
  double momentum = 0;    // kg m/s
};
Error error_between(const Robot& robot, const Samples& a, const Samples& b);
// The same of the centre of mass instead of places: what is left of motion that amplifies the smallest error.
Error statistics_between(const Samples& a, const Samples& b);

}  // namespace cli::accuracy
