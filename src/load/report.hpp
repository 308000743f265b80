// The load report while it grows, and the one place where a message gets its "robot.urdf:12: ".
#pragma once

#include <map>
#include <string>
#include <vector>

#include "model/load.hpp"

namespace dyn::load {

class Report {
 public:
  struct Entry {
    dynReportLevel level;
    int line;
    std::string message;
  };

  // file may be "": text in memory.
  Report(std::string file, bool strict) : file_(std::move(file)), strict_(strict) {}

  const std::string& file() const { return file_; }
  std::string where(int line) const;
  [[noreturn]] void fail(dynStatus status, int line, const std::string& message) const;

  void info(int line, const std::string& message) { add(DYN_REPORT_LEVEL_INFO, line, message); }
  void warning(int line, const std::string& message) { add(DYN_REPORT_LEVEL_WARNING, line, message); }
  // The file says physics that the model does not have, or that no robot can have: a warning, and an error under strict.
  void physics(int line, const std::string& message);
  // Things that a file has by the hundred: one info line for all, "12 x <gazebo>: not used ...", at the first one's line.
  void count(const std::string& what, int line);

  // Under strict, fails when there was physics(). Otherwise every entry, in the file's order.
  std::vector<Entry> finish();

 private:
  void add(dynReportLevel level, int line, const std::string& message);

  struct Count {
    int times = 0, line = 0;
  };
  std::string file_;
  bool strict_;
  std::vector<Entry> entries_, physics_;
  size_t listed_[2] = {0, 0}, unlisted_ = 0, unlisted_physics_ = 0;
  std::map<std::string, Count> counts_;
};

// The text with '?' for bytes that are not UTF-8, and spaces for control characters: messages are one line, and end up in JSON.
std::string printable(const std::string& text);
// 'name', shortened when it is absurdly long: names go into messages.
std::string quoted(const std::string& name);
// " (did you mean 'elbow'?)", or "" when nothing is near.
std::string did_you_mean(const std::string& name, const std::vector<const std::string*>& candidates);
// Shortest text that reads back as the same number; independent of locale.
std::string text(double value);

}  // namespace dyn::load
