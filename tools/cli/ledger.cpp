#include "ledger.hpp"

#include <algorithm>
#include <cstring>

namespace cli {

namespace {

struct Entry {
  const char* name;
  double dynErrorLedger::*of;
};
constexpr Entry sums[] = {{"energy_change", &dynErrorLedger::energy_change},
                          {"applied", &dynErrorLedger::applied},
                          {"actuators", &dynErrorLedger::actuators},
                          {"wrenches", &dynErrorLedger::wrenches},
                          {"damping", &dynErrorLedger::damping},
                          {"friction", &dynErrorLedger::friction},
                          {"fluid", &dynErrorLedger::fluid},
                          {"contact_normal", &dynErrorLedger::contact_normal},
                          {"contact_friction", &dynErrorLedger::contact_friction},
                          {"limits", &dynErrorLedger::limits},
                          {"constraints", &dynErrorLedger::constraints},
                          {"correction", &dynErrorLedger::correction},
                          {"energy_defect", &dynErrorLedger::energy_defect}};
constexpr Entry largest[] = {{"constraint_drift", &dynErrorLedger::constraint_drift},
                             {"cone", &dynErrorLedger::cone},
                             {"complementarity", &dynErrorLedger::complementarity}};

}  // namespace

void Ledger::add(const Robot& robot, const Data& data) {
  dynErrorLedger l{};
  l.struct_size = sizeof l;
  check(dyn_data_ledger(robot, data, &l));
  for (const auto& e : sums) sum_.*e.of += l.*e.of;
  for (const auto& e : largest) sum_.*e.of = std::max(sum_.*e.of, l.*e.of);
  for (int i = 0; i < 3; ++i) sum_.momentum_defect[i] += l.momentum_defect[i];
}

json Ledger::answer() const {
  json out;
  for (const auto& e : sums) out[e.name] = sum_.*e.of;
  out["momentum_defect"] = {sum_.momentum_defect[0], sum_.momentum_defect[1], sum_.momentum_defect[2]};
  for (const auto& e : largest) out[e.name] = sum_.*e.of;
  return out;
}

Vector Ledger::sums_so_far() const {
  Vector out;
  for (const auto& e : sums) out.push_back(sum_.*e.of);
  return out;
}

std::vector<std::string> Ledger::sum_names() {
  std::vector<std::string> out;
  for (const auto& e : sums) out.emplace_back(e.name);
  return out;
}

std::string Ledger::text(const json& a) {
  std::string out = "ledger            change of energy, J, by source; the rest is the error of the steps\n";
  for (const auto& e : sums)
    if (const double x = a[e.name]; x != 0)
      out += "  " + std::string(e.name) + std::string(20 - std::strlen(e.name), ' ') + short_number(x) + "\n";
  out += "  momentum_defect     " + short_number(a["momentum_defect"][0].get<double>()) + " " +
         short_number(a["momentum_defect"][1].get<double>()) + " " + short_number(a["momentum_defect"][2].get<double>()) +
         " N s\n";
  out += "  constraint_drift    " + short_number(a["constraint_drift"].get<double>()) + " m or rad\n  cone                " +
         short_number(a["cone"].get<double>()) + " N\n  complementarity     " + short_number(a["complementarity"].get<double>()) +
         " W\n";
  return out;
}

}  // namespace cli
