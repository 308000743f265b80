// The growing load report. It is the only place that adds "robot.urdf:12: " to messages.
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

  // file: "" for text in memory.
  Report(std::string file, bool strict) : file_(std::move(file)), strict_(strict) {}

  const std::string& file() const { return file_; }
  std::string where(int line) const;
  [[noreturn]] void fail(dynStatus status, int line, const std::string& message) const;

  void info(int line, const std::string& message) { add(DYN_REPORT_LEVEL_INFO, line, message); }
  void warning(int line, const std::string& message) { add(DYN_REPORT_LEVEL_WARNING, line, message); }
  // Physics that the model does not represent, or that no robot can have: of level DROPPED; an error if strict.
  void physics(int line, const std::string& message);
  // Counts repeated things: one info line for all, "12 x <gazebo>: not used ...", at the line of the first.
  void count(const std::string& what, int line);

  // Throws if strict and physics() was called. Otherwise returns all entries in the file's order.
  std::vector<Entry> finish();

 private:
  void add(dynReportLevel level, int line, const std::string& message);

  struct Count {
    int times = 0, line = 0;
  };
  std::string file_;
  bool strict_;
  std::vector<Entry> entries_, physics_;
  size_t listed_[3] = {0, 0, 0}, unlisted_ = 0, unlisted_physics_ = 0;
  std::map<std::string, Count> counts_;
};

// Replaces invalid UTF-8 by '?' and control characters by spaces, because messages are single lines and end up in JSON.
std::string printable(const std::string& text);
// 'name', shortened if very long.
std::string in_quotes(const std::string& name);
// " (did you mean 'elbow'?)", or "" if no candidate is close.
std::string did_you_mean(const std::string& name, const std::vector<const std::string*>& candidates);
// Shortest text that reads back as the same number, independent of the locale.
std::string text(double value);

}  // namespace dyn::load
