// dyn sim: a robot under a constant tau, or one over time, with its contacts, limits and constraints, and an account of energy,
// error and time.
#include <CLI/CLI.hpp>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <algorithm>

#include "drive.hpp"
#include "effect_choice.hpp"
#include "files.hpp"
#include "ledger.hpp"
#include "page/recording.hpp"
#include "stepping.hpp"
#include "system/system.hpp"

namespace cli {
namespace {

struct SimOptions : SteppingOptions {
  double accuracy = 0;
  std::string csv, html, postmortem, forces;
  bool dt_given = false, accuracy_given = false, no_error_estimate = false, profile = false, ledger = false;
};

constexpr double max_csv_bytes = 16e9;

// t, q, v, tau when given, energies: 17 digits.
class Csv {
 public:
  Csv(const std::string& path, const Robot& robot, bool with_tau) : path_(path) {
    file_ = open_file(path, "wb");
    if (!file_) fail(path + ": cannot be written: " + std::strerror(errno) + ".");
    const auto columns = [&](const char* name, int n) {
      for (int i = 0; i < n; ++i) line_ += std::string(",") + name + std::to_string(i);
    };
    line_ = "t";
    columns("q", robot.nq);
    columns("v", robot.nv);
    if (with_tau) columns("tau", robot.nv);
    line_ += ",kinetic,potential,mechanical\n";
  }
  ~Csv() {  // after a failure: what was computed is kept
    if (!file_) return;
    std::fwrite(line_.data(), 1, line_.size(), file_);
    std::fclose(file_);
  }
  Csv(const Csv&) = delete;
  void row(double t, const double* q, int nq, const double* v, int nv, const Vector* tau, double kinetic, double potential) {
    append_number(line_, t);
    const auto add = [&](const double* x, int n) {
      for (int i = 0; i < n; ++i) line_ += ',', append_number(line_, x[i]);
    };
    add(q, nq);
    add(v, nv);
    if (tau) add(tau->data(), nv);
    const double energies[] = {kinetic, potential, kinetic + potential};
    add(energies, 3);
    line_ += '\n';
    if (line_.size() > 1 << 16) flush();
  }
  void flush() {
    errno = 0;
    if (std::fwrite(line_.data(), 1, line_.size(), file_) != line_.size()) fail_();
    line_.clear();
  }
  void close() {
    flush();
    std::FILE* file = file_;
    file_ = nullptr;
    errno = 0;
    if (std::fclose(file) != 0) fail_();
  }

 private:
  [[noreturn]] void fail_() const { fail(path_ + ": writing failed: " + std::strerror(errno) + "."); }
  std::string path_, line_;
  std::FILE* file_ = nullptr;
};

// First passing of each coordinate's limit, where limits are switched off.
class Limits {
 public:
  explicit Limits(const Robot& robot)
      : robot_(robot),
        lower_(dyn_model_array(robot, DYN_MODEL_ARRAY_LOWER_LIMIT)),
        upper_(dyn_model_array(robot, DYN_MODEL_ARRAY_UPPER_LIMIT)),
        said_(robot.nq) {}
  void look(const double* q, double t, json& warnings) {
    for (int i = 0; i < robot_.nq; ++i) {
      if (said_[i] || (q[i] >= lower_[i] && q[i] <= upper_[i])) continue;
      said_[i] = true;
      warnings.push_back("q[" + std::to_string(i) + "] (joint " + joint_of(robot_, i) + ") is " + short_number(q[i]) +
                         " at t = " + short_number(t) + " s, beyond its limits [" + short_number(lower_[i]) + ", " +
                         short_number(upper_[i]) + "]: --effects limits keeps it within");
    }
  }

