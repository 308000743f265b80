#include "file.hpp"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>

#include "xml.hpp"

namespace dyn::load {

static std::string reason(int code) { return std::error_code(code, std::generic_category()).message(); }

std::string read_file(const std::string& path, const std::string& what) {
  const Report report(path, false);
  if (path.empty()) throw Error(DYN_ERROR_FILE, "the path is empty: give the name of " + what);
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    report.fail(DYN_ERROR_FILE, 0, "this is a directory: give the name of " + what + " in it");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) report.fail(DYN_ERROR_FILE, 0, "cannot be opened: " + reason(errno));
  std::string text;
  if (const auto size = std::filesystem::file_size(path, ignored); !ignored && size <= max_file_bytes) text.reserve(size);
  char part[1 << 16];
  for (size_t n; (n = std::fread(part, 1, sizeof part, file.get())) > 0;) {
    text.append(part, n);
    if (text.size() > max_file_bytes)
      report.fail(DYN_ERROR_LIMIT, 0, "larger than " + std::to_string(max_file_bytes) + " bytes, which is the limit");
  }
  if (std::ferror(file.get())) report.fail(DYN_ERROR_FILE, 0, "cannot be read: " + reason(errno));
  return text;
}

}  // namespace dyn::load
