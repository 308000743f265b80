// Files by their descriptors, by one set of names on POSIX and Windows. Paths are UTF-8.
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>

#ifdef _WIN32
#include <io.h>
#define O_CLOEXEC O_NOINHERIT
#define O_NONBLOCK 0
#define S_ISSOCK(mode) false
#endif

namespace dyn::load {

#ifdef _WIN32
// Of the C library's locale otherwise.
inline std::filesystem::path utf8_path(const std::string& path) { return std::u8string(path.begin(), path.end()); }
using FileInfo = struct ::_stat64;
inline int file_info(const std::string& path, FileInfo& out) { return ::_wstat64(utf8_path(path).c_str(), &out); }
inline int file_info(int file, FileInfo& out) { return ::_fstat64(file, &out); }
inline int open_file(const std::string& path, int flags, int mode = 0) {
  return ::_wopen(utf8_path(path).c_str(), flags | O_BINARY, mode & (S_IREAD | S_IWRITE));
}
inline bool is_writable(const std::string& path) { return ::_waccess(utf8_path(path).c_str(), W_OK) == 0; }
inline int write_to_disk(int file) { return ::_commit(file); }
inline void set_mode(int, int) {}
inline void remove_file(const std::string& path) { ::_wunlink(utf8_path(path).c_str()); }
// Replaces `to`. Returns 0, or an error number.
inline int rename_file(const std::string& from, const std::string& to) {
  std::error_code failed;
  std::filesystem::rename(utf8_path(from), utf8_path(to), failed);
  return failed.value();
}
#else
inline std::filesystem::path utf8_path(const std::string& path) { return path; }
using FileInfo = struct ::stat;
inline int file_info(const std::string& path, FileInfo& out) { return ::stat(path.c_str(), &out); }
inline int file_info(int file, FileInfo& out) { return ::fstat(file, &out); }
inline int open_file(const std::string& path, int flags, int mode = 0) { return ::open(path.c_str(), flags, mode); }
inline bool is_writable(const std::string& path) { return ::access(path.c_str(), W_OK) == 0; }
inline int write_to_disk(int file) { return ::fsync(file); }
inline void set_mode(int file, int mode) { ::fchmod(file, ::mode_t(mode)); }
inline void remove_file(const std::string& path) { ::unlink(path.c_str()); }
inline int rename_file(const std::string& from, const std::string& to) { return std::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno; }
#endif

}  // namespace dyn::load
