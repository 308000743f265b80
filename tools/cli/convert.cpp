// dyn convert: a robot file to another format, and what that one has no place for.
#include <CLI/CLI.hpp>
#include <iostream>

#include "cli.hpp"

namespace cli {

namespace {

struct Line {
  dynReportLevel level;
  std::string message;
};

void collect(void* context, dynReportLevel level, const char* message) { static_cast<std::vector<Line>*>(context)->push_back({level, message}); }

void convert(const RobotOptions& options, const std::string& out) {
  const Robot robot(options);
  std::vector<Line> lines;
  const dynStatus status = dyn_model_save(robot, out.c_str(), options.strict, collect, &lines);
  if (options.json) {
    check(status);
    json report = json::array();
    for (const Line& l : lines) report.push_back({{"level", l.level == DYN_REPORT_WARNING ? "warning" : "info"}, {"message", l.message}});
    return print(json_text({{"file", out}, {"report", report}}));
  }
  for (const Line& l : lines) std::cerr << "dyn: " << (l.level == DYN_REPORT_WARNING ? "warning: lost: " : "note: ") << one_line(l.message) << '\n';
  check(status);
}

}  // namespace

void add_convert(CLI::App& app) {
  auto options = std::make_shared<RobotOptions>();
  auto out = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("convert", "Write the robot as URDF, MJCF or .dynb");
  command->footer("The extension of OUT says the format: .urdf, .xml or .mjcf, .dynb. What it has no place for is listed as lost, and is an error with --strict.");
  add_robot_options(*command, *options);
  command->add_option("OUT", *out, "The file to write")->required()->check(not_empty);
  command->callback([options, out] { convert(*options, *out); });
}

}  // namespace cli