 private:
  const Robot& robot_;
  const double *lower_, *upper_;
  std::vector<bool> said_;
};

// The last states, for dyn sim --postmortem.
class Blackbox {
 public:
  Blackbox(const Robot& robot, const std::string& path) : robot_(robot), path_(path) {}
  void record(double t, const double* q, const double* v) {
    if (path_.empty()) return;
    if (last_.size() == kept) last_.erase(last_.begin());
    last_.push_back({t, Vector(q, q + robot_.nq), Vector(v, v + robot_.nv)});
  }
  // The states before the failure, and the joints by how their speeds grew over them; each state is one that --state takes.
  void write(const std::string& error, double h, const std::string& integrator, const State& start) const {
    if (path_.empty()) return;
    json out = {{"error", error}, {"dt", h}, {"integrator", integrator}, {"states", json::array()}, {"grew", json::array()}};
    for (const Entry& e : last_)
      out["states"].push_back({{"time", e.t}, {"q", e.q}, {"v", e.v}, {"tau", start.tau}, {"ctrl", start.ctrl}});
    std::vector<std::pair<double, int>> growth;
    for (int j = 1; j < robot_.njoints; ++j) {
      const dynJointInfo joint = robot_.joint(j);
      const auto speed = [&](const Entry& e) {
        double most = 0;
        for (int k = joint.idx_v; k < joint.idx_v + joint.nv; ++k) most = std::max(most, std::abs(e.v[k]));
        return most;
      };
      growth.emplace_back(speed(last_.back()) / std::max(speed(last_.front()), 1e-9), j);
    }
    std::sort(growth.rbegin(), growth.rend());
    for (std::size_t k = 0; k < std::min<std::size_t>(growth.size(), 10); ++k)
      out["grew"].push_back({{"joint", robot_.joint(growth[k].second).name}, {"factor", growth[k].first}});
    std::FILE* file = open_file(path_, "wb");
    const std::string text = json_text(out);
    if (!file || std::fwrite(text.data(), 1, text.size(), file) != text.size() || std::fclose(file) != 0)
      fail(path_ + ": cannot be written: " + std::strerror(errno) + "; and the simulation failed: " + error);
  }

