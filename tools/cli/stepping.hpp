// What the commands that step a robot have in common: options, integrators and solvers by name, where it starts.
#pragma once

#include <chrono>
#include <limits>

#include "cli.hpp"

namespace cli {

struct Integrator {
  const char* name;
  dynIntegrator id;
  double order;  // 0: it says its error itself
};
const std::vector<Integrator>& integrators();  // by their values
struct Solver {
  const char* name;
  dynContactSolverType id;
};
const std::vector<Solver>& solvers();

const Integrator& integrator_named(const std::string& name);
const Solver& solver_named(const std::string& name);

struct ContactSolver {
  dynContactSolverType type;
  double tolerance;
  int max_iterations = 0;
  double time_budget = 0;  // s a step; 0: none
  dynContactModel model = DYN_CONTACT_MODEL_RIGID;
};
ContactSolver contact_solver_of(const struct SteppingOptions& options);
void set_stepping(const Robot& robot, const Data& data, dynIntegrator integrator, double dt, double accuracy,
                  const ContactSolver& solver, bool ledger = false);

// Of the command line.
struct SteppingOptions {
  RobotOptions robot;
  StateOptions state;
  EffectOptions effects{"stated", ""};
  std::string integrator, solver = "admm", contact_model = "rigid", configuration;  // integrator "": the file's
  double duration = 0, dt = std::numeric_limits<double>::quiet_NaN(), tolerance = 0, time_budget = 0;
  int max_iterations = 0;
  bool ground = false;
  std::vector<std::string> ctrl;
};
// All but --duration and --dt.
void add_stepping_options(CLI::App& command, SteppingOptions& options);
void add_dt_option(CLI::App& command, SteppingOptions& options, const std::string& what);
void check_stepping(const SteppingOptions& options);
// Fills in dt and integrator that were not given: the file's.
void complete_stepping(const Robot& robot, SteppingOptions& options);

// Where the steps begin: as --state or --q say, else in --configuration, else as new data, where an MJCF file draws the robot;
// with --ground on it, if nothing was said. Controls are those of --ctrl.
// A start beyond limits that act is a warning.
State start_of(const Robot& robot, const SteppingOptions& options, json& warnings);
void set_start(const Robot& robot, const Data& data, const State& state);

// Whose coordinate q[i] is.
std::string joint_of(const Robot& robot, int i);

// Steps of dt, and a shorter last one when dt does not divide the duration.
struct Schedule {
  double dt, last;
  long long steps;
  Schedule(double duration, double h);
  double length(long long i) const { return i + 1 == steps ? last : dt; }
};

// What each effect that acts takes of a step and changes of the result, by runs without it: the array of objects of dyn effects.
// (effects.cpp)
json measure_effects(const Robot& robot, const State& state, const SteppingOptions& options, std::uint32_t on);
std::string effects_text(const json& measured);

// The state in data, without copies.
const double* state_view(const Robot& robot, const Data& data, const char* name);

// On a terminal only.
class Progress {
 public:
  explicit Progress(long long total, const char* what = "steps");
  ~Progress();
  void at(long long i);

 private:
  long long total_;
  const char* what_;
  bool on_, shown_ = false;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace cli
