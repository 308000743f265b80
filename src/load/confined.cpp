#include "confined.hpp"

#include <algorithm>
#include <filesystem>

#include "report.hpp"

namespace dyn::load {

namespace fs = std::filesystem;

static fs::path real(const fs::path& path) {
  std::error_code ignored;
  return fs::weakly_canonical(fs::absolute(path, ignored), ignored);
}

Confined::Confined(const std::string& file, const LoadOptions& options) : confined_(options.confined) {
  if (!confined_) return;
  folders_.push_back(real(file.empty() ? fs::path(".") : fs::absolute(file).parent_path()).string());
  for (const std::string& dir : options.package_dirs) folders_.push_back(real(dir).string());
}

void Confined::check(const std::string& path) const {
  if (!confined_) return;
  const fs::path file = real(path);
  for (const std::string& folder : folders_) {
    const fs::path within(folder);
    if (std::mismatch(within.begin(), within.end(), file.begin(), file.end()).first == within.end()) return;
  }
  throw Error(DYN_ERROR_FILE, "file " + in_quotes(path) +
                                  " is outside the folders that may be read, the robot file's folder and package_dirs: add its "
                                  "folder to package_dirs, or load without confined");
}

}  // namespace dyn::load
