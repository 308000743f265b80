#include "stepping.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "effect_choice.hpp"
#include "system/system.hpp"

namespace cli {

namespace {

constexpr double max_steps = 1e9;

// Lifts what flies freely until nothing is below the ground.
void lift(const Robot& robot, Vector& q, json& warnings) {
  const Data data(robot, DYN_PART_COLLISION);
  Vector distances(dyn_model_npairs(robot));
  check(dyn_distances(robot, data, q.data(), distances.data()));
  double lowest = HUGE_VAL;
  const int ground = dyn_model_nshapes(robot) - 1;
  for (int k = 0; k < dyn_model_npairs(robot); ++k) {
    int a, b;
    check(dyn_model_pair(robot, k, &a, &b, nullptr));
    if (a == ground || b == ground) lowest = std::min(lowest, distances[k]);
  }
  if (!(lowest < HUGE_VAL)) return;
  bool lifted = false;
  for (int j = 1; j < robot.njoints; ++j)
    if (const dynJointInfo joint = robot.joint(j); joint.type == DYN_JOINT_TYPE_FREE_FLYER && joint.parent == 0)
      q[joint.idx_q + 2] -= lowest, lifted = true;
  if (lifted)
    warnings.push_back("the robot starts on the ground: its free joint is moved by " + short_number(-lowest) +
                       " m along z; --q chooses another place");
}

// Steps bring back a bounded share of it each, and so a motion that begins there goes by their length.
void warn_beyond_limits(const Robot& robot, const Vector& q, json& warnings) {
  const double *lower = dyn_model_array(robot, DYN_MODEL_ARRAY_LOWER_LIMIT),
               *upper = dyn_model_array(robot, DYN_MODEL_ARRAY_UPPER_LIMIT);
  int farthest = -1;
  double most = 1e-9;
  for (int i = 0; i < robot.nq; ++i)
    if (const double beyond = std::max(lower[i] - q[i], q[i] - upper[i]); beyond > most) most = beyond, farthest = i;
  if (farthest < 0) return;
  warnings.push_back("q[" + std::to_string(farthest) + "] (joint " + joint_of(robot, farthest) + ") starts at " +
                     short_number(q[farthest]) + ", beyond its limits [" + short_number(lower[farthest]) + ", " +
                     short_number(upper[farthest]) +
                     "], farthest of all: steps bring it back; --q chooses another place");
}

}  // namespace

const std::vector<Integrator>& integrators() {
  static const std::vector<Integrator> list = [] {
    std::vector<Integrator> out;
    for (const Choice& c : choices("dynIntegrator")) {
      dynIntegratorInfo info{};
      info.struct_size = sizeof info;
      check(dyn_integrator_info(static_cast<dynIntegrator>(c.value), &info));
      out.push_back({info.name, static_cast<dynIntegrator>(c.value), info.estimates ? 0.0 : info.order});
    }
    return out;
  }();
  return list;
}

const std::vector<Solver>& solvers() {
  static const std::vector<Solver> list = [] {
    std::vector<Solver> out;
    for (const Choice& c : choices("dynContactSolverType"))
      out.push_back({c.name.c_str(), static_cast<dynContactSolverType>(c.value)});
    return out;
  }();
  return list;
}

const Integrator& integrator_named(const std::string& name) {
  return integrators()[value_of("dynIntegrator", "--integrator", name)];
}

const Solver& solver_named(const std::string& name) { return solvers()[value_of("dynContactSolverType", "--solver", name)]; }

ContactSolver contact_solver_of(const SteppingOptions& options) {
  return {solver_named(options.solver).id, options.tolerance, options.max_iterations, options.time_budget,
          static_cast<dynContactModel>(value_of("dynContactModel", "--contact-model", options.contact_model))};
}

void set_stepping(const Robot& robot, const Data& data, dynIntegrator integrator, double dt, double accuracy,
                  const ContactSolver& solver, bool ledger) {
  dynStepOptions options;
  dyn_step_options_init(&options);
  options.solver = solver.type, options.tolerance = solver.tolerance, options.max_iterations = solver.max_iterations,
  options.time_budget = solver.time_budget, options.contact_model = solver.model;
  options.integrator = integrator, options.dt = dt, options.accuracy = accuracy, options.ledger = ledger;
  check(dyn_data_set_step_options(robot, data, &options));
}

void add_stepping_options(CLI::App& command, SteppingOptions& options) {
  add_robot_options(command, options.robot);
  complete(command.add_option("--integrator", options.integrator,
                              one_of("dynIntegrator") + "; default: the nearest to the file's, else semi_implicit_euler"),
           {names_of("dynIntegrator")});
  complete(command.add_option("--solver", options.solver, "Solver of contacts, limits and constraints: " + one_of("dynContactSolverType"))
               ->capture_default_str(),
           {names_of("dynContactSolverType")});
  command.add_option("--tolerance", options.tolerance, "Residual at which the solver stops; 0: 1e-4 of the largest velocity")
      ->check(decimal)
      ->capture_default_str();
  command
      .add_option("--max-iterations", options.max_iterations,
                  "Iterations of the solver, per island and step, over all that it tries; then the best impulses act; 0: 100, or "
                  "1200 with --tolerance")
      ->check(whole)
      ->capture_default_str();
  command
      .add_option("--time-budget", options.time_budget,
                  "Seconds of the solver in a step; then the best impulses act; 0: no limit, and repeatable results")
      ->check(decimal)
      ->capture_default_str();
  complete(command
               .add_option("--contact-model", options.contact_model,
                           "How contacts, limits and equalities give way: " + one_of("dynContactModel") +
                               "; as_file: by the MJCF file's solref and solimp, for comparisons with MuJoCo")
               ->capture_default_str(),
           {names_of("dynContactModel")});
  command.add_flag("--ground", options.ground, "Add the half-space below z = 0; without a state the robot starts on it");
  add_state_options(command, options.state, false);
  command
      .add_option("--configuration,--key", options.configuration,
                  "Start in this configuration of the file, an MJCF key or an SRDF state; default: where an MJCF file draws the "
                  "robot, else neutral")
      ->check(not_empty);
  command.add_option("--ctrl", options.ctrl, "Controls of the actuators, nu numbers; default: the configuration's")
      ->type_name("NUMBERS");
  add_effects_option(command, options.effects);
}

void add_dt_option(CLI::App& command, SteppingOptions& options, const std::string& what) {
  command.add_option("--dt", options.dt, what + "; default: the file's, else 0.001")->check(seconds);
}

void complete_stepping(const Robot& robot, SteppingOptions& options) {
  dynStepOptions file;
  dyn_step_options_init(&file);
  check(dyn_model_step_options(robot, &file));
  if (std::isnan(options.dt)) options.dt = file.dt;
  if (options.integrator.empty()) options.integrator = integrators()[static_cast<std::size_t>(file.integrator)].name;
}

void check_stepping(const SteppingOptions& options) {
  if (!(options.duration > 0) || !std::isfinite(options.duration)) bad_usage("--duration must be a positive number of seconds.");
  if (!(options.tolerance >= 0) || !std::isfinite(options.tolerance)) bad_usage("--tolerance must be a number, 0 or more.");
  if (options.max_iterations < 0) bad_usage("--max-iterations must be 0 or more.");
  if (!(options.time_budget >= 0) || !std::isfinite(options.time_budget))
    bad_usage("--time-budget must be a number of seconds, 0 or more.");
  check_lists(options.state);
  parse_effects(options.effects);
  parse_list("--ctrl", options.ctrl);
}

namespace {

// What is not given on the command line is that of the configuration.
void start_in_configuration(const Robot& robot, const SteppingOptions& options, State& state) {
  state.configuration = options.configuration;
  const Data data(robot, DYN_PART_SIMULATION, DYN_EFFECT_ALL);
  check(dyn_data_reset(robot, data, options.configuration.empty() ? nullptr : options.configuration.c_str()));
  state.q = field(robot, data, "q");
  if (options.state.v.empty()) state.v = field(robot, data, "v");
  state.ctrl = field(robot, data, "ctrl");
  state.in_configuration = true;
}

}  // namespace

State start_of(const Robot& robot, const SteppingOptions& options, json& warnings) {
  State state = read_state(robot, options.state);
  const bool said = !options.state.file.empty() || !options.state.q.empty();
  if (said && !options.configuration.empty()) bad_usage("--configuration excludes --q and --state: keep one.");
  if (!said) start_in_configuration(robot, options, state);
  if (options.ground && !said && options.configuration.empty()) lift(robot, state.q, warnings);
  if (effects_on(robot, options.effects) & DYN_EFFECT_LIMITS) warn_beyond_limits(robot, state.q, warnings);
  if (!options.ctrl.empty()) {
    const Vector given = parse_list("--ctrl", options.ctrl);
    if (given.size() != state.ctrl.size())
      fail("--ctrl has " + std::to_string(given.size()) + " numbers, but the robot has " + std::to_string(state.ctrl.size()) +
           " controls (nu).");
    state.ctrl = given;
  }
  return state;
}

void set_start(const Robot& robot, const Data& data, const State& state) {
  if (state.in_configuration)
    check(dyn_data_reset(robot, data, state.configuration.empty() ? nullptr : state.configuration.c_str()));
  check(dyn_data_set_state(robot, data, state.q.data(), state.v.data(), nullptr, state.tau.data()));
  check(dyn_data_set_control(robot, data, state.ctrl.data()));
}

std::string joint_of(const Robot& robot, int i) {
  for (int j = 1; j < robot.njoints; ++j)
    if (const dynJointInfo info = robot.joint(j); i >= info.idx_q && i < info.idx_q + info.nq) return info.name;
  return "?";
}

Schedule::Schedule(double duration, double h) : dt(h), last(h) {
  const double ratio = duration / h;
  if (!(ratio <= max_steps))
    bad_usage("--duration " + short_number(duration) + " at --dt " + short_number(h) + " is " + short_number(ratio) +
              " steps, more than " + short_number(max_steps) + ": take a larger --dt.");
  steps = std::llround(ratio);
  if (std::abs(ratio - static_cast<double>(steps)) > 1e-9 * ratio || steps == 0) {
    steps = static_cast<long long>(std::floor(ratio)) + 1;
    last = duration - static_cast<double>(steps - 1) * h;
  }
}

const double* state_view(const Robot& robot, const Data& data, const char* name) {
  dynArray array{};
  array.struct_size = sizeof array;
  check(dyn_data_array(robot, data, dyn_field_id(name), &array));
  return array.data;
}

Progress::Progress(long long total, const char* what) : total_(total), what_(what), on_(on_terminal()) {}

Progress::~Progress() {
  if (shown_) std::fprintf(stderr, "\r\033[K");
}

void Progress::at(long long i) {
  if (!on_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  shown_ = true;
  std::fprintf(stderr, "\r%3d %% of %lld %s", static_cast<int>(100 * i / std::max(total_, 1LL)), total_, what_);
}

}  // namespace cli
