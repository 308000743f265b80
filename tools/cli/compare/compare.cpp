// dyn compare: why two simulations differ: two models, a log and a model, or two logs.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "../effect_choice.hpp"
#include "../files.hpp"
#include "../page/markup.hpp"
#include "explain.hpp"
#include "picture.hpp"
#include "../system/system.hpp"

namespace cli {

namespace {

using namespace compare;

struct CompareOptions : SteppingOptions {
  std::string other, model, layout_a, layout_b, html, svg, integrator_b;
  StateOptions state_b;
  std::vector<std::string> ctrl_b;
  double dt_b = std::numeric_limits<double>::quiet_NaN();
};

// The side of B: what is given for it alone, else what is given for both.
SteppingOptions options_of_b(const CompareOptions& o) {
  SteppingOptions b = o;
  if (!std::isnan(o.dt_b)) b.dt = o.dt_b;
  if (!o.integrator_b.empty()) b.integrator = o.integrator_b;
  if (!o.state_b.q.empty()) b.state.q = o.state_b.q;
  if (!o.state_b.v.empty()) b.state.v = o.state_b.v;
  if (!o.state_b.tau.empty()) b.state.tau = o.state_b.tau;
  if (!o.ctrl_b.empty()) b.ctrl = o.ctrl_b;
  return b;
}

std::unique_ptr<Side> side_of(const std::string& file, SteppingOptions options, json& warnings) {
  options.robot.file = file;
  auto side = std::make_unique<Side>(options.robot, options.ground);
  complete_stepping(side->robot(), options);
  side->stepping = {options.dt,
                    integrator_named(options.integrator).id,
                    effects_on(side->robot(), options.effects),
                    contact_solver_of(options)};
  side->start = start_of(side->robot(), options, warnings);
  return side;
}

json curve_json(const Vector& y) {
  json out = json::array();
  for (const double x : y) out.push_back(std::isfinite(x) ? json(x) : json(nullptr));
  return out;
}
json number_json(double x) { return std::isfinite(x) ? json(x) : json(nullptr); }

json comparison_json(const Comparison& c) {
  const auto last = [](const Vector& x) { return x.empty() ? json(nullptr) : number_json(x.back()); };
  json causes = json::array();
  for (const Cause& x : c.causes) {
    json differences = json::array();
    for (const Difference& d : x.differences)
      differences.push_back(
          {{"what", d.what}, {"a", d.a}, {"b", d.b}, {"explained", d.explained < 0 ? json(nullptr) : json(d.explained)}});
    causes.push_back({{"name", x.name},
                      {"explained", x.explained},
                      {"alone", x.measured ? number_json(x.alone) : json(nullptr)},
                      {"differences", differences},
                      {"remaining", curve_json(x.remaining)}});
  }
  return {{"every", c.every},
          {"begins", c.begins < 0 ? json(nullptr) : json(c.begins)},
          {"beyond_errors", c.beyond < 0 ? json(nullptr) : json(c.beyond)},
          {"where", c.where},
          {"at_end", {{"divergence", last(c.divergence)}, {"error_a", last(c.error_a)}, {"error_b", last(c.error_b)}}},
          {"causes", causes},
          {"unexplained", c.unexplained},
          {"divergence", curve_json(c.divergence)},
          {"error_a", curve_json(c.error_a)},
          {"error_b", curve_json(c.error_b)},
          {"notes", c.notes}};
}

std::string value_text(const json& x) {
  if (x.is_null()) return "-";
  if (x.is_number()) return short_number(x.get<double>());
  if (x.is_string()) return x.get<std::string>();
  std::vector<std::string> words;
  for (const json& y : x) words.push_back(value_text(y));
  if (words.size() > 8) words.resize(8), words.push_back("..");
  return "(" + join(words) + ")";
}

constexpr std::size_t most_shown = 5;  // differences of a cause

std::string comparison_text(const Comparison& c) {
  const auto end = [](const Vector& x) { return x.empty() ? std::string("unknown") : short_number(x.back(), 3); };
  if (c.begins < 0)
    return "no divergence: both are within 1e-10 m and rad of one another at " + std::to_string(c.divergence.size()) +
           " moments\n";
  std::string out = "divergence begins at " + short_number(c.begins) + " s" +
                    (c.beyond < 0          ? ", never beyond the errors of integration"
                     : c.beyond > c.begins ? ", beyond the errors of integration at " + short_number(c.beyond) + " s"
                                           : "") +
                    "; " + end(c.divergence) + " m or rad at " +
                    short_number(c.every * static_cast<double>(c.divergence.size() - 1)) + " s, at " + c.where +
                    "\nerror of integration at the end: A " + end(c.error_a) + ", B " + end(c.error_b) + "\n\n";
  std::vector<std::vector<std::string>> rows = {{"cause", "explains", "alone", "what", "A", "B"}};
  for (const Cause& x : c.causes)
    for (std::size_t k = 0; k < std::min(x.differences.size(), most_shown); ++k) {
      const Difference& d = x.differences[k];
      rows.push_back({k ? "" : x.name, k ? "" : short_number(std::round(1000 * x.explained) / 10, 4) + " %",
                      k || !x.measured || x.alone == 0 ? "" : short_number(x.alone, 3), d.what, value_text(d.a),
                      value_text(d.b)});
      if (k + 1 == most_shown && x.differences.size() > most_shown)
        rows.push_back({"", "", "", std::to_string(x.differences.size() - most_shown) + " more", "", ""});
    }
  if (rows.size() > 1) out += table(rows);
  if (c.unexplained > 0.01)
    out += short_number(std::round(1000 * c.unexplained) / 10, 4) + " % is not explained by what differs\n";
  for (const std::string& n : c.notes) out += "note: " + n + "\n";
  return out;
}

void write_picture(const std::string& path, const std::string& text) {
  errno = 0;
  std::FILE* file = open_file(path, "wb");
  const bool good = file && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  if ((file && std::fclose(file) != 0) || !good) fail(path + ": cannot be written: " + std::strerror(errno) + ".");
}

void run_compare(const CompareOptions& o) {
  check_stepping(o), check_stepping(options_of_b(o));
  for (const std::string* layout : {&o.layout_a, &o.layout_b})
    if (!layout->empty()) value_of("dynConvention", "--layout", *layout);
  check_outputs({{"--html", o.html}, {"--svg", o.svg}},
                inputs_of(o.robot, {{"B", o.other}, {"--model", o.model}, {"--state", o.state.file}}));
  const bool log_a = is_log(o.robot.file), log_b = is_log(o.other);
  if (!o.model.empty() && !(log_a && log_b)) bad_usage("--model is for two logs: here FILE or B is a model itself.");
  if ((!o.layout_a.empty() && !log_a) || (!o.layout_b.empty() && !log_b))
    bad_usage("--layout says how a log is stored, and that file is no log (.csv).");
  json warnings = json::array();
  std::vector<std::pair<std::string, Comparison>> parts;
  const bool own_start = !o.state.file.empty() || !o.state.q.empty() || !o.state_b.q.empty() || !o.configuration.empty();
  if (!log_a && !log_b) {
    const auto a = side_of(o.robot.file, o, warnings), b = side_of(o.other, options_of_b(o), warnings);
    parts.emplace_back("", explain_models(*a, *b, o.duration));
  } else if (log_a && log_b && o.model.empty()) {
    parts.emplace_back("", explain_tables(read_table(o.robot.file), read_table(o.other)));
  } else {
    const auto model = side_of(log_a && log_b ? o.model
                               : log_a        ? o.other
                                              : o.robot.file,
                               log_a ? options_of_b(o) : static_cast<const SteppingOptions&>(o), warnings);
    if (log_a)
      parts.emplace_back(log_b ? "A" : "", explain_log(read_log(o.robot.file, model->robot(), o.layout_a), *model, own_start));
    if (log_b)
      parts.emplace_back(log_a ? "B" : "", explain_log(read_log(o.other, model->robot(), o.layout_b), *model, own_start));
    if (!(log_a && log_b) && log_a == false) warnings.push_back("B is the log: in the table it stands as A, and the model as B");
  }
  json answer = {{"a", o.robot.file}, {"b", o.other}};
  if (!o.model.empty()) answer["model"] = o.model;
  std::string text, pictures;
  for (const auto& [name, c] : parts) {
    if (name.empty())
      answer.update(comparison_json(c));
    else
      answer["log_" + std::string(name == "A" ? "a" : "b")] = comparison_json(c);
    text += name.empty() ? comparison_text(c)
                         : "log " + name + " beside the model (A: the log, B: the model)\n" + comparison_text(c) + "\n";
    pictures += picture(c);
  }
  answer["warnings"] = warnings;
  for (const auto& w : warnings) text += "warning: " + w.get<std::string>() + "\n";
  if (!o.svg.empty()) write_picture(o.svg, picture(parts.back().second) + "\n");
  if (!o.html.empty())
    write_picture(
        o.html,
        "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\"><title>dyn compare</title><style>body{font:14px "
        "system-ui;margin:2em}svg{width:720px;max-width:100%}pre{overflow-x:auto}</style><h1>Why they differ</h1><p>A: " +
            page::escaped(o.robot.file) + "<br>B: " + page::escaped(o.other) + "</p>" + pictures + "<pre>" + page::escaped(text) +
            "</pre></html>\n");
  print(o.robot.json ? json_text(answer) : text);
}

}  // namespace

void add_compare(CLI::App& app) {
  auto options = std::make_shared<CompareOptions>();
  options->duration = 1;
  CLI::App* command = app.add_subcommand("compare", "Why two simulations differ: two models, a log and a model, or two logs");
  command->footer(
      "A and B are robot files, or logs: CSV files (.csv) with columns t, q0, .., v0, .. (MuJoCo: qpos0, .., qvel0, ..), and tau "
      "and ctrl if there were any. Each difference is given to the other side alone: what then is left of the divergence says "
      "how "
      "much it explains.");
  add_stepping_options(*command, *options);
  command->get_option("FILE")->description("A: a URDF, MJCF or .dynb file, or a log (.csv)");
  command->add_option("B", options->other, "The other one")->required()->check(not_empty);
  command->add_option("--duration", options->duration, "Seconds to simulate two models")->check(decimal)->capture_default_str();
  add_dt_option(*command, *options, "Step, seconds");
  command->add_option("--dt-b", options->dt_b, "Step of B, where it is another")->check(seconds);
  command->add_option("--integrator-b", options->integrator_b, "Integrator of B, where it is another");
  const auto list = [&](const char* name, std::vector<std::string>& words, const char* what) {
    command->add_option(name, words, what)->type_name("NUMBERS");
  };
  list("--q-b", options->state_b.q, "Configuration of B, where it is another"),
      list("--v-b", options->state_b.v, "Velocity of B");
  list("--tau-b", options->state_b.tau, "Generalised force of B"), list("--ctrl-b", options->ctrl_b, "Controls of B");
  command->add_option("--model", options->model, "Of two logs: the robot")->check(not_empty)->type_name("FILE");
  const std::string conventions = one_of("dynConvention") + "; default: by the columns' names";
  command->add_option("--layout-a", options->layout_a, "How the log A is stored: " + conventions)->check(not_empty);
  command->add_option("--layout-b", options->layout_b, "How the log B is stored")->check(not_empty);
  command->add_option("--svg", options->svg, "Write the picture to this file")->check(not_empty);
  command->add_option("--html", options->html, "Write a page with picture and table to this file")->check(not_empty);
  command->callback([options] { run_compare(*options); });
}

}  // namespace cli
