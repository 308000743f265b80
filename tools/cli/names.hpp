// Enumerations of dyn.h by the names that the command uses: those of the header in small letters.
#pragma once

#include <string>
#include <vector>

#include "dyn.h"

namespace CLI {
class Option;
}

namespace cli {

struct Choice {
  std::string name, capital;  // "rk4", "RK4"
  int value;
};
// Values of an enumeration ("dynIntegrator") in its order.
const std::vector<Choice>& choices(const char* type);
// "unknown" where there is no such value.
const char* name_of(const char* type, int value);
const char* capital_name_of(const char* type, int value);
std::vector<std::string> names_of(const char* type);
// "pgs, admm or newton"; with &Choice::capital "PGS, ADMM or NEWTON"
std::string one_of(const char* type, const std::string Choice::*form = &Choice::name);
// The value of that name; otherwise the command line is refused: option says where.
int value_of(const char* type, const char* option, const std::string& name, const std::string Choice::*form = &Choice::name);

// What shells complete as the option's value (manual.cpp): one of the names, or some with commas between.
struct Values {
  std::vector<std::string> names;
  bool list = false;
};
void complete(const CLI::Option* option, Values values);
const Values* values_of(const CLI::Option* option);  // null: none were given

// " (did you mean "rnea"?)", or nothing where no name is near the word.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& names);

}  // namespace cli
