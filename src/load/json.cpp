#include "json.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace dyn::load {

namespace {

constexpr int max_json_depth = 100;
constexpr std::size_t max_values = 1000000;  // about 200 MB in memory

struct Parser {
  std::string_view text;
  const Report& report;
  std::size_t at = 0, values = 0;
  int depth = 0;

  [[noreturn]] void fail(const std::string& message, dynStatus status = DYN_ERROR_PARSE) const {
    const auto end = text.begin() + std::ptrdiff_t(std::min(at, text.size()));
    report.fail(status, 1 + int(std::count(text.begin(), end, '\n')), "its JSON " + message);
  }
  [[noreturn]] void unexpected() const {
    if (at >= text.size()) fail("is cut off");
    fail("is damaged: " + in_quotes(std::string(text.substr(at, 20))) + " is not expected here");
  }

  char next() {  // past blanks; 0 at the end
    at = std::min(text.find_first_not_of(" \t\r\n", at), text.size());
    return at < text.size() ? text[at] : '\0';
  }
  bool take(std::string_view word) {
    if (!text.substr(at).starts_with(word)) return false;
    at += word.size();
    return true;
  }

  void append_utf8(std::uint32_t c, std::string& out) {
    if (c < 0x80)
      out += char(c);
    else if (c < 0x800)
      out += char(0xC0 | c >> 6), out += char(0x80 | (c & 63));
    else if (c < 0x10000)
      out += char(0xE0 | c >> 12), out += char(0x80 | (c >> 6 & 63)), out += char(0x80 | (c & 63));
    else
      out += char(0xF0 | c >> 18), out += char(0x80 | (c >> 12 & 63)), out += char(0x80 | (c >> 6 & 63)),
          out += char(0x80 | (c & 63));
  }
  std::uint32_t code() {
    std::uint32_t c = 0;
    const std::string_view digits = text.substr(std::min(at, text.size()), 4);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), c, 16);
    if (error != std::errc() || end != digits.data() + 4) unexpected();
    at += 4;
    return c;
  }

  std::string string() {
    if (!take("\"")) unexpected();
    std::string out;
    for (;;) {
      const std::size_t stop = text.find_first_of("\"\\", at);
      if (stop == text.npos) at = text.size(), fail("is cut off: a quote is missing");
      out.append(text, at, stop - at);
      at = stop + 1;
      if (text[stop] == '"') return out;
      const char c = at < text.size() ? text[at] : '\0';
      ++at;
      constexpr std::string_view from = "\"\\/bfnrt", to = "\"\\/\b\f\n\r\t";
      if (const std::size_t k = from.find(c); k != from.npos && c) {
        out += to[k];
      } else if (c == 'u') {
        std::uint32_t x = code();
        if (x >= 0xD800 && x < 0xDC00 && take("\\u")) x = 0x10000 + ((x - 0xD800) << 10) + ((code() - 0xDC00) & 0x3FF);
        append_utf8(x, out);
      } else {
        --at, unexpected();
      }
    }
  }

  Json value() {
    if (++values > max_values)
      fail("has more than " + std::to_string(max_values) + " values, which is the limit", DYN_ERROR_LIMIT);
    Json out;
    const char c = next();
    if (c == '{' || c == '[') {
      out.kind = c == '{' ? Json::Kind::Object : Json::Kind::Array;
      const char close = c == '{' ? '}' : ']';
      if (++depth > max_json_depth)
        fail("is nested more than " + std::to_string(max_json_depth) + " deep, which is the limit", DYN_ERROR_LIMIT);
      ++at;
      for (bool first = true; next() != close; first = false) {
        if (!first && !take(",")) unexpected();
        if (c == '{') {
          next();
          out.keys.push_back(string());
          if (next() != ':') unexpected();
          ++at;
        }
        out.items.push_back(value());
      }
      ++at, --depth;
    } else if (c == '"') {
      out.kind = Json::Kind::String, out.text = string();
    } else if (take("true") || take("false")) {
      out.kind = Json::Kind::Bool, out.number = c == 't';
    } else if (!take("null")) {
      out.kind = Json::Kind::Number;
      const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), out.number);
      if (error != std::errc() || !(c == '-' || (c >= '0' && c <= '9')) || !std::isfinite(out.number)) unexpected();
      at = std::size_t(end - text.data());
    }
    return out;
  }
};

}  // namespace

const Json* Json::find(std::string_view key) const {
  const auto k = std::find(keys.begin(), keys.end(), key);
  return k == keys.end() ? nullptr : &items[std::size_t(k - keys.begin())];
}

Json parse_json(std::string_view text, const Report& report) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  Parser parser{text, report};
  Json out = parser.value();
  // a chunk of a binary file is padded
  if (parser.next() != '\0' || text.substr(parser.at).find_first_not_of('\0') != text.npos) parser.unexpected();
  if (out.kind != Json::Kind::Object) report.fail(DYN_ERROR_PARSE, 1, "its JSON is no object");
  return out;
}

}  // namespace dyn::load
