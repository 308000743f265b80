// What dyn.h declares is there for programs: names, values and sentences of enumerations, the interface as JSON.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>

#include "dyn.h"

namespace {

std::string header() {
  std::ifstream file(DYN_MODELS_DIR "/../include/dyn.h");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

// identifier -> value, of all that is reflected
std::map<std::string, int> reflected() {
  std::map<std::string, int> values;
  for (int e = 0; e < dyn_enum_count(); ++e) {
    dynEnumInfo info = {};
    info.struct_size = sizeof info;
    EXPECT_EQ(dyn_enum_info(e, &info), DYN_OK);
    for (int k = 0; k < info.count; ++k) {
      dynEnumValueInfo value = {};
      value.struct_size = sizeof value;
      EXPECT_EQ(dyn_enum_value_info(e, k, &value), DYN_OK);
      EXPECT_TRUE(values.emplace(value.identifier, value.value).second) << value.identifier;
      EXPECT_EQ(std::string(info.prefix) + value.name, value.identifier);
      EXPECT_STRNE(value.sentence, "") << value.identifier;
    }
  }
  return values;
}

TEST(Reflection, EveryValueOfTheHeaderIsThere) {
  const std::map<std::string, int> values = reflected();
  const std::string text = header();
  const std::regex enumerator(R"(\b(DYN_\w+) = (1u << )?(0x[0-9a-f]+|\d+))");
  int count = 0;
  for (std::sregex_iterator i(text.begin(), text.end(), enumerator), end; i != end; ++i) {
    if ((*i)[1] == "DYN_MAX_CONTACTS_PER_PAIR") continue;  // a constant
    const int number = std::stoi((*i)[3], nullptr, 0);
    ASSERT_EQ(values.count((*i)[1]), 1u) << (*i)[1];
    EXPECT_EQ(values.at((*i)[1]), (*i)[2].matched ? 1 << number : number) << (*i)[1];
    ++count;
  }
  EXPECT_EQ(count, int(values.size()));
  EXPECT_GT(count, 250);
}

TEST(Reflection, EnumerationsHaveNamesAndSentences) {
  for (int e = 0; e < dyn_enum_count(); ++e) {
    dynEnumInfo info = {};
    info.struct_size = sizeof info;
    ASSERT_EQ(dyn_enum_info(e, &info), DYN_OK);
    EXPECT_EQ(dyn_enum_id(info.name), e);
    EXPECT_STRNE(info.sentence, "") << info.name;
  }
  dynEnumInfo effects = {};
  effects.struct_size = sizeof effects;
  ASSERT_EQ(dyn_enum_info(dyn_enum_id("dynEffects"), &effects), DYN_OK);
  EXPECT_STREQ(effects.prefix, "DYN_EFFECT_");
  EXPECT_EQ(effects.bits, 1);
}

TEST(Reflection, RefusesUnknownOnes) {
  EXPECT_EQ(dyn_enum_id("dynColour"), -1);
  EXPECT_NE(std::strstr(dyn_last_error(), "dynColour"), nullptr);
  EXPECT_EQ(dyn_enum_id(nullptr), -1);
  dynEnumInfo info = {};
  info.struct_size = sizeof info;
  EXPECT_EQ(dyn_enum_info(-1, &info), DYN_ERROR_ARGUMENT);
  EXPECT_EQ(dyn_enum_info(dyn_enum_count(), &info), DYN_ERROR_ARGUMENT);
  EXPECT_EQ(dyn_enum_info(0, nullptr), DYN_ERROR_ARGUMENT);
  info.struct_size = 4;
  EXPECT_EQ(dyn_enum_info(0, &info), DYN_ERROR_SIZE);
  dynEnumValueInfo value = {};
  value.struct_size = sizeof value;
  EXPECT_EQ(dyn_enum_value_info(0, 1000, &value), DYN_ERROR_ARGUMENT);
  EXPECT_EQ(dyn_enum_value_info(1000, 0, &value), DYN_ERROR_ARGUMENT);
}

TEST(Reflection, TheInterfaceNamesEveryFunction) {
  const std::string json = dyn_interface_json(), text = header();
  const std::regex function(R"(DYN_API [^;(]*\b(dyn_\w+)\()");
  for (std::sregex_iterator i(text.begin(), text.end(), function), end; i != end; ++i)
    EXPECT_NE(json.find("{\"name\":\"" + (*i)[1].str() + "\",\"returns\":"), std::string::npos) << (*i)[1];
  EXPECT_NE(json.find(R"({"name":"dyn_frame_velocity","returns":"dynStatus","parameters":[{"name":"model","type":"const dynModel*"},{"name":"data","type":"dynData*"},)"
                      R"({"name":"frame","type":"int"},{"name":"reference","type":"dynReference"},{"name":"velocity","type":"double","length":[6]}])"),
            std::string::npos);
}

}  // namespace
