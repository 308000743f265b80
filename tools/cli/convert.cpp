// dyn convert: a robot file to another format, and what that one has no place for.
#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "files.hpp"
#include "system/system.hpp"

namespace cli {

namespace {

struct Line {
  dynReportLevel level;
  std::string message;
};

// Of a C array.
struct Image {
  bool narrow = false, nameless = false;
};

void collect(void* context, dynReportLevel level, const char* message) {
  static_cast<std::vector<Line>*>(context)->push_back({level, message});
}

// Of the file's name, as C can say it.
std::string identifier(const std::string& path) {
  std::string name = std::filesystem::path(path).stem().string();
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) ? "model_" + name : name;
}

// A C array: dyn_model_from_buffer(name, name_size, &model).
dynStatus save_c(const Robot& robot, const Image& image, const std::string& out) {
  const uint32_t flags = (image.narrow ? uint32_t(DYN_IMAGE_NARROW) : 0) | (image.nameless ? uint32_t(DYN_IMAGE_NAMELESS) : 0);
  size_t size = 0;
  if (const dynStatus s = dyn_model_image(robot, flags, nullptr, 0, &size)) return s;
  std::vector<unsigned char> bytes(size);
  if (const dynStatus s = dyn_model_image(robot, flags, bytes.data(), size, &size)) return s;
  const std::string name = identifier(out), n = std::to_string(size);
  std::string text = "/* Made by dyn convert, libdyn " + std::string(dyn_version()) + ": a model for dyn_model_from_buffer(" +
                     name + ", " + name + "_size, &model). */\n" +
                     "#include <stddef.h>\n#ifdef __cplusplus\nextern \"C\" {\n#endif\nextern const unsigned char " + name + "[" +
                     n + "];\nextern const size_t " + name + "_size;\n#ifdef __cplusplus\n}\n#endif\nconst size_t " + name +
                     "_size = " + n + ";\n__attribute__((aligned(64))) const unsigned char " + name + "[" + n + "] = {";
  for (size_t k = 0; k < size; ++k) text += (k % 32 ? "" : "\n") + std::to_string(bytes[k]) + ",";
  text += "\n};\n";
  std::FILE* file = open_file(out, "wb");
  const bool written = file && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  if ((file && std::fclose(file) != 0) || !written) fail("file '" + out + "' cannot be written: " + std::strerror(errno));
  return DYN_OK;
}

void convert(const RobotOptions& options, const Image& image, const std::string& out) {
  check_outputs({{"OUT", out}}, inputs_of(options));
  const std::string ending = std::filesystem::path(out).extension().string();
  const auto is = [&](const char* known) { return ending == known; };
  const bool c = is(".c");
  if (!c && !is(".urdf") && !is(".xml") && !is(".mjcf") && !is(".dynb"))
    bad_usage("OUT is '" + out + "': it must end in .urdf, .xml or .mjcf, .dynb, or .c (a C array)");
  if (!c && (image.narrow || image.nameless)) bad_usage("--narrow and --nameless are for C arrays: OUT ends in .c");
  const Robot robot(options);
  std::vector<Line> lines;
  const dynSaveOptions save = {sizeof save, options.strict, collect, &lines};
  const dynStatus status = c ? save_c(robot, image, out) : dyn_model_save(robot, out.c_str(), &save);
  if (options.json) {
    check(status);
    json report = json::array();
    for (const Line& l : lines)
      report.push_back({{"level", name_of("dynReportLevel", l.level)}, {"message", l.message}});
    return print(json_text({{"file", out}, {"report", report}}));
  }
  for (const Line& l : lines)
    std::cerr << "dyn: " << (l.level == DYN_REPORT_LEVEL_DROPPED ? "warning: lost: " : "note: ") << one_line(l.message) << '\n';
  check(status);
}

}  // namespace

void add_convert(CLI::App& app) {
  auto options = std::make_shared<RobotOptions>();
  auto image = std::make_shared<Image>();
  auto out = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("convert", "Write the robot as URDF, MJCF, .dynb, or a C array");
  command->footer(
      "The extension of OUT is the format: .urdf, .xml or .mjcf, .dynb, .c (a .dynb for dyn_model_from_buffer). Losses are "
      "listed. With --strict they are errors.");
  add_robot_options(*command, *options);
  command->add_option("OUT", *out, "The file to write")->required()->check(not_empty);
  command->add_flag("--narrow", image->narrow, "C array for machines without SIMD, such as a Cortex-M");
  command->add_flag("--nameless", image->nameless, "C array without names and load report");
  command->callback([options, image, out] { convert(*options, *image, *out); });
}

}  // namespace cli
