// Numbers, JSON and the answer on standard output.
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "cli.hpp"

namespace cli {

json vector_json(const double* data, int n) { return json(std::vector<double>(data, data + n)); }

json matrix_json(const double* data, int rows, int cols) {
  json out = json::array();
  for (int i = 0; i < rows; ++i) {
    json row = json::array();
    for (int j = 0; j < cols; ++j) row.push_back(data[i + static_cast<std::ptrdiff_t>(rows) * j]);
    out.push_back(std::move(row));
  }
  return out;
}

std::string json_text(const json& object) {
  const auto dump = [](const json& value) { return value.dump(-1, ' ', false, json::error_handler_t::replace); };
  std::string out = "{";
  const char* comma = "\n";
  for (const auto& [key, value] : object.items()) {
    out += comma + (" " + dump(key)) + ": ";
    comma = ",\n";
    if (value.is_array() && !value.empty() && value.front().is_object()) {
      const char* inner = "[\n  ";
      for (const auto& element : value) {
        out += inner + dump(element);
        inner = ",\n  ";
      }
      out += "\n ]";
    } else {
      out += dump(value);
    }
  }
  return out + "\n}\n";
}

void append_number(std::string& out, double x) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, x, std::chars_format::general, 17);
  out.append(text, end.ptr);
}

std::string short_number(double x, int digits) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, x == 0 ? 0.0 : x, std::chars_format::general, digits);
  return std::string(text, end.ptr);
}

void print(const std::string& answer) {
  errno = 0;
  if (std::fwrite(answer.data(), 1, answer.size(), stdout) != answer.size() || std::fflush(stdout) != 0)
    fail(std::string("the answer cannot be written to standard output: ") + std::strerror(errno) + ".");
}

std::string shown(const std::string& name) { return name.size() > 200 ? name.substr(0, 200) + "..." : name; }

std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return text;
}

std::string library_error() {
  std::string text = dyn_last_error();
  for (const char* base : {"fixed", "floating"}) {
    const std::string option = std::string("base ") + base;
    for (std::size_t at; (at = text.find(option)) != std::string::npos;)
      text.replace(at, option.size(), std::string("--") + base);
  }
  return text;
}

std::string not_empty(const std::string& text) { return text.empty() ? "the text is empty" : ""; }

std::string number_of(const std::string& text, double& x) {
  const char* begin = text.c_str() + (text.size() > 1 && text[0] == '+' && text[1] != '-');
  const char* end = text.c_str() + text.size();
  const auto [stop, error] = std::from_chars(begin, end, x);
  if (error == std::errc::result_out_of_range && stop == end) return "\"" + shown(text) + "\" is beyond the range of a double";
  return error != std::errc() || stop != end ? "\"" + shown(text) + "\" is not a number" : "";
}

std::string decimal(const std::string& text) {
  double x;
  return number_of(text, x);
}

std::string seconds(const std::string& text) {
  double x = 0;
  const std::string why = number_of(text, x);
  return why.empty() && !(x > 0 && std::isfinite(x)) ? "\"" + shown(text) + "\" is no positive number of seconds" : why;
}

std::string whole(const std::string& text) {
  std::uint64_t x = 0;
  const char* end = text.c_str() + text.size();
  const auto [stop, error] = std::from_chars(text.c_str(), end, x);
  const bool octal = text.size() > 1 && text[0] == '0';  // so the parser would take it
  return error != std::errc() || stop != end || octal ? "\"" + shown(text) + "\" is no whole number, 0 or more, of 64 bits" : "";
}

std::vector<std::string> list_of(const std::string& option, const std::string& text) {
  std::vector<std::string> out;
  bool wanted = false;  // behind a comma
  const char* blanks = " \t\r\n";
  for (std::size_t at = text.find_first_not_of(blanks); at != text.npos; at = text.find_first_not_of(blanks, at)) {
    const std::size_t end = std::min(text.find_first_of(" \t\r\n,", at), text.size());
    if (end == at)
      bad_usage(option + ": there is nothing " + (out.empty() ? "before the first comma" : "between two commas") + " of \"" +
                shown(text) + "\".");
    out.push_back(text.substr(at, end - at));
    const std::size_t next = text.find_first_not_of(blanks, end);
    wanted = next != text.npos && text[next] == ',';
    at = wanted ? next + 1 : end;
  }
  if (wanted) bad_usage(option + ": there is nothing behind the last comma of \"" + shown(text) + "\".");
  return out;
}

std::string join(const std::vector<std::string>& words, const char* separator) {
  std::string out;
  for (const auto& word : words) out += (out.empty() ? "" : separator) + word;
  return out;
}

}  // namespace cli
