// dyn distance: how far the parts of a robot are from each other.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

#include "accuracy/distance_sweep.hpp"

namespace cli {
namespace {

struct DistanceOptions {
  RobotOptions robot;
  StateOptions state;
  bool all = false, sweep = false;
  int samples = 20;
};

constexpr std::size_t shown_pairs = 10;

std::string text_of(const json& answer, bool all) {
  const json& pairs = answer["pairs"];
  if (pairs.empty()) return "no pair of collision shapes is tested: dyn info --pairs lists the reasons\n";
  std::string out =
      std::to_string(pairs.size()) + " pairs, " + std::to_string(answer["collisions"].get<int>()) + " in collision\n";
  char line[256];
  std::snprintf(line, sizeof line, "%12s  %-11s  %s\n", "distance m", "", "between");
  out += line;
  for (std::size_t k = 0; k < pairs.size() && (all || k < shown_pairs); ++k) {
    const json& p = pairs[k];
    std::snprintf(line, sizeof line, "%12.6g  %-11s  ", p["distance"].get<double>(), p["status"].get<std::string>().c_str());
    out += line + p["a"].get<std::string>() + " - " + p["b"].get<std::string>() + "\n";
  }
  if (!all && pairs.size() > shown_pairs)
    out += "and " + std::to_string(pairs.size() - shown_pairs) + " farther apart: --pairs lists them\n";
  return out;
}

// The state given, and random ones.
std::vector<Vector> sampled(const Robot& robot, const DistanceOptions& options) {
  std::vector<Vector> out = {read_state(robot, options.state).q};
  for (int k = 0; k < options.samples; ++k) {
    out.push_back(robot.neutral());
    check(dyn_configuration_random(robot, std::uint64_t(k), nullptr, nullptr, out.back().data()));
  }
  return out;
}

void run_sweep(const DistanceOptions& options) {
  check_lists(options.state);
  const Robot robot(options.robot);
  const std::vector<Vector> states = sampled(robot, options);
  const std::vector<DistanceCost> sweep = distance_sweep(robot, states);
  const json answer = {{"reference", distance_reference}, {"states", states.size()}, {"sweep", sweep_json(sweep)}};
  const std::string text = sweep.empty() ? text_of({{"pairs", json::array()}}, true) : sweep_text(sweep);
  print(options.robot.json ? json_text(answer) : text);
}

void run_distance(const DistanceOptions& options) {
  check_lists(options.state);
  const Robot robot(options.robot);
  const Data data(robot, DYN_PART_COLLISION);
  const State state = read_state(robot, options.state);
  check(dyn_distances(robot, data, state.q.data(), nullptr));
  std::vector<json> pairs;
  int collisions = 0;
  for (const int pair : tested_pairs(robot, data)) {
    pairs.push_back(distance_json(robot, data, pair));
    collisions += pairs.back()["distance"].get<double>() <= 0;
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const json& a, const json& b) { return a["distance"].get<double>() < b["distance"].get<double>(); });
  const json answer = {{"collisions", collisions}, {"pairs", pairs}};
  print(options.robot.json ? json_text(answer) : text_of(answer, options.all));
}

}  // namespace

void add_distance(CLI::App& app) {
  auto options = std::make_shared<DistanceOptions>();
  CLI::App* command = app.add_subcommand("distance", "Distances between a robot's collision shapes, the nearest first");
  add_robot_options(*command, options->robot);
  add_state_options(*command, options->state, false);
  command->add_flag("--pairs", options->all, "List all pairs instead of the nearest ten");
  CLI::Option* sweep =
      command->add_flag("--sweep", options->sweep,
                        "Measure errors and times of all pairs by method and tolerance, at q and in random configurations");
  command->add_option("--samples", options->samples, "Random configurations of --sweep (20)")
      ->check(whole)
      ->check(CLI::Range(0, 100000))
      ->needs(sweep);
  command->callback([options] { options->sweep ? run_sweep(*options) : run_distance(*options); });
}

}  // namespace cli
