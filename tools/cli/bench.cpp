// dyn bench: every algorithm on this robot, on this machine.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iostream>
#include <random>

#include "cli.hpp"
#include "counter.hpp"

namespace cli {
namespace {

constexpr int states = 64;
constexpr int max_dense = 2000;  // nv beyond which the nv x nv quantities are left out

struct Options {
  RobotOptions robot;
  double seconds = 5;
  EffectOptions effects{"armature", ""};
};

struct Sample {
  Vector q, v, a, tau;
};

struct Algorithm {
  const char* name;
  bool dense;  // needs nv x nv numbers
  std::function<dynStatus(const Sample&)> call;
  std::function<dynStatus(const Sample&)> prepare;  // before each batch: what the call needs; may be empty
};

dynStatus step(const dynModel* m, dynData* d, dynIntegrator integrator) {
  dynStepOptions options;
  dyn_step_options_init(&options);
  options.integrator = integrator, options.dt = 1e-6;
  check(dyn_data_set_step_options(m, d, &options));
  return dyn_step(m, d);
}

std::vector<Algorithm> algorithms(const Robot& robot, const Data& data, Vector& out) {
  const dynModel* m = robot;
  dynData* d = data;
  const int frame = robot.nframes - 1, nv = robot.nv;
  double* x = out.data();
  using S = const Sample&;
  const auto set = [=](S s) { return dyn_data_set_state(m, d, s.q.data(), s.v.data(), s.a.data(), s.tau.data()); };
  const auto placed = [=](S s) { return dyn_forward_kinematics(m, d, s.q.data(), s.v.data(), s.a.data()); };
  const auto mass = [=](S s) { return dyn_crba(m, d, s.q.data(), nullptr); };
  const auto factor = [=](S s) { return mass(s) ? DYN_ERROR_INTERNAL : dyn_cholesky(m, d); };
  return {
      {"forward_kinematics", false, [=](S s) { return dyn_forward_kinematics(m, d, s.q.data(), nullptr, nullptr); }, {}},
      {"forward_kinematics_q_v", false, [=](S s) { return dyn_forward_kinematics(m, d, s.q.data(), s.v.data(), nullptr); }, {}},
      {"forward_kinematics_q_v_a", false, placed, {}},
      {"frame_placements", false, [=](S) { return dyn_frame_placements(m, d, nullptr); }, placed},
      {"joint_jacobians", false, [=](S s) { return dyn_joint_jacobians(m, d, s.q.data(), nullptr); }, {}},
      {"joint_jacobians_time_variation",
       false,
       [=](S s) { return dyn_joint_jacobians_time_variation(m, d, s.q.data(), s.v.data(), nullptr); },
       {}},
      {"frame_jacobian", false, [=](S) { return dyn_frame_jacobian(m, d, frame, DYN_REFERENCE_LOCAL, x); }, placed},
      {"frame_velocity_derivatives", false,
       [=](S) { return dyn_frame_velocity_derivatives(m, d, frame, DYN_REFERENCE_LOCAL, x, x + 6 * nv); }, placed},
      {"frame_acceleration_derivatives", false,
       [=](S) { return dyn_frame_acceleration_derivatives(m, d, frame, DYN_REFERENCE_LOCAL, x, x + 6 * nv, nullptr); }, placed},
      {"com", false, [=](S s) { return dyn_com(m, d, s.q.data(), nullptr, nullptr, nullptr, nullptr, nullptr); }, {}},
      {"jcom", false, [=](S s) { return dyn_jcom(m, d, s.q.data(), nullptr); }, {}},
      {"vcom_derivatives", false, [=](S s) { return dyn_vcom_derivatives(m, d, s.q.data(), s.v.data(), nullptr, nullptr); }, {}},
      {"rnea", false, [=](S s) { return dyn_rnea(m, d, s.q.data(), s.v.data(), s.a.data(), nullptr, nullptr); }, {}},
      {"nle", false, [=](S s) { return dyn_nle(m, d, s.q.data(), s.v.data(), nullptr); }, {}},
      {"gravity_torque", false, [=](S s) { return dyn_gravity_torque(m, d, s.q.data(), nullptr); }, {}},
      {"static_torque", false, [=](S s) { return dyn_static_torque(m, d, s.q.data(), nullptr, nullptr); }, {}},
      {"gravity_torque_derivatives", true, [=](S s) { return dyn_gravity_torque_derivatives(m, d, s.q.data(), nullptr); }, {}},
      {"static_torque_derivatives",
       true,
       [=](S s) { return dyn_static_torque_derivatives(m, d, s.q.data(), nullptr, nullptr); },
       {}},
      {"rnea_second_order_product",
       true,
       [=](S s) {
         return dyn_rnea_second_order_product(m, d, s.q.data(), s.v.data(), s.a.data(), nullptr, s.tau.data(), nullptr);
       },
       {}},
      {"coriolis_matrix", true, [=](S s) { return dyn_coriolis_matrix(m, d, s.q.data(), s.v.data(), nullptr); }, {}},
      {"aba", false, [=](S s) { return dyn_aba(m, d, s.q.data(), s.v.data(), s.tau.data(), nullptr, nullptr); }, {}},
      {"crba", true, mass, {}},
      {"cholesky", true, [=](S) { return dyn_cholesky(m, d); }, mass},
      {"cholesky_solve", true, [=](S s) { return dyn_cholesky_solve(m, d, s.tau.data(), 1, x); }, factor},
      {"minv", true, [=](S s) { return dyn_minv(m, d, s.q.data(), nullptr); }, {}},
      {"rnea_derivatives",
       true,
       [=](S s) { return dyn_rnea_derivatives(m, d, s.q.data(), s.v.data(), s.a.data(), nullptr, nullptr, nullptr); },
       {}},
      {"aba_derivatives",
       true,
       [=](S s) { return dyn_aba_derivatives(m, d, s.q.data(), s.v.data(), s.tau.data(), nullptr, nullptr); },
       {}},
      {"energy", false, [=](S s) { return dyn_energy(m, d, s.q.data(), s.v.data(), nullptr, nullptr); }, {}},
      {"centroidal_map",
       false,
       [=](S s) { return dyn_centroidal_map(m, d, s.q.data(), s.v.data(), nullptr, nullptr, nullptr); },
       {}},
      {"centroidal_map_time_variation",
       false,
       [=](S s) { return dyn_centroidal_map_time_variation(m, d, s.q.data(), s.v.data(), nullptr); },
       {}},
      {"centroidal_momentum", false, [=](S s) { return dyn_centroidal_momentum(m, d, s.q.data(), s.v.data(), nullptr); }, {}},
      {"centroidal_momentum_time_variation",
       false,
       [=](S s) { return dyn_centroidal_momentum_time_variation(m, d, s.q.data(), s.v.data(), s.a.data(), nullptr); },
       {}},
      {"centroidal_derivatives",
       false,
       [=](S s) { return dyn_centroidal_derivatives(m, d, s.q.data(), s.v.data(), s.a.data(), nullptr); },
       {}},
      {"joint_torque_regressor",
       true,
       [=](S s) { return dyn_joint_torque_regressor(m, d, s.q.data(), s.v.data(), s.a.data(), nullptr); },
       {}},
      {"static_regressor", true, [=](S s) { return dyn_static_regressor(m, d, s.q.data(), nullptr); }, {}},
      {"kinetic_energy_regressor",
       true,
       [=](S s) { return dyn_kinetic_energy_regressor(m, d, s.q.data(), s.v.data(), nullptr); },
       {}},
      {"potential_energy_regressor", true, [=](S s) { return dyn_potential_energy_regressor(m, d, s.q.data(), nullptr); }, {}},
      {"all_terms", true, [=](S s) { return dyn_all_terms(m, d, DYN_TERM_ALL, s.q.data(), s.v.data(), nullptr); }, {}},
      {"integrate", false, [=](S s) { return dyn_integrate(m, s.q.data(), s.v.data(), x); }, {}},
      {"difference", false, [=, home = robot.neutral()](S s) { return dyn_difference(m, home.data(), s.q.data(), x); }, {}},
      {"step_semi_implicit_euler", false, [=](S) { return step(m, d, DYN_INTEGRATOR_SEMI_IMPLICIT_EULER); }, set},
      {"step_rk4", false, [=](S) { return step(m, d, DYN_INTEGRATOR_RK4); }, set},
  };
}

std::vector<Sample> random_states(const Robot& robot) {
  std::mt19937_64 random(1);
  const auto vector = [&] {
    Vector x(robot.nv);
    for (double& value : x) value = 2 * std::generate_canonical<double, 53>(random) - 1;
    return x;
  };
  std::vector<Sample> out(states);
  for (int i = 0; i < states; ++i) {
    out[i] = {Vector(robot.nq), vector(), vector(), vector()};
    check(dyn_configuration_random(robot, static_cast<uint64_t>(i) + 1, nullptr, nullptr, out[i].q.data()));
  }
  return out;
}

// ns a call: batches of about 2 microseconds until the time is up. Every call has another state, or else what is already
// known of it would not be computed again; what needs preparation has one state a batch.
json measure(const Algorithm& algorithm, const std::vector<Sample>& samples, double seconds, const InstructionCounter& counter) {
  using Clock = std::chrono::steady_clock;
  const auto nanoseconds = [](Clock::duration d) { return std::chrono::duration<double, std::nano>(d).count(); };
  const auto prepare = [&](const Sample& s) {
    if (algorithm.prepare) check(algorithm.prepare(s));
  };
  double once = 1e300;
  for (const auto& s : samples) {  // warm, and every status is looked at here
    prepare(s);
    const auto start = Clock::now();
    check(algorithm.call(s));
    once = std::min(once, nanoseconds(Clock::now() - start));
  }
  const int batch = std::max(1, static_cast<int>(std::ceil(2000 / std::max(once, 1.0))));
  Vector times;
  times.reserve(1 << 16);
  uint64_t instructions = 0;
  long long calls = 0;
  std::size_t next = 0;
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  for (std::size_t i = 0; i < states || (Clock::now() < end && i < 1 << 20); ++i) {
    const Sample& s = samples[i % states];
    prepare(s);
    const auto before = counter.read();
    const auto start = Clock::now();
    for (int k = 0; k < batch; ++k) algorithm.call(algorithm.prepare ? s : samples[next++ % states]);
    times.push_back(nanoseconds(Clock::now() - start) / batch);
    if (before) instructions += counter.read().value_or(*before) - *before;
    calls += batch;
  }
  const auto percentile = [&](double p) {
    const auto at = times.begin() + static_cast<std::ptrdiff_t>(p * static_cast<double>(times.size() - 1));
    std::nth_element(times.begin(), at, times.end());
    return *at;
  };
  json row = {{"name", algorithm.name}, {"ns_p50", percentile(0.5)}, {"ns_p99", percentile(0.99)}};
  row["instructions"] =
      instructions ? json(std::round(static_cast<double>(instructions) / static_cast<double>(calls))) : json(nullptr);
  return row;
}

void run(const Options& options) {
  if (!(options.seconds > 0) || !std::isfinite(options.seconds)) bad_usage("--seconds must be a positive number of seconds.");
  const std::uint32_t on = parse_effects(options.effects);
  const Robot robot(options.robot);
  constexpr dynParts sparse =
      DYN_PART_KINEMATICS | DYN_PART_JACOBIANS | DYN_PART_COM | DYN_PART_INVERSE | DYN_PART_ENERGY | DYN_PART_FRAMES |
      DYN_PART_CENTROIDAL;
  const bool dense = robot.nv <= max_dense;
  const Data data(robot, dense ? dynParts(DYN_PART_ALL) : sparse | DYN_PART_SIMULATION, on);
  const auto samples = random_states(robot);
  Vector out(12 * static_cast<std::size_t>(std::max(robot.nq, robot.nv)) + 12);
  auto table = algorithms(robot, data, out);
  if (!dense) {
    std::cerr << "dyn: nv is " << robot.nv << ": what needs nv x nv numbers is left out.\n";
    table.erase(std::remove_if(table.begin(), table.end(), [](const Algorithm& a) { return a.dense; }), table.end());
  }
  const InstructionCounter counter;
  json rows = json::array();
  for (const auto& algorithm : table) {
    try {
      rows.push_back(measure(algorithm, samples, options.seconds / static_cast<double>(table.size()), counter));
    } catch (const Failure& failure) {
      fail(std::string(algorithm.name) + ": " + failure.message);
    }
  }
  const auto rnea = std::find_if(rows.begin(), rows.end(), [](const json& row) { return row["name"] == "rnea"; });
  const double unit = (*rnea)["ns_p50"];
  for (json& row : rows) {
    const double p50 = row["ns_p50"];
    row["percent_of_1ms"] = p50 / 1e4, row["ratio_to_rnea"] = p50 / unit;
  }
  if (options.robot.json) {
    json answer = json::object();
    answer["algorithms"] = rows;
    return print(json_text(answer));
  }
  std::string text = std::string(dyn_model_name(robot)) + ": nq " + std::to_string(robot.nq) + ", nv " +
                     std::to_string(robot.nv) + "; " + dyn_build_info() + "\n";
  char line[128];
  std::snprintf(line, sizeof line, "%-34s %12s %12s %10s %10s %14s\n", "algorithm", "ns p50", "ns p99", "% of 1 ms", "/ RNEA",
                "instructions");
  text += line;
  for (const auto& row : rows) {
    const std::string count = row["instructions"].is_null() ? "-" : short_number(row["instructions"].get<double>(), 9);
    std::snprintf(line, sizeof line, "%-34s %12.1f %12.1f %10.4f %10.2f %14s\n", row["name"].get<std::string>().c_str(),
                  row["ns_p50"].get<double>(), row["ns_p99"].get<double>(), row["percent_of_1ms"].get<double>(),
                  row["ratio_to_rnea"].get<double>(), count.c_str());
    text += line;
  }
  print(text);
}

}  // namespace

void add_bench(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("bench", "Time of every algorithm on 64 random states of this robot");
  add_robot_options(*command, options->robot);
  add_effects_option(*command, options->effects);
  command->add_option("--seconds", options->seconds, "Total time of measuring, seconds")->check(decimal)->capture_default_str();
  command->callback([options] { run(*options); });
}

}  // namespace cli
