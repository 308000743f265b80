// The files of an MJCF model: the main one, included ones, attached models. Each element knows its file.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <set>

#include "budget.hpp"
#include "confined.hpp"
#include "reader.hpp"

namespace dyn::load {

class MjcfSource {
 public:
  // file: "" for text in memory; relative names then refer to the working directory.
  MjcfSource(const std::string& text, const std::string& file, const LoadOptions& options);

  Element& root() { return *root_; }
  // Child elements of e, with <include> replaced by its content.
  std::vector<Element*> children(Element& e);
  std::vector<Element*> children(Element& e, std::string_view name);
  // Opens another model's file and returns its <mujoco>. A model that attaches itself is an error at e.
  Element& open_model(const Element& e, const std::string& file);
  void close_model() { opening_.pop_back(); }

  Report& report(const Element& e) const;  // of the file that holds e
  Reader reader(const Element& e, const std::string& owner) const { return {report(e), owner}; }
  // Path of a name: relative to the main file, else to the file that holds e. Throws for files that may not be read.
  std::filesystem::path path(const Element& e, const std::string& name) const {
    const std::filesystem::path file = folder_ / name, next_to = std::filesystem::path(report(e).file()).parent_path() / name;
    std::error_code none;
    const std::filesystem::path& found =
        !std::filesystem::exists(file, none) && std::filesystem::exists(next_to, none) ? next_to : file;
    return confined_.check(found.string()), found;
  }

  // Charges the account of the load for what e asks for: charge(&Budget::add_bodies, 1, e).
  void charge(void (Budget::*add)(std::int64_t, const Report&, int), std::int64_t n, const Element& e) const {
    if (budget_) (budget_->*add)(n, report(e), line(e));
  }

  // Load reports of all files. Entries of files other than the main one begin with their name.
  std::vector<Report::Entry> finish();

 private:
  struct File {
    std::unique_ptr<Report> report;
    std::vector<std::unique_ptr<Document>> documents;  // the file's parts (split_deep), the main one first
  };
  Element& open(const std::string& text, const std::string& file);
  void include(Element& e, std::vector<Element*>& out);
  Element* part(const Element& e) const;  // that <dyn:part> stands for

  std::filesystem::path folder_;
  bool strict_;
  Budget* budget_;
  Confined confined_;
  std::vector<File> files_;  // the first one is the main file
  std::map<const tinyxml2::XMLDocument*, std::pair<Report*, size_t>> reports_;  // and the number of the file
  std::map<const Element*, Element*> included_;  // <include> elements to their files' roots
  std::set<std::string> names_;                  // included files
  std::vector<std::string> opening_;             // models within models
  Element* root_;
};

}  // namespace dyn::load
