// Model to text by format, and text to file: a file that is there stays as it is until the new one is complete.
#include "dyn/model/save.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "report.hpp"

namespace dyn {

dynFormat format_of(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".urdf") return DYN_FORMAT_URDF;
  if (extension == ".xml" || extension == ".mjcf") return DYN_FORMAT_MJCF;
  if (extension == ".dynb") return DYN_FORMAT_DYNB;
  throw Error(DYN_ERROR_ARGUMENT, load::quoted(path) + ": the extension names no format that is written: use .urdf, .xml or .mjcf, or .dynb");
}

std::string save_string(const Model& m, dynFormat format, bool strict, SaveReport& report) {
  std::string out;
  switch (format) {
    case DYN_FORMAT_URDF: out = save_urdf(m, report); break;
    case DYN_FORMAT_MJCF: out = save_mjcf(m, report); break;
    case DYN_FORMAT_DYNB: out = save_dynb(m); break;
    default: throw Error(DYN_ERROR_ARGUMENT, "format is " + std::to_string(int(format)) + ": use DYN_FORMAT_URDF, DYN_FORMAT_MJCF or DYN_FORMAT_DYNB");
  }
  if (!strict) return out;
  std::string first;
  size_t count = 0;
  for (const SaveEntry& e : report)
    if (e.level == DYN_REPORT_WARNING && count++ == 0) first = e.message;
  if (count) throw Error(DYN_ERROR_STRICT, first + (count > 1 ? " (and " + std::to_string(count - 1) + " more)" : "") + ": the format has no place for it (strict)");
  return out;
}

void save_file(const Model& m, const std::string& path, bool strict, SaveReport& report) {
  const std::string text = save_string(m, format_of(path), strict, report);
  const std::string part = path + ".part";
  const auto fail = [&](const char* what) {
    const int why = errno;
    std::remove(part.c_str());
    throw Error(DYN_ERROR_FILE, "file " + load::quoted(path) + ": " + what + ": " + std::strerror(why));
  };
  std::FILE* file = std::fopen(part.c_str(), "wb");
  if (!file) fail("cannot be written");
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  const bool kept = written && std::fflush(file) == 0 && fsync(fileno(file)) == 0;  // on the disk before it takes the old one's place
  if (std::fclose(file) != 0 || !kept) fail("cannot be written");
  if (std::rename(part.c_str(), path.c_str()) != 0) fail("cannot be replaced");
}

}  // namespace dyn
