// dyn accuracy: what accuracy costs in time on the user's own scene, and the cheapest setting that reaches a target.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "../files.hpp"
#include "../page/markup.hpp"
#include "../effect_choice.hpp"
#include "derivatives.hpp"
#include "distance_sweep.hpp"
#include "plot.hpp"
#include "../system/system.hpp"

namespace cli {
namespace {

using namespace accuracy;

struct AccuracyOptions : SteppingOptions {
  std::string target, budget = "60s", csv, html, svg, reference, resume;
};

// A number with a unit: one of them, or the first if there is none.
double with_unit(const std::string& option, const std::string& text, std::initializer_list<const char*> units,
                 std::string& unit) {
  double x = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  unit = error == std::errc() ? std::string(end, text.data() + text.size()) : "?";
  if (unit.empty()) unit = *units.begin();
  std::string known;
  bool found = false;
  for (const char* u : units) found = found || unit == u, known += (known.empty() ? "" : ", ") + std::string(u);
  if (!found || !(x > 0) || !std::isfinite(x))
    bad_usage(option + ": \"" + shown(text) + "\" is not a positive number with one of the units " + known + ".");
  return x;
}

double by_unit(const Error& e, const std::string& unit) { return unit == "rad" ? e.rad : unit == "J" ? e.energy : e.m; }

json error_json(const Error& e) { return {{"m", e.m}, {"rad", e.rad}, {"J", e.energy}, {"kg m/s", e.momentum}}; }
Error error_of(const json& x) { return {x.at("m"), x.at("rad"), x.at("J"), x.at("kg m/s")}; }

json point_json(const Point& p) {
  const bool good = p.failure.empty();
  json out = {
      {"integrator",
       p.setting.accuracy > 0 && p.setting.integrator.id != DYN_INTEGRATOR_RK45 ? "reference" : p.setting.integrator.name},
      {"solver", solvers()[p.setting.solver].name},
      {"dt", p.setting.accuracy > 0 ? json(nullptr) : json(p.setting.dt)},
      {"accuracy", p.setting.accuracy > 0 ? json(p.setting.accuracy) : json(nullptr)},
      {"tolerance", p.setting.tolerance},
      {"error", good ? json(p.error.m) : json(nullptr)},
      {"errors", good ? error_json(p.error) : json(nullptr)},
      {"wall_s", p.wall_s},
      {"instructions", nullptr},
      {"evaluations", p.evaluations},
      {"steps", p.steps},
      {"penetration", p.penetration},
      {"residual", p.residual},
      {"pareto", p.pareto},
      {"failed", !good}};
  if (!good) out["failure"] = p.failure;
  return out;
}

// dt of an adaptive run: the time between its samples, which the steps end at.
std::string sim_options(const Point& p, double duration, bool contact) {
  std::string out = p.setting.accuracy > 0
                        ? "--accuracy " + short_number(p.setting.accuracy) + " --dt " +
                              short_number(duration / (accuracy::samples * p.setting.parts), 17) +
                              (p.setting.integrator.id == DYN_INTEGRATOR_RK45 ? " --integrator rk45" : "")
                        : "--integrator " + std::string(p.setting.integrator.name) + " --dt " + short_number(p.setting.dt);
  if (contact)
    out += " --solver " + std::string(solvers()[p.setting.solver].name) + " --tolerance " + short_number(p.setting.tolerance);
  return out;
}

std::string in_c(const Point& p) {
  static constexpr const char* names[] = {
      "DYN_INTEGRATOR_SEMI_IMPLICIT_EULER", "DYN_INTEGRATOR_RK4",  "DYN_INTEGRATOR_IMPLICIT_FAST",
      "DYN_INTEGRATOR_IMPLICIT_MIDPOINT",   "DYN_INTEGRATOR_RK45", "DYN_INTEGRATOR_REFERENCE"};
  return std::string("options.integrator = ") + names[p.setting.integrator.id] + "; " +
         (p.setting.accuracy > 0 ? "options.accuracy = " + short_number(p.setting.accuracy)
                                 : "options.dt = " + short_number(p.setting.dt)) +
         "; dyn_data_set_step_options(model, data, &options);" +
         (p.setting.accuracy > 0 ? " dyn_advance(model, data, duration);" : " dyn_step(model, data);");
}

// Points of runs before and what they were measured from, in a file: one JSON object a line, the first one says of which scene.
class Store {
 public:
  Store(const std::string& path, const Robot& robot, const std::string& scene) : path_(path) {
    if (path.empty()) return;
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored))
      fail(path + ": cannot be written and read again, as --resume needs: it is no regular file.");
    std::ifstream in(path);
    std::string line;
    const bool fresh = !std::getline(in, line);
    bool whole = true;
    if (!fresh) {
      json head;
      try {
        head = json::parse(line);
      } catch (const json::exception&) {
        fail(path + ": is not a file of points from dyn accuracy --resume.");
      }
      if (!head.is_object() || head.value("scene", "") != scene)
        fail(path + ": holds points of another scene: name another file.");
      while (std::getline(in, line)) {
        whole = !in.eof();
        try {  // a last line that was cut short is made again
          take(robot, json::parse(line));
        } catch (const json::exception&) {
        } catch (const Failure&) {
        }
      }
    }
    file_ = open_file(path, fresh ? "wb" : "ab");
    if (!file_) fail(path + ": cannot be written: " + std::strerror(errno) + ".");
    if (fresh) put({{"scene", scene}});
    if (!whole) std::fputc('\n', file_);
  }
  ~Store() {
    if (file_) std::fclose(file_);
  }
  Store(const Store&) = delete;
  const Point* find(const std::string& key) const {
    const auto at = known_.find(key);
    return at == known_.end() ? nullptr : &at->second;
  }
  void add(const std::string& key, const Point& p) {
    if (!file_) return;
    json x = point_json(p);
    x["key"] = key, x["parts"] = p.setting.parts, x["integrator_id"] = static_cast<int>(p.setting.integrator.id),
    x["samples"] = json_of(p.samples);
    put(x);
  }
  // One of this contact solver, for which as much time was allowed
  const Reference* reference(const std::string& solver, double seconds) const {
    return solver == solver_ && seconds <= seconds_ ? &reference_ : nullptr;
  }
  void add(const Reference& r, const std::string& solver, double seconds) {
    if (file_)
      put({{"reference",
            {{"samples", json_of(r.run.samples)},
             {"kind", r.kind},
             {"uncertainty", error_json(r.uncertainty)},
             {"confidence", r.confidence},
             {"smooth", r.smooth},
             {"statistics", r.statistics}}},
           {"solver", solver},
           {"seconds", seconds}});
  }

