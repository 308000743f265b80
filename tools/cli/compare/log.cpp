#include "log.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace cli::compare {

namespace {

std::vector<std::string> cells_in(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  std::vector<std::string> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::string_view cell = line.substr(begin, end - begin);
    while (!cell.empty() && (cell.front() == ' ' || cell.front() == '"')) cell.remove_prefix(1);
    while (!cell.empty() && (cell.back() == ' ' || cell.back() == '"')) cell.remove_suffix(1);
    cells.emplace_back(cell);
    begin = end + 1;
  }
  return cells;
}

// Columns NAME0, NAME1, ... (or NAME[0], NAME_0) of one of these names, as many as follow one another.
std::vector<std::size_t> numbered(const Table& table, std::initializer_list<const char*> names) {
  std::vector<std::size_t> out;
  for (const char* name : names) {
    for (std::size_t k = 0;; ++k) {
      const std::string n = std::to_string(k);
      const std::string forms[] = {name + n, name + ("[" + n + "]"), name + ("_" + n)};
      const auto at = std::find_if(table.names.begin(), table.names.end(),
                                   [&](const std::string& x) { return std::find(forms, forms + 3, x) != forms + 3; });
      if (at == table.names.end()) break;
      out.push_back(static_cast<std::size_t>(at - table.names.begin()));
    }
    if (!out.empty()) return out;
  }
  return out;
}

Vector picked(const Vector& row, const std::vector<std::size_t>& columns) {
  Vector out;
  for (const std::size_t k : columns) out.push_back(row[k]);
  return out;
}

dynConvention convention_of(const Table& table, const std::string& layout) {
  if (!layout.empty()) return static_cast<dynConvention>(value_of("dynConvention", "--layout", layout));
  return numbered(table, {"qpos"}).empty() ? DYN_CONVENTION_DYN : DYN_CONVENTION_MUJOCO;
}

}  // namespace

bool is_log(const std::string& path) { return path.ends_with(".csv") || path.ends_with(".CSV"); }

Table read_table(const std::string& path) {
  const std::string text = read_text(path, "log");
  Table out;
  std::size_t line_number = 0;
  for (std::size_t begin = text.starts_with("\xEF\xBB\xBF") ? 3 : 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::vector<std::string> cells = cells_in(std::string_view(text).substr(begin, end - begin));
    begin = end + 1, ++line_number;
    if (cells.size() == 1 && cells[0].empty()) continue;
    const std::string where = path + ":" + std::to_string(line_number);
    if (out.names.empty()) {
      double x;
      if (number_of(cells[0], x).empty())
        fail(where + ": the first line holds numbers: it must name the columns, as t,q0,q1,..,v0,v1,..");
      for (auto at = cells.begin(); at != cells.end(); ++at)
        if (std::find(cells.begin(), at, *at) != at) fail(where + ": there are two columns \"" + shown(*at) + "\".");
      out.names = cells;
      continue;
    }
    if (cells.size() != out.names.size())
      fail(where + ": there are " + std::to_string(cells.size()) + " columns, and the first line names " +
           std::to_string(out.names.size()) + ".");
    Vector row;
    for (const std::string& cell : cells) {
      double x = 0;
      const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), x);
      if (error != std::errc() || stop != cell.data() + cell.size() || !std::isfinite(x))
        fail(where + ": \"" + shown(cell) + "\" is not a finite number.");
      row.push_back(x);
    }
    out.rows.push_back(std::move(row));
  }
  if (out.rows.size() < 2) fail(path + ": a log needs a line of names and at least two rows of numbers.");
  return out;
}

Log read_log(const std::string& path, const Robot& robot, const std::string& layout) {
  const Table table = read_table(path);
  std::size_t time = table.names.size();
  for (std::size_t k = 0; k < table.names.size(); ++k)
    if (table.names[k] == "t" || table.names[k] == "time") time = k;
  if (time == table.names.size()) fail(path + ": there is no column t, the time in seconds.");
  dynStateLayout peer;
  dyn_state_layout_init(&peer);
  peer.convention = convention_of(table, layout);
  int nq = robot.nq, nv = robot.nv;
  check(dyn_state_layout_sizes(robot, &peer, &nq, &nv));
  const auto columns = [&](std::initializer_list<const char*> names, int n, const char* what) {
    const std::vector<std::size_t> found = numbered(table, names);
    if (static_cast<int>(found.size()) != n)
      fail(path + ": there are " + std::to_string(found.size()) + " columns of " + what + " (" +
           join({names.begin(), names.end()}, "0, .. or ") + "0, ..), and the model has " + std::to_string(n) +
           " in the layout " + name_of("dynConvention", peer.convention) + "; another model, or another --layout, may be meant.");
    return found;
  };
  const auto q = columns({"q", "qpos", "position"}, nq, "positions"), v = columns({"v", "qvel", "velocity"}, nv, "velocities");
  const auto u = numbered(table, {"ctrl", "u", "control"}), f = numbered(table, {"tau", "qfrc_applied"});
  if (!u.empty() && static_cast<int>(u.size()) != dyn_model_nu(robot))
    fail(path + ": there are " + std::to_string(u.size()) + " columns of controls, and the model has " +
         std::to_string(dyn_model_nu(robot)) + ".");
  if (!f.empty() && static_cast<int>(f.size()) != nv)
    fail(path + ": there are " + std::to_string(f.size()) + " columns of forces, and there are " + std::to_string(nv) +
         " velocities.");
  Log out;
  for (const Vector& row : table.rows) {
    if (!out.t.empty() && !(row[time] > out.t.back()))
      fail(path + ": t must grow from row to row, and after " + short_number(out.t.back(), 9) + " comes " +
           short_number(row[time], 9) + ".");
    out.t.push_back(row[time]);
    Vector mine_q(robot.nq), mine_v(robot.nv), mine_f(robot.nv);
    const Vector qs = picked(row, q), vs = picked(row, v), fs = f.empty() ? Vector(vs.size()) : picked(row, f);
    dynStateInput from;
    dyn_state_input_init(&from);
    from.q = qs.data(), from.v = vs.data(), from.tau = fs.data();
    dynStateOutput to;
    dyn_state_output_init(&to);
    to.q = mine_q.data(), to.v = mine_v.data(), to.tau = mine_f.data();
    if (dyn_state_layout_convert(robot, &peer, DYN_DIRECTION_FROM_PEER, &from, &to) != DYN_OK)
      fail(path + ": row at t = " + short_number(row[time], 9) + ": " + library_error());
    out.q.push_back(std::move(mine_q)), out.v.push_back(std::move(mine_v));
    if (!f.empty()) out.tau.push_back(std::move(mine_f));
    if (!u.empty()) out.ctrl.push_back(picked(row, u));
  }
  return out;
}

}  // namespace cli::compare
