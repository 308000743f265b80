// Generalised forces over time, from a CSV file: a line of names with t and tau0, tau1, ... in it, as dyn sim --csv writes it,
// whose other columns do not matter; one that the robot has not is refused. A row's forces act from its t on, until the next
// row's.
#pragma once

#include "cli.hpp"

namespace cli {

class Drive {
 public:
  Drive(const std::string& file, const Robot& robot);
  // Those that act at a time; before the first row zero.
  const double* at(double time) const;
  double begin() const { return times_.front(); }
  void act(const Robot& robot, const Data& data, double time) const {
    check(dyn_data_set_state(robot, data, nullptr, nullptr, nullptr, at(time)));
  }

 private:
  std::size_t nv_;
  Vector times_, tau_, none_;
};

}  // namespace cli
