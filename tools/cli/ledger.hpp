// The error ledger of all calls that made steps.
#pragma once

#include "cli.hpp"

namespace cli {

class Ledger {
 public:
  void add(const Robot& robot, const Data& data);
  json answer() const;
  Vector sums_so_far() const;
  static std::vector<std::string> sum_names();
  static std::string text(const json& answer);

 private:
  dynErrorLedger sum_{};
};

}  // namespace cli
