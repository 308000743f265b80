// What dyn.h declares is there for programs: names, values and sentences of enumerations, the interface as JSON.
#include <cstring>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "capi/each_value.hpp"

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
  EXPECT_NE(
      json.find(
          R"({"name":"dyn_frame_velocity","returns":"dynStatus","parameters":[{"name":"model","type":"const dynModel*"},{"name":"data","type":"dynData*"},)"
          R"({"name":"frame","type":"int"},{"name":"reference","type":"dynReference"},{"name":"velocity","type":"double","length":[6]}])"),
      std::string::npos);
}

// Data with the part of an algorithm, and no other, computes it; data without is refused. Fields tell the same part of their
// producer.
TEST(Reflection, AlgorithmsNameThePartThatTheyNeed) {
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  dynModel* model = nullptr;
  ASSERT_EQ(dyn_model_load(DYN_MODELS_DIR "/robots/go2.urdf", &options, &model), DYN_OK) << dyn_last_error();
  const std::vector<double> q(std::size_t(dyn_model_nq(model)), 0.1);
  dyn_test::each_value("dynAlgorithm", [&](const dynEnumValueInfo& value) {
    dynAlgorithmInfo info = {};
    info.struct_size = sizeof info;
    ASSERT_EQ(dyn_algorithm_info(model, dynAlgorithm(value.value), &info), DYN_OK);
    std::vector<double> out[4];
    dynBatchArrays arrays;
    dyn_batch_arrays_init(&arrays);
    arrays.q = arrays.v = arrays.a = arrays.tau = arrays.q1 = arrays.b = q.data(), arrays.joint = arrays.frame = 1,
    arrays.dt = 1e-3;
    for (int k = 0; k < info.outputs; ++k)
      out[k].resize(std::size_t(info.rows[k] * info.cols[k] * info.pages[k])), arrays.out[k] = out[k].data();
    const auto with_parts = [&](dynParts parts) {
      dynData* data = nullptr;
      EXPECT_EQ(dyn_data_new(model, parts, &data), DYN_OK);
      const dynStatus status = dyn_algorithm_run(model, data, dynAlgorithm(value.value), &arrays);
      dyn_data_free(data);
      return status;
    };
    EXPECT_EQ(with_parts(info.part ? info.part : dynParts(DYN_PART_FRAMES)), DYN_OK) << dyn_last_error();
    if (!info.part) return;
    EXPECT_EQ(with_parts(info.part == DYN_PART_MASS || info.part == DYN_PART_INVERSE ? DYN_PART_ENERGY : DYN_PART_INVERSE),
              DYN_ERROR_PART);
    for (int k = 0; k < dyn_field_count(); ++k) {
      dynFieldInfo field = {};
      field.struct_size = sizeof field;
      ASSERT_EQ(dyn_field_info(k, &field), DYN_OK);
      if (field.producer == "dyn_" + std::string(info.name)) {
        EXPECT_EQ(field.part, info.part) << field.name;
      }
    }
  });
  dyn_model_free(model);
}

TEST(Reflection, AnAlgorithmRunsByItsNumber) {
  dynModel* model = nullptr;
  dynData* data = nullptr;
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  ASSERT_EQ(dyn_model_load(DYN_MODELS_DIR "/robots/panda.urdf", &options, &model), DYN_OK) << dyn_last_error();
  ASSERT_EQ(dyn_data_new(model, 0, &data), DYN_OK);
  const auto nq = std::size_t(dyn_model_nq(model)), nv = std::size_t(dyn_model_nv(model));
  std::vector<double> q(nq), v(nv, 0.3), a(nv, -0.2), tau(nv), same(nv);
  ASSERT_EQ(dyn_configuration_random(model, 1, nullptr, nullptr, q.data()), DYN_OK);
  ASSERT_EQ(dyn_rnea(model, data, q.data(), v.data(), a.data(), nullptr, tau.data()), DYN_OK);
  dynBatchArrays arrays;
  dyn_batch_arrays_init(&arrays);
  arrays.q = q.data(), arrays.v = v.data(), arrays.a = a.data(), arrays.out[0] = same.data();
  ASSERT_EQ(dyn_algorithm_run(model, data, DYN_ALGORITHM_RNEA, &arrays), DYN_OK) << dyn_last_error();
  EXPECT_EQ(tau, same);
  EXPECT_EQ(dyn_algorithm_run(model, data, DYN_ALGORITHM_RNEA, nullptr), DYN_ERROR_ARGUMENT);
  EXPECT_EQ(dyn_algorithm_run(model, data, dynAlgorithm(1000), &arrays), DYN_ERROR_ARGUMENT);
  EXPECT_EQ(dyn_algorithm_run(nullptr, data, DYN_ALGORITHM_RNEA, &arrays), DYN_ERROR_HANDLE);
  arrays.struct_size = 8;
  EXPECT_EQ(dyn_algorithm_run(model, data, DYN_ALGORITHM_RNEA, &arrays), DYN_ERROR_SIZE);
  dyn_data_free(data);
  dyn_model_free(model);
}

}  // namespace
