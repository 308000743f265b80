// dyn effects: what a scene calls for, measured. Each effect that acts is left out once: how far the motion then is from that
// with all of them, at most, is its magnitude, and what the steps then take less is its price.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "counter.hpp"
#include "effect_choice.hpp"
#include "stepping.hpp"

namespace cli {

namespace {

constexpr int batches = 50;  // of steps, between looks at the clock
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// What a step takes.
struct Rollout {
  double ns = 0;
  double instructions = unknown;
  std::string error;  // why it ended early
};

Data start(const Robot& robot, const State& state, const SteppingOptions& options, std::uint32_t on) {
  Data data(robot, DYN_PART_SIMULATION, on);
  set_start(robot, data, state);
  set_stepping(robot, data, integrator_named(options.integrator).id, options.dt, 0,
               contact_solver_of(options));
  return data;
}

Rollout roll_out(const Robot& robot, const State& state, const SteppingOptions& options, std::uint32_t on) {
  using Clock = std::chrono::steady_clock;
  const Schedule schedule(options.duration, options.dt);
  Rollout out;
  for (int run = 0; run < 2 && out.error.empty(); ++run) {  // the first one also warms caches
    const Data data = start(robot, state, options, on);
    const long long every = std::max(schedule.steps / batches, 1LL);
    const InstructionCounter counter;
    std::uint64_t counted = 0;
    Clock::duration wall{};
    bool known = true;
    for (long long i = 0; i < schedule.steps && out.error.empty();) {
      const long long end = std::min(i + every, schedule.steps);
      const auto before = counter.read();
      const auto start = Clock::now();
      for (; i < end; ++i)
        if (dyn_step(robot, data) != DYN_OK) {
          out.error = dyn_last_error();
          break;
        }
      wall += Clock::now() - start;
      if (const auto after = counter.read(); before && after) counted += *after - *before;
      else known = false;
    }
    const double ns = std::chrono::duration<double, std::nano>(wall).count() / static_cast<double>(schedule.steps);
    out.ns = run ? std::min(out.ns, ns) : ns;
    if (known) out.instructions = static_cast<double>(counted) / static_cast<double>(schedule.steps);
  }
  return out;
}

// Largest coordinate of the difference, m or rad, after any step; infinite where one of the two ends early.
double largest_difference(const Robot& robot, const State& state, const SteppingOptions& options, std::uint32_t on,
                          std::uint32_t without) {
  const Data a = start(robot, state, options, on), b = start(robot, state, options, without);
  const double *const qa = state_view(robot, a, "q"), *const qb = state_view(robot, b, "q");
  double most = 0;
  Vector d(robot.nv);
  for (long long i = 0, steps = Schedule(options.duration, options.dt).steps; i < steps; ++i) {
    if (dyn_step(robot, a) != DYN_OK || dyn_step(robot, b) != DYN_OK) return HUGE_VAL;
    check(dyn_difference(robot, qa, qb, d.data()));
    for (const double x : d) most = std::max(most, std::abs(x));
  }
  return most;
}

json number_or_null(double x) { return std::isfinite(x) ? json(x) : json(nullptr); }

struct Measured {
  Rollout all;
  json effects;
};

Measured measure(const Robot& robot, const State& state, const SteppingOptions& options, std::uint32_t on) {
  Measured out{roll_out(robot, state, options, on), effects(robot, on)};
  if (!out.all.error.empty()) fail("with all effects: " + out.all.error);
  Progress progress(static_cast<long long>(out.effects.size()), "effects");
  long long done = 0;
  for (json& e : out.effects) {
    progress.at(done++);
    if (!e["active"].get<bool>() || e["name"] == "mimic") continue;
    const std::uint32_t others = on & ~effect_bits(e["name"]);
    const Rollout without = roll_out(robot, state, options, others);
    e["magnitude"] = number_or_null(largest_difference(robot, state, options, on, others));
    e["instructions"] = number_or_null(out.all.instructions - without.instructions);
    e["ns"] = out.all.ns - without.ns;
    if (!without.error.empty()) e["failed_without"] = without.error;
  }
  return out;
}

// The most effects that can be left out together: the least ones first, each that keeps the motion within allowed.
json suggest(const Robot& robot, const State& state, const SteppingOptions& options, std::uint32_t on, const Measured& measured,
             double allowed) {
  std::vector<std::pair<double, std::string>> candidates;
  for (const json& e : measured.effects)
    if (e.contains("magnitude") && !e["magnitude"].is_null() && e["magnitude"].get<double>() < allowed)
      candidates.emplace_back(e["magnitude"].get<double>(), e["name"].get<std::string>());
  std::sort(candidates.begin(), candidates.end());
  std::uint32_t kept = on;
  std::vector<std::string> without;
  double error = 0;
  for (const auto& [magnitude, name] : candidates) {
    const std::uint32_t fewer = kept & ~effect_bits(name);
    const double far = without.empty() ? magnitude : largest_difference(robot, state, options, on, fewer);
    if (far < allowed) kept = fewer, error = far, without.push_back(name);
  }
  const Rollout run = without.empty() ? measured.all : roll_out(robot, state, options, kept);
  json keep = json::array();
  for (const json& e : measured.effects)
    if (e["active"].get<bool>() && std::find(without.begin(), without.end(), e["name"]) == without.end()) keep.push_back(e["name"]);
  return {{"allowed", allowed},
          {"keep", keep},
          {"without", without},
          {"error", error},
          {"ns_per_step", run.ns},
          {"instructions_per_step", number_or_null(run.instructions)},
          {"options", without.empty() ? std::string() : "--without " + join(without, ",")}};
}

std::string amount(const json& x, const char* unit) { return x.is_null() ? "unknown" : short_number(x.get<double>(), 3) + unit; }

json answer_of(const SteppingOptions& options, const Measured& m) {
  return {{"duration", options.duration}, {"dt", options.dt}, {"integrator", options.integrator}, {"ns_per_step", m.all.ns},
          {"instructions_per_step", number_or_null(m.all.instructions)}, {"effects", m.effects}};
}

struct EffectsOptions : SteppingOptions {
  double allowed = 0;
};

void run_effects(const EffectsOptions& given, bool asked) {
  EffectsOptions options = given;
  check_stepping(options);
  if (asked && (!(options.allowed > 0) || !std::isfinite(options.allowed)))
    bad_usage("--suggest must be a positive number of metres and radians.");
  Robot robot(options.robot);
  if (options.ground) robot.add_ground();
  const std::uint32_t on = effects_on(robot, options.effects);
  complete_stepping(robot, options);
  json warnings = json::array();
  const State state = start_of(robot, options, warnings);
  const Measured measured = measure(robot, state, options, on);
  json answer = answer_of(options, measured);
  answer["warnings"] = warnings;
  if (asked) answer["suggested"] = suggest(robot, state, options, on, measured, options.allowed);
  print(options.robot.json ? json_text(answer) : effects_text(answer));
}

}  // namespace

json measure_effects(const Robot& robot, const State& state, const SteppingOptions& options, std::uint32_t on) {
  return answer_of(options, measure(robot, state, options, on));
}

std::string effects_text(const json& a) {
  std::string out = "a step of " + short_number(a["dt"].get<double>()) + " s with all of them takes " +
                    short_number(a["ns_per_step"].get<double>() / 1000, 3) + " us" +
                    (a["instructions_per_step"].is_null()
                         ? ""
                         : ", " + short_number(a["instructions_per_step"].get<double>(), 4) + " instructions") +
                    "; magnitude: largest change within " + short_number(a["duration"].get<double>()) +
                    " s without it, m or rad\n";
  std::vector<std::vector<std::string>> rows = {{"effect", "", "magnitude", "instructions", "us", "bytes", "why"}};
  for (const json& e : a["effects"]) {
    const bool measured = e.contains("magnitude");
    rows.push_back({e["name"], e["active"].get<bool>() ? "on" : "off", measured ? amount(e["magnitude"], "") : "",
                    measured ? amount(e["instructions"], "") : "", measured ? short_number(e["ns"].get<double>() / 1000, 3) : "",
                    std::to_string(e["bytes"].get<long long>()),
                    e["reason"].get<std::string>() +
                        (e.contains("failed_without") ? "; without it: " + e["failed_without"].get<std::string>() : "")});
  }
  if (a["instructions_per_step"].is_null())  // the machine counts none
    for (auto& row : rows) row.erase(row.begin() + 3);
  out += table(rows);
  if (a.contains("suggested")) {
    const json& s = a["suggested"];
    if (s["without"].empty())
      out += "\nnothing can be left out: each effect changes the result by " + short_number(s["allowed"].get<double>()) +
             " or more\n";
    else
      out += "\n" + s["options"].get<std::string>() + " changes the result by " + short_number(s["error"].get<double>(), 3) +
             ", and a step then takes " + short_number(s["ns_per_step"].get<double>() / 1000, 3) + " us\n";
  }
  if (a.contains("warnings"))
    for (const auto& w : a["warnings"]) out += "warning: " + w.get<std::string>() + "\n";
  return out;
}

void add_effects(CLI::App& app) {
  auto options = std::make_shared<EffectsOptions>();
  options->duration = 1;
  CLI::App* command =
      app.add_subcommand("effects", "Each effect of a scene, measured: its price, and the change of the result without it");
  add_stepping_options(*command, *options);
  command->add_option("--duration", options->duration, "Seconds to simulate")->check(decimal)->capture_default_str();
  add_dt_option(*command, *options, "Step, seconds");
  CLI::Option* suggest =
      command
          ->add_option("--suggest", options->allowed,
                       "Find the fewest effects whose result differs by less than this from that of all effects (m, rad)")
          ->check(decimal);
  command->callback([options, suggest] { run_effects(*options, suggest->count() > 0); });
}

}  // namespace cli
