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
#include "effect_choice.hpp"

namespace cli {
namespace {

constexpr int states = 64;
// Algorithms that need more are left out: numbers of an output (M of 2000 degrees of freedom), bytes of data.
constexpr std::int64_t max_numbers = 4'000'000;
constexpr std::size_t max_bytes = 1'000'000'000;

struct BenchOptions {
  RobotOptions robot;
  double seconds = 5;
  EffectOptions effects{"armature", ""};
};

struct BenchState {
  Vector q, v, a, tau;
};

struct Algorithm {
  std::string name, after;  // after: calls that its time includes
  dynParts parts;
  std::function<dynStatus(dynData*, const BenchState&)> call;
  std::function<dynStatus(dynData*, const BenchState&)> prepare;  // before each batch: what the call needs; may be empty
};

dynAlgorithmInfo describe(const Robot& robot, dynAlgorithm algorithm) {
  dynAlgorithmInfo info{};
  info.struct_size = sizeof info;
  check(dyn_algorithm_info(robot, algorithm, &info));
  return info;
}
std::int64_t numbers(const dynAlgorithmInfo& info, int k) { return std::int64_t(info.rows[k]) * info.cols[k] * info.pages[k]; }
bool has_word(const std::string& words, const std::string& word) {
  return (" " + words + " ").find(" " + word + " ") < words.size();
}

// One row of dynAlgorithm. Outputs that may be NULL stay in data.
Algorithm algorithm_row(const Robot& robot, dynAlgorithm algorithm, dynIntegrator integrator, const std::string& name) {
  const dynAlgorithmInfo info = describe(robot, algorithm);
  const auto out = std::make_shared<std::vector<Vector>>();
  const dynModel* m = robot;
  const auto call = [=, frame = robot.nframes - 1, joint = robot.njoints - 1, home = robot.neutral()](dynData* d,
                                                                                                      const BenchState& s) {
    dynBatchArrays x;
    dyn_batch_arrays_init(&x);
    x.q = s.q.data(), x.v = s.v.data(), x.a = s.a.data(), x.tau = x.b = s.tau.data(), x.q1 = home.data();
    x.frame = frame, x.joint = joint, x.dt = 1e-6, x.integrator = integrator;
    for (std::size_t k = 0; k < out->size(); ++k) x.out[k] = (*out)[k].data();
    const dynStatus status = dyn_algorithm_run(m, d, algorithm, &x);
    if (status != DYN_ERROR_ARGUMENT || !out->empty()) return status;
    for (int k = 0; k < info.outputs; ++k)
      out->emplace_back(numbers(info, k) + 1), x.out[k] = out->back().data();  // not NULL, even of no numbers
    return dyn_algorithm_run(m, d, algorithm, &x);
  };
  return {name, info.precondition, info.part, call, {}};
}

// Calls that are no dynAlgorithm.
std::vector<Algorithm> further_rows(const dynModel* m) {
  using S = const BenchState&;
  const auto mass = [=](dynData* d, S s) { return dyn_crba(m, d, s.q.data(), nullptr); };
  return {
      {"forward_kinematics", "", DYN_PART_KINEMATICS,
       [=](dynData* d, S s) { return dyn_forward_kinematics(m, d, s.q.data(), nullptr, nullptr); }, {}},
      {"forward_kinematics_q_v", "", DYN_PART_KINEMATICS,
       [=](dynData* d, S s) { return dyn_forward_kinematics(m, d, s.q.data(), s.v.data(), nullptr); }, {}},
      {"forward_kinematics_q_v_a", "", DYN_PART_KINEMATICS,
       [=](dynData* d, S s) { return dyn_forward_kinematics(m, d, s.q.data(), s.v.data(), s.a.data()); }, {}},
      {"cholesky", "", DYN_PART_CHOLESKY, [=](dynData* d, S) { return dyn_cholesky(m, d); }, mass},
      {"all_terms", "", DYN_PART_ALL,
       [=](dynData* d, S s) { return dyn_all_terms(m, d, DYN_TERM_ALL, s.q.data(), s.v.data(), nullptr); }, {}},
  };
}

bool fits(const Robot& robot, const dynAlgorithmInfo& info) {
  for (int k = 0; k < info.outputs; ++k)
    if (numbers(info, k) > max_numbers) return false;
  return robot.njoints > 1 || !has_word(info.inputs, "joint");
}

// Every algorithm that fits; left_out: the others' names.
std::vector<Algorithm> algorithms(const Robot& robot, std::vector<std::string>& left_out) {
  std::vector<Algorithm> every = further_rows(robot), table;
  for (const Choice& choice : choices("dynAlgorithm")) {
    const auto algorithm = static_cast<dynAlgorithm>(choice.value);
    const dynAlgorithmInfo info = describe(robot, algorithm);
    const std::string name = info.name;
    if (!fits(robot, info)) {
      left_out.push_back(name);
    } else if (!has_word(info.inputs, "integrator")) {
      every.push_back(algorithm_row(robot, algorithm, {}, name));
    } else {
      for (const Choice& by : choices("dynIntegrator"))
        every.push_back(algorithm_row(robot, algorithm, static_cast<dynIntegrator>(by.value), name + "_" + by.name));
    }
  }
  for (Algorithm& a : every) {
    if (a.parts && dyn_data_size(robot, a.parts) > max_bytes) left_out.push_back(a.name);
    else table.push_back(std::move(a));
  }
  return table;
}

std::vector<BenchState> random_states(const Robot& robot) {
  std::mt19937_64 random(1);
  const auto vector = [&] {
    Vector x(robot.nv);
    for (double& value : x) value = 2 * std::generate_canonical<double, 53>(random) - 1;
    return x;
  };
  std::vector<BenchState> out(states);
  for (int i = 0; i < states; ++i) {
    out[i] = {Vector(robot.nq), vector(), vector(), vector()};
    check(dyn_configuration_random(robot, static_cast<uint64_t>(i) + 1, nullptr, nullptr, out[i].q.data()));
  }
  return out;
}

// ns a call: batches of about 2 microseconds until the time is up. Every call has another state, or else what is already
// known of it would not be computed again; what needs preparation has one state a batch.
json measure(const Algorithm& algorithm, dynData* data, const std::vector<BenchState>& samples, double seconds,
             const InstructionCounter& counter) {
  using Clock = std::chrono::steady_clock;
  const auto nanoseconds = [](Clock::duration d) { return std::chrono::duration<double, std::nano>(d).count(); };
  const auto prepare = [&](const BenchState& s) {
    if (algorithm.prepare) check(algorithm.prepare(data, s));
  };
  double once = 1e300;
  for (const auto& s : samples) {  // warm, and every status is looked at here
    prepare(s);
    const auto start = Clock::now();
    check(algorithm.call(data, s));
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
    const BenchState& s = samples[i % states];
    prepare(s);
    const auto before = counter.read();
    const auto start = Clock::now();
    for (int k = 0; k < batch; ++k) algorithm.call(data, algorithm.prepare ? s : samples[next++ % states]);
    times.push_back(nanoseconds(Clock::now() - start) / batch);
    if (before) instructions += counter.read().value_or(*before) - *before;
    calls += batch;
  }
  const auto percentile = [&](double p) {
    const auto at = times.begin() + static_cast<std::ptrdiff_t>(p * static_cast<double>(times.size() - 1));
    std::nth_element(times.begin(), at, times.end());
    return *at;
  };
  json row = {{"name", algorithm.name}, {"after", algorithm.after}, {"ns_p50", percentile(0.5)}, {"ns_p99", percentile(0.99)}};
  row["instructions"] =
      instructions ? json(std::round(static_cast<double>(instructions) / static_cast<double>(calls))) : json(nullptr);
  return row;
}

void run_bench(const BenchOptions& options) {
  if (!(options.seconds > 0) || !std::isfinite(options.seconds)) bad_usage("--seconds must be a positive number of seconds.");
  parse_effects(options.effects);
  const Robot robot(options.robot);
  const std::uint32_t on = effects_on(robot, options.effects);
  std::vector<std::string> left_out;
  const auto table = algorithms(robot, left_out);
  if (!left_out.empty()) std::cerr << "dyn: left out, because they need too much memory or a joint: " << join(left_out) << ".\n";
  dynParts parts = 0;
  for (const Algorithm& a : table) parts |= a.parts;
  const Data data(robot, parts, on);
  const auto samples = random_states(robot);
  const InstructionCounter counter;
  json rows = json::array();
  for (const auto& algorithm : table) {
    try {
      rows.push_back(measure(algorithm, data, samples, options.seconds / static_cast<double>(table.size()), counter));
    } catch (const Failure& failure) {
      fail(algorithm.name + ": " + failure.message);
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
  std::snprintf(line, sizeof line, "%-42s %12s %12s %10s %10s %14s  %s\n", "algorithm", "ns p50", "ns p99", "% of 1 ms", "/ RNEA",
                "instructions", "includes");
  text += line;
  for (const auto& row : rows) {
    const std::string count = row["instructions"].is_null() ? "-" : short_number(row["instructions"].get<double>(), 9);
    std::snprintf(line, sizeof line, "%-42s %12.1f %12.1f %10.4f %10.2f %14s", row["name"].get<std::string>().c_str(),
                  row["ns_p50"].get<double>(), row["ns_p99"].get<double>(), row["percent_of_1ms"].get<double>(),
                  row["ratio_to_rnea"].get<double>(), count.c_str());
    const auto after = row["after"].get<std::string>();
    text += line + (after.empty() ? "" : "  " + after) + "\n";
  }
  print(text);
}

}  // namespace

void add_bench(CLI::App& app) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* command = app.add_subcommand("bench", "Time of every algorithm on 64 random states of this robot");
  add_robot_options(*command, options->robot);
  add_effects_option(*command, options->effects);
  command->add_option("--seconds", options->seconds, "Total time of measuring, seconds")->check(decimal)->capture_default_str();
  command->callback([options] { run_bench(*options); });
}

}  // namespace cli
