// dyn stress: hard cases against their references.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <set>

#include "case.hpp"
#include "../files.hpp"
#include "../system/system.hpp"
#include "page.hpp"

namespace cli {

namespace {

using namespace stress;

struct StressOptions {
  std::vector<std::string> names;
  std::string html;
  bool json = false, list = false, slow = false;
};

// Cases by their names or their themes; all that are not slow without any.
std::vector<const Case*> chosen(const StressOptions& options) {
  std::vector<const Case*> out;
  std::set<std::string> known, themes, asked(options.names.begin(), options.names.end());
  for (const Case& c : cases()) known.insert(c.name), themes.insert(c.theme);
  for (const auto& name : asked)
    if (!known.count(name) && !themes.count(name)) {
      std::string all;
      for (const Case& c : cases()) all += (all.empty() ? "" : ", ") + std::string(c.name);
      bad_usage("there is no case \"" + shown(name) + "\"; themes: " + join({themes.begin(), themes.end()}) + "; cases: " + all +
                ".");
    }
  for (const Case& c : cases())
    if (asked.count(c.name) || ((asked.empty() || asked.count(c.theme)) && (options.slow || options.list || !c.slow)))
      out.push_back(&c);
  return out;
}

// On a terminal only.
void progress(std::size_t k, std::size_t n, const char* name) {
  if (on_terminal()) std::fprintf(stderr, "\r\033[K%zu of %zu: %s", k + 1, n, name), std::fflush(stderr);
}
void end_progress() {
  if (on_terminal()) std::fprintf(stderr, "\r\033[K");
}

Verdict judge(const Case& c) {
  Verdict v{&c, {}, 0, false, ""};
  const auto began = std::chrono::steady_clock::now();
  try {
    v.outcome = c.run();
    v.passed = v.outcome.error <= c.tolerance;
  } catch (const dyn::Error& error) {
    v.outcome.error = HUGE_VAL, v.failure = error.what();
  }
  v.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return v;
}

json numbers(const Vector& x) { return x.empty() ? json(0.0) : x.size() == 1 ? json(x[0]) : json(x); }

json to_json(const std::vector<Verdict>& verdicts) {
  json rows = json::array();
  for (const Verdict& v : verdicts) {
    json row = {{"name", v.c->name},
                {"theme", v.c->theme},
                {"metric", v.c->metric},
                {"reference", numbers(v.outcome.reference)},
                {"result", v.outcome.reference.empty() ? json(v.outcome.error) : numbers(v.outcome.result)},
                {"error", v.outcome.error},
                {"tolerance", v.c->tolerance},
                {"passed", v.passed},
                {"wall_s", v.wall_s},
                {"source", v.c->source}};
    if (!v.failure.empty()) row["failure"] = v.failure;
    rows.push_back(std::move(row));
  }
  return {{"cases", rows}};
}

std::string text_of(const std::vector<Verdict>& verdicts) {
  std::vector<std::vector<std::string>> rows = {
      {"case", "metric", "reference", "result", "error", "tolerance", "verdict", "time, s"}};
  std::size_t failed = 0;
  for (const Verdict& v : verdicts) {
    rows.push_back({v.c->name, v.c->metric, v.shown_reference(), v.shown_result(), short_number(v.outcome.error, 2),
                    short_number(v.c->tolerance, 2), v.passed ? "passed" : "FAILED", short_number(v.wall_s, 2)});
    failed += !v.passed;
  }
  std::string out = table(rows);
  for (const Verdict& v : verdicts)
    if (!v.failure.empty()) out += std::string(v.c->name) + ": " + v.failure + "\n";
  return out + std::to_string(verdicts.size() - failed) + " of " + std::to_string(verdicts.size()) + " passed\n";
}

std::string list(const std::vector<const Case*>& all) {
  std::vector<std::vector<std::string>> rows = {{"case", "theme", "what is hard"}};
  for (const Case* c : all) rows.push_back({c->name, c->theme, std::string(c->sentence) + (c->slow ? " (--long)" : "")});
  return table(rows);
}

void run_stress(const StressOptions& options) {
  const auto all = chosen(options);
  if (options.list) return print(list(all));
  check_outputs({{"--html", options.html}});
  std::vector<Verdict> verdicts;
  for (std::size_t k = 0; k < all.size(); ++k) progress(k, all.size(), all[k]->name), verdicts.push_back(judge(*all[k]));
  end_progress();
  if (!options.html.empty()) write_page(options.html, verdicts);
  print(options.json ? json_text(to_json(verdicts)) : text_of(verdicts));
  std::size_t failed = 0;
  for (const Verdict& v : verdicts) failed += !v.passed;
  if (failed) fail(std::to_string(failed) + " of " + std::to_string(verdicts.size()) + " cases failed.");
}

}  // namespace

void add_stress(CLI::App& app) {
  auto options = std::make_shared<StressOptions>();
  CLI::App* command = app.add_subcommand("stress", "Hard cases against their references: error, tolerance, verdict");
  command->add_option("cases", options->names, "Names of cases or themes; default: all quick cases");
  command->add_flag("--json", options->json, "One JSON object");
  command->add_option("--html", options->html, "Write a page with a picture of each case to this file")->check(not_empty);
  command->add_flag("--list", options->list, "List the cases and what is hard about each; run nothing");
  command->add_flag("--long", options->slow, "Run the slow cases, too");
  command->callback([options] { run_stress(*options); });
}

}  // namespace cli