 private:
  void put(const json& x) {
    const std::string line = x.dump() + "\n";
    if (std::fwrite(line.data(), 1, line.size(), file_) != line.size() || std::fflush(file_) != 0)
      fail(path_ + ": writing failed: " + std::strerror(errno) + ".");
  }
  void take(const Robot& robot, const json& x) {
    if (x.contains("reference")) {
      const json& r = x.at("reference");
      Reference y;
      y.run.samples = samples_of(robot, r.at("samples")), y.kind = r.at("kind"), y.uncertainty = error_of(r.at("uncertainty")),
      y.confidence = r.at("confidence"), y.smooth = r.at("smooth");
      y.statistics = r.value("statistics", false);
      reference_ = std::move(y), solver_ = x.at("solver"), seconds_ = x.at("seconds");
      return;
    }
    Point p;
    p.setting.integrator = integrators()[x.at("integrator_id").get<int>()];
    if (!x.at("dt").is_null()) p.setting.dt = x.at("dt");
    if (!x.at("accuracy").is_null()) p.setting.accuracy = x.at("accuracy");
    p.setting.solver = solver_named(x.at("solver")).id, p.setting.tolerance = x.at("tolerance"), p.setting.parts = x.at("parts");
    if (!x.at("errors").is_null()) p.error = error_of(x.at("errors")), p.samples = samples_of(robot, x.at("samples"));
    p.wall_s = x.at("wall_s"), p.evaluations = x.at("evaluations"), p.steps = x.at("steps"), p.penetration = x.at("penetration"),
    p.residual = x.at("residual");
    p.failure = x.value("failure", "");
    known_[x.at("key")] = p;
  }
  std::string path_;
  std::map<std::string, Point> known_;
  Reference reference_;
  std::string solver_;  // of it, and the budget
  double seconds_ = 0;
  std::FILE* file_ = nullptr;
};

