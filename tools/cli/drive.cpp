#include "drive.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

namespace cli {

namespace {

constexpr double rounding = 1e-9;  // s: times of steps are sums

std::vector<std::string_view> cells_of(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return cells;
}

// Those of dyn sim --csv beside t and tau0, tau1, ...
bool is_of_sim(const std::string& name, const Robot& robot) {
  const auto one_of = [&](char letter, int n) {
    for (int k = 0; k < n; ++k)
      if (name == letter + std::to_string(k)) return true;
    return false;
  };
  return name == "kinetic" || name == "potential" || name == "mechanical" || one_of('q', robot.nq) || one_of('v', robot.nv);
}

// Where t, tau0, tau1, ... stand among the names.
std::vector<std::size_t> columns_of(const std::vector<std::string_view>& names, const Robot& robot, const std::string& file) {
  std::vector<std::size_t> columns;
  const std::string all = "t and tau0 to tau" + std::to_string(robot.nv - 1);
  std::vector<bool> known(names.size());
  for (int k = 0; k <= robot.nv; ++k) {
    const std::string name = k ? "tau" + std::to_string(k - 1) : "t";
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) fail(file + ": there is no column " + name + ": the first line names " + all + ".");
    if (std::find(found + 1, names.end(), name) != names.end()) fail(file + ": there are two columns " + name + ".");
    columns.push_back(static_cast<std::size_t>(found - names.begin()));
    known[columns.back()] = true;
  }
  for (std::size_t k = 0; k < names.size(); ++k)
    if (const std::string name(names[k]); !known[k] && !is_of_sim(name, robot))
      fail(file + ": unknown column \"" + shown(name) + "\": the columns are " + all + ", and those of dyn sim --csv.");
  return columns;
}

}  // namespace

Drive::Drive(const std::string& file, const Robot& robot) : nv_(static_cast<std::size_t>(robot.nv)), none_(nv_) {
  const std::string text = read_text(file, "file of forces");
  std::vector<std::size_t> columns;  // of t, tau0, tau1, ...
  std::size_t width = 0, line_number = 0;
  for (std::size_t begin = text.starts_with("\xEF\xBB\xBF") ? 3 : 0; begin < text.size();) {  // as spreadsheets begin their files
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::vector<std::string_view> cells = cells_of(std::string_view(text).substr(begin, end - begin));
    begin = end + 1, ++line_number;
    if (cells.size() == 1 && cells[0].empty()) continue;
    if (columns.empty()) {
      width = cells.size(), columns = columns_of(cells, robot, file);
      continue;
    }
    const std::string where = file + ":" + std::to_string(line_number);
    if (cells.size() != width)
      fail(where + ": there are " + std::to_string(cells.size()) + " columns, and the first line names " + std::to_string(width) +
           ".");
    for (const std::size_t k : columns) {
      const std::string_view cell = cells[k];
      double x = 0;
      const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), x);
      if (error != std::errc() || stop != cell.data() + cell.size() || !std::isfinite(x))
        fail(where + ": \"" + shown(std::string(cell)) + "\" is not a finite number.");
      (k == columns[0] ? times_ : tau_).push_back(x);
    }
    if (times_.size() > 1 && !(times_.back() > times_[times_.size() - 2])) fail(where + ": t must grow from row to row.");
  }
  if (times_.empty()) fail(file + ": there are no rows: give t and tau0 to tau" + std::to_string(nv_ - 1) + ", first as names.");
}

const double* Drive::at(double time) const {
  const auto next = std::upper_bound(times_.begin(), times_.end(), time + rounding);
  return next == times_.begin() ? none_.data() : tau_.data() + nv_ * static_cast<std::size_t>(next - times_.begin() - 1);
}

}  // namespace cli
