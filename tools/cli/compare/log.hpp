// A log of states: a CSV file of times, configurations and velocities, as dyn sim --csv writes it, or with another engine's
// columns and conventions (capi/pages/states.md).
#pragma once

#include "../cli.hpp"

namespace cli::compare {

bool is_log(const std::string& path);  // by its name: .csv

// In the model's own order and convention.
struct Log {
  Vector t;
  std::vector<Vector> q, v;
  std::vector<Vector> ctrl, tau;  // empty: the file has none
};
// layout: a name of dynConvention, or "": by the names of the columns.
Log read_log(const std::string& path, const Robot& robot, const std::string& layout);

// Columns alone, without a model.
struct Table {
  std::vector<std::string> names;
  std::vector<Vector> rows;
};
Table read_table(const std::string& path);

}  // namespace cli::compare
