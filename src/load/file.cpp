#include "file.hpp"

#include <cerrno>
#include <system_error>

#include "system.hpp"

namespace dyn::load {

namespace {

std::string reason(int code) { return std::error_code(code, std::generic_category()).message(); }

// An open file, closed at the end.
struct Descriptor {
  int fd;
  explicit Descriptor(int f) : fd(f) {}
  Descriptor(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

// Refuses what is no regular file, and no pipe where one is allowed.
void check_kind(const FileInfo& s, const std::string& what, FileKind kind, const Report& report) {
  if (S_ISREG(s.st_mode) || (S_ISFIFO(s.st_mode) && kind == FileKind::Pipe)) return;
  if (S_ISDIR(s.st_mode)) report.fail(DYN_ERROR_FILE, 0, "this is a directory: give the name of " + what + " in it");
  const char* is = S_ISFIFO(s.st_mode) ? "pipe" : S_ISSOCK(s.st_mode) ? "socket" : "device";
  report.fail(DYN_ERROR_FILE, 0, "this is a " + std::string(is) + ", no regular file: give the name of " + what);
}

FileInfo stat_of(const std::string& path, const Report& report) {
  FileInfo s{};
  if (file_info(path, s) != 0) report.fail(DYN_ERROR_FILE, 0, "cannot be opened: " + reason(errno));
  return s;
}

[[noreturn]] void fail_size(std::uint64_t limit, const Report& report) {
  report.fail(DYN_ERROR_LIMIT, 0, "larger than " + std::to_string(limit) + " bytes, which is the limit");
}

}  // namespace

std::uint64_t file_size(const std::string& path, const std::string& what) {
  const Report report(path, false);
  const FileInfo s = stat_of(path, report);
  check_kind(s, what, FileKind::Regular, report);
  return std::uint64_t(s.st_size);
}

std::string read_file(const std::string& path, const std::string& what, FileKind kind, std::uint64_t limit) {
  const Report report(path, false);
  if (path.empty()) throw Error(DYN_ERROR_FILE, "the path is empty: give the name of " + what);
  check_kind(stat_of(path, report), what, kind, report);
  // a file that became a pipe meanwhile does not block
  const int flags = O_RDONLY | O_CLOEXEC | (kind == FileKind::Regular ? O_NONBLOCK : 0);
  const Descriptor file(open_file(path, flags));
  FileInfo opened{};
  if (file.fd < 0 || file_info(file.fd, opened) != 0) report.fail(DYN_ERROR_FILE, 0, "cannot be opened: " + reason(errno));
  check_kind(opened, what, kind, report);
  std::string text;
  if (S_ISREG(opened.st_mode)) {
    if (std::uint64_t(opened.st_size) > limit) fail_size(limit, report);
    text.reserve(std::size_t(opened.st_size));
  }
  char part[1 << 16];
  for (;;) {
    const ::ssize_t n = ::read(file.fd, part, sizeof part);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) report.fail(DYN_ERROR_FILE, 0, "cannot be read: " + reason(errno));
    if (n == 0) return text;
    if (text.size() + std::size_t(n) > limit) fail_size(limit, report);
    text.append(part, std::size_t(n));
  }
}

}  // namespace dyn::load
