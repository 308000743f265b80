// Constraints: what eval says of them, and `dyn check`.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>
#include <sstream>

#include "cli.hpp"

namespace cli {

namespace {

std::string slot_name(const Robot& robot, int slot) {
  return slot < dyn_model_nconstraints(robot) ? dyn_model_constraint_name(robot, slot)
                                              : "contact " + std::to_string(slot - dyn_model_nconstraints(robot) + 1);
}

int row_count(const Robot& robot, const Data& data) {
  int rows;
  check(dyn_data_constraint_rows(robot, data, -1, nullptr, &rows));
  return rows;
}

}  // namespace

void add_contact_options(CLI::App& command, ContactOptions& options) {
  command.add_option("--points", options.points, "Frames with a point contact on the ground, separated by commas")
      ->allow_extra_args(false)
      ->type_name("LIST");
  command.add_option("--faces", options.faces, "Frames with a face contact on the ground, separated by commas")
      ->allow_extra_args(false)
      ->type_name("LIST");
}

int contact_count(const ContactOptions& options) {
  int count = 0;
  for (const auto* list : {&options.points, &options.faces})
    for (std::string words : *list) {
      std::replace(words.begin(), words.end(), ',', ' ');
      std::istringstream in(words);
      for (std::string word; in >> word;) ++count;
    }
  return count;
}

void set_contacts(const Robot& robot, const Data& data, const ContactOptions& options) {
  int slot = dyn_model_nconstraints(robot);
  auto add = [&](std::string words, dynConstraintType type) {
    std::replace(words.begin(), words.end(), ',', ' ');
    std::istringstream in(words);
    for (std::string word; in >> word;) {
      dynConstraint c;
      dyn_constraint_init(&c, type);
      if ((c.first = dyn_model_frame_id(robot, word.c_str())) < 0) fail(library_error());
      check(dyn_data_set_constraint(robot, data, slot++, &c));
    }
  };
  for (const auto& words : options.points) add(words, DYN_CONSTRAINT_TYPE_POINT);
  for (const auto& words : options.faces) add(words, DYN_CONSTRAINT_TYPE_FRAME);
}

json constrained_json(const Robot& robot, const Data& data, const double* q, const double* v, const double* tau, bool forces) {
  Vector ddq(static_cast<std::size_t>(robot.nv)), lambda(static_cast<std::size_t>(row_count(robot, data)));
  const dynConstrainedOutput out = {sizeof out, ddq.data(), nullptr, lambda.data(), nullptr};
  check(dyn_constrained_dynamics(robot, data, q, v, tau, nullptr, nullptr, &out));
  return forces ? vector_json(lambda.data(), static_cast<int>(lambda.size())) : vector_json(ddq.data(), robot.nv);
}

json delassus_json(const Robot& robot, const Data& data, const double* q) {
  const int rows = row_count(robot, data);
  Vector G(static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows));
  check(dyn_delassus(robot, data, q, G.data()));
  return matrix_json(G.data(), rows, rows);
}

json constraint_terms_json(const Robot& robot, const Data& data, const double* q, const double* v, const char* what) {
  const int rows = row_count(robot, data);
  const std::size_t n = static_cast<std::size_t>(rows);
  Vector C(n), J(n * static_cast<std::size_t>(robot.nv));
  check(dyn_constraint_terms(robot, data, q, v, C.data(), J.data(), nullptr, nullptr));
  return std::string(what) == "J" ? matrix_json(J.data(), rows, robot.nv) : vector_json(C.data(), rows);
}

// Eigenvalues are squares of the share of its terms by which the joints move a row.
std::vector<std::string> misalignment_notes(const Robot& robot, const dynConstraintReport& report) {
  constexpr double aligned = 1e-9, slight = 0.02;
  std::vector<std::string> notes;
  if (report.contradictory == 0 && report.contradiction > aligned)
    notes.push_back("redundant rows are misaligned by " + short_number(report.contradiction, 3) +
                    " m or rad: steps leave them out, and the mechanism moves");
  if (report.rank == robot.nv && report.rank > 0 && std::sqrt(report.smallest) < slight)
    notes.push_back("the mechanism is locked by a misalignment of about " + short_number(std::sqrt(report.smallest), 2) +
                    " rad: align its axes to 5e-4 rad, or remove rows that only repeat others");
  return notes;
}

std::vector<std::string> misalignment_notes(const Robot& robot, const double* q) {
  const Data data(robot, DYN_PART_CONSTRAINTS);
  if (row_count(robot, data) == 0) return {};
  dynConstraintReport report{};
  report.struct_size = sizeof report;
  check(dyn_constraint_report(robot, data, q, &report, nullptr, 0));
  std::vector<std::string> notes = misalignment_notes(robot, report);
  constexpr double open = 1e-3;  // above what misalignments are tolerated for
  if (report.error > open)
    notes.push_back("constraints are violated by up to " + short_number(report.error, 3) +
                    " m or rad where it starts: steps close them where a motion can; dyn check --json has a q that satisfies them");
  return notes;
}

