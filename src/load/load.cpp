// Files to text, and text to the loader of its format: content decides, not the name.
#include "dyn/model/load.hpp"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>

#include "xml.hpp"

namespace dyn {

namespace {

using load::Report;

std::string reason(int code) { return std::error_code(code, std::generic_category()).message(); }

// Also reads pipes, such as the output of xacro.
std::string read_file(const std::string& path) {
  const Report report(path, false);
  if (path.empty()) throw Error(DYN_ERROR_FILE, "the path is empty: give the name of a URDF file");
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    report.fail(DYN_ERROR_FILE, 0, "this is a directory: give the name of a URDF file in it");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) report.fail(DYN_ERROR_FILE, 0, "cannot be opened: " + reason(errno));
  std::string text;
  if (const auto size = std::filesystem::file_size(path, ignored); !ignored && size <= load::max_file_bytes) text.reserve(size);
  char part[1 << 16];
  for (size_t n; (n = std::fread(part, 1, sizeof part, file.get())) > 0;) {
    text.append(part, n);
    if (text.size() > load::max_file_bytes)
      report.fail(DYN_ERROR_LIMIT, 0, "larger than " + std::to_string(load::max_file_bytes) + " bytes, which is the limit");
  }
  if (std::ferror(file.get())) report.fail(DYN_ERROR_FILE, 0, "cannot be read: " + reason(errno));
  return text;
}

ModelPtr load_content(const std::string& text, const std::string& file, const LoadOptions& options) {
  const Report report(file, options.strict);
  const auto starts = [&](std::string_view head) { return std::string_view(text).starts_with(head); };
  const size_t visible = text.find_first_not_of(starts("\xEF\xBB\xBF") ? "\xEF\xBB\xBF \t\r\n" : " \t\r\n");
  if (visible == text.npos) report.fail(DYN_ERROR_PARSE, 0, "the " + std::string(file.empty() ? "text" : "file") + " is empty");
  if (starts("\xFF\xFE") || starts("\xFE\xFF") || starts(std::string_view("<\0", 2)) || starts(std::string_view("\0<", 2)))
    report.fail(DYN_ERROR_PARSE, 0, "this is UTF-16 or UTF-32: save it as UTF-8");
  if (starts("DYNB") || starts("dynb") || starts(".dynb"))
    report.fail(DYN_ERROR_UNSUPPORTED, 0, "this is a binary model (.dynb), which this version does not read: load the URDF");
  if ((text[visible] != '<' && text.substr(0, 512).find('\0') != text.npos) || starts("\x1F\x8B") || starts("PK\x03\x04"))
    report.fail(DYN_ERROR_UNSUPPORTED, 0, "this is a binary file: libdyn reads URDF");
  if (text[visible] != '<') {
    const bool path = text.size() < 4096 && text.find('\n') == text.npos;
    report.fail(DYN_ERROR_PARSE, 1,
                std::string("this is not XML") +
                    (file.empty() && path ? ": the text of a URDF is expected, and dyn_model_load takes a path" : ""));
  }
  const std::string root = load::root_element(text);
  if (root == "mujoco")
    report.fail(DYN_ERROR_UNSUPPORTED, 0,
                "this is an MJCF model (<mujoco>), which this version does not read: convert it to URDF");
  if (root == "sdf")
    report.fail(DYN_ERROR_UNSUPPORTED, 0, "this is an SDF model (<sdf>), which libdyn does not read: convert it to URDF");
  return load_urdf(text, file, options);
}

}  // namespace

ModelPtr load_file(const std::string& path, const LoadOptions& options) { return load_content(read_file(path), path, options); }

ModelPtr load_string(const std::string& text, const LoadOptions& options) { return load_content(text, "", options); }

}  // namespace dyn