 private:
  static constexpr std::size_t kept = 100;
  struct Entry {
    double t;
    Vector q, v;
  };
  const Robot& robot_;
  std::string path_;
  std::vector<Entry> last_;
};

// By the same simulation at half the step, or for a third of the accuracy (dyn_data_error_bar).
dynErrorBar error_bar(const Robot& robot, const Data& data, const State& start, const SimOptions& options,
                      const ContactSolver& solver, std::uint32_t effects, const Schedule& schedule, const Drive* drive) {
  const bool adaptive = options.accuracy > 0;
  const dynIntegrator integrator = integrator_named(options.integrator).id;
  const Data fine(robot, DYN_PART_SIMULATION, effects);
  set_start(robot, fine, start);
  const double* time = state_view(robot, fine, "time");
  Progress progress(schedule.steps);
  for (long long i = 0; i < schedule.steps; ++i) {
    const double h = schedule.length(i), accuracy = options.accuracy * h / options.duration / 3;
    const int parts = adaptive ? 1 : 2;
    set_stepping(robot, fine, integrator, h / parts, accuracy, {solver.type, solver.tolerance});
    for (int part = 0; part < parts; ++part) {
      if (drive) drive->act(robot, fine, *time);
      if ((adaptive ? dyn_advance(robot, fine, h) : dyn_step(robot, fine)) != DYN_OK)
        fail(std::string("the finer run failed: ") + dyn_last_error());
    }
    progress.at(i);
  }
  dynErrorBar bar{};
  bar.struct_size = sizeof bar;
  check(dyn_data_error_bar(robot, data, fine, &bar));
  return bar;
}

std::string text_of(const json& a) {
  const auto number = [](const json& x) { return x.is_null() ? std::string("unknown") : short_number(x.get<double>()); };
  std::string out = number(a["duration"]) + " s in " + std::to_string(a["steps"].get<long long>()) +
                    (a["steps"] == 1 ? " step of " : " steps of ") + number(a["dt"]) + " s (" +
                    a["integrator"].get<std::string>() + ")\n";
  out += "wall time         " + number(a["wall_s"]) + " s: " + number(a["real_time_factor"]) + " times real time\n";
  out += "energy            " + number(a["energy"]["initial"]) + " J at the start, " + number(a["energy"]["final"]) +
         " J at the end, largest drift " + number(a["energy"]["drift_max"]) + " J\n";
  out += "error estimate    " + number(a["error_estimate"]) + " (" + a["error_estimate_method"].get<std::string>() + ")\n";
  if (a["contacts_max"] > 0 || a["residual_max"] > 0)
    out += "contact           up to " + std::to_string(a["contacts_max"].get<int>()) + " points, deepest " +
           number(a["penetration_max"]) + " m, largest residual " + number(a["residual_max"]) + " (" +
           a["solver"].get<std::string>() + ")\n";
  if (a.contains("ledger")) out += Ledger::text(a["ledger"]);
  for (const char* key : {"q", "v"}) {
    out += std::string(key) + "                ";
    for (const auto& x : a[key]) out += " " + short_number(x.get<double>(), 9);
    out += "\n";
  }
  for (const auto& e : a["effects"])
    if (e["active"].get<bool>())
      out += "effect            " + e["name"].get<std::string>() + ": " + e["reason"].get<std::string>() + "\n";
  if (a.contains("profile")) out += "\n" + effects_text(a["profile"]);
  for (const auto& w : a["warnings"]) out += "warning           " + w.get<std::string>() + "\n";
  return out;
}

constexpr double profiled_s = 2;

void write_html(const std::string& html, const SimOptions& options, const Robot& robot, const page::Recording& recording,
                const json& answer, const json& notes) {
  page::Pack pack;
  json head = page::head("simulation", options.robot, robot, recording, pack, notes);
  head["answer"] = answer;
  page::write_file(options.html, page::filled(html, head, pack));
}

void run_sim(const SimOptions& given) {
  SimOptions options = given;
  check_stepping(options);
  if (options.accuracy_given && (!(options.accuracy > 0) || !std::isfinite(options.accuracy)))
    bad_usage("--accuracy must be a positive number.");
  const ContactSolver solver = contact_solver_of(options);
  const bool adaptive = options.accuracy > 0;
  const bool page = !options.html.empty();
  const double rows = options.duration / 100;
  check_outputs({{"--csv", options.csv}, {"--html", options.html}, {"--postmortem", options.postmortem}},
                inputs_of(options.robot, {{"--state", options.state.file}, {"--tau-csv", options.forces}}));
  const std::string html = page ? page::page_template() : "";  // first of all: whether there is one

  json warnings = json::array();
  Robot robot(options.robot);
  if (options.ground) robot.add_ground();
  const std::uint32_t on = effects_on(robot, options.effects);
  complete_stepping(robot, options);
  const auto& integrator = integrator_named(options.integrator);
  const double dt = !adaptive || options.dt_given ? options.dt : page ? std::min(rows, 1.0 / 60) : rows;
  const Schedule schedule(options.duration, dt);
  const Data data(robot, DYN_PART_SIMULATION | DYN_PART_ENERGY, on);
  State state = start_of(robot, options, warnings);
  if (!options.forces.empty() && state.has_tau) bad_usage("--tau-csv and a constant tau exclude each other: keep one.");
  const std::unique_ptr<Drive> drive = options.forces.empty() ? nullptr : std::make_unique<Drive>(options.forces, robot);
  const auto act = [&](double time) {
    if (drive) state.tau.assign(drive->at(time), drive->at(time) + robot.nv), state.has_tau = true;
  };
  act(0);
  if (drive && drive->begin() > 0)
    warnings.push_back("the first row of --tau-csv is at t = " + short_number(drive->begin()) + " s: tau is zero until then");
  const State start = state;  // of it what effects take and change is measured
  const double bytes = 22.0 * static_cast<double>(schedule.steps) * (4 + robot.nq + robot.nv * (state.has_tau ? 2 : 1));
  if (!options.csv.empty() && bytes > max_csv_bytes)
    fail("--csv would be about " + short_number(bytes / 1e9, 3) + " GB, more than " + short_number(max_csv_bytes / 1e9) +
         " GB: take a larger --dt, or leave it out.");

  for (const std::string& note : misalignment_notes(robot, start.q.data())) warnings.push_back(note);
  set_start(robot, data, state);
  double kinetic, potential;
  check(dyn_energy(robot, data, nullptr, nullptr, &kinetic, &potential));
  const double initial = kinetic + potential;
  const double *q = state_view(robot, data, "q"), *v = state_view(robot, data, "v"), *time = state_view(robot, data, "time");
  std::unique_ptr<Csv> csv;
  const Vector* tau = state.has_tau ? &state.tau : nullptr;
  const auto record = [&] {
    if (csv) csv->row(*time, q, robot.nq, v, robot.nv, tau, kinetic, potential);
  };
  std::unique_ptr<page::Recording> recording;
  if (page) recording = std::make_unique<page::Recording>(robot, on);
  const auto film = [&](const Ledger* ledger, double step_s) {
    if (recording && recording->due(*time))
      recording->add(data, {*time, kinetic, potential, q, v, state.tau.data()}, ledger, step_s);
  };
  if (!options.csv.empty()) csv = std::make_unique<Csv>(options.csv, robot, state.has_tau);
  record();
  Ledger ledger;
  const bool keep_ledger = options.ledger || page;
  film(keep_ledger ? &ledger : nullptr, 0);

  for (const auto& effect : effects(robot, on)) {
    const std::string name = effect["name"], reason = effect["reason"];
    if (reason.find("switched off") != std::string::npos) warnings.push_back(name + ": " + reason + ": --effects applies it");
  }
  Blackbox blackbox(robot, options.postmortem);
  blackbox.record(*time, q, v);
  for (const double x : state.tau)
    if (x != 0) {
      warnings.push_back("tau is not zero: the energy drift includes its work");
      break;
    }

  using Clock = std::chrono::steady_clock;
  Limits limits(robot);
  const bool watch_limits = !(on & DYN_EFFECT_LIMITS);
  if (watch_limits) limits.look(q, *time, warnings);
  Clock::duration wall{};
  double drift_max = 0, estimate = 0;
  long long steps = 0, evaluations = 0, dropped = 0, unsolved = 0;
  int contacts_max = 0, rows_max = 0, sleeping = 0;
  double penetration_max = 0, residual_max = 0;
  {
    Progress progress(schedule.steps);
    for (long long i = 0; i < schedule.steps; ++i) {
      const double h = schedule.length(i);
      if (drive) drive->act(robot, data, *time);
      const auto before = Clock::now();
      set_stepping(robot, data, integrator.id, h, options.accuracy * h / options.duration, solver, keep_ledger);
      const dynStatus status = adaptive ? dyn_advance(robot, data, h) : dyn_step(robot, data);
      const auto step = Clock::now() - before;
      wall += step;
      dynStepReport report{};
      report.struct_size = sizeof report;
      check(dyn_data_step_report(robot, data, &report));
      if (keep_ledger) ledger.add(robot, data);
      steps += report.steps, evaluations += report.evaluations, estimate += report.error_estimate, dropped += report.dropped,
          unsolved += report.unsolved;
      sleeping = report.sleeping;
      contacts_max = std::max(contacts_max, report.contacts), rows_max = std::max(rows_max, report.rows);
      penetration_max = std::max(penetration_max, report.penetration), residual_max = std::max(residual_max, report.residual);
      if (status != DYN_OK || dyn_energy(robot, data, nullptr, nullptr, &kinetic, &potential) != DYN_OK) {
        const std::string error = dyn_last_error();
        blackbox.write(error, h, options.integrator, state);
        if (page)
          write_html(html, options, robot, *recording, {},
                     {"the simulation failed at t = " + short_number(*time, 9) + " s: " + error});
        fail("step " + std::to_string(i + 1) + " at t = " + short_number(*time, 9) + " s: " + error);
      }
      drift_max = std::max(drift_max, std::abs(kinetic + potential - initial));
      act(*time);
      record();
      film(&ledger, std::chrono::duration<double>(step).count() / static_cast<double>(std::max<std::int64_t>(report.steps, 1)));
      blackbox.record(*time, q, v);
      if (watch_limits) limits.look(q, *time, warnings);
      progress.at(i);
    }
  }
  if (csv) csv->close();

  const double wall_s = std::chrono::duration<double>(wall).count();
  json answer = {{"duration", options.duration}, {"steps", steps}, {"evaluations", evaluations}, {"wall_s", wall_s}};
  answer["real_time_factor"] = options.duration / std::max(wall_s, 1e-9);
  answer["q"] = vector_json(q, robot.nq);
  answer["v"] = vector_json(v, robot.nv);
  answer["time"] = *time;
  answer["energy"] = {{"initial", initial}, {"final", kinetic + potential}, {"drift_max", drift_max}};
  answer["contacts_max"] = contacts_max;
  answer["penetration_max"] = penetration_max;
  answer["residual_max"] = residual_max;
  answer["unsolved"] = unsolved;
  answer["sleeping"] = sleeping;
  answer["integrator"] =
      adaptive && integrator.id != DYN_INTEGRATOR_RK45 ? "reference" : options.integrator;  // whose methods an accuracy takes
  answer["solver"] = rows_max > 0 ? options.solver : "none";
  answer["dt"] = adaptive ? options.duration / static_cast<double>(std::max(steps, 1LL)) : schedule.length(0);
  if (adaptive) answer["accuracy"] = options.accuracy, answer["step_errors"] = estimate;
  if (options.no_error_estimate) {
    answer["error_estimate"] = nullptr, answer["error_estimate_method"] = "not asked for";
  } else {
    answer["error_estimate"] = nullptr;
    answer["error_estimate_method"] = adaptive ? "bound by a run for a third of the accuracy" : "bound by a run at half the step";
    try {
      const dynErrorBar bar = error_bar(robot, data, start, options, solver, on, schedule, drive.get());
      if (bar.lost)
        warnings.push_back("no digit of the final state is known: the motion amplifies errors, and a finer run ends elsewhere; q is "
                           "one of many that are as likely, and a shorter --duration is known better");
      else answer["error_estimate"] = bar.q;
    } catch (const Failure& failure) {  // what was simulated stands
      warnings.push_back("no error estimate: " + failure.message);
    }
  }
  if (unsolved)
    warnings.push_back(
        std::to_string(unsolved) +
        " contact problems ended above --tolerance: their impulses are the best within --max-iterations and --time-budget");
  if (adaptive && estimate > 3 * options.accuracy)
    warnings.push_back("the accuracy " + short_number(options.accuracy) +
                       " was not reached: errors of the steps are estimated to add up to " + short_number(estimate, 2) +
                       ". Where contacts open and close again, and where motion is chaotic, shorter steps do not help: q is one "
                       "of many that are as likely; a shorter --duration is known better");
  if (dropped)
    warnings.push_back(std::to_string(dropped) +
                       " contact points were left out in all steps, the shallowest: raise --contact-capacity");
  if (options.ledger) answer["ledger"] = ledger.answer();
  answer["effects"] = effects(robot, on);
  answer["warnings"] = warnings;
  if (options.profile) answer["profile"] = measure_effects(robot, start, options, on);
  if (page) {
    json shown = answer;
    shown["ledger"] = ledger.answer();
    if (!options.profile) {
      SteppingOptions beginning = options;  // what effects cost is told by the first seconds
      beginning.duration = std::min(options.duration, profiled_s);
      if (!adaptive) shown["profile"] = measure_effects(robot, start, beginning, on);
    }
    write_html(html, options, robot, *recording, shown, warnings);
  }
  print(options.robot.json ? json_text(answer) : text_of(answer));
}

}  // namespace

void add_sim(CLI::App& app) {
  auto options = std::make_shared<SimOptions>();
  CLI::App* command =
      app.add_subcommand("sim", "Simulation under a constant tau or forces over time, with contacts, limits and constraints");
  add_stepping_options(*command, *options);
  command->add_option("--duration", options->duration, "Seconds to simulate")->check(decimal)->required();
  add_dt_option(*command, *options, "Step, seconds; with --accuracy, the time between rows of --csv");
  CLI::Option* accuracy = command
                              ->add_option("--accuracy", options->accuracy,
                                           "Bound on the sum of the steps' errors (m, rad and their rates); step sizes follow")
                              ->check(decimal);
  command->add_option("--csv", options->csv, "Write every step to this file: t, q, v, tau when given, energies")
      ->check(not_empty);
  command
      ->add_option("--tau-csv", options->forces,
                   "Forces over time: a CSV file with columns t, tau0, tau1, ...; each row acts until the next row's t")
      ->check(not_empty);
  command->add_option("--html", options->html, "Write a page to this file: motion, forces, plots, ledger, time of each effect")
      ->check(not_empty);
  command
      ->add_option("--postmortem", options->postmortem,
                   "After a failure, write the last 100 states to this file, and name the joints whose speeds grew most")
      ->check(not_empty);
  command->add_flag("--profile", options->profile, "Measure each effect, as dyn effects does");
  command->add_flag("--ledger", options->ledger, "Print energy and momentum by source, and their defects");
  command->add_flag("--no-error-estimate", options->no_error_estimate, "Skip the second, finer run");
  command->callback([options, accuracy] {
    options->dt_given = !std::isnan(options->dt), options->accuracy_given = accuracy->count() > 0;
    run_sim(*options);
  });
}

}  // namespace cli