namespace {

struct CheckOptions {
  RobotOptions robot;
  StateOptions state;
  ContactOptions contacts;
  bool as_is = false;
};

// A q that satisfies the constraints, from q and, as a linkage stretched flat lets no step go anywhere, from starts ever farther
// from it; where none leads to one, what q itself led to.
Vector satisfying(const Robot& robot, const Data& data, const Vector& q) {
  constexpr int starts = 32;
  dynConstraintResult found{};
  found.struct_size = sizeof found;
  Vector nearest(q), start(q), trial(q);
  for (int k = 0; k <= starts; ++k) {
    if (k > 0) {
      check(dyn_configuration_random(robot, static_cast<uint64_t>(k), nullptr, nullptr, start.data()));
      check(dyn_interpolate(robot, q.data(), start.data(), static_cast<double>(k) / starts, start.data()));
    }
    check(dyn_project(robot, data, start.data(), nullptr, nullptr, trial.data(), nullptr, &found));
    if (found.reason == DYN_CONSTRAINT_REASON_CONVERGED) return trial;
    if (k == 0) nearest = trial;
  }
  return nearest;
}

// What is wrong with the constraints where they are satisfied.
void run_constraints(const CheckOptions& options) {
  check_lists(options.state);
  const Robot robot(options.robot, contact_count(options.contacts));
  const Data data(robot, DYN_PART_CONSTRAINTS);
  set_contacts(robot, data, options.contacts);
  const State state = read_state(robot, options.state);
  const Vector q = options.as_is ? state.q : satisfying(robot, data, state.q);

  const int rows = row_count(robot, data);
  std::vector<dynRowReport> list(static_cast<std::size_t>(rows));
  dynConstraintReport report{};
  report.struct_size = sizeof report;
  check(dyn_constraint_report(robot, data, q.data(), &report, list.data(), rows));
  json answer = {{"constraints", 0},
                 {"rows", report.rows},
                 {"rank", report.rank},
                 {"redundant", report.redundant},
                 {"contradictory", report.contradictory},
                 {"mobility", robot.nv - report.rank},
                 {"condition", report.condition},
                 {"error", report.error},
                 {"contradiction", report.contradiction},
                 {"satisfied", report.error < 1e-9},
                 {"q", vector_json(q.data(), robot.nq)},
                 {"dependent", json::array()}};
  std::set<int> slots;
  for (const dynRowReport& r : list) {
    slots.insert(r.slot);
    if (r.verdict == DYN_ROW_VERDICT_INDEPENDENT) continue;
    answer["dependent"].push_back({{"constraint", slot_name(robot, r.slot)},
                                   {"row", r.row},
                                   {"verdict", name_of("dynRowVerdict", r.verdict)},
                                   {"share", r.share},
                                   {"error", r.error}});
  }
  answer["constraints"] = slots.size();
  const std::vector<std::string> notes = misalignment_notes(robot, report);
  answer["notes"] = notes;
  if (options.robot.json) return print(json_text(answer));
  std::string text = std::to_string(slots.size()) + " constraints, " + std::to_string(report.rows) + " rows, rank " +
                     std::to_string(report.rank) + ": " + std::to_string(robot.nv - report.rank) + " of " +
                     std::to_string(robot.nv) + " degrees of freedom are left\n";
  const bool misaligned = report.contradictory == 0 && report.error <= 1.001 * report.contradiction;
  text += report.error < 1e-9 ? "q satisfies them"
          : misaligned        ? "q satisfies them but for their misalignment"
          : options.as_is     ? "q does not satisfy them"
                              : "no q was found that satisfies them";
  text += ": largest error " + short_number(report.error) + "; condition " + short_number(report.condition) + "\n";
  for (const std::string& note : notes) text += note + "\n";
  if (!answer["dependent"].empty()) {
    std::vector<std::vector<std::string>> lines = {{"constraint", "row", "verdict", "share", "error"}};
    for (const json& r : answer["dependent"])
      lines.push_back({r["constraint"], std::to_string(r["row"].get<int>()), r["verdict"],
                       short_number(r["share"].get<double>(), 3), short_number(r["error"].get<double>(), 3)});
    text += table(lines);
  }
  print(text);
}

}  // namespace

void add_check(CLI::App& app) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app.add_subcommand("check", "Constraint diagnostics: redundant and contradictory rows, by name");
  add_robot_options(*command, options->robot);
  add_state_options(*command, options->state, false);
  add_contact_options(*command, options->contacts);
  command->add_flag("--as-is", options->as_is, "Use the given q; by default q is projected onto the constraints");
  command->callback([options] { run_constraints(*options); });
}

}  // namespace cli
