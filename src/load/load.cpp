// Loads files and texts. The content decides the format, not the name.
#include "model/load.hpp"

#include "budget.hpp"
#include "confined.hpp"
#include "model/model.hpp"
#include "file.hpp"
#include "mesh_path.hpp"
#include "xml.hpp"

namespace dyn {

namespace {

using load::Report;

ModelPtr load_content(const std::string& text, const std::string& file, const LoadOptions& options) {
  const Report report(file, options.strict);
  const auto starts = [&](std::string_view head) { return std::string_view(text).starts_with(head); };
  if (starts("DYNB")) return load_dynb(text, file, options);
  const size_t visible = text.find_first_not_of(starts("\xEF\xBB\xBF") ? "\xEF\xBB\xBF \t\r\n" : " \t\r\n");
  if (visible == text.npos) report.fail(DYN_ERROR_PARSE, 0, "the " + std::string(file.empty() ? "text" : "file") + " is empty");
  if (starts("\xFF\xFE") || starts("\xFE\xFF") || starts(std::string_view("<\0", 2)) || starts(std::string_view("\0<", 2)))
    report.fail(DYN_ERROR_PARSE, 0, "this is UTF-16 or UTF-32: save it as UTF-8");
  if ((text[visible] != '<' && text.substr(0, 512).find('\0') != text.npos) || starts("\x1F\x8B") || starts("PK\x03\x04"))
    report.fail(DYN_ERROR_UNSUPPORTED, 0, "this is a binary file of an unknown format: give a URDF, MJCF or .dynb");
  if (text[visible] != '<') {
    const bool path = text.size() < 4096 && text.find('\n') == text.npos;
    report.fail(DYN_ERROR_PARSE, 1,
                std::string("this is not XML") +
                    (file.empty() && path ? ": the text of a robot file is expected here; load a path as a file" : ""));
  }
  const std::string root = load::root_element(text);
  if (root == "mujoco") return load_mjcf(text, file, options);
  if (root == "mujocoinclude") report.fail(DYN_ERROR_PARSE, 0, "this is a part of an MJCF model: load the file that includes it");
  if (root == "sdf")
    report.fail(DYN_ERROR_UNSUPPORTED, 0, "this is an SDF model (<sdf>), which libdyn does not read: convert it to URDF");
  return load_urdf(text, file, options);
}

// Checks all mesh files of a model, also those that the loader does not open: callers open them by name.
ModelPtr within_folders(ModelPtr model, const std::string& file, const LoadOptions& options) {
  if (!options.confined) return model;
  const load::Confined confined(file, options);
  load::MeshPaths meshes("", options.package_dirs);
  for (Index k = 0; k < model->n.shapes; ++k)
    if (const std::string name = model->string(model->shapes()[k].mesh); !name.empty())
      if (const std::string& path = meshes.find(name).path; !path.empty()) confined.check(path);
  return model;
}

ModelPtr load_within_limits(const std::string& text, const std::string& file, LoadOptions options) {
  load::Budget budget(options.limits);
  options.budget = &budget;
  budget.add_bytes(std::int64_t(text.size()), Report(file, false), 0);
  return within_folders(load_content(text, file, options), file, options);
}

}  // namespace

ModelPtr load_file(const std::string& path, const LoadOptions& options) {
  const load::FileKind kind = options.confined ? load::FileKind::Regular : load::FileKind::Pipe;
  return load_within_limits(load::read_file(path, "a robot file", kind), path, options);
}

ModelPtr load_string(const std::string& text, const LoadOptions& options) { return load_within_limits(text, "", options); }

}  // namespace dyn
