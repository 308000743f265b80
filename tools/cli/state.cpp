// The state: a JSON file {"q":[nq],"v":[nv],"a":[nv],"tau":[nv]} or lists on the command line. Missing ones: neutral, zero.
// In the file each may also be an object {"joint": number or list}; joints that it does not name stay neutral or zero.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <set>

#include "cli.hpp"
#include "system/system.hpp"

namespace cli {

void add_state_options(CLI::App& command, StateOptions& options, bool with_acceleration) {
  auto* file = command.add_option("--state", options.file, "State file: JSON with any of q, v, a, tau, ctrl")
                   ->check(not_empty)
                   ->type_name("S.json");
  const auto list = [&](const char* name, std::vector<std::string>& words, const char* what) {
    command.add_option(name, words, what)->type_name("NUMBERS")->excludes(file);
  };
  list("--q", options.q, "Configuration, nq numbers, separated by commas or spaces; default neutral");
  list("--v", options.v, "Velocity, nv numbers; default zero");
  if (with_acceleration) list("--a", options.a, "Acceleration, nv numbers; default zero");
  list("--tau", options.tau, "Generalised force, nv numbers; default zero");
}

Vector parse_list(const std::string& option, const std::vector<std::string>& words) {
  std::string text = join(words, " ");
  if (text.starts_with('[') && text.ends_with(']')) text = text.substr(1, text.size() - 2);
  Vector out;
  for (const std::string& word : list_of(option, text)) {
    double x;
    if (const std::string fault = number_of(word, x); !fault.empty()) bad_usage(option + ": " + fault + ".");
    if (!std::isfinite(x)) bad_usage(option + ": \"" + shown(word) + "\" is not finite.");
    out.push_back(x);
  }
  return out;
}

namespace {

std::string sizes(const std::string& what, std::size_t got, int needed, const char* symbol) {
  return what + " has " + std::to_string(got) + " numbers, but the robot needs " + std::to_string(needed) + " (" + symbol + ").";
}

void from_list(const Robot& robot, const char* key, const std::vector<std::string>& words, Vector& out) {
  if (words.empty()) return;
  const std::string option = std::string("--") + key;
  Vector given = parse_list(option, words);
  const bool is_q = *key == 'q';
  const int n = is_q ? robot.nq : robot.nv;
  if (given.size() != static_cast<std::size_t>(n)) fail(sizes(option, given.size(), n, is_q ? "nq" : "nv"));
  out = std::move(given);
}

double number(const json& value, const std::string& where) {
  if (!value.is_number())
    fail(where + " must be a number, but is " + value.dump(-1, ' ', false, json::error_handler_t::replace).substr(0, 40) + ".");
  const double x = value.get<double>();
  if (!std::isfinite(x)) fail(where + " is not finite.");
  return x;
}

// So many numbers of a list.
void numbers(const json& list, const std::string& where, int n, const char* symbol, double* out) {
  if (!list.is_array()) fail(where + " must be a list of numbers.");
  Vector given;
  for (const json& x : list) given.push_back(number(x, where + "[" + std::to_string(given.size()) + "]"));
  if (given.size() != static_cast<std::size_t>(n)) fail(sizes(where, given.size(), n, symbol));
  std::copy(given.begin(), given.end(), out);
}

void from_json(const Robot& robot, const std::string& file, const std::string& key, const json& value, Vector& out) {
  const std::string where = file + ": \"" + key + "\"";
  const bool is_q = key == "q";
  if (value.is_object()) {
    for (const auto& [name, given] : value.items()) {
      const std::string place = where + ", joint \"" + shown(name) + "\"";
      if (name.find('\0') != name.npos) fail(place + ": a name has no zero byte in it.");
      const int id = dyn_model_joint_id(robot, name.c_str());
      if (id < 0) fail(where + ": " + dyn_last_error());
      const dynJointInfo joint = robot.joint(id);
      if (joint.mimic_leader >= 0)
        fail(place + " follows \"" + dyn_model_joint_name(robot, joint.mimic_leader) +
             "\" and has no numbers of its own: set that one.");
      const int first = is_q ? joint.idx_q : joint.idx_v, n = is_q ? joint.nq : joint.nv;
      const json list = given.is_array() ? given : json::array({given});
      if (list.size() != static_cast<std::size_t>(n))
        fail(place + " has " + std::to_string(list.size()) + " numbers, but the joint needs " + std::to_string(n) + ".");
      for (int i = 0; i < n; ++i) out[first + i] = number(list[i], place);
    }
    return;
  }
  numbers(value, where, is_q ? robot.nq : robot.nv, is_q ? "nq" : "nv", out.data());
}

}  // namespace

std::string read_text(const std::string& file, const char* what) {
  constexpr std::size_t limit = std::size_t(128) << 20;
  const std::string the = file + ": the " + what;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(open_file(file, "rb"), &std::fclose);
  if (!in) fail(the + " cannot be read: " + std::strerror(errno) + ".");
  std::string text;
  char part[1 << 16];
  for (std::size_t n; (n = std::fread(part, 1, sizeof part, in.get())) > 0;) {
    text.append(part, n);
    if (text.size() > limit) fail(the + " is larger than " + std::to_string(limit) + " bytes, which is the limit.");
  }
  if (std::ferror(in.get())) fail(the + " cannot be read: " + std::strerror(errno) + ".");
  return text;
}

namespace {

// The parser says which number it was, 'so', and not where.
[[noreturn]] void fail_beyond_double(const std::string& file, const std::string& text, const std::string& said) {
  const std::size_t begin = said.find('\'') + 1, end = std::max(said.rfind('\''), begin);
  const std::string word = said.substr(begin, end - begin);
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(text.find(word), text.size())), '\n');
  fail(file + ":" + std::to_string(line) + ": \"" + shown(word) + "\" is beyond the range of a double.");
}

