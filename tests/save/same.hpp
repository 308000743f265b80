// Compares a model with the one that was saved and loaded again.
#pragma once

#include <cstring>

#include "common/random_tree.hpp"
#include "common/results.hpp"
#include "common/work.hpp"
#include "model/load.hpp"
#include "model/save.hpp"

namespace dyn_test {

inline ModelPtr again(const Model& m, dynFormat format, dynBase base, SaveReport* lines = nullptr) {
  SaveReport report;
  const std::string text = save_string(m, format, false, report);
  if (lines) *lines = report;
  LoadOptions options;
  options.base = base;
  options.gravity = format == DYN_FORMAT_URDF ? std::array<double, 3>{m.gravity[0], m.gravity[1], m.gravity[2]} : options.gravity;
  return load_string(text, options);
}

inline std::string name_of(const Model& m, Index joint) { return m.string(m.joints()[joint].name); }

// Same coordinates, M, nle, and placements of the named frames; with limits and other joint parameters.
inline void expect_same(const Model& a, const Model& b, std::uint64_t seed, bool limits) {
  ASSERT_EQ(a.n.nq, b.n.nq);
  ASSERT_EQ(a.n.nv, b.n.nv);
  State s(a, seed);
  const Results x(a, s.q, s.v), y(b, s.q, s.v);
  EXPECT_LE((x.tau - y.tau).cwiseAbs().maxCoeff(), 1e-12 * std::max(1.0, x.tau.cwiseAbs().maxCoeff()));
  EXPECT_LE((x.M - y.M).cwiseAbs().maxCoeff(), 1e-12 * std::max(1.0, x.M.cwiseAbs().maxCoeff()));
  for (Index f = 1; f < a.n.frames; ++f) {
    const bool body = a.frames()[f].type == DYN_FRAME_TYPE_BODY;
    const char* name = a.string(a.frames()[f].name);
    Index g = 0;
    for (Index k = 1; k < b.n.frames; ++k)
      if (!std::strcmp(b.string(b.frames()[k].name), name) && (b.frames()[k].type == DYN_FRAME_TYPE_BODY) == body) g = k;
    ASSERT_GT(g, 0) << name;
    const double far = std::max(1.0, x.frames[std::size_t(f)].cwiseAbs().maxCoeff());
    EXPECT_LE((x.frames[std::size_t(f)] - y.frames[std::size_t(g)]).cwiseAbs().maxCoeff(), 1e-12 * far) << name;
  }
  if (!limits) return;
  for (Index k = 0; k < a.n.nv; ++k) {
    EXPECT_EQ(a.damping()[k], b.damping()[k]);
    EXPECT_EQ(a.friction()[k], b.friction()[k]);
    EXPECT_EQ(a.effort_limit()[k], b.effort_limit()[k]);
  }
  for (Index k = 0; k < a.n.nq; ++k) {
    EXPECT_EQ(a.lower_limit()[k], b.lower_limit()[k]);
    EXPECT_EQ(a.upper_limit()[k], b.upper_limit()[k]);
  }
}

inline bool follows(const Model& m) { return m.has_mimic != 0; }

inline std::vector<std::pair<std::string, dynBase>> robots() {
  const std::string folder = DYN_MODELS_DIR;
  std::vector<std::pair<std::string, dynBase>> out;
  for (const char* r : {"double_pendulum", "go2", "gripper", "humanoid", "panda"})
    out.emplace_back(folder + "/robots/" + r + ".urdf", DYN_BASE_FIXED);
  for (const char* r : {"go2", "humanoid"}) out.emplace_back(folder + "/robots/" + r + ".urdf", DYN_BASE_FLOATING);
  for (const char* r :
       {"bricard", "four_bar", "four_bar_in_space", "humanoid_on_both_feet", "linkage_gripper", "parallel_four_bar"})
    out.emplace_back(folder + "/mechanisms/" + r + ".urdf", DYN_BASE_FIXED);
  return out;
}
inline ModelPtr robot(const std::string& path, dynBase base) {
  LoadOptions options;
  options.base = base;
  return load_file(path, options);
}

}  // namespace dyn_test
