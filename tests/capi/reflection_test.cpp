// What dyn.h declares is there for programs: names, values and sentences of enumerations, the interface as JSON.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

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

// f(value) for each of an enumeration
template <class F>
void each_value(const char* type, F&& f) {
  dynEnumInfo info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(dyn_enum_info(dyn_enum_id(type), &info), DYN_OK);
  for (int k = 0; k < info.count; ++k) {
    dynEnumValueInfo value = {};
    value.struct_size = sizeof value;
    ASSERT_EQ(dyn_enum_value_info(dyn_enum_id(type), k, &value), DYN_OK);
    SCOPED_TRACE(value.identifier);
    f(value);
  }
}

TEST(Reflection, JointTypesHaveTheSizesThatModelsHave) {
  each_value("dynJointType", [](const dynEnumValueInfo& value) {
    dynJointTypeInfo info = {};
    info.struct_size = sizeof info;
    ASSERT_EQ(dyn_joint_type_info(dynJointType(value.value), &info), DYN_OK);
    EXPECT_STRNE(info.name, "");
    if (value.value == DYN_JOINT_TYPE_FIXED || value.value == DYN_JOINT_TYPE_COMPOSITE) {
      EXPECT_EQ(info.nq, 0);
      return;
    }
    dynBuilder* builder = nullptr;
    dynModel* model = nullptr;
    ASSERT_EQ(dyn_builder_new("one", &builder), DYN_OK);
    dynJointSpec spec;
    dyn_joint_spec_init(&spec);
    spec.name = "joint", spec.type = dynJointType(value.value), spec.pitch = 0.1;
    const double com[3] = {}, inertia[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    ASSERT_EQ(dyn_builder_add_joint(builder, &spec), DYN_OK) << dyn_last_error();
    ASSERT_EQ(dyn_builder_add_body(builder, "body", "joint", nullptr, 1, com, inertia), DYN_OK);
    ASSERT_EQ(dyn_builder_finish(builder, &model), DYN_OK) << dyn_last_error();
    EXPECT_EQ(info.nq, dyn_model_nq(model));
    EXPECT_EQ(info.nv, dyn_model_nv(model));
    EXPECT_STRNE(info.chain, "");
    dyn_model_free(model);
    dyn_builder_free(builder);
  });
  dynJointTypeInfo planar = {};
  planar.struct_size = sizeof planar;
  ASSERT_EQ(dyn_joint_type_info(DYN_JOINT_TYPE_PLANAR, &planar), DYN_OK);
  EXPECT_STREQ(planar.chain, "prismatic axis_x, prismatic axis_y, revolute axis");
  EXPECT_EQ(planar.axis, 1);
  EXPECT_EQ(planar.axis2, 0);
  EXPECT_EQ(dyn_joint_type_info(dynJointType(1000), &planar), DYN_ERROR_ARGUMENT);
  EXPECT_NE(std::strstr(dyn_last_error(), "_FREE_FLYER"), nullptr);
}

TEST(Reflection, ShapeTypesNameTheirSizes) {
  each_value("dynShapeType", [](const dynEnumValueInfo& value) {
    dynShapeTypeInfo info = {};
    info.struct_size = sizeof info;
    ASSERT_EQ(dyn_shape_type_info(dynShapeType(value.value), &info), DYN_OK);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(std::strlen(info.size[k]) > 0, k < info.sizes);
    // a positive length is asked for where there is a size, and nothing else
    if (info.surface || value.value == DYN_SHAPE_TYPE_MESH) return;
    dynGeometry geometry;
    dyn_geometry_init(&geometry);
    geometry.type = dynShapeType(value.value);
    const double identity[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, point[3] = {5, 0, 0};
    dynClosestPoint closest = {};
    closest.struct_size = sizeof closest;
    for (int k = 0; k < 3; ++k) geometry.size[k] = k < info.sizes ? 1 : -1;
    EXPECT_EQ(dyn_geometry_closest_point(&geometry, identity, point, &closest), DYN_OK) << dyn_last_error();
    if (info.sizes) geometry.size[info.sizes - 1] = -1;
    EXPECT_EQ(dyn_geometry_closest_point(&geometry, identity, point, &closest) == DYN_OK, info.sizes == 0);
  });
}

TEST(Reflection, ConstraintTypesAndIntegratorsHaveInfos) {
  each_value("dynConstraintType", [](const dynEnumValueInfo& value) {
    dynConstraintTypeInfo info = {};
    info.struct_size = sizeof info;
    ASSERT_EQ(dyn_constraint_type_info(dynConstraintType(value.value), &info), DYN_OK);
    EXPECT_EQ(info.rows == 0, value.value == DYN_CONSTRAINT_TYPE_NONE || value.value == DYN_CONSTRAINT_TYPE_LOOP);
  });
  dynConstraintTypeInfo weld = {};
  weld.struct_size = sizeof weld;
  ASSERT_EQ(dyn_constraint_type_info(DYN_CONSTRAINT_TYPE_WELD, &weld), DYN_OK);
  EXPECT_EQ(weld.rows, 6);
  EXPECT_STREQ(weld.name, "weld");
  each_value("dynIntegrator", [](const dynEnumValueInfo& value) {
    dynIntegratorInfo info = {};
    info.struct_size = sizeof info;
    ASSERT_EQ(dyn_integrator_info(dynIntegrator(value.value), &info), DYN_OK);
    EXPECT_GT(info.order, 0);
  });
}

// The array that an effect names is the one that brings it into a model.
TEST(Reflection, EffectsNameTheirArrays) {
  int arrays = 0;
  each_value("dynEffects", [&](const dynEnumValueInfo& value) {
    dynEffectTypeInfo info = {};
    info.struct_size = sizeof info;
    if (!std::has_single_bit(unsigned(value.value))) {
      EXPECT_EQ(dyn_effect_type_info(unsigned(value.value), &info), DYN_ERROR_ARGUMENT);
      return;
    }
    ASSERT_EQ(dyn_effect_type_info(unsigned(value.value), &info), DYN_OK) << dyn_last_error();
    EXPECT_EQ(info.bit, unsigned(value.value));
    EXPECT_STRNE(info.absent, "");
    EXPECT_EQ(std::strlen(info.quantity) > 0, info.array >= 0);
    if (info.array < 0) return;
    ++arrays;
    dynBuilder* builder = nullptr;
    dynModel* model = nullptr;
    dynData* data = nullptr;
    ASSERT_EQ(dyn_builder_new("one", &builder), DYN_OK);
    dynJointSpec spec;
    dyn_joint_spec_init(&spec);
    const double one = 1, com[3] = {}, inertia[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    spec.name = "joint", spec.type = DYN_JOINT_TYPE_REVOLUTE;
    const std::pair<dynModelArray, const double**> members[] = {{DYN_MODEL_ARRAY_ARMATURE, &spec.armature}, {DYN_MODEL_ARRAY_DAMPING, &spec.damping},
                                                                {DYN_MODEL_ARRAY_FRICTION, &spec.friction}, {DYN_MODEL_ARRAY_STIFFNESS, &spec.stiffness}};
    for (const auto& [array, member] : members)
      if (array == info.array) *member = &one;
    ASSERT_EQ(dyn_builder_add_joint(builder, &spec), DYN_OK) << dyn_last_error();
    ASSERT_EQ(dyn_builder_add_body(builder, "body", "joint", nullptr, 1, com, inertia), DYN_OK);
    ASSERT_EQ(dyn_builder_finish(builder, &model), DYN_OK) << dyn_last_error();
    EXPECT_EQ(*dyn_model_array(model, dynModelArray(info.array)), 1);
    ASSERT_EQ(dyn_data_new(model, 0, &data), DYN_OK);
    ASSERT_EQ(dyn_data_set_effects(model, data, 0, DYN_EFFECT_ALL), DYN_OK);
    std::uint32_t acting = 0;
    ASSERT_EQ(dyn_data_effects(model, data, 0, &acting), DYN_OK);
    EXPECT_EQ(acting & ~std::uint32_t(DYN_EFFECT_SLEEPING), info.bit);
    dyn_data_free(data), dyn_model_free(model), dyn_builder_free(builder);
  });
  EXPECT_GE(arrays, 4);
  dynEffectTypeInfo info = {};
  info.struct_size = sizeof info;
  for (const std::uint32_t bit : {0u, 3u, 1u << 30, 1u << 31}) EXPECT_EQ(dyn_effect_type_info(bit, &info), DYN_ERROR_ARGUMENT) << bit;
}

TEST(Reflection, ContactSolversHaveInfos) {
  each_value("dynContactSolverType", [](const dynEnumValueInfo& value) {
    dynContactSolverTypeInfo info = {};
    info.struct_size = sizeof info;
    ASSERT_EQ(dyn_contact_solver_type_info(dynContactSolverType(value.value), &info), DYN_OK);
    EXPECT_EQ(info.refined, value.value != DYN_CONTACT_SOLVER_TYPE_PGS);
    EXPECT_EQ(std::strlen(info.sentence) > 0, true);
  });
}

// Data with the part of an algorithm, and no other, computes it; data without is refused. Fields tell the same part of their producer.
TEST(Reflection, AlgorithmsNameThePartThatTheyNeed) {
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  dynModel* model = nullptr;
  ASSERT_EQ(dyn_model_load(DYN_MODELS_DIR "/robots/go2.urdf", &options, &model), DYN_OK) << dyn_last_error();
  const std::vector<double> q(std::size_t(dyn_model_nq(model)), 0.1);
  each_value("dynAlgorithm", [&](const dynEnumValueInfo& value) {
    dynAlgorithmInfo info = {};
    info.struct_size = sizeof info;
    ASSERT_EQ(dyn_algorithm_info(model, dynAlgorithm(value.value), &info), DYN_OK);
    std::vector<double> out[4];
    dynBatchArrays arrays;
    dyn_batch_arrays_init(&arrays);
    arrays.q = arrays.v = arrays.a = arrays.tau = arrays.q1 = arrays.b = q.data(), arrays.joint = arrays.frame = 1, arrays.dt = 1e-3;
    for (int k = 0; k < info.outputs; ++k) out[k].resize(std::size_t(info.rows[k] * info.cols[k] * info.pages[k])), arrays.out[k] = out[k].data();
    const auto with_parts = [&](dynParts parts) {
      dynData* data = nullptr;
      EXPECT_EQ(dyn_data_new(model, parts, &data), DYN_OK);
      const dynStatus status = dyn_algorithm_run(model, data, dynAlgorithm(value.value), &arrays);
      dyn_data_free(data);
      return status;
    };
    EXPECT_EQ(with_parts(info.part ? info.part : dynParts(DYN_PART_FRAMES)), DYN_OK) << dyn_last_error();
    if (!info.part) return;
    EXPECT_EQ(with_parts(info.part == DYN_PART_MASS || info.part == DYN_PART_INVERSE ? DYN_PART_ENERGY : DYN_PART_INVERSE), DYN_ERROR_PART);
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
