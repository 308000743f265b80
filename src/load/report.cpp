#include "report.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>

namespace dyn::load {

namespace {

constexpr size_t max_entries = 20000;  // of each level; limits the memory that a hostile file can use
constexpr size_t max_listed = 5;       // reasons listed when strict loading refuses

int edit_distance(const std::string& a, const std::string& b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (size_t i = 0; i < a.size(); ++i) {
    int diagonal = row[0];
    row[0] = int(i) + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      const int replace = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replace, row[j] + 1, diagonal + 1});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string Report::where(int line) const {
  if (file_.empty()) return line > 0 ? "line " + std::to_string(line) + ": " : "";
  constexpr size_t longest = 300;  // leaves room for the rest of the message
  const std::string file = file_.size() > longest ? "..." + file_.substr(file_.size() - longest) : file_;
  return printable(line > 0 ? file + ":" + std::to_string(line) + ": " : file + ": ");
}

void Report::fail(dynStatus status, int line, const std::string& message) const {
  throw Error(status, where(line) + printable(message));
}

void Report::add(dynReportLevel level, int line, const std::string& message) {
  if (size_t& listed = listed_[level]; listed < max_entries)
    ++listed, entries_.push_back({level, line, printable(message)});
  else
    ++unlisted_;
}

void Report::physics(int line, const std::string& message) {
  if (strict_) {
    if (physics_.size() < max_entries)
      physics_.push_back({DYN_REPORT_LEVEL_DROPPED, line, printable(message)});
    else
      ++unlisted_physics_;
  }
  add(DYN_REPORT_LEVEL_DROPPED, line, message);
}

void Report::count(const std::string& what, int line) {
  Count& c = counts_[what];
  if (c.times++ == 0) c.line = line;
}

std::vector<Report::Entry> Report::finish() {
  const auto by_line = [](const Entry& a, const Entry& b) { return a.line < b.line; };
  if (!physics_.empty()) {
    std::stable_sort(physics_.begin(), physics_.end(), by_line);
    const size_t total = physics_.size() + unlisted_physics_, listed = std::min(total, max_listed);
    std::string all;
    for (size_t i = 0; i < listed; ++i) all += (i ? "; " : "") + where(physics_[i].line) + physics_[i].message;
    if (total > listed) all += "; and " + std::to_string(total - listed) + " more";
    throw Error(DYN_ERROR_STRICT, "strict: " + all + " (without strict these are warnings of the load report)");
  }
  if (unlisted_) entries_.push_back({DYN_REPORT_LEVEL_WARNING, 0, std::to_string(unlisted_) + " more entries are not listed"});
  for (const auto& [what, c] : counts_)
    entries_.push_back({DYN_REPORT_LEVEL_INFO, c.line, std::to_string(c.times) + " x " + what});
  std::stable_sort(entries_.begin(), entries_.end(), by_line);
  return entries_;
}

std::string printable(const std::string& text) {
  std::string out = text;
  for (size_t i = 0; i < out.size();) {
    const auto byte = [&](size_t k) { return k < out.size() ? static_cast<unsigned char>(out[k]) : 0u; };
    const unsigned c = byte(i);
    const size_t length = c < 0x80 ? 1 : c >= 0xC2 && c < 0xE0 ? 2 : c >= 0xE0 && c < 0xF0 ? 3 : c >= 0xF0 && c < 0xF5 ? 4 : 0;
    bool good = length > 0;
    for (size_t k = 1; k < length; ++k) good = good && (byte(i + k) & 0xC0) == 0x80;
    // refuse overlong forms, surrogates, and code points beyond Unicode
    const unsigned second = byte(i + 1);
    good = good && !(c == 0xE0 && second < 0xA0) && !(c == 0xED && second > 0x9F) && !(c == 0xF0 && second < 0x90) &&
           !(c == 0xF4 && second > 0x8F);
    if (!good) out[i] = '?';
    if (c < 0x20 || c == 0x7F) out[i] = ' ';
    i += good ? length : 1;
  }
  return out;
}

std::string in_quotes(const std::string& name) {
  constexpr size_t longest = 200;
  if (name.size() <= longest) return "'" + name + "'";
  size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;  // do not cut a UTF-8 character
  return "'" + name.substr(0, end) + "...'";
}

std::string did_you_mean(const std::string& name, const std::vector<const std::string*>& candidates) {
  if (name.size() > 100 || candidates.size() > 10000) return "";
  const std::string* best = nullptr;
  int best_distance = std::max(2, int(name.size()) / 4) + 1;
  for (const std::string* c : candidates) {
    if (c->size() > 100) continue;
    const bool part = name.size() >= 4 && c->size() > name.size() && c->ends_with(name);  // a missing prefix
    const int distance = part ? 1 : edit_distance(name, *c);
    if (distance < best_distance) best = c, best_distance = distance;
  }
  return best ? " (did you mean " + in_quotes(*best) + "?)" : "";
}

std::string text(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value);
  return std::string(buffer, end.ptr);
}

}  // namespace dyn::load
