// Writes a model as text, and text to a file. An existing file stays unchanged until the new one is complete.
#include "model/save.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "report.hpp"
#include "system.hpp"

namespace dyn {

namespace {

namespace fs = std::filesystem;

// Follows links to the file to be replaced, which need not exist.
std::string target_of(const std::string& path) {
  constexpr int max_links = 40;
  std::error_code ignored;
  fs::path target = path;
  for (int links = 0; links < max_links && fs::is_symlink(fs::symlink_status(target, ignored)); ++links)
    target = target.parent_path() / fs::read_symlink(target, ignored);
  return target.string();
}

// Creates a new file beside the target.
int open_temporary(const std::string& target, int mode, std::string& part) {
  constexpr int max_parts = 10000;  // concurrent saves, and leftovers of killed ones
  int file = -1;
  for (int k = 0; k < max_parts; ++k) {
    part = target + ".part" + std::to_string(k);
    file = load::open_file(part, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (file >= 0 || errno != EEXIST) break;
  }
  return file;
}

bool write_all(int file, const std::string& text) {
  for (size_t at = 0; at < text.size();) {
    const ssize_t n = write(file, text.data() + at, text.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += size_t(n);
  }
  return true;
}

}  // namespace

dynFormat format_of(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".urdf") return DYN_FORMAT_URDF;
  if (extension == ".xml" || extension == ".mjcf") return DYN_FORMAT_MJCF;
  if (extension == ".dynb") return DYN_FORMAT_DYNB;
  throw Error(DYN_ERROR_ARGUMENT, load::in_quotes(path) + ": unknown extension: use .urdf, .xml, .mjcf or .dynb");
}

std::string save_string(const Model& m, dynFormat format, bool strict, SaveReport& report) {
  std::string out;
  switch (format) {
    case DYN_FORMAT_URDF: out = save_urdf(m, report); break;
    case DYN_FORMAT_MJCF: out = save_mjcf(m, report); break;
    case DYN_FORMAT_DYNB: out = save_dynb(m); break;
    default: throw Error(DYN_ERROR_ARGUMENT, "format " + std::to_string(int(format)) + " does not exist: use URDF, MJCF or DYNB");
  }
  if (!strict) return out;
  std::string first;
  size_t count = 0;
  for (const SaveEntry& e : report)
    if (e.level == DYN_REPORT_LEVEL_DROPPED && count++ == 0) first = e.message;
  if (count)
    throw Error(DYN_ERROR_STRICT, first + (count > 1 ? " (and " + std::to_string(count - 1) + " more)" : "") +
                                      ": the format cannot hold it (strict)");
  return out;
}

void save_file(const Model& m, const std::string& path, bool strict, SaveReport& report) {
  const std::string text = save_string(m, format_of(path), strict, report);
  const auto fail = [&](const char* what, const char* why) {
    throw Error(DYN_ERROR_FILE, "file " + load::in_quotes(path) + ": " + what + ": " + why);
  };
  const std::string target = target_of(path);
  load::FileInfo old{};
  const bool there = load::file_info(target, old) == 0;
  if (there && !load::is_writable(target)) fail("cannot be written", std::strerror(errno));
  if (there && !S_ISREG(old.st_mode)) fail("cannot be replaced", "it is not a regular file");
  std::string part;
  const int file = open_temporary(target, there ? old.st_mode & 0777 : 0666, part);
  if (file < 0) fail("cannot be written", std::strerror(errno));
  if (there) load::set_mode(file, old.st_mode & 0777);  // undo umask; file systems without modes ignore it
  const auto left = [&](const char* what, int why) { load::remove_file(part), fail(what, std::strerror(why)); };
  int why = write_all(file, text) && load::write_to_disk(file) == 0 ? 0 : errno;  // on disk before it replaces the old file
  if (close(file) != 0 && !why) why = errno;
  if (why) left("cannot be written", why);
  if (const int failed = load::rename_file(part, target)) left("cannot be replaced", failed);
}

}  // namespace dyn
