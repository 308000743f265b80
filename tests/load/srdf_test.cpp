// SRDF files: named configurations, disabled pairs, reports of unused parts, and hostile files.
#include <clocale>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "load/urdf.hpp"

namespace dyn_test {
namespace {

const std::string arm =
    robot(link("base") + link("upper") + link("lower") + link("hand") + joint("shoulder", "revolute", "base", "upper") +
          joint("elbow", "continuous", "upper", "lower", "<axis xyz=\"0 0 1\"/>") +
          joint("finger", "revolute", "lower", "hand", "<axis xyz=\"0 0 1\"/>" + limit + "<mimic joint=\"shoulder\"/>") +
          link("tip") + joint("weld", "fixed", "hand", "tip", ""));

// An SRDF on disk for the arm.
struct Beside {
  std::filesystem::path path;
  Options options;
  Beside(const std::string& inside, dynBase base = DYN_BASE_FIXED, bool strict = false, bool whole = false)
      : options(base, strict) {
    std::string name = (std::filesystem::temp_directory_path() / "dyn_srdf_XXXXXX").string();
    EXPECT_TRUE(mkdtemp(name.data()));
    path = std::filesystem::path(name) / "r.srdf";
    std::ofstream(path, std::ios::binary) << (whole ? inside : "<robot name=\"r\">\n" + inside + "</robot>\n");
    text_ = path.string();
    options.srdf = text_.c_str();
  }
  ~Beside() { std::filesystem::remove_all(path.parent_path()); }
  Loaded load(const std::string& urdf = arm) const { return dyn_test::load(urdf, options); }

