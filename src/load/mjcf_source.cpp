#include "mjcf_source.hpp"

#include <algorithm>

#include "file.hpp"

namespace dyn::load {

namespace {
constexpr size_t max_files = 1000;
constexpr size_t max_models = 16;  // nested models
}  // namespace

MjcfSource::MjcfSource(const std::string& text, const std::string& file, const LoadOptions& options)
    : folder_(std::filesystem::path(file).parent_path()),
      strict_(options.strict),
      budget_(options.budget),
      confined_(file, options),
      root_(&open(text, file)) {}

Element& MjcfSource::open(const std::string& text, const std::string& file) {
  File f{std::make_unique<Report>(file, strict_), {}};
  const std::int64_t bytes = check_xml(text, *f.report, max_split_depth);
  if (budget_) budget_->add_bytes(bytes, *f.report, 0);
  for (const std::string& part : split_deep(text, *f.report)) {
    f.documents.push_back(std::make_unique<Document>(part, *f.report));
    reports_[f.documents.back()->root().GetDocument()] = {f.report.get(), files_.size()};
  }
  files_.push_back(std::move(f));
  return files_.back().documents[0]->root();
}

Report& MjcfSource::report(const Element& e) const { return *reports_.at(e.GetDocument()).first; }

Element* MjcfSource::part(const Element& e) const {
  return &files_[reports_.at(e.GetDocument()).second].documents[size_t(e.IntAttribute("n"))]->root();
}

void MjcfSource::include(Element& e, std::vector<Element*>& out) {
  Element*& root = included_[&e];
  if (!root) {
    const Reader reader = this->reader(e, "the model");
    const std::string name = reader.name(e, "file");
    reader.unread(e, {"file"}, {});
    if (!names_.insert(name).second)
      reader.fail(DYN_ERROR_INVALID, e,
                  "file " + load::in_quotes(name) + " is included a second time: a file can be included once");
    if (files_.size() >= max_files) reader.fail(DYN_ERROR_LIMIT, e, "more than " + std::to_string(max_files) + " files");
    const std::string file = path(e, name).string();
    if (!std::filesystem::exists(file))
      reader.fail(DYN_ERROR_FILE, e, "the included file " + load::in_quotes(file) + " does not exist");
    root = &open(read_file(file, "an MJCF file"), file);
    const std::string_view kind = root->Name();
    if (kind != "mujoco" && kind != "mujocoinclude")
      report(*root).fail(
          DYN_ERROR_PARSE, line(*root),
          "the root of an included file is <mujoco> or <mujocoinclude>, not <" + std::string(kind.substr(0, 60)) + ">");
  }
  for (Element* c : children(*root)) out.push_back(c);
}

std::vector<Element*> MjcfSource::children(Element& e) {
  std::vector<Element*> out;
  for (Element* c = e.FirstChildElement(); c; c = c->NextSiblingElement())
    if (std::string_view(c->Name()) == "include") include(*c, out);
    else if (std::string_view(c->Name()) == part_name) out.push_back(part(*c));
    else out.push_back(c);
  return out;
}

std::vector<Element*> MjcfSource::children(Element& e, std::string_view name) {
  std::vector<Element*> out = children(e);
  std::erase_if(out, [&](Element* c) { return c->Name() != name; });
  return out;
}

Element& MjcfSource::open_model(const Element& e, const std::string& name) {
  const Reader reader = this->reader(e, "the model");
  const std::string file = path(e, name).string();
  if (std::find(opening_.begin(), opening_.end(), file) != opening_.end() || file == files_[0].report->file())
    reader.fail(DYN_ERROR_INVALID, e, "the model " + load::in_quotes(file) + " attaches itself");
  if (files_.size() >= max_files || opening_.size() >= max_models)
    reader.fail(DYN_ERROR_LIMIT, e, "too many models within models");
  if (!std::filesystem::exists(file))
    reader.fail(DYN_ERROR_FILE, e, "the model file " + load::in_quotes(file) + " does not exist");
  opening_.push_back(file);
  Element& root = open(read_file(file, "an MJCF file"), file);
  if (std::string_view(root.Name()) != "mujoco")
    report(root).fail(DYN_ERROR_PARSE, line(root), "the root of a model is <mujoco>");
  return root;
}

std::vector<Report::Entry> MjcfSource::finish() {
  auto all = files_[0].report->finish();
  for (size_t i = 1; i < files_.size(); ++i)
    for (Report::Entry& entry : files_[i].report->finish())
      all.push_back({entry.level, 0, files_[i].report->where(entry.line) + entry.message});
  return all;
}

}  // namespace dyn::load