void write(const std::string& path, const std::string& text) {
  errno = 0;
  std::FILE* file = open_file(path, "wb");
  const bool good = file && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  if ((file && std::fclose(file) != 0) || !good) fail(path + ": cannot be written: " + std::strerror(errno) + ".");
}

std::string csv_of(const json& answer) {
  std::string out =
      "what,integrator,solver,dt,accuracy,tolerance,error_m,error_rad,error_J,error_momentum,penetration,residual,wall_s,"
      "evaluations,steps,pareto,failure\n";
  const auto cell = [&](const json& x) {
    return x.is_null()      ? std::string()
           : x.is_string()  ? "\"" + x.get<std::string>() + "\""
           : x.is_boolean() ? std::to_string(int(x.get<bool>()))
                            : x.dump();
  };
  for (const char* list : {"points", "solvers"})
    for (const json& p : answer[list]) {
      out += list;
      for (const char* key : {"integrator", "solver", "dt", "accuracy", "tolerance"}) out += "," + cell(p[key]);
      for (const char* key : {"m", "rad", "J", "kg m/s"})
        out += "," + (p["errors"].is_null() ? std::string() : cell(p["errors"][key]));
      for (const char* key : {"penetration", "residual", "wall_s", "evaluations", "steps", "pareto"}) out += "," + cell(p[key]);
      out += "," + (p.contains("failure") ? cell(p["failure"]) : std::string()) + "\n";
    }
  return out;
}

std::string short_json(const json& x) { return x.is_null() ? "" : short_number(x.get<double>(), 3); }

