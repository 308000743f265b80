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

std::map<std::string, std::vector<Choice>> read_all() {
  std::map<std::string, std::vector<Choice>> all;
  for (int e = 0; e < dyn_enum_count(); ++e) {
    dynEnumInfo info{};
    info.struct_size = sizeof info;
    check(dyn_enum_info(e, &info));
    for (int k = 0; k < info.count; ++k) {
      dynEnumValueInfo value{};
      value.struct_size = sizeof value;
      check(dyn_enum_value_info(e, k, &value));
      all[info.name].push_back({small(value.name), value.name, value.value});
    }
  }
  return all;
}

// Letters to insert, take away, change or swap with the next (optimal string alignment).
std::size_t edits_between(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

std::map<const CLI::Option*, Values>& completed() {
  static std::map<const CLI::Option*, Values> all;
  return all;
}

}  // namespace

const std::vector<Choice>& choices(const char* type) {
  static const std::map<std::string, std::vector<Choice>> all = read_all();
  return all.at(type);
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

std::string one_of(const char* type, const std::string Choice::*form) {
  std::string out;
  const std::vector<Choice>& list = choices(type);
  for (std::size_t k = 0; k < list.size(); ++k) out += (k == 0 ? "" : k + 1 == list.size() ? " or " : ", ") + list[k].*form;
  return out;
}

int value_of(const char* type, const char* option, const std::string& name, const std::string Choice::*form) {
  for (const Choice& c : choices(type))
    if (c.*form == name) return c.value;
  bad_usage(std::string(option) + ": \"" + shown(name) + "\" is not " + one_of(type, form) + ".");
}

void complete(const CLI::Option* option, Values values) { completed()[option] = std::move(values); }

const Values* values_of(const CLI::Option* option) {
  const auto found = completed().find(option);
  return found == completed().end() ? nullptr : &found->second;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
  if (word.size() > 100) return "";
  std::size_t best = std::max<std::size_t>(2, word.size() / 4) + 1;
  std::string near;
  for (const std::string& name : names)
    if (const std::size_t edits = edits_between(word, name); edits < best) best = edits, near = name;
  return near.empty() ? "" : " (did you mean \"" + near + "\"?)";
}

}  // namespace cli