 private:
  std::string text_;
};

std::vector<double> configuration(const Loaded& l, const std::string& name) {
  std::vector<double> q(std::size_t(dyn_model_nq(l.model.get())));
  EXPECT_EQ(DYN_OK, dyn_model_configuration(l.model.get(), name.c_str(), q.data())) << dyn_last_error();
  return q;
}
std::set<std::string> names(const Loaded& l) {
  std::set<std::string> out;
  for (int i = 0; i < dyn_model_nconfigurations(l.model.get()); ++i) out.insert(dyn_model_configuration_name(l.model.get(), i));
  return out;
}
struct Pair {
  std::string one, two, reason;
  bool operator==(const Pair&) const = default;
};
std::vector<Pair> pairs(const dynModel* m) {
  std::vector<Pair> out;
  for (int i = 0; i < dyn_model_ndisabled_pairs(m); ++i) {
    int a = -1, b = -1;
    const char* reason = nullptr;
    EXPECT_EQ(DYN_OK, dyn_model_disabled_pair(m, i, &a, &b, &reason));
    out.push_back({dyn_model_frame_name(m, a), dyn_model_frame_name(m, b), reason});
    dynFrameInfo info{};
    info.struct_size = sizeof info;
    EXPECT_EQ(DYN_OK, dyn_model_frame_info(m, a, &info));
    EXPECT_EQ(DYN_FRAME_TYPE_BODY, info.type);
  }
  return out;
}

using Numbers = std::vector<double>;

TEST(Srdf, StatesAreConfigurations) {
  const Beside srdf(
      "<group name=\"all\"/>\n<group_state name=\"home\" group=\"all\">\n<joint name=\"elbow\" value=\"1.5\"/>\n<joint "
      "name=\"shoulder\" value=\" -0.25 \"/>\n</group_state>\n"
      "<group_state name=\"rest\" group=\"all\"/>\n");
  const Loaded l = srdf.load();
  ASSERT_EQ(DYN_OK, l.status) << l.error;
  EXPECT_EQ((std::set<std::string>{"neutral", "home", "rest"}), names(l));
  EXPECT_EQ((Numbers{-0.25, 1.5}), configuration(l, "home"));
  EXPECT_EQ((Numbers{0, 0}), configuration(l, "rest"));
}

TEST(Srdf, FloatingBaseByAnyName) {
  const std::string state =
      "<group_state name=\"up\" group=\"g\"><joint name=\"NAME\" value=\"1 2 3 0 0 2 0\"/><joint name=\"elbow\" "
      "value=\"1\"/></group_state>";
  for (const std::string name : {"root_joint", "world_joint"}) {
    std::string text = state;
    text.replace(text.find("NAME"), 4, name);
    const Beside srdf(
        "<virtual_joint name=\"world_joint\" type=\"floating\" parent_frame=\"world\" child_link=\"base\"/>\n" + text,
        DYN_BASE_FLOATING);
    const Loaded l = srdf.load();
    ASSERT_EQ(DYN_OK, l.status) << l.error;
    EXPECT_EQ((Numbers{1, 2, 3, 0, 0, 1, 0, 0, 1}), configuration(l, "up"));  // normalised
    EXPECT_TRUE(l.reports("virtual_joint 'world_joint'", DYN_REPORT_LEVEL_INFO, 2));
    // a fixed base has no coordinates to set, which is no error
    const Beside fixed(
        "<virtual_joint name=\"world_joint\" type=\"floating\" parent_frame=\"world\" child_link=\"base\"/>\n" + text,
        DYN_BASE_FIXED, true);
    const Loaded f = fixed.load();
    ASSERT_EQ(DYN_OK, f.status) << f.error;
    EXPECT_EQ((Numbers{0, 1}), configuration(f, "up"));
    EXPECT_TRUE(f.reports("is not used: the base is fixed", DYN_REPORT_LEVEL_INFO, 3));
  }
}

TEST(Srdf, AnglesAndCosSin) {
  Beside srdf(
      "<group_state name=\"a\" group=\"g\"><joint name=\"elbow\" value=\"0.5\"/></group_state><group_state name=\"b\" "
      "group=\"g\"><joint name=\"elbow\" value=\"0 -2\"/></group_state>");
  Loaded l = srdf.load();
  EXPECT_EQ((Numbers{0, 0.5}), configuration(l, "a"));
  EXPECT_EQ((Numbers{0, -M_PI / 2}), configuration(l, "b"));
  srdf.options.cos_sin = 1;
  l = srdf.load();
  EXPECT_EQ((Numbers{0, std::cos(0.5), std::sin(0.5)}), configuration(l, "a"));
  EXPECT_EQ((Numbers{0, 0, -1}), configuration(l, "b"));
}

TEST(Srdf, NamesOfStates) {
  const Beside srdf("<group_state name=\"home\" group=\"arm\"><joint name=\"elbow\" value=\"1\"/></group_state>\n"
                    "<group_state name=\"home\" group=\"hand\"><joint name=\"elbow\" value=\"2\"/></group_state>\n"
                    "<group_state name=\"only\" group=\"arm\"/>\n<group_state name=\"neutral\" group=\"arm\"/>\n"
                    "<group_state name=\"home\" group=\"arm\"><joint name=\"elbow\" value=\"3\"/></group_state>\n");
  const Loaded l = srdf.load();
  ASSERT_EQ(DYN_OK, l.status) << l.error;
  EXPECT_EQ((std::set<std::string>{"neutral", "arm/home", "hand/home", "only", "arm/neutral"}), names(l));
  EXPECT_EQ(1, configuration(l, "arm/home")[1]);
  EXPECT_EQ(2, configuration(l, "hand/home")[1]);
  EXPECT_TRUE(l.reports("occurs twice: the first one is used", DYN_REPORT_LEVEL_DROPPED, 6));
}

TEST(Srdf, DisabledPairs) {
  const Beside srdf(
      "<disable_collisions link1=\"base\" link2=\"upper\" reason=\"Adjacent\"/>\n<disable_collisions link1=\"hand\" "
      "link2=\"base\"/>\n"
      "<disable_collisions link1=\"upper\" link2=\"base\" reason=\"Never\"/>\n<disable_collisions link1=\"tip\" link2=\"tip\" "
      "reason=\"x\"/>\n");
  const Loaded l = srdf.load();
  ASSERT_EQ(DYN_OK, l.status) << l.error;
  EXPECT_EQ((std::vector<Pair>{{"base", "upper", "Adjacent"}, {"hand", "base", ""}}), pairs(l.model.get()));
  EXPECT_TRUE(l.reports("1 x <disable_collisions> of a pair that is disabled already", DYN_REPORT_LEVEL_INFO, 4));
  EXPECT_TRUE(l.reports("link 'tip' and itself", DYN_REPORT_LEVEL_WARNING, 5));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_disabled_pair(l.model.get(), 2, nullptr, nullptr, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_disabled_pair(l.model.get(), -1, nullptr, nullptr, nullptr));
  EXPECT_EQ(DYN_OK, dyn_model_disabled_pair(l.model.get(), 1, nullptr, nullptr, nullptr));
  EXPECT_EQ(0, dyn_model_ndisabled_pairs(load(arm).model.get()));
}

TEST(Srdf, DefaultsAsMoveItReadsThem) {
  const Beside srdf(
      "<disable_default_collisions link=\"tip\"/>\n<enable_collisions link1=\"tip\" link2=\"base\"/>\n<enable_collisions "
      "link1=\"upper\" link2=\"tip\"/>\n"
      "<disable_collisions link1=\"tip\" link2=\"upper\" reason=\"User\"/>\n");
  const Loaded l = srdf.load();
  ASSERT_EQ(DYN_OK, l.status) << l.error;
  EXPECT_EQ((std::vector<Pair>{{"tip", "upper", "User"}, {"tip", "lower", "Default"}, {"tip", "hand", "Default"}}),
            pairs(l.model.get()));
}

TEST(Srdf, UnknownNamesAreWarningsAndErrorsUnderStrict) {
  const struct {
    std::string text, words;
  } rows[] = {
      {"<disable_collisions link1=\"bsae\" link2=\"upper\"/>", "no link 'bsae' in the robot (did you mean 'base'?)"},
      {"<enable_collisions link1=\"base\" link2=\"uper\"/>", "no link 'uper' in the robot (did you mean 'upper'?)"},
      {"<disable_default_collisions link=\"hnad\"/>", "no link 'hnad'"},
      {"<group_state name=\"a\" group=\"g\"><joint name=\"elbo\" value=\"1\"/></group_state>",
       "group_state 'a': there is no joint 'elbo' in the robot (did you mean 'elbow'?)"},
      {"<group_state name=\"a\" group=\"g\"><joint name=\"elbow\" value=\"1 2 3\"/></group_state>", "has 3 numbers and needs 1"},
      {"<group_state name=\"a\" group=\"g\"><joint name=\"elbow\"/></group_state>", "has no value"},
      {"<group_state name=\"a\" group=\"g\"><joint name=\"elbow\" value=\"1\"/><joint name=\"elbow\" value=\"2\"/></group_state>",
       "occurs twice"},
      {"<group name=\"g\"><joint name=\"shulder\"/></group>", "no joint 'shulder'"},
      {"<group name=\"g\"><link name=\"handd\"/></group>", "no link 'handd'"},
      {"<group name=\"g\"><chain base_link=\"base\" tip_link=\"tipp\"/></group>", "no link 'tipp'"},
      {"<group name=\"arm\"/><group_state name=\"a\" group=\"amr\"/>", "no group 'amr' (did you mean 'arm'?)"},
      {"<end_effector name=\"e\" parent_link=\"lowr\" group=\"g\"/>", "no link 'lowr'"},
      {"<passive_joint name=\"elbw\"/>", "no joint 'elbw'"},
      {"<virtual_joint name=\"v\" type=\"fixed\" parent_frame=\"w\" child_link=\"bas\"/>", "no link 'bas'"},
      {"<disable_collision link=\"base\"/>", "<disable_collision> is not used"},
      {"<rotor_params/>", "rotor"},
  };
  for (const auto& [text, words] : rows) {
    SCOPED_TRACE(text);
    const Loaded l = Beside("\n" + text).load();
    ASSERT_EQ(DYN_OK, l.status) << l.error;
    EXPECT_TRUE(l.reports(words, DYN_REPORT_LEVEL_DROPPED, 3));
    const auto report = l.report();
    EXPECT_EQ(0u, Loaded::find(report, words)->message.rfind("r.srdf: ", 0));
    const Loaded strict = Beside("\n" + text, DYN_BASE_FIXED, true).load();
    EXPECT_EQ(DYN_ERROR_STRICT, strict.status);
    EXPECT_NE(std::string::npos, strict.error.find("r.srdf:3: ")) << strict.error;
    EXPECT_NE(std::string::npos, strict.error.find(words)) << strict.error;
  }
}

TEST(Srdf, WhatIsListed) {
  const Loaded l = Beside(
                       "<group name=\"arm\"><joint name=\"elbow\"/><link name=\"base\"/><group "
                       "name=\"x\"/></group>\n<end_effector name=\"e\" parent_link=\"tip\" group=\"arm\"/>\n"
                       "<passive_joint name=\"elbow\"/>\n<link_sphere_approximation link=\"base\"><sphere center=\"0 0 0\" "
                       "radius=\"1\"/></link_sphere_approximation>\n"
                       "<group_state name=\"a\" group=\"arm\"><joint name=\"finger\" value=\"1\"/>\n<joint name=\"weld\" "
                       "value=\"1\"/>\n<joint name=\"shoulder\" value=\"1.5\"/></group_state>\n")
                       .load();
  ASSERT_EQ(DYN_OK, l.status) << l.error;
  EXPECT_TRUE(l.reports("group 'arm': not used", DYN_REPORT_LEVEL_INFO, 2));
  EXPECT_TRUE(l.reports("end_effector 'e': not used", DYN_REPORT_LEVEL_INFO, 3));
  EXPECT_TRUE(l.reports("passive_joint 'elbow': not used", DYN_REPORT_LEVEL_INFO, 4));
  EXPECT_TRUE(l.reports("link_sphere_approximation: not used", DYN_REPORT_LEVEL_INFO, 5));
  EXPECT_TRUE(l.reports("joint 'finger' follows 'shoulder'", DYN_REPORT_LEVEL_INFO, 6));
  EXPECT_TRUE(l.reports("joint 'weld' is fixed", DYN_REPORT_LEVEL_INFO, 7));
  EXPECT_TRUE(l.reports("joint 'shoulder' is at 1.5, outside of its limits, -1 to 1", DYN_REPORT_LEVEL_WARNING, 8));
}

TEST(Srdf, Refused) {
  const struct {
    std::string text;
    dynStatus status;
    std::string words;
  } rows[] = {
      {"", DYN_ERROR_PARSE, ""},
      {"<robot name=\"r\">", DYN_ERROR_PARSE, "never closed"},
      {"<robot name=\"r\"><group_state name=\"a\"", DYN_ERROR_PARSE, "r.srdf:1"},
      {"<mujoco/>", DYN_ERROR_PARSE, "begins with <robot>"},
      {arm, DYN_ERROR_PARSE, "this is a URDF"},
      {"<!DOCTYPE a [<!ENTITY a \"aaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;\">]><robot name=\"&b;\"/>", DYN_ERROR_PARSE,
       "not allowed"},
      {"<robot name=\"r\">\n<group_state group=\"g\"/></robot>", DYN_ERROR_PARSE, "no attribute name"},
      {"<robot name=\"r\">\n<disable_collisions link1=\"base\"/></robot>", DYN_ERROR_PARSE, "no attribute link2"},
      {"<robot name=\"r\">\n<group_state name=\"a\"><joint name=\"elbow\" value=\"1,5\"/></group_state></robot>", DYN_ERROR_PARSE,
       "a point as decimal sign"},
      {"<robot name=\"r\">\n<group_state name=\"a\"><joint name=\"elbow\" value=\"nan\"/></group_state></robot>", DYN_ERROR_PARSE,
       "not finite"},
      {"<robot name=\"r\">\n<group_state name=\"a\"><joint name=\"elbow\" value=\"0 0\"/></group_state></robot>",
       DYN_ERROR_QUATERNION, "is zero"},
  };
  for (const auto& row : rows) {
    SCOPED_TRACE(row.text.substr(0, 80));
    const Loaded l = Beside(row.text, DYN_BASE_FIXED, false, true).load();
    EXPECT_EQ(row.status, l.status);
    EXPECT_NE(std::string::npos, l.error.find("r.srdf")) << l.error;
    EXPECT_NE(std::string::npos, l.error.find(row.words)) << l.error;
  }
  std::string deep = "<robot name=\"r\">";
  for (int i = 0; i < 100000; ++i) deep += "<group name=\"g\">";
  EXPECT_EQ(DYN_ERROR_LIMIT, Beside(deep, DYN_BASE_FIXED, false, true).load().status);
  Options o;
  o.srdf = "/no/such/file.srdf";
  const Loaded missing = load(arm, o);
  EXPECT_EQ(DYN_ERROR_FILE, missing.status);
  EXPECT_NE(std::string::npos, missing.error.find("/no/such/file.srdf: cannot be opened"));
  o.srdf = "";
  EXPECT_EQ(DYN_ERROR_ARGUMENT, load(arm, o).status);
}

TEST(Srdf, SameUnderACommaLocale) {
  const Beside srdf("<group_state name=\"a\" group=\"g\"><joint name=\"elbow\" value=\"0.25\"/></group_state>");
  const std::string before = std::setlocale(LC_ALL, nullptr);
  if (!std::setlocale(LC_ALL, "de_DE.UTF-8")) GTEST_SKIP() << "no such locale";
  const Loaded l = srdf.load();
  std::setlocale(LC_ALL, before.c_str());
  EXPECT_EQ(0.25, configuration(l, "a")[1]);
}

// ---------------------------------------------------------------------------------------------------- builders keep pairs

struct FreeBuilder {
  void operator()(dynBuilder* b) const { dyn_builder_free(b); }
};
using BuilderHandle = std::unique_ptr<dynBuilder, FreeBuilder>;
BuilderHandle builder_of(const dynModel* m) {
  dynBuilder* b = nullptr;
  EXPECT_EQ(DYN_OK, dyn_builder_from_model(m, &b));
  return BuilderHandle(b);
}
ModelHandle finish(const BuilderHandle& b) {
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_OK, dyn_builder_finish(b.get(), &m)) << dyn_last_error();
  return ModelHandle(m);
}

TEST(Srdf, BuildersCarryPairs) {
  const Loaded l = Beside(
                       "<disable_collisions link1=\"base\" link2=\"hand\" reason=\"one\"/><disable_collisions link1=\"lower\" "
                       "link2=\"tip\" reason=\"two\"/>")
                       .load();
  const std::vector<Pair> all = {{"base", "hand", "one"}, {"lower", "tip", "two"}};
  ASSERT_EQ(all, pairs(l.model.get()));
  EXPECT_EQ(all, pairs(finish(builder_of(l.model.get())).get()));

  const double q[2] = {0.1, 0.2};
  const char* elbow = "elbow";
  BuilderHandle b = builder_of(l.model.get());
  ASSERT_EQ(DYN_OK, dyn_builder_lock(b.get(), &elbow, 1, q, 2)) << dyn_last_error();
  EXPECT_EQ(all, pairs(finish(b).get()));

  b = builder_of(l.model.get());
  ASSERT_EQ(DYN_OK, dyn_builder_attach(b.get(), l.model.get(), "other_", nullptr)) << dyn_last_error();
  std::vector<Pair> both = all;
  both.push_back({"other_base", "other_hand", "one"}), both.push_back({"other_lower", "other_tip", "two"});
  EXPECT_EQ(both, pairs(finish(b).get()));
}

// A pair is dropped with one of its links.
TEST(Srdf, SubtreesKeepTheirPairs) {
  const std::string chain =
      robot(link("a") + link("b") + link("c") + link("d") + joint("ab", "continuous", "a", "b", "<axis xyz=\"0 0 1\"/>") +
            joint("bc", "continuous", "b", "c", "<axis xyz=\"0 1 0\"/>") +
            joint("cd", "continuous", "c", "d", "<axis xyz=\"1 0 0\"/>"));
  const Loaded l =
      Beside("<disable_collisions link1=\"a\" link2=\"c\"/><disable_collisions link1=\"b\" link2=\"d\" reason=\"x\"/>")
          .load(chain);
  ASSERT_EQ(2u, pairs(l.model.get()).size()) << l.error;
  BuilderHandle b = builder_of(l.model.get());
  ASSERT_EQ(DYN_OK, dyn_builder_keep_subtree(b.get(), "ab"));
  EXPECT_EQ((std::vector<Pair>{{"b", "d", "x"}}), pairs(finish(b).get()));
  b = builder_of(l.model.get());
  ASSERT_EQ(DYN_OK, dyn_builder_remove_subtree(b.get(), "cd"));
  EXPECT_EQ((std::vector<Pair>{{"a", "c", ""}}), pairs(finish(b).get()));
}

// The only pair overlaps from the start, so nothing is tested and the report says so. With longer links there is no such report.
TEST(Pairs, NoneTestedIsReported) {
  for (const bool overlap : {true, false}) {
    const std::string ball = solid + "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision>";
    const std::string away = std::string("<origin xyz=\"0 0 ") + (overlap ? "0.05" : "1") + "\"/><axis xyz=\"0 1 0\"/>";
    const Loaded l = good(robot(link("base", ball) + link("upper", solid) + link("lower", ball) +
                                joint("shoulder", "continuous", "base", "upper", away) +
                                joint("elbow", "continuous", "upper", "lower", away)));
    ASSERT_EQ(1, dyn_model_npairs(l.model.get()));
    const auto report = l.report();
    EXPECT_EQ(overlap, Loaded::find(report, "no pair of the collision shapes is tested") != nullptr);
  }
}

// Disabled pairs of links are not tested unless the data enables them.
TEST(Srdf, DisabledPairsAreNotTested) {
  const std::string ball = solid + "<collision><geometry><sphere radius=\"0.01\"/></geometry></collision>",
                    away = "<origin xyz=\"0 0 1\"/>";
  const std::string chain = robot(link("base", ball) + link("upper", ball) + link("lower", ball) + link("hand", ball) +
                                  joint("shoulder", "continuous", "base", "upper", away + "<axis xyz=\"0 1 0\"/>") +
                                  joint("elbow", "continuous", "upper", "lower", away + "<axis xyz=\"0 1 0\"/>") +
                                  joint("wrist", "continuous", "lower", "hand", away + "<axis xyz=\"0 1 0\"/>"));
  const Beside srdf("<disable_collisions link1=\"hand\" link2=\"base\" reason=\"Never\"/>");
  const Loaded l = srdf.load(chain);
  const dynModel* m = l.model.get();
  ASSERT_EQ(3, dyn_model_npairs(m));  // base - lower, base - hand, upper - hand
  std::set<std::pair<int, int>> tested, disabled;
  for (int k = 0; k < 3; ++k) {
    int a, b;
    dynPairReason reason;
    ASSERT_EQ(DYN_OK, dyn_model_pair(m, k, &a, &b, &reason));
    (reason == DYN_PAIR_REASON_DISABLED ? disabled : tested).insert({a, b});
  }
  EXPECT_EQ((std::set<std::pair<int, int>>{{0, 3}}), disabled);
  EXPECT_EQ((std::set<std::pair<int, int>>{{0, 2}, {1, 3}}), tested);
}

}  // namespace
}  // namespace dyn_test