std::vector<std::vector<std::string>> rows_of(const json& points, bool by_tolerance) {
  std::vector<std::vector<std::string>> rows = {{"", by_tolerance ? "solver" : "integrator",
                                                 by_tolerance ? "tolerance" : "dt or accuracy", "m", "rad", "J", "kg m/s",
                                                 "penetration", "residual", "time, ms", "evaluations", ""}};
  for (const json& p : points) {
    std::vector<std::string> row = {p["pareto"].get<bool>() ? "*" : "",
                                    p[by_tolerance ? "solver" : "integrator"].get<std::string>(),
                                    by_tolerance        ? short_json(p["tolerance"])
                                    : p["dt"].is_null() ? "accuracy " + short_json(p["accuracy"])
                                                        : short_json(p["dt"])};
    for (const char* key : {"m", "rad", "J", "kg m/s"}) row.push_back(p["errors"].is_null() ? "" : short_json(p["errors"][key]));
    row.insert(row.end(), {short_json(p["penetration"]), short_json(p["residual"]),
                           short_number(1000 * p["wall_s"].get<double>(), 3), std::to_string(p["evaluations"].get<long long>()),
                           p.contains("failure") ? "failed: " + p["failure"].get<std::string>() : ""});
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string derivative_text(const json& list) {
  std::vector<std::vector<std::string>> rows = {{"step", "forward", "central", "extrapolated"}};
  std::map<double, std::map<std::string, std::string>> by_step;
  std::map<std::string, double> time;
  for (const json& d : list)
    by_step[-d["step"].get<double>()][d["method"]] = short_json(d["error"]), time[d["method"]] = d["wall_s"];
  for (const auto& [step, errors] : by_step) {
    if (step == 0) continue;
    const auto at = [&](const char* m) { return errors.count(m) ? errors.at(m) : std::string(); };
    rows.push_back({short_number(-step), at("forward"), at("central"), at("extrapolated")});
  }
  const auto us = [&](const char* m) { return short_number(1e6 * time[m], 3); };
  rows.push_back({"time, us", us("forward"), us("central"), us("extrapolated")});
  return "derivatives of forward dynamics: error of differences relative to the analytic ones, which take " + us("analytic") +
         " us\n" + table(rows);
}

std::string text_of(const json& a, const std::vector<Point>& points, const std::string& distances) {
  const json& r = a["reference"];
  std::string out = "reference: " + r["kind"].get<std::string>() + "; itself known to " + short_json(r["uncertainty"]["m"]) +
                    " m, " + short_json(r["uncertainty"]["rad"]) + " rad (" + r["confidence"].get<std::string>() +
                    ")\n\nerrors are the largest over " + std::to_string(accuracy::samples) +
                    " moments, of the places of all frames; * nothing is both cheaper and nearer\n" +
                    table(rows_of(a["points"], false)) + "\n" + chart(points);
  if (!a["solvers"].empty())
    out += "\ncontact solvers at steps of " + short_json(a["solvers"][0]["dt"]) + " s: distance from the tightest one\n" +
           table(rows_of(a["solvers"], true));
  if (!distances.empty()) out += "\ndistances: error of each method and tolerance\n" + distances;
  if (!a["derivatives"].empty()) out += "\n" + derivative_text(a["derivatives"]);
  if (a.contains("recommended")) {
    const json& x = a["recommended"];
    out += x.is_null()
               ? "\nno setting reached the target within the budget: give it more time (--budget), or a larger target\n"
               : "\ncheapest for " + a["target"].get<std::string>() + ": " + x["command"].get<std::string>() + "\n  error " +
                     short_json(x["error"]) + ", " + short_json(x["margin"]) + " times below the target, " +
                     short_json(x["verified"]) + " in a run of its own; " +
                     short_number(1000 * x["wall_s"].get<double>(), 3) + " ms\n  in C: " + x["c"].get<std::string>() + "\n";
  }
  for (const auto& w : a["warnings"]) out += "warning: " + w.get<std::string>() + "\n";
  return out;
}

std::string html_of(const json& a, const std::vector<Point>& points, const std::string& text) {
  return "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\"><title>dyn accuracy</title><style>body{font:14px "
         "system-ui;margin:2em}svg{width:620px;max-width:48%}pre{overflow-x:auto}</style>"
         "<h1>What accuracy costs: " +
         page::escaped(a["name"]) + "</h1>" + svg(points, Work::Seconds) + svg(points, Work::Evaluations) + "<pre>" +
         page::escaped(text) + "</pre></html>\n";
}

std::string quoted(const std::string& word) {
  return !word.empty() && word.find_first_of(" \t'\"$&;()*?<>|\\") == word.npos ? word : "'" + word + "'";
}

void run_accuracy(const AccuracyOptions& given, const std::vector<std::string>& words) {
  AccuracyOptions options = given;
  check_stepping(options);
  std::string unit, second;
  const double target = options.target.empty() ? 0 : with_unit("--target", options.target, {"m", "rad", "J"}, unit);
  const double seconds = with_unit("--budget", options.budget, {"s", "min"}, second) * (second == "min" ? 60 : 1);
  check_outputs({{"--csv", options.csv}, {"--svg", options.svg}, {"--html", options.html}, {"--resume", options.resume}},
                inputs_of(options.robot, {{"--state", options.state.file}, {"--reference", options.reference}}));
  Robot robot(options.robot);
  if (options.ground) robot.add_ground();
  const std::uint32_t on = effects_on(robot, options.effects);
  complete_stepping(robot, options);
  json warnings = json::array();
  const Scene scene{robot, start_of(robot, options, warnings), on, options.duration};
  const Budget budget(seconds);
  json identity = {{"file", options.robot.file}, {"q", scene.start.q},           {"v", scene.start.v},
                   {"tau", scene.start.tau},     {"ctrl", scene.start.ctrl},     {"effects", on},
                   {"ground", options.ground},   {"duration", options.duration}, {"reference", options.reference}};
  Store store(options.resume, robot, identity.dump());
  Setting contact;
  contact.solver = solver_named(options.solver).id, contact.tolerance = options.tolerance;
  Reference reference;
  const std::string solver = options.solver + " " + short_number(options.tolerance, 17);
  if (const Reference* earlier = options.reference.empty() ? store.reference(solver, seconds) : nullptr) {
    reference = *earlier;
  } else if (options.reference.empty()) {
    reference = make_reference(scene, contact, budget);
    store.add(reference, solver, seconds);
  } else {
    StateOptions given;
    given.file = options.reference;
    const State end = read_state(robot, given);
    reference = given_reference(scene, end.q, end.v);
  }
  const auto known = [&](const std::string& key) { return store.find(key); };
  std::vector<Point> points =
      integrator_sweep(scene, reference, contact, budget, known, [&](const Point& p) { store.add(key_of(p.setting), p); });
  const double doubt = by_unit(reference.uncertainty, unit);
  const Point* best = nullptr;
  if (reference.statistics && unit == "rad")
    warnings.push_back("this motion amplifies errors: there is no error in rad, and none can be recommended; name m or J");
  else if (target > 0)
    best = refine_cheapest(
        scene, reference, budget, [&](const Error& e) { return by_unit(e, unit) + doubt <= 0.8 * target; }, points);
  std::vector<Point> by_solver;
  if (!reference.smooth)
    by_solver = solver_sweep(scene, std::min(options.dt, scene.duration / accuracy::samples), budget, known,
                             [&](const Point& p) { store.add("solver " + key_of(p.setting), p); });
  json answer = {
      {"name", dyn_model_name(robot)},
      {"metric", "largest distance of any frame from the reference, m, over " + std::to_string(accuracy::samples) + " moments"},
      {"duration", options.duration},
      {"reference",
       {{"kind", reference.kind},
        {"uncertainty", error_json(reference.uncertainty)},
        {"confidence", reference.confidence},
        {"smooth", reference.smooth},
        {"statistics", reference.statistics}}},
      {"points", json::array()},
      {"solvers", json::array()},
      {"distances", json::array()},
      {"derivatives", json::array()}};
  for (const Point& p : points) answer["points"].push_back(point_json(p));
  for (const Point& p : by_solver) answer["solvers"].push_back(point_json(p));
  if (std::all_of(points.begin(), points.end(), [](const Point& p) { return !p.failure.empty(); }))
    warnings.push_back("no setting gave a result within the budget of " + options.budget +
                       ": give it more time, or a shorter --duration");
  std::string distances;
  if (dyn_model_npairs(robot) > 0 && budget.left() > 0) {
    std::vector<Vector> states;
    for (const Sample& s : reference.run.samples) states.push_back(s.q);
    const auto sweep = distance_sweep(robot, states, 3);
    answer["distances"] = sweep_json(sweep);
    std::vector<DistanceCost> together;  // the kinds one by one are in the JSON, and in dyn distance --sweep
    std::copy_if(sweep.begin(), sweep.end(), std::back_inserter(together), [](const DistanceCost& d) { return d.kind == "all"; });
    distances = sweep_text(together);
  }
  if (budget.left() > 0)
    for (const DerivativeCost& d : derivative_sweep(scene))
      answer["derivatives"].push_back({{"method", d.method}, {"step", d.step}, {"error", d.error}, {"wall_s", d.wall_s}});
  if (target > 0) {
    answer["target"] = short_number(target) + unit;
    if (!best) {
      answer["recommended"] = nullptr;
    } else {
      std::string command = "dyn sim";
      for (const std::string& w : words) command += " " + quoted(w);
      command +=
          " --duration " + short_number(options.duration, 17) + " " + sim_options(*best, options.duration, !reference.smooth);
      answer["recommended"] = point_json(*best);
      json& x = answer["recommended"];
      x["error"] = by_unit(best->error, unit), x["unit"] = unit,
      x["margin"] = target / std::max(by_unit(best->error, unit), 1e-300), x["command"] = command, x["c"] = in_c(*best);
      x["options"] = sim_options(*best, options.duration, !reference.smooth);
      const JointRun again = run_within(scene, best->setting, std::max(budget.share(), 20 * best->wall_s));
      if (!again.error.empty()) fail("the recommended setting, run again: " + again.error);
      x["verified"] = by_unit(error_from(scene, reference, again.samples), unit);
    }
  }
  answer["warnings"] = warnings;
  const std::string text = text_of(answer, points, distances);
  if (!options.csv.empty()) write(options.csv, csv_of(answer));
  if (!options.svg.empty()) write(options.svg, svg(points, Work::Seconds) + "\n");
  if (!options.html.empty()) write(options.html, html_of(answer, points, text));
  print(options.robot.json ? json_text(answer) : text);
}

// The words of the command line that say which scene it is: those that dyn sim takes, too.
std::vector<std::string> scene_words(const SteppingOptions& o) {
  std::vector<std::string> out = {o.robot.file};
  const auto flag = [&](bool on, const char* name) {
    if (on) out.push_back(name);
  };
  const auto value = [&](const std::string& x, const char* name, const std::string& standard = "") {
    if (x != standard) out.insert(out.end(), {name, x});
  };
  const auto list = [&](const std::vector<std::string>& x, const char* name) {
    if (!x.empty()) out.insert(out.end(), {name, join(list_of(name, join(x, " ")), ",")});
  };
  flag(o.robot.fixed, "--fixed"), flag(o.robot.floating, "--floating"), flag(o.robot.cos_sin, "--cos-sin"),
      flag(o.ground, "--ground");
  for (const auto& d : o.robot.package_dirs) out.insert(out.end(), {"--package-dir", d});
  value(o.robot.srdf, "--srdf"), value(o.robot.meshes, "--collision-meshes", RobotOptions().meshes),
      value(o.state.file, "--state"), value(o.configuration, "--configuration");
  list(o.state.q, "--q"), list(o.state.v, "--v"), list(o.state.tau, "--tau"), list(o.ctrl, "--ctrl");
  value(o.effects.with, "--effects", "stated"), value(o.effects.without, "--without");
  return out;
}

}  // namespace

void add_accuracy(CLI::App& app) {
  auto options = std::make_shared<AccuracyOptions>();
  options->duration = 1;
  CLI::App* command = app.add_subcommand(
      "accuracy", "The time that accuracy costs on this scene: every integrator and solver, and the cheapest for a target");
  command->footer(
      "Errors are measured from a reference. Smooth motion has order 8 to rounding. Contact has the finest steps that the budget "
      "allows.");
  add_stepping_options(*command, *options);
  command->remove_option(command->get_option("--integrator"));
  command->add_option("--duration", options->duration, "Seconds to simulate")->check(decimal)->capture_default_str();
  add_dt_option(*command, *options, "Step at which contact solvers are compared, seconds");
  command->add_option("--target", options->target, "Allowed error with a unit: 1e-4m, 1e-3rad, 0.1J")->check(not_empty);
  command->add_option("--budget", options->budget, "Time for all runs, with a unit: 60s, 5min")
      ->capture_default_str()
      ->check(not_empty);
  command->add_option("--reference", options->reference, "State file with the exact final state")->check(not_empty);
  command->add_option("--csv", options->csv, "Write all points to this file")->check(not_empty);
  command->add_option("--svg", options->svg, "Write the diagram to this file")->check(not_empty);
  command->add_option("--html", options->html, "Write a page with diagrams and tables to this file")->check(not_empty);
  command->add_option("--resume", options->resume, "Keep points in this file, and reuse those in it")->check(not_empty);
  command->callback([options] { run_accuracy(*options, scene_words(*options)); });
}

}  // namespace cli
