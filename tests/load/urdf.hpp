// Loads URDF texts through the C interface, for tests.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "dyn.h"

namespace dyn_test {

struct FreeModel {
  void operator()(dynModel* m) const { dyn_model_free(m); }
};
using ModelHandle = std::unique_ptr<dynModel, FreeModel>;

struct Entry {
  dynReportLevel level;
  int line;
  std::string message;
};

struct Loaded {
  dynStatus status;
  std::string error;
  ModelHandle model;

  std::vector<Entry> report() const {
    std::vector<Entry> all;
    for (int i = 0; i < dyn_model_report_count(model.get()); ++i) {
      dynReportEntry e{};
      e.struct_size = sizeof e;
      EXPECT_EQ(DYN_OK, dyn_model_report_entry(model.get(), i, &e));
      all.push_back({e.level, e.line, e.message});
    }
    return all;
  }
  // The first entry with this text, or null.
  static const Entry* find(const std::vector<Entry>& all, const std::string& words) {
    for (const Entry& e : all)
      if (e.message.find(words) != std::string::npos) return &e;
    return nullptr;
  }
  bool reports(const std::string& words, dynReportLevel level, int line) const {
    const auto all = report();
    const Entry* e = find(all, words);
    if (e && e->level == level && e->line == line) return true;
    ADD_FAILURE() << "no entry '" << words << "' of level " << level << " at line " << line;
    for (const Entry& x : all) std::printf("  %d line %d: %s\n", x.level, x.line, x.message.c_str());
    return false;
  }
  int warnings() const {
    int n = 0;
    for (const Entry& e : report()) n += e.level != DYN_REPORT_LEVEL_INFO;
    return n;
  }
};

struct Options : dynLoadOptions {
  explicit Options(dynBase base_ = DYN_BASE_FIXED, bool strict_ = false) {
    dyn_load_options_init(this);
    base = base_;
    strict = strict_;
  }
};

inline Loaded load(const std::string& text, const Options& options = Options()) {
  dynModel* m = nullptr;
  const dynStatus s = dyn_model_load_string(text.c_str(), &options, &m);
  EXPECT_EQ(s == DYN_OK, m != nullptr);
  return {s, s == DYN_OK ? "" : dyn_last_error(), ModelHandle(m)};
}

inline Loaded load_path(const std::string& path, const Options& options = Options()) {
  dynModel* m = nullptr;
  const dynStatus s = dyn_model_load(path.c_str(), &options, &m);
  EXPECT_EQ(s == DYN_OK, m != nullptr);
  return {s, s == DYN_OK ? "" : dyn_last_error(), ModelHandle(m)};
}

inline Loaded good(const std::string& text, const Options& options = Options()) {
  Loaded l = load(text, options);
  EXPECT_EQ(DYN_OK, l.status) << l.error;
  return l;
}

inline dynJointInfo joint(const Loaded& l, const char* name) {
  dynJointInfo info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(DYN_OK, dyn_model_joint_info(l.model.get(), dyn_model_joint_id(l.model.get(), name), &info)) << name;
  return info;
}

inline dynFrameInfo frame(const Loaded& l, const char* name, dynFrameType type = DYN_FRAME_TYPE_BODY) {
  dynFrameInfo info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(DYN_OK, dyn_model_frame_info(l.model.get(), dyn_model_frame_id_of_type(l.model.get(), name, type), &info)) << name;
  return info;
}

inline std::vector<std::string> joint_names(const Loaded& l) {
  std::vector<std::string> names;
  for (int j = 1; j < dyn_model_njoints(l.model.get()); ++j) names.push_back(dyn_model_joint_name(l.model.get(), j));
  return names;
}

// Snippets: a link of 1 kg, and a joint between two links.
inline const std::string solid =
    "<inertial><mass value=\"1\"/><inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial>";
inline std::string link(const std::string& name, const std::string& inside = solid) {
  return "<link name=\"" + name + "\">" + inside + "</link>\n";
}
inline const std::string ab = link("a") + link("b");
inline const std::string limit = "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>";
inline std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                         const std::string& inside = "<axis xyz=\"0 0 1\"/>" + limit) {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child + "\"/>" +
         inside + "</joint>\n";
}
inline std::string robot(const std::string& inside) { return "<robot name=\"r\">\n" + inside + "</robot>\n"; }

}  // namespace dyn_test
