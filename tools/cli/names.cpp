#include "names.hpp"

#include <algorithm>
#include <map>

#include "cli.hpp"

namespace cli {

namespace {

std::string small(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  return text;
}

}  // namespace

const std::vector<Choice>& choices(const char* type) {
  static std::map<std::string, std::vector<Choice>> known;
  std::vector<Choice>& list = known[type];
  if (!list.empty()) return list;
  const int index = dyn_enum_id(type);
  dynEnumInfo info{};
  info.struct_size = sizeof info;
  check(dyn_enum_info(index, &info));
  for (int k = 0; k < info.count; ++k) {
    dynEnumValueInfo value{};
    value.struct_size = sizeof value;
    check(dyn_enum_value_info(index, k, &value));
    list.push_back({small(value.name), value.name, value.value, value.sentence});
  }
  return list;
}

const char* name_of(const char* type, int value) {
  for (const Choice& c : choices(type))
    if (c.value == value) return c.name.c_str();
  return "unknown";
}

const char* capital_name_of(const char* type, int value) {
  for (const Choice& c : choices(type))
    if (c.value == value) return c.capital.c_str();
  return "UNKNOWN";
}

std::vector<std::string> names_of(const char* type) {
  std::vector<std::string> out;
  for (const Choice& c : choices(type)) out.push_back(c.name);
  return out;
}

std::string one_of(const char* type) {
  std::string out;
  const std::vector<Choice>& list = choices(type);
  for (std::size_t k = 0; k < list.size(); ++k) out += (k == 0 ? "" : k + 1 == list.size() ? " or " : ", ") + list[k].name;
  return out;
}

int value_of(const char* type, const char* option, const std::string& name) {
  for (const Choice& c : choices(type))
    if (c.name == small(name)) return c.value;
  bad_usage(std::string(option) + ": \"" + shown(name) + "\" is not " + one_of(type) + ".");
}

}  // namespace cli
