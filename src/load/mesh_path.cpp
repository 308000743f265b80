#include "mesh_path.hpp"
#include "system.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace dyn::load {

namespace fs = std::filesystem;

namespace {

// file://host/a%20b -> /a b
std::string from_file_uri(std::string uri) {
  const size_t slash = uri.find('/');
  if (slash != uri.npos && slash > 0) uri.erase(0, slash);  // the host
  std::string path;
  for (size_t i = 0; i < uri.size(); ++i) {
    const auto hex = [&](size_t k) { return k < uri.size() && std::isxdigit(static_cast<unsigned char>(uri[k])); };
    if (uri[i] == '%' && hex(i + 1) && hex(i + 2)) {
      path += char(std::strtol(uri.substr(i + 1, 2).c_str(), nullptr, 16));
      i += 2;
    } else {
      path += uri[i];
    }
  }
  return path;
}

bool is_file(const std::string& path) {
  std::error_code ignored;
  return fs::is_regular_file(utf8_path(path), ignored);
}

std::string join(const std::string& folder, const std::string& rest) {
  return folder.empty() ? rest : (fs::path(folder) / rest).string();
}

}  // namespace

MeshPaths::MeshPaths(const std::string& file, std::vector<std::string> package_dirs) : package_dirs_(std::move(package_dirs)) {
  std::error_code ignored;
  if (!file.empty()) {
    folder_ = fs::path(file).parent_path().string();
    fs::path above = fs::absolute(file, ignored).parent_path();
    for (int levels = 0; levels < 32 && !above.empty(); ++levels) {
      above_.push_back(above.string());
      if (above == above.parent_path()) break;
      above = above.parent_path();
    }
  }
  if (const char* ros = std::getenv("ROS_PACKAGE_PATH")) {
    const std::string list = ros;
    for (size_t at = 0; at <= list.size();) {
      const size_t end = std::min(list.find(':', at), list.size());
      if (end > at) ros_.push_back(list.substr(at, end - at));
      at = end + 1;
    }
  }
}

std::vector<std::string> MeshPaths::candidates(const std::string& name) const {
  std::vector<std::string> all;
  for (const std::string scheme : {"package://", "model://"}) {
    if (!name.starts_with(scheme)) continue;
    const std::string full =
        name.substr(std::min(name.find_first_not_of('/', scheme.size()), name.size()));  // also package:///NAME
    const size_t slash = full.find('/');
    const std::string rest = slash == full.npos ? "" : full.substr(slash + 1);
    for (const std::string& dir : package_dirs_) {
      all.push_back(join(dir, full));
      if (!rest.empty()) all.push_back(join(dir, rest));
    }
    for (const std::string& dir : above_) all.push_back(join(dir, full));
    for (const std::string& dir : ros_) all.push_back(join(dir, full));
    return all;
  }
  if (name.starts_with("file://")) {
    const std::string path = from_file_uri(name.substr(7));
    return {fs::path(path).is_absolute() ? path : join(folder_, path)};
  }
  if (name.find("://") != name.npos) return {};  // http and the like
  return {fs::path(name).is_absolute() ? name : join(folder_, name)};
}

const MeshPaths::Found& MeshPaths::find(const std::string& name) {
  const auto [at, added] = known_.try_emplace(name);
  Found& found = at->second;
  found.first_time = added;
  if (!added) return found;
  for (const std::string& path : candidates(name)) {
    if (std::find(found.tried.begin(), found.tried.end(), path) != found.tried.end()) continue;
    found.tried.push_back(path);
    if (is_file(path)) {
      found.path = path;
      break;
    }
  }
  return found;
}

}  // namespace dyn::load