// What JSON leaves open is refused: a name twice in an object; and what the parser takes for the end: a zero byte.
json read_json(const std::string& file) {
  const std::string text = read_text(file, "state");
  if (text.find('\0') != text.npos) fail(file + ": not JSON: there is a zero byte in it.");
  std::vector<std::set<std::string>> names;  // of the objects that are open
  const auto look = [&](int depth, json::parse_event_t event, json& parsed) {
    if (depth > 3) fail(file + ": nested deeper than {\"q\": {\"joint\": [numbers]}}.");
    if (event == json::parse_event_t::object_start) names.emplace_back();
    if (event == json::parse_event_t::object_end) names.pop_back();
    if (event == json::parse_event_t::key && !names.back().insert(parsed.get<std::string>()).second)
      fail(file + ": \"" + shown(parsed.get<std::string>()) + "\" stands there twice.");
    return true;
  };
  try {
    return json::parse(text, look);
  } catch (const json::out_of_range& error) {
    fail_beyond_double(file, text, error.what());
  } catch (const json::exception& error) {
    fail(file + ": not JSON: " + error.what() + ".");
  }
}

}  // namespace

void check_lists(const StateOptions& options) {
  parse_list("--q", options.q);
  parse_list("--v", options.v);
  parse_list("--a", options.a);
  parse_list("--tau", options.tau);
}

State read_state(const Robot& robot, const StateOptions& options) {
  State state{robot.neutral(), Vector(robot.nv), Vector(robot.nv), Vector(robot.nv), Vector(dyn_model_nu(robot))};
  from_list(robot, "q", options.q, state.q);
  from_list(robot, "v", options.v, state.v);
  from_list(robot, "a", options.a, state.a);
  from_list(robot, "tau", options.tau, state.tau);
  state.has_tau = !options.tau.empty();
  if (options.file.empty()) return state;

  const json object = read_json(options.file);
  if (!object.is_object()) fail(options.file + ": must be an object with any of \"q\", \"v\", \"a\", \"tau\", \"ctrl\".");
  for (const auto& [key, value] : object.items()) {
    if (key == "q")
      from_json(robot, options.file, key, value, state.q);
    else if (key == "v")
      from_json(robot, options.file, key, value, state.v);
    else if (key == "a")
      from_json(robot, options.file, key, value, state.a);
    else if (key == "tau")
      from_json(robot, options.file, key, value, state.tau), state.has_tau = true;
    else if (key == "ctrl")
      numbers(value, options.file + ": \"ctrl\"", static_cast<int>(state.ctrl.size()), "nu", state.ctrl.data());
    else
      fail(options.file + ": unknown key \"" + shown(key) + "\"; the keys are \"q\", \"v\", \"a\", \"tau\", \"ctrl\".");
  }
  return state;
}

}  // namespace cli
