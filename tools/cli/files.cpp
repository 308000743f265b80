#include "files.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "system/system.hpp"

namespace cli {

namespace {

namespace fs = std::filesystem;

// Where a file that is made comes to lie: links lead there even while nothing is there.
fs::path target_of(const std::string& path) {
  constexpr int max_links = 40;
  std::error_code ignored;
  fs::path target = path;
  for (int links = 0; links < max_links && fs::is_symlink(fs::symlink_status(target, ignored)); ++links)
    target = target.parent_path() / fs::read_symlink(target, ignored);
  return target;
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  if (fs::exists(a, ignored) && !fs::is_regular_file(a, ignored)) return false;
  const auto whole = [&](const std::string& path) {
    return fs::weakly_canonical(fs::absolute(target_of(path), ignored), ignored);
  };
  return fs::equivalent(a, b, ignored) || whole(a) == whole(b);
}

// Why a file cannot be written, as errno says it; 0: it can.
int obstacle(const std::string& path) {
  std::error_code ignored;
  const int why = obstacle_to_write(path);
  if (why == 0) return fs::is_directory(path, ignored) ? EISDIR : 0;
  if (why != ENOENT) return why;
  const fs::path folder = target_of(path).parent_path();
  return obstacle_to_make(folder.empty() ? "." : folder.string());
}

}  // namespace

std::vector<NamedFile> inputs_of(const RobotOptions& robot, std::vector<NamedFile> more) {
  more.push_back({"FILE", robot.file}), more.push_back({"--srdf", robot.srdf});
  return more;
}

void check_outputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs) {
  for (auto out = outputs.begin(); out != outputs.end(); ++out) {
    if (out->path.empty()) continue;
    if (out->path == "-") bad_usage(std::string(out->option) + ": \"-\" is no file's name; standard output is /dev/stdout.");
    for (const NamedFile& in : inputs)
      if (!in.path.empty() && same_file(out->path, in.path))
        bad_usage(std::string(in.option) + " and " + out->option + " name the same file, " + shown(in.path) +
                  ": it would be overwritten.");
    for (auto other = outputs.begin(); other != out; ++other)
      if (!other->path.empty() && same_file(out->path, other->path))
        bad_usage(std::string(other->option) + " and " + out->option + " name the same file, " + shown(out->path) + ".");
  }
  for (const NamedFile& out : outputs)
    if (const int why = out.path.empty() ? 0 : obstacle(out.path))
      fail(out.path + ": cannot be written: " + std::strerror(why) + ".");
}

}  // namespace cli
